"""Evaluate a launch file, and read from its plan which simulator and robots it starts."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.manifests import target_of
from wsgen.diagnostics import Rule, Severity, has_errors
from wsgen.launching.descriptions import (
    UNPUBLISHED_DESCRIPTION,
    Description,
    published_descriptions,
    read_published,
)
from wsgen.launching.evaluate import DISTRO_OF_LAUNCHES, evaluate
from wsgen.launching.explain_missing import PACKAGE_NOT_FOUND
from wsgen.launching.simulators import find_simulator
from wsgen.packages.workspace.settings import read_settings
from wsgen.pipeline.gazebo_models import find_robots

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from wsgen.checks.rules.manifests import Target
    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.parent import Run
    from wsgen.model.plan import LaunchPlan, Process
    from wsgen.model.world import Simulator, Spawn
    from wsgen.packages.workspace.overlay import Overlay
    from wsgen.pipeline.requests import ValidateRequest


class Started(NamedTuple):
    """What a launch file starts."""

    plan: LaunchPlan
    simulator: Simulator | None
    spawns: tuple[Spawn, ...]
    diagnostics: tuple[Diagnostic, ...]  # of the plan; of simulator and spawners if it has no error
    # Or a robot in its world; in a plan that stopped at an error, a spawner before that.
    has_spawner: bool
    seconds: float  # wall-clock
    is_evaluated: bool  # to its end; or without helpers that are missing, where it spawns robots
    # It starts a simulator in a world that is not found, and spawns nothing itself.
    lacks_world: bool = False
    lacks_model: str | None = None  # the same of a model of its world: what is said of that

    @property
    def may_spawn(self) -> bool:
        """Whether it has a spawner, or its world may have a robot."""
        return self.has_spawner or self.lacks_world


DESCRIPTION_FROM_ELSEWHERE = Rule(
    code="LCH066",
    name="description-from-elsewhere",
    severity=Severity.INFO,
    summary="Another launch file publishes the robot description that the spawner waits for.",
    what="Where a launch file starts neither a simulator nor a `robot_state_publisher`, looks for "
    "a publisher of the topic in the launch files of the package, then of the workspace.",
    why="The two launch files are started in different terminals. Without the other one, the "
    "spawner waits forever.",
    example="ros2 launch my_robot spawn.launch.py",
    instead="ros2 launch my_robot rsp.launch.py  # first, in another terminal",
)


def as_sourced(overlay: Overlay, target: Target) -> Overlay:
    """The overlay as with a ROS of the target sourced, where none is."""
    if overlay.environment.get("ROS_DISTRO") or DISTRO_OF_LAUNCHES in target.distros:
        return overlay
    environment = {**overlay.environment, "ROS_DISTRO": target.distros[0]}
    return replace(overlay, environment=environment)


def overlay_for(package: str, overlay: Overlay) -> Overlay:
    """The overlay as with a ROS sourced that a package is for, where none is."""
    packages = {one.name: one for one in overlay.written}
    written = packages.get(package)
    if written is None or overlay.environment.get("ROS_DISTRO"):
        return overlay
    settings, _ = read_settings(written.path)
    target = target_of(written.manifest, recorded=settings.distro, workspace=packages.keys())
    return as_sourced(overlay, target)


def start(
    launch_file: Path, package: str | None, overlay: Overlay, request: ValidateRequest, run: Run
) -> Started:
    """Evaluate a launch file of a package with the arguments of the request; see `evaluate`.

    Where it fails for want of a value of an argument, those that it names are tried.
    """
    before = time.perf_counter()
    if package is not None:
        overlay.look_up(package)  # the launch file is in its share folder
    given = request.launch_arguments

    def play(more: Mapping[str, str], *, only_arguments: bool = False) -> LaunchPlan:
        return evaluate(
            launch_file,
            package=package,
            arguments={**given, **more},
            environment=overlay.environment,
            answers=request.answers,
            only_arguments=only_arguments,
            run=run,
        )

    plan = play({})
    if has_errors(plan.diagnostics) and not request.is_live:
        # It loads what explains errors, which most workspaces do not need.
        from wsgen.launching.evaluate import alternatives, with_assumed  # noqa: PLC0415

        for values in alternatives(plan, given, lambda: play({}, only_arguments=True).arguments):
            other = play(values)
            if not has_errors(other.diagnostics):
                plan = with_assumed(other, plan, values)
                break
    return read_plan(name_markers(plan, overlay), overlay, time.perf_counter() - before)


def name_markers(plan: LaunchPlan, overlay: Overlay) -> LaunchPlan:
    """The plan that says of packages that are not found if colcon ignores them, and why."""

    def explained(found: Diagnostic) -> Diagnostic:
        is_lookup = found.code == PACKAGE_NOT_FOUND.code and found.element is not None
        ignored = overlay.ignored(found.element or "") if is_lookup else None
        if ignored is None:
            return found
        return replace(
            found, message=f"{found.message.rstrip('.')}: {ignored.message}", hint=ignored.hint
        )

    return replace(plan, diagnostics=tuple(map(explained, plan.diagnostics)))


def read_plan(plan: LaunchPlan, overlay: Overlay, seconds: float) -> Started:
    """What a plan starts; `seconds` is how long it took to evaluate it."""
    simulator, no_simulator = find_simulator(plan)
    robots = find_robots(plan, overlay)
    lacks_something = has_errors(plan.diagnostics)
    found = tuple(
        one
        for one in (*no_simulator, *robots.diagnostics)
        if not lacks_something or one.severity is Severity.INFO
    )
    # A helper that is missing does not keep the robots from being simulated.
    is_evaluated = not lacks_something or (
        plan.is_complete and (robots.are_meant or robots.lack_world)
    )
    return Started(
        plan=plan,
        simulator=simulator,
        spawns=robots.spawns if is_evaluated else (),
        diagnostics=(*plan.diagnostics, *found),
        has_spawner=robots.are_meant,
        lacks_world=robots.lack_world,
        lacks_model=robots.lack_model,
        seconds=seconds,
        is_evaluated=is_evaluated,
    )


def waits_for_description(started: Started) -> bool:
    """Whether a spawner waits for a topic that a launch file beside this one may publish."""
    return any(
        found.code == UNPUBLISHED_DESCRIPTION.code and found.severity is Severity.WARNING
        for found in started.diagnostics
    )


def with_publisher_that_fails(started: Started, plan: LaunchPlan) -> Started:
    """Say that a launch file which cannot be evaluated may publish what a spawner waits for."""
    name = plan.launch_file.name
    diagnostics = tuple(
        replace(
            found,
            message=f"{found.message} {name}, which may publish it, cannot be evaluated.",
            hint=f"Correct the errors of {name} first.",
        )
        if found.code == UNPUBLISHED_DESCRIPTION.code
        else found
        for found in started.diagnostics
    )
    return started._replace(diagnostics=diagnostics)


def with_description(started: Started, others: Iterable[LaunchPlan], overlay: Overlay) -> Started:
    """Spawn what other launch files publish on the topic that a spawner waits for.

    Nothing changes where none publishes it, or where several publish different robots.
    """
    published: dict[str, dict[str, tuple[LaunchPlan, Process]]] = {}  # by topic, then text
    for plan in others:
        for topic, publisher in published_descriptions(plan).items():
            description = read_published(plan, publisher)
            if isinstance(description, Description):
                texts = published.setdefault(topic, {})
                texts.setdefault(description.text, (plan, publisher))
    only = {
        text: one for texts in published.values() if len(texts) == 1 for text, one in texts.items()
    }
    processes = (*started.plan.processes, *(publisher for _, publisher in only.values()))
    found = read_plan(replace(started.plan, processes=processes), overlay, started.seconds)
    spawn = next((spawn for spawn in found.spawns if spawn.description in only), None)
    if spawn is None or spawn.process is None or waits_for_description(found):
        return started
    plan, _ = only[spawn.description]
    elsewhere = DESCRIPTION_FROM_ELSEWHERE.at(
        spawn.process.file,
        spawn.process.line,
        message=f"{plan.package} {plan.launch_file.name} publishes the robot description, and must "
        "be started, too.",
        hint=f"Include {plan.launch_file.name}, so that a single command starts both.",
    )
    return found._replace(plan=started.plan, diagnostics=(*found.diagnostics, elsewhere))
