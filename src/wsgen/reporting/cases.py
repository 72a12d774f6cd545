"""The outcome of a validation as test cases: one for each check, passed or not."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.checks.rules import runs
from wsgen.diagnostics import Severity
from wsgen.model.behavior import ELEMENT
from wsgen.reporting.check_formats import Case, Failure, Suite, full_message, relative_name
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic, Rule
    from wsgen.model.outcome import NotValidated, Outcome, PackageOutcome, RobotOutcome


# What is checked of the run of each robot, in the order of the run.
OF_RUNS: dict[str, tuple[Rule, ...]] = {
    "has the mass and the joints of its description": (runs.MASS_DIFFERS, runs.JOINTS_DIFFER),
    "is spawned above the ground": (runs.SPAWNED_IN_GROUND, runs.SPAWNED_HIGH),
    "does not overlap": (runs.OVERLAPPING_ROBOTS, runs.OVERLAPPING_LINKS),
    "is not thrown by forces": (
        runs.STATE_NOT_FINITE,
        runs.CUT_SHORT,
        runs.THROWN_INTO_THE_AIR,
        runs.GAINS_ENERGY,
        runs.ENGINE_UNSTABLE,
    ),
    "does not sink or fall": (
        runs.STUCK_IN_GROUND,
        runs.FALLS_WITHOUT_END,
        runs.RESTS_ON_HULL,
        runs.NO_BUOYANCY,
    ),
    "does not tip over": (runs.TIPS_OVER, runs.LEANS),
    "comes to rest": (runs.KEEPS_MOVING, runs.UNACTUATED_JOINTS_MOVE),
    "keeps its joints within their limits": (runs.JOINT_BEYOND_LIMIT,),
}
COMPARED = "does the same in all engines"  # with several
OF_COMPARISON = (runs.ENGINES_DISAGREE,)
# What is checked before, by the family of the rules; the last one is for all others.
OF_FILES = {
    "LCH": "launch file",
    "ROB": "robot descriptions",
    "WLD": "worlds and meshes",
    "PKG": "package",
    "BLD": "package",
    "SPN": "spawning and simulation",
}
LAUNCH, DESCRIPTIONS = OF_FILES["LCH"], OF_FILES["ROB"]
OTHERS = OF_FILES["SPN"]
STAGES = {LAUNCH: "launch", DESCRIPTIONS: "expand"}  # the times in `PackageOutcome.seconds`


@dataclass(frozen=True, kw_only=True)
class _Context:
    """What the cases of a launch file or a file have in common."""

    suite: str
    folder: Path  # that paths are relative to
    package: PackageOutcome

    def case(
        self, name: str, found: Sequence[Diagnostic], *, seconds: float = 0.0, shows: bool = False
    ) -> Case:
        """A case that fails if a diagnostic is an error; `shows` says that the picture shows it."""
        errors = [one for one in found if one.severity is Severity.ERROR]
        first = next(iter(errors), None)
        texts = [self._text(one) for one in found if one not in errors]
        if shows and self.package.picture is not None:
            texts += self._pictures()
        if first is None:
            return Case(suite=self.suite, name=name, seconds=seconds, output="\n\n".join(texts))
        file = first.file or self.package.launch_file or self.package.file
        return Case(
            suite=self.suite,
            name=name,
            seconds=seconds,
            file=relative_name(file, self.folder) or None,
            line=first.line,
            failure=Failure(
                message=first.message,
                kind=first.code,
                text="\n\n".join(map(self._text, errors)),
            ),
            output="\n\n".join(texts),
        )

    def skipped(self, name: str, why: str) -> Case:
        return Case(suite=self.suite, name=name, skipped=why)

    def _text(self, found: Diagnostic) -> str:
        """A diagnostic with its place, as `wsgen check` prints it."""
        file = relative_name(found.file, self.folder)
        place = f"{file}:{found.line}" if file and found.line else file
        kind = f"{found.severity.value}[{found.code}] {found.name}: {full_message(found)}"
        return f"{place}: {kind}" if place else kind

    def _pictures(self) -> Iterator[str]:
        """The paths, and the marks by which GitLab shows pictures."""
        for picture in (self.package.picture, self.package.world_picture):
            if picture is not None:
                name = relative_name(picture.absolute(), self.folder)
                yield f"picture: {name}"
                yield f"[[ATTACHMENT|{name}]]"


def outcome_suites(outcome: Outcome, folder: Path) -> list[Suite]:
    """A suite for each launch file or file; paths are relative to the folder, with slashes."""
    suites = [_suite(package, folder) for package in outcome.packages]
    if outcome.not_validated:
        cases = [_not_validated(one) for one in outcome.not_validated]
        suites.append(Suite(name="not validated", cases=cases))
    if not outcome.is_complete:
        why = "The run was interrupted: only the packages and files above were validated."
        failure = Failure(message=why, kind="interrupted", text=why)
        stopped = Case(suite="wsgen.validate", name="is complete", failure=failure)
        suites.append(Suite(name="interrupted", cases=[stopped]))
    return suites


def suite_name(package: str | None, file: Path | None) -> str:
    """The name by which services group test cases; Jenkins and colcon divide it at the dot."""
    name = "" if file is None else file.name.replace(".", "_")
    return f"{package or 'files'}.{name}" if name else f"{package}.wsgen"


def _not_validated(one: NotValidated) -> Case:
    suite = suite_name(one.package, one.launch_file)
    return Case(suite=suite, name="is validated", skipped=one.reason)


def _suite(package: PackageOutcome, folder: Path) -> Suite:
    file = package.file or package.launch_file
    suite = suite_name(package.package, file)
    context = _Context(suite=suite, folder=folder, package=package)
    properties = {
        "launch_file": package.launch_file,
        "world": package.world.file if package.world else None,
        "picture": package.picture,
        "world_picture": package.world_picture,
        "video": package.video,
    }
    return Suite(
        name=suite,
        cases=list(_cases(context)),
        seconds=package.seconds.get("total", 0.0),
        properties={name: str(path) for name, path in properties.items() if path is not None},
    )


def _cases(context: _Context) -> Iterator[Case]:
    """Each diagnostic is in one of them."""
    package = context.package
    of_robots = [case for robot in package.robots for case in _robot(robot, context)]
    used = {one for robot in package.robots for one in _about(robot, package)}
    rest = [one for one in package.diagnostics if one not in used]
    by_check: dict[str, list[Diagnostic]] = {
        **({LAUNCH: []} if package.launch_file else {}),
        **({DESCRIPTIONS: []} if package.robots else {}),
    }
    for found in rest:
        by_check.setdefault(OF_FILES.get(found.code[:3], OTHERS), []).append(found)
    if not package.passed and not package.robots and not any(map(_is_error, rest)):
        yield _no_robot(context)
    for name, of_check in by_check.items():
        yield context.case(name, of_check, seconds=package.seconds.get(STAGES.get(name, ""), 0.0))
    yield from of_robots


def _is_error(found: Diagnostic) -> bool:
    return found.severity is Severity.ERROR


def _no_robot(context: _Context) -> Case:
    why = "No robot is simulated."
    failure = Failure(message=why, kind="no-robot", text=why)
    return Case(suite=context.suite, name="robots are simulated", failure=failure)


def _about(robot: RobotOutcome, package: PackageOutcome) -> list[Diagnostic]:
    """The diagnostics of a robot's run and of its behaviors."""
    names = {ELEMENT.format(behavior.name) for behavior in robot.behaviors}
    codes = {rule.code for rules in OF_RUNS.values() for rule in rules}
    codes |= {rule.code for rule in OF_COMPARISON}
    return [
        one
        for one in package.diagnostics
        if one.element in names or (one.element == robot.entity and one.code in codes)
    ]


