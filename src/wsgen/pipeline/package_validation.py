"""One package on its way through the stages of `wsgen validate`.

The source of an installed package: what a person edits, and what was not built since.

World files that a launch file names and that are not there.
"""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import Diagnostic, Severity, has_errors
from wsgen.isolation import parent
from wsgen.launch.evaluate import evaluate
from wsgen.launch.explain_missing import first_missing
from wsgen.launch.spawning import find_simulator, find_spawns
from wsgen.launch.syntax import where_written
from wsgen.model.outcome import PackageOutcome
from wsgen.pipeline.clock import DRAW, Clock
from wsgen.pipeline.prepare import (
    PrepareContext,
    PreparedRobot,
    describe,
    describe_models,
    name_some,
    read_file,
    read_spawned,
    share_on_model_path,
    without_taken,
)
from wsgen.pipeline.run_robots import SimulationResult, try_robots
from wsgen.rules.allowances import unknown_rule_allowed, without_allowed
from wsgen.rules.scenes import spawned_twice
from wsgen.sdf.lookup import find_world, gazebo_worlds, is_there, world_names
from wsgen.sdf.reader import DEFAULT_WORLD
from wsgen.sdf.source import is_sdf
from wsgen.suggestions import advice
from wsgen.workspace.settings import read_settings

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping

    from wsgen.events import Listener
    from wsgen.isolation.parent import Run
    from wsgen.model.plan import LaunchPlan, Simulator, Spawn
    from wsgen.model.world import World
    from wsgen.pipeline.behaviors import BehaviorPlan
    from wsgen.pipeline.request import ValidateRequest
    from wsgen.pipeline.selection import SelectedPackage
    from wsgen.workspace.overlay import Overlay
    from wsgen.workspace.settings import Settings


NAMED = 5  # so many files are told in a message


def name_sources(
    diagnostics: Iterable[Diagnostic], share: Path, source: Path
) -> Iterator[Diagnostic]:
    """Name the file that a person edits instead of its installed copy, where the two are equal.

    A change of the copy would be lost in the next build.
    """
    for found in diagnostics:
        origin = None if found.file is None else _origin(found.file, share, source)
        if origin is not None and found.file is not None and _same(origin, found.file):
            yield replace(found, file=origin)
        else:
            yield found


def changed_since_build(share: Path, source: Path) -> Iterator[Diagnostic]:
    """Files of the source differ from what is installed.

    ## What it does
    Compares the installed files with those of the same name in the package's source.

    ## Why is this bad?
    `ros2 launch` and this simulation read the installed files: the change has no effect yet.

    ## Use instead
    A build after every change, or one with --symlink-install.
    """
    changed = [
        origin.relative_to(source).as_posix()
        for file in sorted(share.rglob("*"))
        if (origin := _origin(file, share, source)) is not None and not _same(origin, file)
    ]
    if changed:
        others = f" and {len(changed) - NAMED} more" if len(changed) > NAMED else ""
        yield Diagnostic(
            code="PKG052",
            severity=Severity.WARNING,
            message=f"Changed since the last build: {', '.join(changed[:NAMED])}{others}. "
            "What is checked are the installed files.",
            file=source / changed[0],
            hint="Run `wsgen build`, then validate again.",
        )


def _origin(file: Path, share: Path, source: Path) -> Path | None:
    if not file.is_relative_to(share):
        return None
    origin = source / file.relative_to(share)
    return origin if origin.is_file() and file.is_file() else None


def _same(first: Path, second: Path) -> bool:
    try:
        one, other = first.stat(), second.stat()
        if one.st_size != other.st_size:
            return False
        # CMake gives the installed file the time of the other.
        return one.st_mtime_ns == other.st_mtime_ns or first.read_bytes() == second.read_bytes()
    except OSError:
        return False


