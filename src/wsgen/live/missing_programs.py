"""Report what a plan starts that cannot run here, and what it would take from absent modules."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.errors import NotFoundError
from wsgen.launching import commands
from wsgen.live.missing_modules import way_to_module
from wsgen.live.programs import LeftOut, find_component, find_replacement
from wsgen.model.plan import ABSENT_MODULE, OF_ABSENT_MODULE, STARTS_UNKNOWN

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan, Process


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
