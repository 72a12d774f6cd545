"""Report what a plan starts that cannot run here."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.launch import commands
from wsgen.live.programs import LeftOut, find_stand

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan


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
        for program in commands.programs(process):
            name = program.executable or ""
            stand = find_stand(program.package, name, program.arguments, is_sourced=is_sourced)
            left_out = stand.stand if stand else None
            if isinstance(left_out, LeftOut) and left_out.is_missed:
                of = f" of {program.package}" if program.package else ""
                yield CANNOT_RUN.at(
                    process.file,
                    process.line,
                    name,
                    message=f"{name}{of} cannot run here: {left_out.why}.",
                    hint="Start it under a condition, or leave --strict out.",
                )
