"""Which launch files of the packages spawn a robot: each is evaluated, and its plan says so."""

from __future__ import annotations

import threading
import time
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import Severity, has_errors
from wsgen.events import OneAtATime, StepEnded, StepProgressed, StepStarted, post
from wsgen.isolation import parent
from wsgen.launching.commands import nested_launch, programs
from wsgen.launching.spawning import names_spawner
from wsgen.pipeline.parallel import run_parallel
from wsgen.pipeline.started import (
    waits_for_description,
    with_description,
    with_publisher_that_fails,
)
from wsgen.text.files import real_path

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.events import Listener
    from wsgen.isolation.parent import Run
    from wsgen.model.plan import Include
    from wsgen.packages.workspace.overlay import Overlay
    from wsgen.pipeline.started import Started


class LaunchFile(NamedTuple):
    """A launch file of a package."""

    package: str
    file: Path
    is_installed: bool = True  # not: in the source of the package alone


class Candidate(NamedTuple):
    """A launch file that was evaluated."""

    launch_file: LaunchFile
    started: Started

    @property
    def package(self) -> str:
        """The package that it belongs to."""
        return self.launch_file.package

    @property
    def file(self) -> Path:
        """The launch file."""
        return self.launch_file.file

    @property
    def name(self) -> str:
        """Package and launch file, as `ros2 launch` takes them."""
        return f"{self.package} {self.file.name}"

    @property
    def errors(self) -> frozenset[tuple[str, str, Path | None, int | None]]:
        """What makes each error of the plan the one that it is."""
        return frozenset(
            (found.code, found.message, found.file, found.line)
            for found in self.started.plan.diagnostics
            if found.severity is Severity.ERROR
        )

    @property
    def included(self) -> frozenset[str]:
        """Real paths of the launch files that it includes."""
        return frozenset(real_path(one.file) for one in self.started.plan.includes)

    @property
    def descriptions(self) -> frozenset[str]:
        """The texts of the robots that it spawns."""
        return frozenset(spawn.description for spawn in self.started.spawns)


class Choice(NamedTuple):
    """The launch files to simulate, and why others that may spawn a robot are not."""

    chosen: tuple[Candidate, ...]
    others: tuple[tuple[Candidate, str], ...]


def evaluate_launch_files(
    files: Sequence[LaunchFile],
    jobs: int,
    listener: Listener | None,
    evaluate: Callable[[LaunchFile, Run], Started],
) -> tuple[Candidate, ...]:
    """Evaluate launch files, several at a time, and post how many are done."""
    if not files:
        return ()
    count, before = len(files), time.perf_counter()
    step = ("evaluate", "launch files") if count > 1 else (files[0].package, "launch")
    detail = f"0/{count}" if count > 1 else files[0].file.name
    serial = OneAtATime(listener)
    lock, done = threading.Lock(), 0

    def call(file: LaunchFile, run: Run) -> Candidate:
        nonlocal done
        candidate = Candidate(file, evaluate(file, run))
        with lock:
            done += 1
            post(serial, StepProgressed(step=step, detail=f"{done}/{count}"))
        return candidate

    post(listener, StepStarted(step=step, detail=detail))
    ended: list[Candidate] = []
    if count == 1:
        ended.append(call(files[0], parent.run))
    else:
        run_parallel(lambda run: [partial(call, file, run) for file in files], jobs, serial, ended)
    first = ended[0].started
    found = first.diagnostics if first.may_spawn else first.plan.diagnostics
    post(
        listener,
        StepEnded(
            step=step,
            succeeded=count > 1 or not has_errors(found),
            seconds=time.perf_counter() - before,
            detail=str(count) if count > 1 else detail,
        ),
    )
    return tuple(ended)


def with_descriptions(found: Sequence[Candidate], overlay: Overlay) -> Iterator[Candidate]:
    """Give spawners that wait for the description of another launch file what that publishes.

    It is one of the same package if that has one, else of any.
    """
    for one in found:
        started = one.started
        beside = [other.started.plan for other in found if other.package == one.package]
        for plans in (beside, [other.started.plan for other in found]):
            if waits_for_description(started):
                started = with_description(started, plans, overlay)
        failed = [plan for plan in beside if has_errors(plan.diagnostics) and plan.launch_file]
        if failed and waits_for_description(started):
            started = with_publisher_that_fails(started, failed[0])
        yield one._replace(started=started)


def with_commands(
    found: Sequence[Candidate], evaluate: Callable[[LaunchFile, Mapping[str, str]], Started]
) -> list[Candidate]:
    """Evaluate those that fail again, with what `ros2 launch` gives them in other launch files."""
    return [
        next(_started_by_commands(one, found, evaluate), one)
        if has_errors(one.started.plan.diagnostics)
        else one
        for one in found
    ]


