"""What is checked of a plan before it is run: that it starts something, and what is waited for.

It says, too, what cannot run here, and what the plan would take from absent modules.
"""

from __future__ import annotations

import re
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.errors import NotFoundError, RequestError
from wsgen.launching import commands
from wsgen.live.python_failures import way_to_module
from wsgen.live.replacements import PLUGINS, LeftOut, find_component, find_replacement
from wsgen.model.plan import ABSENT_MODULE, OF_ABSENT_MODULE, STARTS_UNKNOWN
from wsgen.text.files import read_regular_text
from wsgen.text.suggestions import ask_for_nearest, some_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan, Process


# What launch files of Gazebo start, that are not installed (`wsgen.live.resolve`).
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


CANNOT_RUN = Rule(
    code="LCH091",
    name="cannot-run",
    severity=Severity.ERROR,
    summary="A program that the launch file starts cannot run here.",
    what="Looks, with `wsgen launch --run --strict`, for programs of packages that are not "
    "installed, and for what needs a window of Gazebo or libraries that PyPI does not have.",
    why="Without --strict the program is left out: what it would do is not done, and what waits "
    "for it waits for ever.",
    example="Node(package='rviz2', executable='rviz2')",
    instead="Node(package='rviz2', executable='rviz2', condition=IfCondition(use_rviz))",
)
ABSENT_LAUNCH_MODULE = Rule(
    code="LCH100",
    name="absent-launch-module",
    severity=Severity.WARNING,
    summary="The launch file takes what it starts from a Python module that is not installed.",
    what="Looks, with `wsgen launch --run`, for what a launch file or an included one calls or "
    "reads in modules of packages that are not installed. With --strict it is an error. Where the "
    "launch file starts nothing else, nothing is run, and the exit code is 4.",
    why="`ros2 launch` ends with a ModuleNotFoundError where the module is not installed. wsgen "
    "starts what the launch file itself describes, without what the module would start or say.",
    example="from moveit_configs_utils.launches import generate_demo_launch",
    instead="source /opt/ros/jazzy/setup.bash  # that of a ROS which has the module",
)
STARTS_NOTHING = Rule(
    code="LCH101",
    name="launch-starts-nothing",
    severity=Severity.WARNING,
    summary="The launch file starts no process.",
    what="Looks, with `wsgen launch --run`, for plans without processes and without included "
    "launch files of packages that are not installed.",
    why="The run ends at once, as that of `ros2 launch`: conditions exclude every node, or an "
    "action is created but not added to the LaunchDescription.",
    example="return LaunchDescription([])",
    instead="return LaunchDescription([node])",
)


def absent_modules(plan: LaunchPlan, workspace: Collection[str]) -> Iterator[Diagnostic]:
    """Report modules that are not installed, of which the launch file needs something.

    Args:
        plan: Of the launch file.
        workspace: The names of its packages.
    """
    for module in plan.unresolved:
        if module.why != ABSENT_MODULE:
            continue
        of_module = [one for one in plan.unresolved if one.what.startswith(f"{module.what}.")]
        started = [one.what for one in of_module if one.why == STARTS_UNKNOWN]
        read = [one.what for one in of_module if one.why == OF_ABSENT_MODULE]
        if not started and not read:
            continue
        rest = f"what {started[0]} starts" if started else f"the value of {read[0]}"
        yield ABSENT_LAUNCH_MODULE.at(
            module.file,
            module.line,
            module.what,
            message=f"The Python module {module.what} is not installed: {rest} is left out.",
            hint=way_to_module(module.what, Path(sys.executable), workspace, None),
        )


def starts_nothing(plan: LaunchPlan) -> bool:
    """Whether a launch file, as far as it is known, starts no process."""
    return not plan.processes and all(one.evaluated for one in plan.includes)


def nothing_started(plan: LaunchPlan, absent: Sequence[Diagnostic]) -> Diagnostic:
    """Report that a launch file starts nothing.

    Args:
        plan: Of the launch file.
        absent: What is reported of modules that it needs and that are not installed.

    Raises:
        NotFoundError: It starts nothing for want of a module.
    """
    if absent:
        file = absent[0].file or plan.launch_file
        place = f"line {absent[0].line} of {file.name}" if absent[0].line else file.name
        raise NotFoundError(
            f"{plan.launch_file.name} starts nothing without the Python module "
            f"{absent[0].element}, which is not installed: {place} imports it.",
            hint=absent[0].hint or "",
        )
    return STARTS_NOTHING.at(
        plan.launch_file,
        message="The launch file starts no process.",
        hint="Check the conditions of its actions, and that all of them are in the "
        "LaunchDescription that it returns.",
    )


def cannot_run(plan: LaunchPlan, *, is_sourced: bool) -> Iterator[Diagnostic]:
    """Report the programs of a plan that would be left out."""
    for process in plan.processes:
        if process.container is not None:
            component = find_component(process.executable or "", is_sourced=is_sourced)
            if isinstance(component, LeftOut):
                yield _cannot_run(process, process, component)
            continue
        for program in commands.programs(process):
            name = program.executable or ""
            found = find_replacement(
                program.package, name, program.arguments, is_sourced=is_sourced
            )
            left_out = found.replacement if found else None
            if isinstance(left_out, LeftOut) and left_out.is_missed:
                yield _cannot_run(process, program, left_out)


def _cannot_run(process: Process, program: Process, left_out: LeftOut) -> Diagnostic:
    name = program.executable or ""
    of = f" of {program.package}" if program.package else ""
    return CANNOT_RUN.at(
        process.file,
        process.line,
        name,
        message=f"{name}{of} cannot run here: {left_out.why}.",
        hint="Start it under a condition, or leave --strict out.",
    )
