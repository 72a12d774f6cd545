"""Launch arguments, paths and next steps: text that several commands read or print."""

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
    """Parse `name:=value` as `ros2 launch` does; the last value of a name counts.

    Raises:
        RequestError: A word does not have this form, or has no value.
    """
    values: dict[str, str] = {}
    for word in words:
        name, _, value = word.partition(":=")
        if not name or not value:
            raise RequestError(
                f"The launch argument {word!r} does not have the form name:=value.",
                hint="Write it like this: z:=0.5",
            )
        values[name] = value
    return values


def short_path(path: Path) -> str:
    """The path relative to the current folder if it is below it."""
    relative = os.path.relpath(path)
    return os.fspath(path) if relative.startswith("..") else relative


def short_name(path: Path) -> str:
    """The path relative to the current folder if it is below it, made printable."""
    return click.format_filename(short_path(path))


def next_command(workspace: Workspace, *commands: str) -> str:
    """The commands to run next in a workspace, starting from the current folder."""
    import shlex

    root = os.fspath(workspace.root)
    if not os.path.join(os.getcwd(), "").startswith(os.path.join(root, "")):  # noqa: PTH109, PTH118
        commands = (f"cd {shlex.quote(short_name(workspace.root))}", *commands)
    return " && ".join(commands)