def missing_world(plan: LaunchPlan, file: Path) -> Diagnostic:
    """Report the path of a world that leads to nothing, at the line that writes it."""
    missing, beside = first_missing(str(file))
    written, line = where_written(missing, plan.evaluated_files) or (plan.launch_file, None)
    return Diagnostic(
        code="WLD001",
        severity=Severity.ERROR,
        message=f"The world file '{file}' is not there.",
        file=Path(written),
        line=line,
        element=missing,
        hint=advice(
            missing,
            beside,
            "Put its folder into an install(DIRECTORY ...) rule of CMakeLists.txt, then build "
            "again with `wsgen build`.",
        ),
    )


def unknown_world(plan: LaunchPlan, name: str, environment: Mapping[str, str]) -> Diagnostic:
    """Report the name of a world that is not found here; Gazebo may have it."""
    written, line = where_written(name, plan.evaluated_files) or (plan.launch_file, None)
    gazebos = gazebo_worlds()
    use_path = "Give the path of a world file that the package installs."
    return Diagnostic(
        code="WLD008",
        severity=Severity.WARNING,
        message=f"No file is called {name}. If it is one of Gazebo's own worlds, Gazebo finds it; "
        "the simulation takes a ground plane instead.",
        file=Path(written),
        line=line,
        element=name,
        hint=use_path
        if name in gazebos
        else advice(name, [*gazebos, *world_names(environment)], use_path),
    )


class Started(NamedTuple):
    """What a launch file starts."""

    plan: LaunchPlan
    simulator: Simulator | None
    spawns: tuple[Spawn, ...]


