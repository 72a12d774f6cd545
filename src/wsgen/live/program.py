"""Find the program that `ros2 run PACKAGE EXECUTABLE` starts."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError
from wsgen.live.programs import LeftOut, find_replacement
from wsgen.ros.environment.processes import module_command
from wsgen.text.suggestions import advice, suggest

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from wsgen.ros.environment import RosEnvironment

PYTHON = b"python"
BUILD = "Build the workspace (wsgen build), and name the one that has it with --workspace."


def find_command(
    package: str,
    executable: str,
    arguments: tuple[str, ...],
    *,
    ros: RosEnvironment,
    variables: Mapping[str, str],
) -> tuple[str, ...]:
    """The command line of a program.

    Args:
        package: That it belongs to.
        executable: Its name in `lib/PACKAGE`.
        arguments: Its arguments.
        ros: What it runs with.
        variables: Its environment.

    Raises:
        NotFoundError: No package has it, or it cannot run here.
    """
    replaced = find_replacement(package, executable, arguments, is_sourced=ros.is_sourced)
    if replaced is not None:
        program = replaced.replacement
        if isinstance(program, LeftOut):
            raise NotFoundError(
                f"{executable} of {package} does not run here: {program.why}.",
                hint="Source a ROS that has it, or do without it.",
            )
        return module_command(ros.python, program.module, *program.arguments, *replaced.arguments)
    folders = [folder / package for folder in _libraries(variables)]
    for folder in folders:
        path = folder / executable
        if path.is_file() and os.access(path, os.X_OK):
            command = (str(path), *arguments)
            return command if ros.is_sourced or not is_python(path) else (str(ros.python), *command)
    known = sorted({one for folder in folders for one in executables(folder)})
    if known:
        raise NotFoundError(
            f"The package {package} has no program `{executable}`.",
            hint=suggest(executable, known),
        )
    packages = {one.name for folder in _libraries(variables) for one in _folders(folder)}
    raise NotFoundError(
        f"No package {package} with programs is installed.", hint=advice(package, packages, BUILD)
    )


def executables(folder: Path) -> Iterator[str]:
    """The programs of a package, of its folder in `lib`."""
    if folder.is_dir():
        for one in folder.iterdir():
            if one.is_file() and os.access(one, os.X_OK):
                yield one.name


def _libraries(variables: Mapping[str, str]) -> list[Path]:
    prefixes = variables.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return [Path(prefix, "lib") for prefix in prefixes if prefix]


def _folders(folder: Path) -> Iterator[Path]:
    for one in folder.iterdir() if folder.is_dir() else ():
        if any(executables(one)):
            yield one


def is_python(path: Path) -> bool:
    """Whether the first line of a program names Python as its interpreter."""
    with path.open("rb") as file:
        first = file.readline(200)
    return first.startswith(b"#!") and PYTHON in first