def _robot(robot: RobotOutcome, context: _Context) -> Iterator[Case]:
    package, entity = context.package, robot.entity
    own = _about(robot, package)
    if robot.simulated is None:
        yield _not_simulated(robot, context)
        return
    yield context.case(f"{entity} is loaded", [], seconds=package.seconds.get("load", 0.0))
    simulated = package.seconds.get("simulate", 0.0)
    checks = {**OF_RUNS, **({COMPARED: OF_COMPARISON} if len(robot.engines) > 1 else {})}
    for check, rules in checks.items():
        codes = {rule.code for rule in rules}
        found = [one for one in own if one.code in codes]
        is_last_state = check == "comes to rest"
        yield context.case(
            f"{entity} {check}",
            found or _explained(robot, codes, context),
            seconds=simulated if is_last_state else 0.0,
            shows=is_last_state or any(map(_is_error, found)),
        )
    yield from _behaviors(robot, own, context)


def _not_simulated(robot: RobotOutcome, context: _Context) -> Case:
    """A robot that was not simulated fails; one that need not be is skipped."""
    name = f"{robot.entity} is loaded"
    errors = [one for one in context.package.diagnostics if _is_error(one)]
    # Of several, the one that names it.
    errors.sort(key=lambda one: one.element != robot.entity)
    if robot.passed or not errors:
        return context.skipped(name, "The robot was not simulated.")
    return context.case(name, errors[:1])


def _explained(robot: RobotOutcome, codes: set[str], context: _Context) -> list[Diagnostic]:
    """The errors of the description that explain what the run shows and is not reported twice."""
    shown = set().union(*(one.codes for one in robot.engines))
    if robot.passed or not codes & shown:
        return []
    return _described(context)


def _described(context: _Context) -> list[Diagnostic]:
    """The errors of the description, in which what follows from them is folded."""
    return [
        one
        for one in context.package.diagnostics
        if _is_error(one) and one.code[:3] in {"ROB", "WLD"}
    ]


def _behaviors(robot: RobotOutcome, own: Sequence[Diagnostic], context: _Context) -> Iterator[Case]:
    """A case for each behavior; with several engines, for each in each."""
    each = [(f" ({one.name})", one.behaviors) for one in robot.engines]
    if len(each) <= 1:
        each = [("", robot.behaviors)]
    for where, behaviors in each:
        for behavior in behaviors:
            found = [one for one in own if one.element == ELEMENT.format(behavior.name)]
            name = f"{robot.entity}: {behavior.name}{where}"
            if behavior.passed:
                found = [one for one in found if not _is_error(one)]
            elif behavior.seconds is not None:
                found = found or _described(context)
            if not behavior.passed and not any(map(_is_error, found)):
                why = "It was left out." if behavior.is_left_out else "It was not simulated."
                yield context.skipped(name, why)
                continue
            case = context.case(
                name, found, seconds=behavior.wall_seconds, shows=not behavior.passed
            )
            yield replace(case, output=_with_printed(case.output, behavior.printed))


def _with_printed(output: str, lines: Sequence[str]) -> str:
    """What a case says, and what the nodes of its launch file have printed last."""
    if not lines:
        return output
    printed = "\n".join(["the last lines that the nodes printed:", *lines])
    return f"{output}\n\n{printed}" if output else printed