def _started_by_commands(
    one: Candidate,
    found: Sequence[Candidate],
    evaluate: Callable[[LaunchFile, Mapping[str, str]], Started],
) -> Iterator[Candidate]:
    """The launch file with the arguments of each command with which it does not fail."""
    for command in commands(one, found):
        if command.arguments:
            started = evaluate(one.launch_file, command.arguments)
            if not has_errors(started.plan.diagnostics):
                yield one._replace(started=started)


def commands(one: Candidate, beside: Iterable[Candidate]) -> Iterator[Include]:
    """The commands `ros2 launch` in other launch files that run this one."""
    for other in beside:
        if other is one:
            continue
        for process in other.started.plan.processes:
            for program in programs(process) if process.command else ():
                nested = nested_launch(program)
                if nested is None or nested.file.name != one.file.name:
                    continue
                is_path = nested.package is None
                if (
                    real_path(nested.file) == real_path(one.file)
                    if is_path
                    else (nested.package == one.package)
                ):
                    yield nested


def choose(
    found: Sequence[Candidate],
    *,
    kept: Collection[str] = (),
    named: Collection[str] = (),
    running: Collection[str] = (),
) -> Choice:
    """Choose the launch files that spawn robots, and those whose mistakes may hide one.

    Of launch files that include each other the outer one is chosen, of those that start the same
    simulation the first. `kept` are packages whose launch files are simulated also where one of
    another package includes them. Of the packages that are `named`, and spawn nothing, each mistake
    is shown. The nodes of those that are `running` run: where no launch file of such a package
    spawns a robot, its nodes may, in a simulator that a launch file starts.
    """
    evaluated = [one for one in found if one.started.is_evaluated]
    spawning = [one for one in evaluated if one.started.may_spawn]
    outer: list[Candidate] = []
    others: list[tuple[Candidate, str]] = []
    for one in spawning:
        includer = _includer(one, spawning, kept)
        if includer is None:
            outer.append(one)
        elif includer.package != one.package:
            others.append((one, f"included by {includer.name}"))
    others += [
        (one, one.started.lacks_model.removesuffix("."))
        for one in evaluated
        if one.started.lacks_model and _includer(one, evaluated) is None
    ]
    outer += _waiting_for_robots(evaluated, {*running} - {one.package for one in spawning})
    simulating = [one for one in outer if one.started.simulator]
    chosen = [one for one in outer if one.started.simulator or not _is_simulated(one, simulating)]
    failing, more = _choose_failing(found, chosen, named)
    chosen, same = _without_same([*chosen, *failing])
    order = {one.launch_file: number for number, one in enumerate(found)}
    return Choice(
        tuple(sorted(chosen, key=lambda one: order[one.launch_file])),
        (*others, *more, *same),
    )


def _waiting_for_robots(
    evaluated: Sequence[Candidate], packages: Collection[str]
) -> Iterator[Candidate]:
    """The launch files of these packages that start a simulator, the outermost ones."""
    simulating = [one for one in evaluated if one.started.simulator and one.package in packages]
    return (one for one in simulating if _includer(one, simulating) is None)


def _includer(
    inner: Candidate, candidates: Iterable[Candidate], kept: Collection[str] = ()
) -> Candidate | None:
    """The outermost candidate that includes another one."""
    file = real_path(inner.file)
    including = [
        one
        for one in candidates
        if one is not inner
        and file in one.included
        and (one.package == inner.package or inner.package not in kept)
    ]
    return max(including, key=lambda one: len(one.included), default=None)


def _is_simulated(spawner: Candidate, simulating: Sequence[Candidate]) -> bool:
    """Whether launch files that start a simulator spawn what one without a simulator spawns."""
    if not spawner.descriptions:
        return any(one.package == spawner.package for one in simulating)
    return spawner.descriptions <= {text for one in simulating for text in one.descriptions}


