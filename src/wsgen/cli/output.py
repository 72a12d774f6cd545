"""Results -> the lines that a person reads: diagnostics, outcomes, launch plans."""

from __future__ import annotations

import math
import re
import shlex
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import click

from wsgen.cli.terminal import Branch, draw_table, draw_tree, fit_lines
from wsgen.cli.words import short_name
from wsgen.diagnostics import Severity, has_errors
from wsgen.reporting.words import cause_of, result_of, start_tree, what_it_did, write_xyz
from wsgen.text.printable import clean_line

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import BehaviorOutcome
    from wsgen.model.outcome import (
        EngineOutcome,
        NotValidated,
        Outcome,
        PackageOutcome,
        RobotOutcome,
        Simulated,
    )
    from wsgen.model.plan import Include, LaunchArgument, LaunchPlan, Process
    from wsgen.reporting.words import Started


COLORS = {Severity.ERROR: "red", Severity.WARNING: "yellow", Severity.INFO: "blue"}
ORDER = tuple(COLORS)


def render_diagnostics(
    diagnostics: Sequence[Diagnostic], *, most_alike: int | None = None
) -> list[str]:
    """Errors first; of each the message, the place and what to do.

    Of warnings and notes with one code, `most_alike` are shown and the others are counted.
    Errors are all shown.
    """
    lines: list[str] = []
    alike: Counter[str] = Counter()
    for diagnostic in sorted(diagnostics, key=lambda one: ORDER.index(one.severity)):
        name = diagnostic.name
        if diagnostic.severity is not Severity.ERROR:
            alike[name] += 1
            if most_alike is not None and alike[name] > most_alike:
                continue
        kind = f"{diagnostic.severity.value}[{diagnostic.code}]"
        label = click.style(kind, fg=COLORS[diagnostic.severity])
        lines.append(f"{label} {name}: {diagnostic.message}")
        place = _place(diagnostic)
        if place:
            lines.append(f"    at: {place}")
        if diagnostic.hint:
            lines.append(f"   try: {diagnostic.hint}")
    if most_alike is not None:
        hidden = [
            f"{count - most_alike} more of {name}"
            for name, count in alike.items()
            if count > most_alike
        ]
        lines += [f"and {', '.join(hidden)}: -v shows all"] if hidden else []
    return lines


def without_notes(diagnostics: Sequence[Diagnostic]) -> tuple[Diagnostic, ...]:
    """The diagnostics without notes about the robot, which say nothing about this run.

    Others say what is missing in it: a world, a package that is not built, an engine.
    """
    return tuple(
        one
        for one in diagnostics
        if one.severity is not Severity.INFO or not one.code.startswith(OF_ROBOTS)
    )


def render_alike(diagnostics: Sequence[Diagnostic]) -> list[str]:
    """A line each of diagnostics of one rule whose messages say where; the rest is said once."""
    if not diagnostics:
        return []
    first, *_ = render_diagnostics(diagnostics[:1])
    others = [f"    and: {one.message}" for one in diagnostics[1:]]
    return [first, *others, f"   try: {diagnostics[0].hint}"]


def _place(diagnostic: Diagnostic) -> str:
    parts = []
    if diagnostic.file is not None:
        short = short_name(diagnostic.file)
        parts.append(short if diagnostic.line is None else f"{short}:{diagnostic.line}")
    if diagnostic.element:
        parts.append(diagnostic.element)
    return "  ".join(parts)


# Lengths in meters.
HEADINGS = ("robot", "mass, kg", "movable", "spawned at, m", "at the end, m", "result")
ENGINE_HEADINGS = ("robot", "engine", "mass, kg", "at the end, m", "tilt, degrees", "result")

OF_ROBOTS = "ROB"  # the family of rules about descriptions
MOST_ALIKE = 3  # warnings of one code that are shown without --verbose


