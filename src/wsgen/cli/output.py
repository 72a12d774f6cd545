"""Outcome -> what a person reads at the end of `wsgen validate`.

Diagnostics -> lines that a person reads.
"""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING

import click

from wsgen.cli.words import short_path
from wsgen.diagnostics import Severity
from wsgen.rules._remaining import REMAINING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import BehaviorOutcome
    from wsgen.model.outcome import Outcome, PackageOutcome, RobotOutcome


COLORS = {Severity.ERROR: "red", Severity.WARNING: "yellow", Severity.INFO: "blue"}
ORDER = tuple(COLORS)
NAMES = {code: name for code, name, _ in REMAINING}


def render_findings(
    diagnostics: Sequence[Diagnostic], *, most_alike: int | None = None
) -> list[str]:
    """Errors first; of each the place, what is wrong, and what to do.

    Of warnings and informations with one code, `most_alike` are told and the others counted. Errors
    are all told.
    """
    lines: list[str] = []
    told: Counter[str] = Counter()
    for finding in sorted(diagnostics, key=lambda found: ORDER.index(found.severity)):
        told[finding.code] += 1
        is_one_of_many = most_alike is not None and told[finding.code] > most_alike
        if is_one_of_many and finding.severity is not Severity.ERROR:
            continue
        kind = f"{finding.severity.value}[{finding.code}]"
        label = click.style(kind, fg=COLORS[finding.severity])
        lines.append(f"{label} {NAMES[finding.code]}: {finding.message}")
        place = _place(finding)
        if place:
            lines.append(f"    at: {place}")
        if finding.hint:
            lines.append(f"   try: {finding.hint}")
    return lines + _not_told(diagnostics, told, most_alike)


def _not_told(
    diagnostics: Sequence[Diagnostic], told: Counter[str], most_alike: int | None
) -> list[str]:
    severities = {found.code: found.severity for found in diagnostics}
    left = [
        f"{count - most_alike} more of {NAMES[code]}"
        for code, count in told.items()
        if most_alike is not None and count > most_alike and severities[code] is not Severity.ERROR
    ]
    return [f"and {', '.join(left)}: -v shows all"] if left else []


def _place(finding: Diagnostic) -> str:
    parts = []
    if finding.file is not None:
        short = short_path(finding.file)
        parts.append(short if finding.line is None else f"{short}:{finding.line}")
    if finding.element:
        parts.append(finding.element)
    return "  ".join(parts)


# Lengths in meters; the whole fits into 80 columns.
HEADINGS = ("robot", "mass, kg", "joints move", "spawned at, m", "at the end, m", "")

TIPS_OVER, GIVES_WAY = "SPN059", "SPN060"
MOST_ALIKE = 3  # so many warnings of one code are told, without --verbose


def render_outcome_table(outcome: Outcome, *, verbose: bool = False) -> list[str]:
    """A block a package: what was played, a table of robots, the findings, the picture."""
    lines: list[str] = []
    for package in outcome.packages:
        lines += [*_package(package, verbose=verbose), ""]
    if len(outcome.packages) > 1:
        lines += [*_summary(outcome), ""]
    if not outcome.is_complete:
        lines += ["interrupted: what is not named above was not checked", ""]
    if outcome.left_out:
        lines += [f"not checked, as they spawn no robot: {', '.join(outcome.left_out)}", ""]
    return lines[:-1]


def _summary(outcome: Outcome) -> list[str]:
    failed = [_name(package) for package in outcome.packages if not package.passed]
    passed = len(outcome.packages) - len(failed)
    lines = [f"{passed} passed, {len(failed)} failed" + (":" if failed else "")]
    return lines + [f"  {name}" for name in failed]