def _choose_failing(
    found: Sequence[Candidate], chosen: Sequence[Candidate], named: Collection[str]
) -> tuple[list[Candidate], list[tuple[Candidate, str]]]:
    """Those that may spawn a robot, or cannot read its description; why not the others.

    A launch file that others include with the arguments that it needs has no mistake.
    """
    evaluated = [one for one in found if one.started.is_evaluated]
    spawning = [one.file for one in evaluated if one.started.has_spawner]
    packages = {one.package for one in chosen}
    likely: list[Candidate] = []
    unlikely: list[Candidate] = []
    others: list[tuple[Candidate, str]] = []
    for one in found:
        if one.started.is_evaluated:
            continue
        lacks, needs_argument = _lacks(one)
        may_spawn = _may_spawn(one, spawning)
        includer = _includer(one, evaluated)
        if includer is not None:
            if may_spawn and includer.package != one.package:
                others.append((one, f"included by {includer.name}"))
        elif may_spawn and not (needs_argument and one.package in packages):
            likely.append(one)
        elif not lacks and (_is_robot_broken(one) or one.package in {*named} - packages):
            unlikely.append(one)
        else:
            others.append((one, _first_error(one, with_place=not lacks)))
    reported = [*likely, *unlikely]  # of those with the same mistake the first is shown
    outer = [
        one
        for one in reported
        if not any(other is not one and _says_all(other, one) for other in reported)
    ]
    # What is wrong in an included one is said of the outer one.
    return outer, [one for one in others if not any(_says_all(other, one[0]) for other in outer)]


def _says_all(outer: Candidate, inner: Candidate) -> bool:
    return real_path(inner.file) in outer.included and inner.errors <= outer.errors


def _may_spawn(failing: Candidate, spawning: Sequence[Path]) -> bool:
    """Whether its plan or its text has a spawner, a simulator or a launch file that spawns."""
    started = failing.started
    return (
        started.has_spawner
        or started.simulator is not None
        or not failing.included.isdisjoint(map(real_path, spawning))
        or names_spawner(failing.file, {file.name for file in spawning})
    )


def _is_robot_broken(failing: Candidate) -> bool:
    """Whether it fails for a mistake in the description of a robot."""
    from wsgen.launching.explain_missing import XACRO_FAILS  # noqa: PLC0415  see `_lacks`

    return any(code == XACRO_FAILS.code for code, *_ in failing.errors)


def _lacks(failing: Candidate) -> tuple[bool, bool]:
    """Whether it lacks only what is given from outside; whether that is a launch argument."""
    # They load what explains errors, which most workspaces do not need.
    from wsgen.launching.explain import (  # noqa: PLC0415
        ARGUMENT_WITHOUT_VALUE,
        INTERACTIVE_INPUT,
        NEEDS_UNKNOWN,
        VARIABLE_NOT_SET,
    )
    from wsgen.launching.explain_missing import PACKAGE_NOT_FOUND  # noqa: PLC0415
    from wsgen.launching.explain_names import UNSUPPORTED_API  # noqa: PLC0415

    from_outside = (
        *(ARGUMENT_WITHOUT_VALUE, INTERACTIVE_INPUT, NEEDS_UNKNOWN, PACKAGE_NOT_FOUND),
        *(UNSUPPORTED_API, VARIABLE_NOT_SET),
    )
    codes = {code for code, *_ in failing.errors}
    return codes <= {rule.code for rule in from_outside}, codes == {ARGUMENT_WITHOUT_VALUE.code}


def _first_error(failing: Candidate, *, with_place: bool) -> str:
    found = next(
        found for found in failing.started.plan.diagnostics if found.severity is Severity.ERROR
    )
    if not with_place:
        return found.message
    place = (found.file or failing.file).name + (f":{found.line}" if found.line else "")
    return f"{found.message.removesuffix('.')} ({found.code}, {place})"


def _without_same(
    candidates: Sequence[Candidate],
) -> tuple[list[Candidate], list[tuple[Candidate, str]]]:
    """The first of those of a package with the same simulation, and of those that fail alike."""
    first: dict[object, Candidate] = {}
    others: list[tuple[Candidate, str]] = []
    for one in candidates:
        same = first.setdefault(simulation_of(one), one)
        if same is not one:
            what = "simulation" if one.started.is_evaluated else "mistake"
            name = same.file.name if same.package == one.package else same.name
            others.append((one, f"the same {what} as {name}"))
    return list(first.values()), others


def simulation_of(candidate: Candidate) -> object:
    """What two launch files have in common if they start the same simulation."""
    started = candidate.started
    if not started.is_evaluated or not started.spawns:
        return candidate.errors or candidate.file
    paths = {
        (name, value)
        for name, value in started.plan.environment.items()
        if name.endswith("_PATH")  # where models and meshes are looked up
    }
    spawns = {
        (spawn.entity, spawn.description, spawn.pose_in_world.xyz, spawn.pose_in_world.rpy)
        for spawn in started.spawns
    }
    simulator = started.simulator and (started.simulator.kind, started.simulator.world)
    return candidate.package, simulator, frozenset(spawns), frozenset(paths)
