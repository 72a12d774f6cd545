"""Report what a plan starts that cannot run here."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.launch import commands
from wsgen.live.programs import LeftOut, find_component, find_replacement

if TYPE_CHECKING:
    from collections.abc import Iterator

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
