"""The names under which the packages of a workspace spawn their robots."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.workspace.layout import find_packages

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.workspace.layout import Workspace


# The options of spawn_entity.py and of create, with a name that is written out after them.
NAMED = re.compile(r"""['"]-(?:entity|name)['"]\s*,\s*['"]([^'"]+)['"]""")


def spawned_entities(workspace: Workspace) -> frozenset[str]:
    """Find the names in the launch files of its packages, except computed ones."""
    return frozenset(
        name
        for package in find_packages(workspace)
        for file in sorted(package.path.glob("launch/*.py"))
        for name in NAMED.findall(_read(file))
    )


def _read(file: Path) -> str:
    """Read the text; empty if the file cannot be read."""
    try:
        return file.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""