class Validation:
    """Evaluates, reads, simulates and checks; collects what is found on the way."""

    def __init__(
        self,
        selected: SelectedPackage,
        overlay: Overlay,
        request: ValidateRequest,
        listener: Listener | None,
        run: Run = parent.run,
    ) -> None:
        self.selected = selected
        self.package = selected.name
        self.overlay = overlay
        self.request = request
        self.run_task = run
        self.clock = Clock(selected.name, listener)
        self.generation: str | None = None  # of the simulator: "classic" or "gz"
        self.diagnostics: list[Diagnostic] = []
        self.settings: Settings | None = None
        self.wrong_settings: tuple[Diagnostic, ...] = ()
        if selected.source is not None:
            self.settings, self.wrong_settings = read_settings(selected.source)

    def run(self) -> PackageOutcome:
        """All stages, as far as they go."""
        with tempfile.TemporaryDirectory(prefix="wsgen-") as folder:
            return self._run(Path(folder))

    def _run(self, folder: Path) -> PackageOutcome:
        launch_file = self.selected.launch_file
        if self.selected.problem is not None:
            self.diagnostics.append(self.selected.problem)
        started = self._evaluate(launch_file) if launch_file else None
        world, simulated = self._play(started, folder) if started else (None, SimulationResult())
        return PackageOutcome(
            package=self.package,
            share=self.selected.share,
            launch_file=launch_file,
            world=world,
            robots=simulated.robots,
            diagnostics=self._told(),
            picture=simulated.picture,
            picture_tile=simulated.picture_tile,
            world_picture=simulated.world_picture,
            video=simulated.video,
            seconds=self.clock.read(),
        )

    def _play(self, started: Started, folder: Path) -> tuple[World | None, SimulationResult]:
        """Put what the plan spawns into the world that it names, and try it."""
        environment = {**self.overlay.environment, **started.plan.environment}
        on_model_path = share_on_model_path(environment)
        context = PrepareContext(
            share_of=lambda package: self.overlay.share(package) or on_model_path(package),
            folder=folder,
            run=self.run_task,
            with_colors=self.request.is_drawn,
        )
        world, static_models = self._read_world(started, context, environment)
        if world is None:
            return None, SimulationResult()
        in_world = {
            *(model.entity for model in static_models),
            *(model.name for model in world.models if model.name),
        }
        prepared = self._describe(started, context, environment, in_world)
        if not prepared:
            return world, SimulationResult()
        taken = [robot.entity for robot in prepared]
        return world, self._try(world, [*without_taken(static_models, taken), *prepared], folder)

    def _told(self) -> tuple[Diagnostic, ...]:
        """The findings as the package's source has them, without what it has on purpose."""
        source, share = self.selected.source, self.selected.share
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
                package=self.package if self.selected.share else None,
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
        self, started: Started, context: PrepareContext, environment: Mapping[str, str]
    ) -> tuple[World | None, list[PreparedRobot]]:
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
            found = read_file(file, context, environment)
            static_models, flawed = describe_models(found, context, is_static_model=True)
            step.succeeded = not has_errors((*found.diagnostics, *flawed))
        self.diagnostics += (*found.diagnostics, *flawed)
        return found.world, static_models

    def _describe(
        self,
        started: Started,
        context: PrepareContext,
        environment: Mapping[str, str],
        in_world: Collection[str],
    ) -> list[PreparedRobot]:
        with self.clock.step("expand", "robot description") as step:
            spawns, before = started.spawns, len(self.diagnostics)
            self.diagnostics += spawned_twice([spawn.entity for spawn in spawns], in_world)
            # Of two with one name the simulator refuses the second.
            unique = {spawn.entity: spawn for spawn in reversed(spawns)}
            prepared = [
                robot
                for spawn in reversed(unique.values())
                if (robot := self._describe_one(spawn, context, environment))
            ]
            if spawns and not prepared and not has_errors(self.diagnostics):
                self.diagnostics.append(_nothing_spawned(started.plan.launch_file))
            step.succeeded = not has_errors(self.diagnostics[before:])
        return prepared

    def _describe_one(
        self, spawn: Spawn, context: PrepareContext, environment: Mapping[str, str]
    ) -> PreparedRobot | None:
        if is_sdf(spawn.description):
            found = read_spawned(spawn, context, environment)
            models, flawed = describe_models(found, context)
            self.diagnostics += (*found.diagnostics, *flawed)
            return next(
                (
                    replace(model, entity=spawn.entity, height=spawn.height, on_the_ground=False)
                    for model in models
                ),
                None,
            )
        prepared, diagnostics = describe(
            spawn.description,
            file=spawn.description_file,
            context=context,
            entity=spawn.entity,
            spawn_pose=spawn.pose_in_world,
            generation=self.generation,
            distro=(self.settings and self.settings.distro) or environment.get("ROS_DISTRO"),
        )
        self.diagnostics += diagnostics
        return replace(prepared, height=spawn.height) if prepared else None

    def _behavior_plan(self, prepared: list[PreparedRobot]) -> BehaviorPlan | None:
        """What the robots must do beyond standing; most packages load nothing for it."""
        if self.settings is None or not self.settings.behaviors:
            return None
        from wsgen.pipeline.behaviors import plan_behaviors  # noqa: PLC0415

        return plan_behaviors(self.settings, prepared, generation=self.generation)

    def _try(self, world: World, prepared: list[PreparedRobot], folder: Path) -> SimulationResult:
        progress = folder / "progress" if self.request.video else None
        with (
            self.clock.step("simulate", name_some(prepared)) as step,
            self.clock.watch(DRAW, progress),
        ):
            simulated = try_robots(
                world,
                prepared,
                self.request,
                self.package,
                run=self.run_task,
                behavior_plan=self._behavior_plan(prepared),
                progress=progress,
            )
            step.succeeded = all(robot.passed for robot in simulated.robots)
            simulated.tell_drawing(step, self.request)
        self.diagnostics = simulated.told_after(self.diagnostics)
        self.clock.take(simulated.seconds or {})
        return simulated


def _nothing_spawned(launch_file: Path | None) -> Diagnostic:
    return Diagnostic(
        code="SPN003",
        severity=Severity.ERROR,
        message="What the launch file spawns has no link: there is no robot to try.",
        file=launch_file,
        hint="Spawn a model with <link>, or leave the package out.",
    )