def render_outcome(outcome: Outcome, *, verbose: bool = False, quiet: bool = False) -> list[str]:
    """For each package: what was simulated, a table of robots, the diagnostics, the pictures.

    Of a package with several launch files, what is reported of several is shown with the first.
    """
    lines: list[str] = []
    shown: set[tuple[str | None, Diagnostic]] = set()
    for package in outcome.packages:
        new = tuple(
            found
            for found in package.diagnostics
            if found.severity is Severity.ERROR or (package.package, found) not in shown
        )
        shown.update((package.package, found) for found in new)
        lines += [*_package(package, new, verbose=verbose, quiet=quiet), ""]
    if len(outcome.packages) > 1:
        lines += [*_summary(outcome), ""]
    if not outcome.is_complete:
        lines += ["interrupted: only the packages and files above were checked", ""]
    if outcome.not_validated and not outcome.packages:
        lines += ["no launch file spawns a robot: nothing was simulated", ""]
    if outcome.not_validated:
        lines += [*_not_validated(outcome.not_validated), ""]
    return lines[:-1]


def _not_validated(packages: Sequence[NotValidated]) -> Iterator[str]:
    """For each reason the packages or launch files; for robots that nothing spawns, what to do."""
    yield click.style("not validated", bold=True)
    alike: dict[tuple[str, str, bool], list[NotValidated]] = {}
    for one in packages:
        prefix = f"{one.package} " if one.launch_file else ""
        alike.setdefault((one.reason, prefix, bool(one.robot_files)), []).append(one)
    for (reason, prefix, _), those in alike.items():
        names = [one.launch_file.name if one.launch_file else one.package for one in those]
        yield "  " + clean_line(f"{prefix}{', '.join(names)}: {reason}")
        files = [short_name(file) for one in those for file in one.robot_files]
        if files:
            more = f"  # or one of {len(files) - MOST_ALIKE} more" * (len(files) > MOST_ALIKE)
            yield f"   try: {shlex.join(['wsgen', 'validate', *files[:MOST_ALIKE]])}{more}"


def _summary(outcome: Outcome) -> list[str]:
    """How many passed, and of each that failed its first error."""
    failed = [package for package in outcome.packages if not package.passed]
    passed = len(outcome.packages) - len(failed)
    lines = [f"{passed} passed, {len(failed)} failed" + (":" if failed else "")]
    for package in failed:
        file = f"  {package.launch_file.name}" if package.package and package.launch_file else ""
        errors = [one for one in package.diagnostics if one.severity is Severity.ERROR]
        why = f": {errors[0].message}" if errors else ""
        lines.append(f"  {_name(package)}{file}{why}")
    return lines


def _package(
    package: PackageOutcome, diagnostics: Sequence[Diagnostic], *, verbose: bool, quiet: bool
) -> list[str]:
    result = (
        click.style("passed", fg="green", bold=True)
        if package.passed
        else click.style("failed", fg="red", bold=True)
    )
    lines = [f"{click.style(_name(package), bold=True)}: {result}"]
    if package.launch_file is not None:
        lines.append(f"  launch file  {short_name(package.launch_file)}")
    if package.world is not None and (package.robots or package.world.file):
        file = package.world.file
        lines.append(
            f"  world        {clean_line(package.world.name)}"
            + (f"  {short_name(file)}" if file else "")
        )
    if package.robots:
        lines += ["", *_robots(package, quiet=quiet)]
        lines += fit_lines(_behaviors(package))
    lines += _reported(package, diagnostics, verbose=verbose)
    if package.picture is not None:
        scale = f"  (a square is {package.picture_tile:g} m)" if package.picture_tile else ""
        lines += ["", f"  picture      {package.picture}{scale}"]
    if package.world_picture is not None:
        lines += [f"  whole world  {package.world_picture}"]
    if package.video is not None:
        if package.picture is None:
            lines.append("")
        lines += [f"  video        {package.video}"]
    return lines


def _reported(
    package: PackageOutcome, diagnostics: Sequence[Diagnostic], *, verbose: bool
) -> list[str]:
    """The diagnostics that were not shown before, and how many were, or are for `verbose`."""
    lines: list[str] = []
    # What keeps a robot from passing may be explained by it.
    all_of_package, notable = package.diagnostics, diagnostics
    if not verbose and not has_errors(package.diagnostics):
        all_of_package, notable = without_notes(all_of_package), without_notes(notable)
    shown = render_diagnostics(notable, most_alike=None if verbose else MOST_ALIKE)
    notes = len(diagnostics) - len(notable)
    if notes:
        what = "note" if notes == 1 else "notes"
        shown.append(f"-v shows {notes} {what} about the robot.")
    if shown:
        lines += ["", *(f"  {line}" for line in shown)]
    repeated = len(all_of_package) - len(notable)
    if repeated:
        lines += [
            "",
            f"  and {repeated} {'diagnostic' if repeated == 1 else 'diagnostics'} as above",
        ]
    return lines


