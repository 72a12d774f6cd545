"""The folders of packages and models that addresses name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.world.lookup import is_folder, model_folders
from wsgen.xmltree import Malformed, child_text, parse

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path


def share_on_model_path(environment: Mapping[str, str]) -> Callable[[str], Path | None]:
    """Look a package or model up where the environment tells Gazebo to look for models."""
    folders = model_folders(environment)

    def share_of(package: str) -> Path | None:
        found = (folder / package for folder in folders if package)
        return next((folder for folder in found if is_folder(folder)), None)

    return share_of


def share_around(file: Path) -> Callable[[str], Path | None]:
    """Look a package up among the folders that a file lies in, and those beside them.

    A folder is taken for the package if it is called so, or if its package.xml says so. Gazebo's
    `model://` addresses are looked up in the same way.
    """
    folders = file.absolute().parents

    def share_of(package: str) -> Path | None:
        for folder in folders:
            if folder.name == package or _manifest_name(folder) == package:
                return folder
            for beside in (folder / package, folder / "share" / package):
                if package and is_folder(beside):
                    return beside
        return None

    return share_of


def _manifest_name(folder: Path) -> str | None:
    try:
        root = parse((folder / "package.xml").read_bytes())
    except OSError:
        return None
    return None if isinstance(root, Malformed) else child_text(root, "name")
