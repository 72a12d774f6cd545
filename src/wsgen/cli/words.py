"""Launch arguments, paths and next steps: text that several commands read or print."""

from __future__ import annotations

import os
import shlex
from typing import TYPE_CHECKING

from wsgen.cli.terminal import echo
from wsgen.errors import NotFoundError, RequestError
from wsgen.text.printable import clean_line

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from wsgen.packages.workspace.layout import Workspace
    from wsgen.pipeline.requests import ValidateRequest


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


def launch_file_of(
    names: Sequence[str], launch_file: str | None
) -> tuple[str, str, Workspace | None] | None:
    """The package, name and workspace of the launch file that is given in place of a package.

    None where none is.

    Raises:
        NotFoundError: It does not exist.
        RequestError: It is in no package, or beside other names or --launch.
    """
    from pathlib import Path

    from wsgen.packages.workspace.layout import (
        LAUNCH_FILES,
        find_launch_files,
        has_launch_function,
        workspace_around,
        workspace_if_any,
    )
    from wsgen.pipeline.plan_launch import package_of, packages_with

    given = [
        name
        for name in names
        if (name.endswith(LAUNCH_FILES) and not Path(name).is_dir())
        or (name.endswith(".py") and has_launch_function(Path(name)))
    ]
    if not given:
        return None
    if len(names) > 1 or launch_file is not None:
        other = next((name for name in names if name != given[0]), f"--launch {launch_file}")
        raise RequestError(
            f"{given[0]!r} is a launch file, and cannot be combined with {other!r}.",
            hint="Give one launch file, or the packages: all launch files that spawn a robot are"
            " simulated.",
        )
    file = Path(given[0])
    if not file.is_file():
        owner = next(iter(packages_with(workspace_if_any(None), given[0])), "PACKAGE")
        raise NotFoundError(
            f"The launch file {file} does not exist.",
            hint=f"Check its path, or name the package: {owner} --launch {shlex.quote(file.name)}",
        )
    package = package_of(file)
    if package is None:
        raise RequestError(
            f"{file} is not in a package: no package.xml is above it.",
            hint=f"Simulate it alone: wsgen launch {shlex.quote(given[0])} --play",
        )
    file = file.absolute()
    folder = next(one for one in file.parents if (one / "package.xml").is_file())
    alike = [one for one in find_launch_files(folder) if one.name == file.name]
    name = os.fspath(file.relative_to(folder)) if len(alike) > 1 else file.name
    return package, name, workspace_around(file.parent)


def short_path(path: Path) -> str:
    """The path relative to the current folder if it is below it."""
    relative = os.path.relpath(path)
    return os.fspath(path) if relative.startswith("..") else relative


def short_name(path: Path) -> str:
    """The path relative to the current folder if it is below it, made printable."""
    return clean_line(short_path(path))


def written(file: Path) -> str:
    """The path of a file that was written, and its size."""
    size = file.stat().st_size
    for unit, least in (("MB", 1_000_000), ("kB", 1_000)):
        if size >= least:
            return f"{short_name(file)}: {size / least:.1f} {unit}"
    return f"{short_name(file)}: {size} bytes"


def report_unfinished(video: Path) -> None:
    """Say that a signal keeps a video from being drawn, and what is kept."""
    import contextlib

    text = f"{video} was not finished: wsgen was ended before it was drawn.{_kept(video)}"
    with contextlib.suppress(OSError):  # the terminal may be gone
        echo(text, err=True)


def unwritten(recording: Path) -> str:
    """Say that a recording has no message, and what is kept."""
    return f"{short_name(recording)} was not written: no message was received.{_kept(recording)}"


def _kept(file: Path) -> str:
    return f" The previous {file.name} is unchanged." if file.exists() else ""


def next_command(workspace: Workspace, *commands: str) -> str:
    """The commands to run next in a workspace, starting from the current folder."""
    root = os.fspath(workspace.root)
    if not os.path.join(os.getcwd(), "").startswith(os.path.join(root, "")):  # noqa: PTH109, PTH118
        commands = (f"cd {shlex.quote(short_name(workspace.root))}", *commands)
    return " && ".join(commands)


def announce_place(workspace: Workspace, given: str | None) -> None:
    """Say which workspace will be written to, where it is around the current folder.

    Not if it was `given`.
    """
    from wsgen.packages.workspace.layout import current_folder

    here = current_folder()
    if given is None and workspace.root in here.parents:
        name = clean_line(str(workspace.root))
        echo(f"note: The current folder is in the workspace {name}, which is used.", err=True)


def engine_words(request: ValidateRequest) -> list[str]:
    """`--engine`, unless it is the default."""
    from wsgen.cli.options import chosen_engines

    if request.engines == chosen_engines(None):
        return []
    return ["--engine", request.engines[0] if len(request.engines) == 1 else "all"]


def workspace_words(workspace: Workspace | None) -> list[str]:
    """`-w` for the workspace, unless the current folder is in it."""
    from wsgen.packages.workspace.layout import open_workspace

    try:
        is_meant = workspace is None or open_workspace(None).root == workspace.root
    except (NotFoundError, RequestError):
        is_meant = False
    return [] if workspace is None or is_meant else ["-w", short_name(workspace.root)]