def _behaviors(package: PackageOutcome) -> list[str]:
    """A line for each, and for each engine if there are several: what the robot did."""
    robots = [robot for robot in package.robots if robot.behaviors]
    lines = []
    for robot in robots:
        prefix = f"{robot.entity}: " if len(robots) > 1 else ""
        each = [(f", {one.name}", one.behaviors) for one in robot.engines]
        if len(each) <= 1:
            each = [("", robot.behaviors)]
        lines += [
            line
            for number in range(len(robot.behaviors))
            for engine, behaviors in each
            for line in _behavior(f"{prefix}{behaviors[number].name}{engine}", behaviors[number])
        ]
    return ["", *lines] if lines else []


MOST_PRINTED = 8  # lines of the nodes of a behavior
INFORMATIVE = ("[ERROR]", "[FATAL]", "[WARN]", "[WARNING]", "Error: ", "Traceback")


def _behavior(name: str, one: BehaviorOutcome) -> list[str]:
    mark = click.style("  ok  ", fg="green") if one.passed else click.style("failed", fg="red")
    if one.is_left_out:
        mark = click.style("  --  ", fg="yellow")
    lines = [f"  {mark}  {name}: {what_it_did(one)}"]
    printed = () if one.passed else most_informative(one.printed)
    if printed:
        lines += [click.style(f"          {line}", dim=True) for line in printed]
    return lines


def most_informative(lines: Sequence[str]) -> list[str]:
    """A few of the last lines that nodes have printed: errors and warnings, then what is last."""
    informative = [
        number for number, line in enumerate(lines) if any(map(line.__contains__, INFORMATIVE))
    ]
    others = [number for number in range(len(lines)) if number not in informative]
    left = MOST_PRINTED - len(informative[-MOST_PRINTED:])
    kept = {*informative[-MOST_PRINTED:], *(others[-left:] if left else ())}
    return [lines[number] for number in sorted(kept)]


def _name(package: PackageOutcome) -> str:
    file = package.file or package.launch_file
    return package.package or (short_name(file) if file else "(file)")


def _robots(package: PackageOutcome, *, quiet: bool) -> list[str]:
    """The table of the robots; with several engines, of each robot in each of them."""
    headings, rows = HEADINGS, [_robot(robot) for robot in package.robots]
    if any(len(robot.engines) > 1 for robot in package.robots):
        headings = ENGINE_HEADINGS
        rows = [_in_engine(robot, one) for robot in package.robots for one in robot.engines]
    return draw_table(rows, headings=headings, wrapped=(0, -1), quiet=quiet)


def _robot(robot: RobotOutcome) -> tuple[str, ...]:
    rest = robot.rest
    return (
        robot.entity,
        _mass(robot.simulated),
        f"{robot.movable_joints} of {robot.joints}",
        write_xyz(robot.spawn_pose.xyz),
        write_xyz(rest.pose_in_world.xyz) if rest else "-",
        result_of(robot.engines[0]) if robot.engines else "not simulated",
    )


def _in_engine(robot: RobotOutcome, one: EngineOutcome) -> tuple[str, ...]:
    rest = one.rest
    return (
        robot.entity,
        one.name,
        _mass(one.simulated),
        write_xyz(rest.pose_in_world.xyz) if rest else "-",
        f"{math.degrees(rest.tilt):.1f}" if rest else "-",
        result_of(one),
    )


def _mass(simulated: Simulated | None) -> str:
    """As simulated: what was read may have links that are refused."""
    return f"{simulated.mass:.3f}" if simulated else "-"


MOST_CHARACTERS = 120  # of a value; a robot description has thousands


def render_arguments(plan: LaunchPlan) -> Iterator[str]:
    """The arguments, in the form of `ros2 launch --show-args`; then the diagnostics."""
    yield "Arguments (pass arguments as '<name>:=<value>'):"
    for argument in plan.arguments:
        yield ""
        yield f"    '{clean_line(argument.name)}':{'*' if argument.is_conditional else ''}"
        yield f"        {clean_line(argument.description)}"
        if argument.default is not None:
            yield f"        (default: {clean_line(argument.default)})"
    if not plan.arguments:
        yield ""
        yield "  No arguments."
    if any(argument.is_conditional for argument in plan.arguments):
        yield ""
        yield "* argument(s) which are only used if specific conditions occur"
    yield from _diagnostics_of(plan)


