"""What several commands read from their words, and how they write paths."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from wsgen.errors import RequestError

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path


def split_launch_arguments(words: Iterable[str]) -> dict[str, str]:
    """`name:=value` as `ros2 launch` takes it; the last of a name counts.

    Raises:
        RequestError: a word is not of this form, or has no value.
    """
    values: dict[str, str] = {}
    for word in words:
        name, _, value = word.partition(":=")
        if not name or not value:
            raise RequestError(
                f"The launch argument {word!r} is not of the form name:=value.",
                hint="For example: z:=0.5",
            )
        values[name] = value
    return values


def short_path(path: Path) -> str:
    """Relative to the current folder where it is below that."""
    relative = os.path.relpath(path)
    return os.fspath(path) if relative.startswith("..") else relative
