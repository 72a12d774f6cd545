"""The file that a world's name stands for."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

# Where Gazebo Classic, Gazebo Sim and Gazebo Fortress look, after the current folder.
SEARCH_PATHS = ("GAZEBO_RESOURCE_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH")


def find_world(name: str, environment: Mapping[str, str]) -> Path | None:
    """The file of a world given as a path or a name; None if a name is found nowhere.

    A path that is absolute is taken as it is, whether there is a file or not.
    """
    if Path(name).is_absolute():
        return Path(name)
    folders = [Path.cwd()]
    for variable in SEARCH_PATHS:
        folders += [
            Path(entry) for entry in environment.get(variable, "").split(os.pathsep) if entry
        ]
    for folder in folders:
        for candidate in (folder / name, folder / "worlds" / name):
            if candidate.is_file():
                return candidate
    return None