def render_tree(plan: LaunchPlan, *, quiet: bool = False) -> Iterator[str]:
    """A tree of what starts, below arguments, environment and includes; then the diagnostics."""
    yield click.style(short_name(plan.launch_file), bold=True)
    yield from _section("arguments", [_argument(argument) for argument in plan.arguments])
    yield from _section(
        "environment", [f"{name}={value}" for name, value in plan.environment.items()]
    )
    yield from _section("includes", [line for one in plan.includes for line in _include(one)])
    if plan.processes:
        yield ""
        starts = Branch(click.style("starts", bold=True), _branches(start_tree(plan.processes)))
        yield from draw_tree(starts, quiet=quiet)
    yield from _section(
        "not known without ROS",
        [
            f"{_clip(entry.what)}: {entry.why}{_file_and_line(entry.file, entry.line)}"
            for entry in plan.unresolved
        ],
    )
    yield from _diagnostics_of(plan)


def _section(title: str, lines: Sequence[str]) -> Iterator[str]:
    if lines:
        yield ""
        yield click.style(title, bold=True)
        yield from fit_lines(f"  {_on_one_line(line)}" for line in lines)


def _diagnostics_of(plan: LaunchPlan) -> Iterator[str]:
    if plan.diagnostics:
        yield ""
        yield from render_diagnostics(plan.diagnostics)


def _argument(argument: LaunchArgument) -> str:
    given = "" if argument.value == argument.default else click.style("  (given)", dim=True)
    description = click.style(f"  {argument.description}", dim=True) if argument.description else ""
    return f"{argument.name}:={_clip(str(argument.value))}{given}{description}"


def _include(include: Include) -> Iterator[str]:
    name = f"{include.package} {include.file.name}" if include.package else short_name(include.file)
    note = "" if include.evaluated else click.style("  (not installed: not evaluated)", fg="yellow")
    yield f"{name}{note}"
    for argument, value in include.arguments.items():
        yield f"    {argument}:={_clip(value)}"


def _branches(started: Sequence[Started]) -> tuple[Branch, ...]:
    return tuple(
        Branch(
            "\n    ".join(map(_on_one_line, (_title(one.process), *_details(one.process)))),
            _branches(one.followers),
        )
        for one in started
    )


def _title(process: Process) -> str:
    what = click.style(_what(process), bold=True)
    cause = f"  {click.style(cause_of(process), fg='cyan')}" if cause_of(process) else ""
    node = f"{process.namespace.rstrip('/')}/{process.name}" if process.name else process.namespace
    called = f"  {node}" if node and process.command is None else ""
    host = f"  in {process.container}" if process.container else ""
    return f"{what}{called}{host}{cause}{_file_and_line(process.file, process.line)}"


def _what(process: Process) -> str:
    if process.command is not None:
        return _clip(" ".join(process.command))
    return f"{process.package} {process.executable}" if process.package else str(process.executable)


def _details(process: Process) -> Iterator[str]:
    if process.arguments:
        yield f"arguments: {_clip(' '.join(process.arguments))}"
    for name, value in process.parameters.items():
        if process.description_file is not None and str(value).lstrip().startswith("<"):
            yield f"{name}: {len(value)} characters from {short_name(process.description_file)}"
        else:
            yield f"{name}: {_clip(str(value))}"
    for source, target in process.remappings:
        yield f"{source} → {target}"


def _on_one_line(text: str) -> str:
    """A name with a line break must not begin another line; styles stay."""
    return text.replace("\n", " ")


def _clip(text: str) -> str:
    """A value on one line, with paths relative to the current folder if they are below it."""
    line = re.sub(rf"(?<![^\s\"'=]){re.escape(str(Path.cwd()))}/", "", " ".join(text.split()))
    return line if len(line) <= MOST_CHARACTERS else f"{line[: MOST_CHARACTERS - 1]}…"


def _file_and_line(file: Path | None, line: int | None) -> str:
    if file is None:
        return ""
    return click.style(f"  {file.name}" + (f":{line}" if line else ""), dim=True)
