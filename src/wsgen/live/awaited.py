"""The process whose end ends a run: whether a plan starts it."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import RequestError
from wsgen.launching import commands
from wsgen.live.programs import PLUGINS
from wsgen.text.files import read_regular_text
from wsgen.text.suggestions import ask_for_nearest, some_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

    from wsgen.model.plan import LaunchPlan, Process

# What launch files of Gazebo start, that are not installed (`wsgen.live.includes`).
_OF_INCLUDES = ("gazebo", "gzserver", "gzclient", "gz", "create", "bridge_node")


MOST_NAMED = 12  # processes in a hint


def check_awaited(name: str, plan: LaunchPlan) -> None:
    """Refuse the name of a process that the plan does not start.

    Raises:
        RequestError: It starts none that is called so.
    """
    nested = [process for process in plan.processes if _is_launch(process)]
    of_processes = {
        one
        for process in plan.processes
        if process not in nested
        for one in _names_of(process)
        if one
    }
    known = of_processes | set(_of_includes(plan))
    bare = re.sub(r"-\d+$", "", name)  # `node-1` is the first process
    if {name, bare} & known or any(plan.is_unknown(one) for one in of_processes):
        return
    if {name, bare} & {one for process in nested for one in _names_of(process)}:
        raise RequestError(
            f"--until-exit waits for `{name}`, which starts another launch file; wsgen plays that "
            "in the same launch, which does not end by itself.",
            hint=f"Name one of its nodes or programs. {ask_for_nearest(bare, known)}".rstrip(),
        )
    if _is_mentioned(bare, plan):
        return
    raise RequestError(
        f"--until-exit waits for `{name}`, but the launch file starts no node or program of this "
        "name.",
        hint=what_is_started(bare, _shown_names(plan, nested), known),
    )


def what_is_started(name: str, started: Collection[str], known: Collection[str] = ()) -> str:
    """The next step where nothing of a name is started, but what else.

    `known` are more names that may be meant.
    """
    listed = f"It starts {some_of(sorted(started), MOST_NAMED)}." if started else "It starts none."
    return f"{ask_for_nearest(name, {*started, *known})}{listed}"


def _shown_names(plan: LaunchPlan, nested: Collection[Process]) -> set[str]:
    """The names that processes are best known by."""
    names = {
        next(filter(None, _names_of(process)), None)
        for process in plan.processes
        if process not in nested
    }
    return {name for name in names if name}


def _is_launch(process: Process) -> bool:
    """Whether it runs `ros2 launch`."""
    return any(commands.nested_launch(program) for program in commands.programs(process))


def _of_includes(plan: LaunchPlan) -> Iterator[str]:
    for include in plan.includes:
        if not include.evaluated:
            yield from _OF_INCLUDES
            yield from (value for value in include.arguments.values() if value)


def _names_of(process: Process) -> Iterator[str | None]:
    """What a process may be called; a node has its name, and the one of its program."""
    yield process.name
    if process.name and process.command is None:
        namespace = process.namespace.strip("/")
        yield f"/{namespace}/{process.name}" if namespace else f"/{process.name}"
    yield process.executable
    if process.executable:
        yield Path(process.executable).name
    if process.command:
        yield Path(process.command[0]).name
    yield PLUGINS.get(process.executable or "", (None, None))[1]


def _is_mentioned(name: str, plan: LaunchPlan) -> bool:
    """Whether it may be the `exec_name` of a node, or a program that is not in the plan."""
    if any(name in found.message for found in plan.diagnostics):
        return True
    for file in {plan.launch_file, *(include.file for include in plan.includes)}:
        with suppress(OSError):
            text = read_regular_text(file, errors="replace")
            if any(f"{quote}{name}{quote}" in text for quote in "'\""):
                return True
    return False
