"""What several commands read from their words, and how they write paths."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import click

from wsgen.errors import RequestError

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from wsgen.workspace.layout import Workspace


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


def short_name(path: Path) -> str:
    """Relative to the current folder where that is below it; odd bytes made printable."""
    return click.format_filename(short_path(path))


def next_command(workspace: Workspace, *commands: str) -> str:
    """What to type next in a workspace, from the current folder."""
    import shlex

    root = os.fspath(workspace.root)
    if not os.path.join(os.getcwd(), "").startswith(os.path.join(root, "")):  # noqa: PTH109, PTH118
        commands = (f"cd {shlex.quote(short_name(workspace.root))}", *commands)
    return " && ".join(commands)