def _package(package: PackageOutcome, *, verbose: bool) -> list[str]:
    verdict = (
        click.style("passed", fg="green", bold=True)
        if package.passed
        else click.style("failed", fg="red", bold=True)
    )
    lines = [f"{click.style(_name(package), bold=True)}: {verdict}"]
    if package.launch_file is not None:
        lines.append(f"  launch file  {short_path(package.launch_file)}")
    if package.world is not None and (package.robots or package.world.file):
        file = package.world.file
        lines.append(
            f"  world        {package.world.name}" + (f"  {short_path(file)}" if file else "")
        )
    if package.robots:
        rows = [_robot(robot, package) for robot in package.robots]
        lines += ["", *_table([HEADINGS, *rows])]
        lines += _behaviors(package)
    findings = render_findings(package.diagnostics, most_alike=None if verbose else MOST_ALIKE)
    if findings:
        lines += ["", *(f"  {line}" for line in findings)]
    if package.picture is not None:
        scale = f"  (a square is {package.picture_tile:g} m)" if package.picture_tile else ""
        lines += ["", f"  picture      {package.picture}{scale}"]
    if package.world_picture is not None:
        lines += [f"  whole world  {package.world_picture}"]
    if package.video is not None:
        lines += [f"  video         {package.video}"]
    return lines


def _behaviors(package: PackageOutcome) -> list[str]:
    """A line for each: its name, and what the robot did."""
    simulated = [(robot, one) for robot in package.robots for one in robot.behaviors]
    several = len({robot.entity for robot, _ in simulated}) > 1
    lines = []
    for robot, one in simulated:
        mark = click.style("  ok  ", fg="green") if one.passed else click.style("failed", fg="red")
        name = f"{robot.entity}: {one.name}" if several else one.name
        lines.append(f"  {mark}  {name}: {_did(one)}")
    return ["", *lines] if lines else []


def _did(behavior: BehaviorOutcome) -> str:
    if behavior.moved is not None:
        x, y, yaw = (_plain(value) for value in behavior.moved)
        return f"{x} m ahead, {y} m to the left, turned by {yaw} rad"
    if behavior.positions is not None:
        return ", ".join(f"{name} {_plain(value)}" for name, value in behavior.positions.items())
    return "not tried"


def _plain(value: float) -> str:
    return f"{round(value, 2) + 0.0:.2f}" if math.isfinite(value) else str(value)


def _name(package: PackageOutcome) -> str:
    file = package.file or package.launch_file
    return package.package or (short_path(file) if file else "(file)")


def _robot(robot: RobotOutcome, package: PackageOutcome) -> tuple[str, ...]:
    rest, simulated = robot.rest, robot.simulated
    return (
        robot.entity,
        f"{simulated.mass:.3f}" if simulated else "-",  # what was read may lack refused links
        f"{robot.movable_joints} of {robot.joints}",
        _xyz(robot.spawn_pose.xyz),
        _xyz(rest.pose_in_world.xyz) if rest else "-",
        _verdict(robot, package),
    )


def _verdict(robot: RobotOutcome, package: PackageOutcome) -> str:
    if not robot.passed:
        return "fails" if robot.rest else "not tried"
    found = {found.code for found in package.diagnostics if found.element == robot.entity}
    settled = None if robot.rest is None else robot.rest.settled_after
    if TIPS_OVER in found:
        return "tips over"
    if settled is None:
        return "keeps moving, limp" if GIVES_WAY in found else "keeps moving"
    return (
        f"rests after {settled:.1f} s, limp"
        if GIVES_WAY in found
        else f"stands after {settled:.1f} s"
    )


def _xyz(xyz: tuple[float, float, float]) -> str:
    """Centimetres on the ground, millimeters above it; adding zero makes -0.00 plain."""
    return " ".join(
        f"{round(value, decimals) + 0.0:.{decimals}f}" if math.isfinite(value) else str(value)
        for value, decimals in zip(xyz, (2, 2, 3), strict=True)
    )


def _table(rows: list[tuple[str, ...]]) -> list[str]:
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = [
        "  "
        + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]
    rule = "  " + "  ".join("-" * width for width in widths)
    return [click.style(lines[0], bold=True), rule, *lines[1:]]
