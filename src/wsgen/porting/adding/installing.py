"""Have files that launch files and ROS read be installed into the share folder of a package."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.porting.adding.cmake import CMake
from wsgen.porting.adding.setup_py import add_data

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.porting.adding.addition import Addition

SHARE = "share/${PROJECT_NAME}"


def share(addition: Addition, file: Path, pattern: str = "*.*") -> None:
    """Install the folder of a file, if the file is not installed already.

    Args:
        addition: The package.
        file: In a folder of the package.
        pattern: Of the files of that folder that setup.py installs.
    """
    if addition.is_shared(file):
        return
    folder = file.parent.relative_to(addition.folder).as_posix()
    if addition.is_python:
        add_data(addition, folder, pattern)
        return
    cmake = CMake(addition)
    for command in cmake.calls("ament_auto_package"):
        words = [one.text for one in command.arguments]
        if "INSTALL_TO_SHARE" in words and folder not in words:
            edit = cmake.argument_beside(command, words[-1].__eq__, folder)
            cmake.add(folder, edit, "Add it to INSTALL_TO_SHARE of ament_auto_package().")
            return
    place, _, name = folder.rpartition("/")
    cmake.install("DIRECTORY", folder, f"{SHARE}/{place}" if place and name else SHARE)
