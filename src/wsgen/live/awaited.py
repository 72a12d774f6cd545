"""The process whose end ends a run: whether a plan starts it."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import RequestError
from wsgen.live.programs import PLUGINS
from wsgen.suggestions import ask_for_nearest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.model.plan import LaunchPlan, Process

# What launch files of Gazebo start, that are not installed (`wsgen.live.includes`).
_OF_INCLUDES = ("gazebo", "gzserver", "gzclient", "gz", "create", "bridge_node")


def check_awaited(name: str, plan: LaunchPlan) -> None:
    """Refuse the name of a process that the plan does not start.

    Raises:
        RequestError: It starts none that is called so.
    """
    of_processes = {one for process in plan.processes for one in _names_of(process) if one}
    known = of_processes | set(_of_includes(plan))
    bare = re.sub(r"-\d+$", "", name)  # `node-1` is the first process
    if {name, bare} & known or any(plan.is_unknown(one) for one in of_processes):
        return
    if _is_mentioned(bare, plan):
        return
    raise RequestError(
        f"--until-exit waits for `{name}`, but the launch file starts no node or program of this "
        "name.",
        hint=f"{ask_for_nearest(bare, known)}`wsgen launch` without --run lists what the launch "
        "file starts.",
    )


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
            text = file.read_text(encoding="utf-8", errors="replace")
            if any(f"{quote}{name}{quote}" in text for quote in "'\""):
                return True
    return False
