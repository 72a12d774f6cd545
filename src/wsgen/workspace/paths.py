"""Check that colcon, CMake and the shells can all handle the path of a workspace."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.errors import RequestError

if TYPE_CHECKING:
    from pathlib import Path


# As tried: with `$`, `:` and the backquote the build passes, but sourcing the install space does
# not bring in the package; with the others CMake fails, or loses a part of the path.
REFUSED = frozenset(';$:`"\\[]?<>\n\r')


def check_workspace_path(path: Path) -> None:
    """Stop if the path has a character that breaks builds.

    Raises:
        RequestError: it has one.
    """
    refused = sorted(REFUSED.intersection(str(path)))
    if refused:
        named = " and ".join("a line break" if sign in "\n\r" else sign for sign in refused)
        raise RequestError(
            f"A workspace cannot be in {str(path)!r}: CMake and colcon do not support {named} "
            "in a path.",
            hint="Rename the folder, or use another one; letters, digits, spaces, `-`, `_` and "
            "`.` are safe.",
        )
