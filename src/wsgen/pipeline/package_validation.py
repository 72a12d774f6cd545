"""Validate one package: evaluate its launch file, read world and robots, simulate and check."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Rule, Severity, has_errors
from wsgen.isolation import parent
from wsgen.launch.descriptions import UNKNOWN_DESCRIPTION, UNPUBLISHED_DESCRIPTION
from wsgen.launch.explain_missing import first_missing, where_written
from wsgen.launch.simulators import kind_of_project
from wsgen.launch.spawning import NO_ROBOT
from wsgen.model.outcome import PackageOutcome
from wsgen.pipeline.clock import DRAW, Clock
from wsgen.pipeline.gazebo_models import DATABASE_MODEL, as_robots, look_up_model, robots_of_world
from wsgen.pipeline.prepare import (
    PrepareContext,
    PreparedRobot,
    for_simulator,
    name_some,
    prepare_models,
    prepare_robot,
    read_file,
    read_spawned,
    share_on_model_path,
    without_taken,
)
from wsgen.pipeline.run_robots import SimulationResult, simulate_robots
from wsgen.pipeline.started import start
from wsgen.rules.catalogue import unknown_rule_allowed, without_allowed
from wsgen.rules.runs import spawned_twice
from wsgen.sdf.lookup import (
    EMPTY_WORLDS,
    find_world,
    gazebo_worlds,
    is_brought_along,
    is_there,
    world_names,
)
from wsgen.sdf.source import is_sdf
from wsgen.sdf.worlds import DEFAULT_WORLD
from wsgen.suggestions import advice
from wsgen.workspace.settings import read_settings

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

    from wsgen.events import Listener
    from wsgen.isolation.parent import Run
    from wsgen.model.plan import LaunchPlan
    from wsgen.model.world import Spawn, World
    from wsgen.pipeline.behavior_plan import BehaviorPlan
    from wsgen.pipeline.selection import SelectedPackage, ValidateRequest
    from wsgen.pipeline.started import Started
    from wsgen.sdf.models import SdfFile
    from wsgen.workspace.overlay import Overlay
    from wsgen.workspace.settings import Settings


NAMED = 5  # at most so many files are named in a message


def name_sources(
    diagnostics: Iterable[Diagnostic], sources: Mapping[Path, Path]
) -> Iterator[Diagnostic]:
    """Name the source file instead of its installed copy, where the two are equal.

    A change of the copy would be lost in the next build. `sources` are those of share folders.
    """
    for found in diagnostics:
        file = found.file
        origins = (_origin(file, *one) for one in sources.items()) if file is not None else ()
        origin = next((one for one in origins if one is not None), None)
        if origin is not None and file is not None and _same(origin, file):
            yield replace(found, file=origin)
        else:
            yield found


CHANGED_SINCE_BUILD = Rule(
    code="PKG052",
    name="changed-since-build",
    severity=Severity.WARNING,
    summary="A file was changed after the last build.",
    what="Compares the installed files with those of the same name in the source of the package.",
    why="`ros2 launch` and this simulation read the installed files: the change has no effect yet.",
    example="wsgen build\n$EDITOR src/my_robot/model/robot.xacro\nwsgen validate",
    instead="wsgen build\n$EDITOR src/my_robot/model/robot.xacro\nwsgen build\nwsgen validate",
)


def changed_since_build(share: Path, source: Path) -> Iterator[Diagnostic]:
    """Report files of the source that differ from what is installed."""
    if share == source:  # the package is not built
        return
    changed = [
        origin.relative_to(source).as_posix()
        for file in sorted(share.rglob("*"))
        if (origin := _origin(file, share, source)) is not None and not _same(origin, file)
    ]
    if changed:
        others = f" and {len(changed) - NAMED} more" if len(changed) > NAMED else ""
        yield CHANGED_SINCE_BUILD.at(
            source / changed[0],
            message=f"Changed since the last build: {', '.join(changed[:NAMED])}{others}. "
            "The installed files are checked.",
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


MISSING_WORLD = Rule(
    code="WLD001",
    name="missing-world",
    severity=Severity.ERROR,
    summary="The world file that the launch file names does not exist.",
    why="The simulator stops, or starts without the world.",
    example="# launch file\nworld = os.path.join(share, 'worlds', 'office.world')\n\n"
    "# CMakeLists.txt\ninstall(DIRECTORY launch DESTINATION share/${PROJECT_NAME})",
    instead="# CMakeLists.txt\ninstall(DIRECTORY launch worlds DESTINATION share/${PROJECT_NAME})",
)


def missing_world(plan: LaunchPlan, file: Path) -> Diagnostic:
    """Report the path of a world that does not exist, at the line that writes it."""
    missing, beside = first_missing(str(file))
    return MISSING_WORLD.at(
        *_where(plan, missing),
        missing,
        message=f"The world file '{file}' does not exist.",
        hint=advice(
            missing,
            beside,
            "Add its folder to an install(DIRECTORY ...) rule of CMakeLists.txt, then run "
            "`wsgen build`.",
        ),
    )


UNKNOWN_WORLD = Rule(
    code="WLD008",
    name="unknown-world",
    severity=Severity.WARNING,
    summary="No world file of this name is found; Gazebo may bring one along.",
    why="The simulation uses an empty world with a ground plane instead. If Gazebo has no world of "
    "this name either, it stops.",
    example="launch_arguments={'gz_args': 'my_wrold.sdf'}.items()",
    instead="launch_arguments={'gz_args': os.path.join(share, 'worlds', 'my_world.sdf')}.items()",
)


def unknown_world(plan: LaunchPlan, name: str, environment: Mapping[str, str]) -> Diagnostic:
    """Report the name of a world that is not found; Gazebo may have it."""
    return UNKNOWN_WORLD.at(
        *_where(plan, name),
        name,
        message=f"No world file {name} is found. If Gazebo brings it along, Gazebo finds it; "
        "the simulation uses a ground plane instead.",
        hint=advice(
            name,
            [*gazebo_worlds(), *world_names(environment)],
            "Use the path of a world file that the package installs.",
        ),
    )


WORLD_NOT_HERE = Rule(
    code="WLD061",
    name="world-not-here",
    severity=Severity.INFO,
    summary="The world is one of Gazebo, or of a ROS package that is not installed here.",
    why="The simulation of wsgen has a ground plane alone, so what stands in the world is missing.",
    example="launch_arguments={'gz_args': 'shapes.sdf'}.items()",
    instead="launch_arguments={'gz_args': os.path.join(share, 'worlds', 'shapes.sdf')}.items()",
)


def world_not_here(plan: LaunchPlan, name: str) -> Iterator[Diagnostic]:
    """Report a world that only Gazebo or another package has, unless that is empty."""
    if Path(name).name not in EMPTY_WORLDS:
        yield WORLD_NOT_HERE.at(
            *_where(plan, name),
            name,
            message=f"The world {name} is not here: the simulation uses a ground plane instead.",
            hint="Nothing to do for Gazebo, which finds it where it is installed.",
        )


def _where(plan: LaunchPlan, text: str) -> tuple[Path, int | None]:
    """The launch file and the line that write a text, or the launch file of the plan."""
    written, line = where_written(text, plan.evaluated_files) or (plan.launch_file, None)
    return Path(written), line


class Validation:
    """Evaluates, reads, simulates and checks; collects what is reported on the way."""

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
        self.label = selected.label or selected.name
        self.clock = Clock(self.label, listener)
        self.started: Started | None = None
        self.simulator_kind: str | None = None  # "classic" or "gz"
        self.diagnostics: list[Diagnostic] = []
        self.written: dict[Path, Path] = {}  # a copy of what a process writes -> its xacro file
        self.settings: Settings | None = None
        self.settings_diagnostics: tuple[Diagnostic, ...] = ()
        if selected.source is not None:
            self.settings, self.settings_diagnostics = read_settings(selected.source)

    def run(self) -> PackageOutcome:
        """Run all stages, up to the first that fails."""
        with tempfile.TemporaryDirectory(prefix="wsgen-") as folder:
            return self._run(Path(folder))

    def _run(self, folder: Path) -> PackageOutcome:
        launch_file = self.selected.launch_file
        if self.selected.problem is not None:
            self.diagnostics.append(self.selected.problem)
        started = self._evaluate(launch_file) if launch_file else None
        world, simulated = self._play(started, folder) if started else (None, SimulationResult())
        if started and not simulated.robots and not has_errors(self.diagnostics):
            self.diagnostics = _why_nothing_is_simulated(started.plan, self.diagnostics)
        return PackageOutcome(
            package=self.package,
            share=self.selected.share,
            launch_file=launch_file,
            world=world,
            robots=simulated.robots,
            diagnostics=self._reported(),
            picture=simulated.picture,
            picture_tile=simulated.picture_tile,
            world_picture=simulated.world_picture,
            video=simulated.video,
            seconds=self.clock.read(),
        )

    def _play(self, started: Started, folder: Path) -> tuple[World | None, SimulationResult]:
        """Put what the plan spawns into the world that it names, and simulate it."""
        environment = {**self.overlay.environment, **started.plan.environment}
        on_model_path = share_on_model_path(environment)
        context = PrepareContext(
            share_of=lambda package: self.overlay.share(package) or on_model_path(package),
            folder=folder,
            run=self.run_task,
            with_colors=self.request.is_drawn,
        )
        world, models = self._read_world(started, context, environment)
        if world is None:
            return None, SimulationResult()
        in_world = {
            *(model.entity for model in models),
            *(model.name for model in world.models if model.name),
        }
        prepared = self._describe(started, context, environment, in_world)
        scene = [*without_taken(models, [robot.entity for robot in prepared]), *prepared]
        if all(model.is_static_model for model in scene):
            return world, SimulationResult()
        return world, self._simulate(world, scene, folder)

    def _reported(self) -> tuple[Diagnostic, ...]:
        """The diagnostics with files of the source, without those that the package allows."""
        self.diagnostics = [
            replace(found, file=self.written[found.file], line=None)
            if found.file in self.written
            else found
            for found in self.diagnostics
        ]
        source, share = self.selected.source, self.selected.share
        settings = self.settings
        if source is None or share is None or settings is None:
            return tuple(self.diagnostics)
        used = {**self._used(), share: source}
        of_package = (
            *(found for one in used.items() for found in changed_since_build(*one)),
            *self.settings_diagnostics,
            *unknown_rule_allowed(settings.allow, settings.file, settings.allow_line),
        )
        reported = (
            *name_sources(self.diagnostics, used),
            *(of_package if self.selected.is_first else ()),
        )
        return without_allowed(reported, settings.allow)

    def _used(self) -> dict[Path, Path]:
        """The packages of the workspace that the launch uses: share folder -> source."""
        if self.started is None:
            return {}
        robots = (spawn.description_file for spawn in self.started.spawns)
        files = [*self.started.plan.evaluated_files, *(file for file in robots if file)]
        return {
            share: source
            for share, source in self.selected.workspace.items()
            if any(file.is_relative_to(share) for file in files)
        }

    def _evaluate(self, launch_file: Path) -> Started | None:
        started = self.selected.started
        if started is None:
            with self.clock.step("launch", launch_file.name) as step:
                started = start(
                    launch_file,
                    self.package if self.selected.share else None,
                    self.overlay,
                    self.request,
                    self.run_task,
                )
                step.succeeded = not has_errors(started.diagnostics)
        else:
            self.clock.add("launch", started.seconds)
        self.clock.split("launch", "expand", started.plan.seconds_in_xacro)
        self.diagnostics += started.diagnostics
        self.started = started
        simulator = started.simulator
        self.simulator_kind = simulator.kind if simulator else kind_of_project(started.plan)
        return started if started.is_evaluated else None

    def _read_world(
        self, started: Started, context: PrepareContext, environment: Mapping[str, str]
    ) -> tuple[World | None, list[PreparedRobot]]:
        """The world that the plan starts, and the models in it, robots among them."""
        name = started.simulator.world if started.simulator else None
        if not name:
            return DEFAULT_WORLD, []
        with self.clock.step("expand", Path(name).name) as step:
            file = self._written_world(started, name, context) or find_world(name, environment)
            if file is None or not is_there(file):
                if is_brought_along(name):
                    self.diagnostics += world_not_here(started.plan, name)
                    return DEFAULT_WORLD, []
                missing = (
                    unknown_world(started.plan, name, environment)
                    if file is None
                    else missing_world(started.plan, file)
                )
                step.succeeded = not has_errors([missing])
                self.diagnostics.append(missing)
                return DEFAULT_WORLD if file is None else None, []
            found = self._for_simulator(read_file(file, context, environment))
            models, more = prepare_models(found, context, is_static_model=True)
            step.succeeded = not has_errors((*found.diagnostics, *more))
        self.diagnostics += (*found.diagnostics, *more)
        world = found.world
        if world is not None and world.file in self.written:
            world = replace(world, file=self.written[world.file])
        return world, as_robots(models, robots_of_world(found, environment))

    def _written_world(self, started: Started, name: str, context: PrepareContext) -> Path | None:
        """A file with the world that a process of the launch would write under this name."""
        path = str(Path(name).absolute())
        text = started.plan.written.get(path)
        if text is None:
            return None
        file = context.folder / Path(name).name
        file.write_text(text, encoding="utf-8")
        self.written[file] = Path(started.plan.written_from.get(path, path))
        return file

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
            # The simulator refuses the second of two with one name.
            unique = {spawn.entity: spawn for spawn in reversed(spawns)}
            prepared = [
                robot
                for spawn in reversed(unique.values())
                if (robot := self._describe_one(spawn, context, environment))
            ]
            is_explained = any(found.code == DATABASE_MODEL.code for found in self.diagnostics)
            if spawns and not (prepared or is_explained or has_errors(self.diagnostics)):
                self.diagnostics.append(_nothing_spawned(started.plan.launch_file))
            step.succeeded = not has_errors(self.diagnostics[before:])
        return prepared

    def _describe_one(
        self, spawn: Spawn, context: PrepareContext, environment: Mapping[str, str]
    ) -> PreparedRobot | None:
        if spawn.model_uri is not None:
            looked_up = look_up_model(spawn, context, environment)
            if isinstance(looked_up, Diagnostic):
                self.diagnostics.append(looked_up)
                return None
            spawn = looked_up
        if is_sdf(spawn.description):
            found = self._for_simulator(read_spawned(spawn, context, environment))
            models, more = prepare_models(found, context)
            self.diagnostics += (*found.diagnostics, *more)
            return next(
                (
                    replace(
                        model,
                        entity=spawn.entity,
                        height=spawn.height,
                        on_the_ground=spawn.is_assumed,
                    )
                    for model in models
                ),
                None,
            )
        prepared, diagnostics = prepare_robot(
            spawn.description,
            file=spawn.description_file,
            context=context,
            entity=spawn.entity,
            spawn_pose=spawn.pose_in_world,
            on_the_ground=spawn.is_assumed,
            simulator=self.simulator_kind,
            distro=(self.settings and self.settings.distro) or environment.get("ROS_DISTRO"),
        )
        self.diagnostics += diagnostics
        return replace(prepared, height=spawn.height) if prepared else None

    def _for_simulator(self, found: SdfFile) -> SdfFile:
        diagnostics = for_simulator(found.diagnostics, self.simulator_kind)
        return found._replace(diagnostics=tuple(diagnostics))

    def _behavior_plan(self, prepared: list[PreparedRobot]) -> BehaviorPlan | None:
        """What the robots must do beyond standing; most packages load nothing for it."""
        if self.settings is None or not self.settings.behaviors:
            return None
        there = {robot.entity for robot in prepared}
        behaviors = tuple(
            behavior
            for behavior in self.settings.behaviors
            if behavior.robot in there or behavior.robot not in self.selected.elsewhere
        )
        from wsgen.pipeline.behavior_plan import plan_behaviors  # noqa: PLC0415

        return plan_behaviors(
            replace(self.settings, behaviors=behaviors), prepared, simulator=self.simulator_kind
        )

    def _simulate(
        self, world: World, prepared: list[PreparedRobot], folder: Path
    ) -> SimulationResult:
        progress = folder / "progress" if self.request.video else None
        with (
            self.clock.step("simulate", name_some(prepared)) as step,
            self.clock.watch(DRAW, progress),
        ):
            simulated = simulate_robots(
                world,
                prepared,
                self.request,
                self.label,
                run=self.run_task,
                behavior_plan=self._behavior_plan(prepared),
                progress=progress,
            )
            step.succeeded = all(robot.passed for robot in simulated.robots)
            simulated.report_drawing(step, self.request)
        self.diagnostics = simulated.diagnostics_after(self.diagnostics)
        self.clock.take(simulated.seconds or {})
        return simulated


def _why_nothing_is_simulated(plan: LaunchPlan, found: Sequence[Diagnostic]) -> list[Diagnostic]:
    """The diagnostics with an error: each that says why a robot is missing, or one more."""
    codes = {rule.code for rule in (DATABASE_MODEL, UNKNOWN_DESCRIPTION, UNPUBLISHED_DESCRIPTION)}
    if codes.isdisjoint(one.code for one in found):
        missing = NO_ROBOT.at(
            plan.launch_file,
            message="No robot is simulated: nothing that the launch file spawns can move.",
            hint="Spawn a model with movable joints, or one that is not static.",
        )
        return [*found, missing]
    return [replace(one, severity=Severity.ERROR) if one.code in codes else one for one in found]


def _nothing_spawned(launch_file: Path | None) -> Diagnostic:
    return NO_ROBOT.at(
        launch_file,
        message="No model that the launch file spawns has a link.",
        hint="Spawn a model with a <link>.",
    )
