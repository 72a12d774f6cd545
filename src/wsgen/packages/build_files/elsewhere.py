"""Where a file or folder of a package is that a build file looks for at another place."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from wsgen.packages.source_shares import may_have_sources

if TYPE_CHECKING:
    from pathlib import Path


def find_elsewhere(source: Path, name: str, *, is_folder: bool = False) -> str | None:
    """The only path with this name in a package, relative to its folder."""
    found = []
    for folder, folders, files in os.walk(source):
        folders[:] = filter(may_have_sources, folders)
        if name in (folders if is_folder else files):
            found.append(os.path.relpath(os.path.join(folder, name), source))
    return found[0] if len(found) == 1 else None
