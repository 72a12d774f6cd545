"""One package on its way through the stages of `wsgen validate`."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.allowances import unknown_rule_allowed, without_allowed
from wsgen.checks.spawn_rules import spawned_twice
from wsgen.diagnostics import Diagnostic, Severity, has_errors
from wsgen.isolation import parent
from wsgen.launch.evaluate import evaluate
from wsgen.launch.spawning import find_simulator, find_spawns
from wsgen.model.outcome import PackageOutcome
from wsgen.pipeline.clock import DRAW, Clock
from wsgen.pipeline.described import Described, Workshop, describe, name_some
from wsgen.pipeline.folders import share_on_model_path
from wsgen.pipeline.models import (
    describe_models,
    read_file,
    read_spawned,
    without_taken,
)
from wsgen.pipeline.sources import changed_since_build, name_sources
from wsgen.pipeline.trial import Tried, try_robots
from wsgen.pipeline.worlds import missing_world, unknown_world
from wsgen.workspace.settings import read_settings
from wsgen.world.document import is_sdf
from wsgen.world.lookup import find_world, is_there
from wsgen.world.reader import DEFAULT_WORLD

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from wsgen.events import Listener
    from wsgen.isolation.protocol import Run
    from wsgen.model.plan import LaunchPlan, Simulator, Spawn
    from wsgen.model.world import World
    from wsgen.pipeline.behaviours import Programme
    from wsgen.pipeline.request import ValidateRequest
    from wsgen.pipeline.selection import Chosen
    from wsgen.workspace.overlay import Overlay
    from wsgen.workspace.settings import Settings


class Started(NamedTuple):
    """What a launch file starts."""

    plan: LaunchPlan
    simulator: Simulator | None
    spawns: tuple[Spawn, ...]


class Validation:
    """Evaluates, reads, simulates and judges; collects what is found on the way."""

    def __init__(
        self,
        chosen: Chosen,
        overlay: Overlay,
        request: ValidateRequest,
        listener: Listener | None,
        run: Run = parent.run,
    ) -> None:
        self.chosen = chosen
        self.package = chosen.name
        self.overlay = overlay
        self.request = request
        self.run_task = run
        self.clock = Clock(chosen.name, listener)
        self.generation: str | None = None  # of the simulator: "classic" or "gz"
        self.diagnostics: list[Diagnostic] = []
        self.settings: Settings | None = None
        self.wrong_settings: tuple[Diagnostic, ...] = ()
        if chosen.source is not None:
            self.settings, self.wrong_settings = read_settings(chosen.source)

    def run(self) -> PackageOutcome:
        """All stages, as far as they go."""
        with tempfile.TemporaryDirectory(prefix="wsgen-") as folder:
            return self._run(Path(folder))

    def _run(self, folder: Path) -> PackageOutcome:
        launch_file = self.chosen.launch_file
        if self.chosen.problem is not None:
            self.diagnostics.append(self.chosen.problem)
        started = self._evaluate(launch_file) if launch_file else None
        world, tried = self._play(started, folder) if started else (None, Tried())
        return PackageOutcome(
            package=self.package,
            share=self.chosen.share,
            launch_file=launch_file,
            world=world,
            robots=tried.robots,
            diagnostics=self._told(),
            picture=tried.picture,
            picture_tile=tried.picture_tile,
            world_picture=tried.world_picture,
            film=tried.film,
            seconds=self.clock.read(),
        )

    def _play(self, started: Started, folder: Path) -> tuple[World | None, Tried]:
        """Put what the plan spawns into the world that it names, and try it."""
        environment = {**self.overlay.environment, **started.plan.environment}
        on_model_path = share_on_model_path(environment)
        workshop = Workshop(
            share_of=lambda package: self.overlay.share(package) or on_model_path(package),
            folder=folder,
            run=self.run_task,
            with_colours=self.request.is_drawn,
        )
        world, scenery = self._read_world(started, workshop, environment)
        if world is None:
            return None, Tried()
        in_world = {
            *(model.entity for model in scenery),
            *(model.name for model in world.models if model.name),
        }
        described = self._describe(started, workshop, environment, in_world)
        if not described:
            return world, Tried()
        taken = [robot.entity for robot in described]
        return world, self._try(world, [*without_taken(scenery, taken), *described], folder)

    def _told(self) -> tuple[Diagnostic, ...]:
        """The findings as the package's source has them, without what it has on purpose."""
        source, share = self.chosen.source, self.chosen.share
        settings = self.settings
        if source is None or share is None or settings is None:
            return tuple(self.diagnostics)
        told = (
            *changed_since_build(share, source),
            *name_sources(self.diagnostics, share, source),
            *self.wrong_settings,
            *unknown_rule_allowed(settings.allow, settings.file),
        )
        return without_allowed(told, settings.allow)

    def _evaluate(self, launch_file: Path) -> Started | None:
        with self.clock.step("launch", launch_file.name) as step:
            plan = evaluate(
                launch_file,
                package=self.package if self.chosen.share else None,
                arguments=self.request.launch_arguments,
                environment=self.overlay.environment,
                run=self.run_task,
            )
            is_evaluated = not has_errors(plan.diagnostics)
            simulator, no_simulator = find_simulator(plan) if is_evaluated else (None, ())
            spawns, no_spawns = find_spawns(plan) if is_evaluated else ((), ())
            found = (*plan.diagnostics, *no_simulator, *no_spawns)
            step.succeeded = not has_errors(found)
        self.clock.split("launch", "expand", plan.seconds_in_xacro)
        self.diagnostics += found
        self.generation = simulator.generation if simulator else None
        return Started(plan, simulator, spawns) if is_evaluated else None

    def _read_world(
        self, started: Started, workshop: Workshop, environment: Mapping[str, str]
    ) -> tuple[World | None, list[Described]]:
        """The world that the plan starts, and the models in it."""
        name = started.simulator.world if started.simulator else None
        if not name:
            return DEFAULT_WORLD, []
        with self.clock.step("expand", Path(name).name) as step:
            file = find_world(name, environment)
            if file is None or not is_there(file):
                lost = (
                    unknown_world(started.plan, name, environment)
                    if file is None
                    else missing_world(started.plan, file)
                )
                step.succeeded = not has_errors([lost])
                self.diagnostics.append(lost)
                return DEFAULT_WORLD if file is None else None, []
            found = read_file(file, workshop, environment)
            scenery, flawed = describe_models(found, workshop, is_scenery=True)
            step.succeeded = not has_errors((*found.diagnostics, *flawed))
        self.diagnostics += (*found.diagnostics, *flawed)
        return found.world, scenery

    def _describe(
        self,
        started: Started,
        workshop: Workshop,
        environment: Mapping[str, str],
        in_world: Collection[str],
    ) -> list[Described]:
        with self.clock.step("expand", "robot description") as step:
            spawns, before = started.spawns, len(self.diagnostics)
            self.diagnostics += spawned_twice([spawn.entity for spawn in spawns], in_world)
            # Of two with one name the simulator refuses the second.
            unique = {spawn.entity: spawn for spawn in reversed(spawns)}
            described = [
                robot
                for spawn in reversed(unique.values())
                if (robot := self._describe_one(spawn, workshop, environment))
            ]
            if spawns and not described and not has_errors(self.diagnostics):
                self.diagnostics.append(_nothing_spawned(started.plan.launch_file))
            step.succeeded = not has_errors(self.diagnostics[before:])
        return described

    def _describe_one(
        self, spawn: Spawn, workshop: Workshop, environment: Mapping[str, str]
    ) -> Described | None:
        if is_sdf(spawn.description):
            found = read_spawned(spawn, workshop, environment)
            models, flawed = describe_models(found, workshop)
            self.diagnostics += (*found.diagnostics, *flawed)
            return next(
                (
                    replace(model, entity=spawn.entity, height=spawn.height, on_the_ground=False)
                    for model in models
                ),
                None,
            )
        described, diagnostics = describe(
            spawn.description,
            file=spawn.description_file,
            workshop=workshop,
            entity=spawn.entity,
            spawn_pose=spawn.pose_in_world,
            generation=self.generation,
            distro=(self.settings and self.settings.distro) or environment.get("ROS_DISTRO"),
        )
        self.diagnostics += diagnostics
        return replace(described, height=spawn.height) if described else None

    def _programme(self, described: list[Described]) -> Programme | None:
        """What the robots must do beyond standing; most packages load nothing for it."""
        if self.settings is None or not self.settings.behaviours:
            return None
        from wsgen.pipeline.behaviours import make_programme  # noqa: PLC0415

        return make_programme(self.settings, described, generation=self.generation)

    def _try(self, world: World, described: list[Described], folder: Path) -> Tried:
        progress = folder / "progress" if self.request.film else None
        with (
            self.clock.step("simulate", name_some(described)) as step,
            self.clock.watch(DRAW, progress),
        ):
            tried = try_robots(
                world,
                described,
                self.request,
                self.package,
                run=self.run_task,
                programme=self._programme(described),
                progress=progress,
            )
            step.succeeded = all(robot.passed for robot in tried.robots)
            tried.tell_drawing(step, self.request)
        self.diagnostics = tried.told_after(self.diagnostics)
        self.clock.take(tried.seconds or {})
        return tried


def _nothing_spawned(launch_file: Path | None) -> Diagnostic:
    return Diagnostic(
        code="SPN003",
        severity=Severity.ERROR,
        message="What the launch file spawns has no link: there is no robot to try.",
        file=launch_file,
        hint="Spawn a model with <link>, or leave the package out.",
    )
