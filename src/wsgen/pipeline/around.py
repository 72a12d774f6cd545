"""Packages and models in the folders around a file, for what is not installed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.xmltree import Malformed, child_text, parse

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


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
                if package and beside.is_dir():
                    return beside
        return None

    return share_of


def _manifest_name(folder: Path) -> str | None:
    try:
        root = parse((folder / "package.xml").read_bytes())
    except OSError:
        return None
    return None if isinstance(root, Malformed) else child_text(root, "name")
