"""Validate one package: evaluate its launch file, read world and robots, simulate and check."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.checks.rules.catalogue import unknown_rule_allowed, without_allowed
from wsgen.checks.rules.consequences import without_explained
from wsgen.checks.rules.drives import friction_without_direction
from wsgen.checks.rules.entities import spawned_twice
from wsgen.checks.rules.settings import solver_not_simulated
from wsgen.checks.rules.worlds import (
    UNKNOWN_WORLD,
    is_folder_reported,
    missing_world,
    unknown_world,
    world_not_here,
)
from wsgen.descriptions.sdf.lookup import find_world, is_brought_along, is_there
from wsgen.descriptions.sdf.source import is_sdf
from wsgen.descriptions.sdf.worlds import default_world
from wsgen.diagnostics import Diagnostic, Severity, has_errors, worst_of_each
from wsgen.errors import NotFoundError, WsgenError
from wsgen.isolation import parent
from wsgen.launching.descriptions import UNKNOWN_DESCRIPTION, UNPUBLISHED_DESCRIPTION
from wsgen.launching.simulators import kind_of_project
from wsgen.launching.spawning import NO_ROBOT
from wsgen.model.outcome import PackageOutcome
from wsgen.packages.workspace.layout import workspace_around
from wsgen.packages.workspace.settings import read_settings
from wsgen.pipeline.changed_since_build import (
    changed_since_build,
    name_sources,
    used_packages,
    with_needs,
)
from wsgen.pipeline.clock import DRAW, Clock
from wsgen.pipeline.gazebo_models import (
    DATABASE_MODEL,
    ReadWorld,
    as_robots,
    look_up_model,
    robots_of_world,
)
from wsgen.pipeline.launched_simulator import check_search_path, check_systems, find_started_world
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
from wsgen.pipeline.requests import SelectedLaunchFile, SimulationResult
from wsgen.pipeline.started import overlay_for, start

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

    from wsgen.descriptions.sdf.models import SdfFile
    from wsgen.events import Listener
    from wsgen.isolation.parent import Run
    from wsgen.model.behavior import BehaviorRun, LiveMeasurement
    from wsgen.model.devices import Devices
    from wsgen.model.plan import LaunchPlan
    from wsgen.model.world import Spawn, World
    from wsgen.packages.workspace.overlay import Overlay
    from wsgen.packages.workspace.settings import Settings
    from wsgen.pipeline.behavior_plan import BehaviorPlan
    from wsgen.pipeline.gazebo_models import KnownWorlds
    from wsgen.pipeline.launched_simulator import StartedWorld
    from wsgen.pipeline.prepare import KnownRobots
    from wsgen.pipeline.real_gazebo import RealGazebo
    from wsgen.pipeline.requests import SelectedPackage, ValidateRequest
    from wsgen.pipeline.started import Started

    Live = Mapping[str, Mapping[str, LiveMeasurement]]  # what was measured, by engine, then by name


class Validation:
    """Evaluates, reads, simulates and checks; collects what is reported on the way."""

    def __init__(  # noqa: PLR0913  what the stages need
        self,
        selected: SelectedPackage,
        overlay: Overlay,
        request: ValidateRequest,
        listener: Listener | None,
        run: Run = parent.run,
        *,
        known: KnownRobots | None = None,
        worlds: KnownWorlds | None = None,
    ) -> None:
        self.known = known
        self.worlds = worlds
        self.selected = selected
        self.package = selected.name
        self.overlay = overlay_for(selected.name, overlay)
        self.request = request
        self.run_task = run
        self.label = selected.label or selected.name
        self.clock = Clock(self.label, listener)
        self.started: Started | None = None
        self.simulator_kind: str | None = None  # "classic" or "gz"
        self.world_devices: Devices | None = None  # of a live run
        self.world_file: Path | None = None  # that it is read from
        self.started_world: StartedWorld | None = None  # of Gazebo Sim, where it is known
        self.diagnostics: list[Diagnostic] = []
        self.sdf_files: set[Path] = set()  # that the world and what is spawned were read from
        self.written: dict[Path, Path] = {}  # a copy of what a process writes -> its xacro file
        self.settings: Settings | None = None
        self.settings_diagnostics: tuple[Diagnostic, ...] = ()
        if selected.source is not None:
            self.settings, self.settings_diagnostics = read_settings(selected.source)

    def run(self) -> PackageOutcome:
        """Run all stages, up to the first that fails."""
        with parent.make_scratch() as folder:
            return self._run(folder)

    def _run(self, folder: Path) -> PackageOutcome:
        world, scene = self.read(folder)
        simulated = SimulationResult()
        started = self.started
        live: Live | None = None
        if world is not None and started is not None and self._nodes_may_spawn(started):
            live, robots = self._run_for_robots(scene, folder)
            scene += robots
        if world is not None and not all(model.is_static_model for model in scene):
            simulated = self._simulate(world, scene, folder, live)
        if (
            started is not None
            and started.is_evaluated
            and not simulated.robots
            and not has_errors(self.diagnostics)
        ):
            self.diagnostics = why_nothing_is_simulated(started.plan, self.diagnostics)
        # Other commands read packages, too, and need nothing of what checks them.
        from wsgen.pipeline.check_validated import errors_of_check, without_undeclared  # noqa: PLC0415

        self.diagnostics = without_undeclared(self)
        self.diagnostics += errors_of_check(self, world, scene)
        return PackageOutcome(
            package=self.package,
            share=self.selected.share,
            launch_file=self.selected.launch_file,
            world=world,
            robots=simulated.robots,
            diagnostics=self.reported(),
            picture=simulated.picture,
            picture_tile=simulated.picture_tile,
            world_picture=simulated.world_picture,
            video=simulated.video,
            plan=None if started is None else started.plan,
            view=simulated.view,
            seconds=self.clock.read(),
        )

    def read(self, folder: Path) -> tuple[World | None, list[PreparedRobot]]:
        """Run the stages before the simulation: the world, and what stands in it.

        `folder` is for files that engines read; `diagnostics` has what is reported.
        """
        launch_file = self.selected.launch_file
        if self.selected.problem is not None:
            self.diagnostics.append(self.selected.problem)
        started = self._evaluate(launch_file) if launch_file else None
        return (None, []) if started is None else self._prepare(started, folder)

    def _prepare(self, started: Started, folder: Path) -> tuple[World | None, list[PreparedRobot]]:
        """Read what the plan spawns, and the world that it names."""
        context, environment = self._context(started, folder)
        world, models = self._read_world(started, context, environment)
        if world is None:
            return None, []
        in_world = {
            *(model.entity for model in models),
            *(model.name for model in world.models if model.name),
        }
        prepared = self._describe(started, context, environment, in_world)
        self.diagnostics += check_search_path(
            started, self.overlay, environment, self.selected.workspace.values()
        )
        self.started_world = find_started_world(
            started,
            self.world_file,
            environment=environment,
            distro=self._distro(environment),
        )
        if self.started_world is not None:
            lacking = check_systems(started, self.started_world, self.sdf_files)
            self.diagnostics += self._as_written(lacking)
        for robot in (*models, *prepared):
            self.diagnostics += friction_without_direction(robot.lumped, self.request.engines)
        self.diagnostics += solver_not_simulated(
            world, (robot.drive for robot in prepared), context.engines
        )
        robots = [*without_taken(models, [robot.entity for robot in prepared]), *prepared]
        return replace(world, simulator=self.simulator_kind), robots

    def _distro(self, environment: Mapping[str, str]) -> str | None:
        """The distribution that the package is for, if that is known."""
        return (self.settings and self.settings.distro) or environment.get("ROS_DISTRO")

    def _context(self, started: Started, folder: Path) -> tuple[PrepareContext, dict[str, str]]:
        """What it takes to complete descriptions, and the environment that they are read in."""
        environment = {**self.overlay.environment, **started.plan.environment}
        on_model_path = share_on_model_path(environment)
        return PrepareContext(
            share_of=lambda package: self.overlay.look_up(package) or on_model_path(package),
            folder=folder,
            run=self.run_task,
            with_colors=self.request.is_drawn or self._has_cameras(started),
            with_devices=self.request.is_live,
            engines=self.request.engines if self.simulator_kind == "classic" else (),
            known=self.known,
        ), environment

    def prepare_later(
        self, spawn: Spawn, folder: Path
    ) -> tuple[PreparedRobot | None, tuple[Diagnostic, ...]]:
        """Read what is spawned while a launch runs, after `read`; and what is reported of it.

        `folder` is for files that engines read, of this entity alone.
        """
        if self.started is None:
            return None, ()
        before = len(self.diagnostics)
        prepared = self._describe_one(spawn, *self._context(self.started, folder))
        return prepared, self.named(self.diagnostics[before:])

    def _has_cameras(self, started: Started) -> bool:
        """Whether robots of a live run look at one another."""
        return self.request.is_live and any("camera" in one.description for one in started.spawns)

    def named(self, diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
        """Diagnostics with the files of the source in place of copies and of what is installed."""
        written = self._as_written(diagnostics)
        source, share = self.selected.source, self.selected.share
        if source is None or share is None:
            return tuple(written)
        return tuple(name_sources(written, {**self._used(), share: source}))

    def _as_written(self, diagnostics: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
        """Diagnostics with the files that processes expand in place of what they write."""
        for found in diagnostics:
            file = None if found.file is None else self.written.get(found.file)
            yield found if file is None else replace(found, file=file, line=None)

    def reported(self) -> tuple[Diagnostic, ...]:
        """The diagnostics with files of the source, without those that the package allows."""
        reported = self.named(without_explained(worst_of_each(self.diagnostics)))
        if self.selected.is_first:
            reported += tuple(self.of_package())
        return reported if self.settings is None else without_allowed(reported, self.settings.allow)

    def of_package(self) -> Iterator[Diagnostic]:
        """What is wrong with the package itself: its settings, and a build that is out of date."""
        source, settings = self.selected.source, self.settings
        if source is None or self.selected.share is None or settings is None:
            return
        yield from self.changed()
        yield from self.settings_diagnostics
        yield from unknown_rule_allowed(settings.allow, settings.file, settings.allow_line)

    def changed(self) -> Iterator[Diagnostic]:
        """What was changed after the build of the package, and of those that the launch uses."""
        source, share = self.selected.source, self.selected.share
        own = {} if source is None or share is None else {share: source}
        for one in {**self._used(), **own}.items():
            yield from changed_since_build(*one)

    def _used(self) -> dict[Path, Path]:
        """The packages of the workspace that the launch uses: share folder -> source."""
        if self.started is None:
            return {}
        shares = self.selected.workspace
        robots = [spawn.description_file for spawn in self.started.spawns]
        described = (
            share.name
            for share in shares
            if any(file is not None and file.is_relative_to(share) for file in robots)
        )
        return {**used_packages(self.started.plan, shares), **with_needs(described, shares)}

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
                # What runs need not have all that a simulation needs.
                step.succeeded = (
                    started.is_evaluated
                    if self.request.is_live
                    else not has_errors(started.diagnostics)
                )
        else:
            self.clock.add("launch", started.seconds)
        self.clock.split("launch", "expand", started.plan.seconds_in_xacro)
        found = started.diagnostics
        self.diagnostics += map(may_come_later, found) if self._nodes_may_spawn(started) else found
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
            return default_world(self.simulator_kind), []
        with self.clock.step("expand", Path(name).name) as step:
            file = self._written_world(started, name, context) or find_world(name, environment)
            if file is None or not is_there(file):
                if is_brought_along(name):
                    self.diagnostics += world_not_here(started.plan, name)
                    return default_world(self.simulator_kind), []
                if file is not None and is_folder_reported(file, self.diagnostics):
                    step.succeeded = False
                    return None, []
                missing = (
                    unknown_world(started.plan, name, environment)
                    if file is None
                    else missing_world(started.plan, file, self.overlay)
                )
                step.succeeded = not has_errors([missing])
                self.diagnostics.append(missing)
                return default_world(self.simulator_kind) if file is None else None, []
            self.world_file = file
            found, models, more = self._read_models(name, file, context, environment)
            step.succeeded = not has_errors((*found.diagnostics, *more))
        self.diagnostics += (*found.diagnostics, *more)
        world = found.world
        self.world_devices = found.devices
        if world is not None and world.file in self.written:
            world = replace(world, file=self.written[world.file])
        return world, as_robots(models, robots_of_world(found, environment))

    def _read_models(
        self, name: str, file: Path, context: PrepareContext, environment: Mapping[str, str]
    ) -> ReadWorld:
        """What is in a world file, which other launch files may start, too."""

        def read(context: PrepareContext) -> ReadWorld:
            found = self._for_simulator(read_file(file, context, environment))
            models, more = prepare_models(found, context, is_static_model=True)
            return ReadWorld(found, models, more)

        if self.worlds is None or file in self.written:
            return read(context)
        known = self.worlds.read(name, file, self.simulator_kind, context, environment, read)
        self.sdf_files |= known.file.files
        return known

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
        spawns, before = started.spawns, len(self.diagnostics)
        if not spawns:
            return []
        with self.clock.step("expand", "robot description") as step:
            self.diagnostics += spawned_twice(spawns, in_world)
            # The simulator refuses the second of two with one name.
            unique = {spawn.entity: spawn for spawn in reversed(spawns)}
            prepared = [
                robot
                for spawn in reversed(unique.values())
                if (robot := self._describe_one(spawn, context, environment))
            ]
            is_explained = any(found.code == DATABASE_MODEL.code for found in self.diagnostics)
            if not (prepared or is_explained or has_errors(self.diagnostics)):
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
                        entity=spawn.entity or model.entity,
                        text=spawn.description,
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
            distro=self._distro(environment),
        )
        self.diagnostics += diagnostics
        return replace(prepared, height=spawn.height) if prepared else None

    def _for_simulator(self, found: SdfFile) -> SdfFile:
        self.sdf_files |= found.files
        diagnostics = for_simulator(found.diagnostics, self.simulator_kind)
        return found._replace(diagnostics=tuple(diagnostics))

    def behavior_plan(self, prepared: Sequence[PreparedRobot]) -> BehaviorPlan | None:
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

        spawns = () if self.started is None else self.started.spawns
        return plan_behaviors(
            replace(self.settings, behaviors=behaviors),
            prepared,
            simulator=self.simulator_kind,
            assumed=[spawn.entity for spawn in spawns if spawn.is_assumed],
        )

    def _run_launch_file(
        self, behavior_plan: BehaviorPlan | None, prepared: Sequence[PreparedRobot]
    ) -> BehaviorPlan | None:
        """The plan with what was measured while the launch file ran, where it has to run."""
        launch_file = self.selected.launch_file
        if behavior_plan is None or not behavior_plan.to_run or launch_file is None:
            return behavior_plan
        if has_errors(self.diagnostics) or not all(robot.can_run for robot in prepared):
            return behavior_plan.leave_out(
                "The package has errors.", "Correct the errors; then wsgen runs its launch file."
            )
        if self.request.run_live is None:
            return behavior_plan.leave_out(
                "This command does not run nodes.",
                "Run `wsgen validate`, which runs them.",
                Severity.INFO,
            )
        try:
            live = self._measure_live(launch_file, behavior_plan.to_run, prepared)
        except WsgenError as error:  # nothing that is to be corrected in the package
            return behavior_plan.leave_out(error.message, error.hint)
        return replace(behavior_plan, live=live)

    def _nodes_may_spawn(self, started: Started) -> bool:
        """Whether a behavior runs the launch file, which starts Gazebo and names no robot."""
        settings = self.settings
        return (
            settings is not None
            and any(behavior.runs_launch_file for behavior in settings.behaviors)
            and self.request.run_live is not None
            and started.is_evaluated
            and started.simulator is not None
            and not started.has_spawner
        )

    def _run_for_robots(
        self, models: Sequence[PreparedRobot], folder: Path
    ) -> tuple[Live | None, list[PreparedRobot]]:
        """Run the launch file for its behaviors; gives what was measured, and who has come.

        Robots that nodes have spawned are read as those of launch files are.
        """
        launch_file, settings = self.selected.launch_file, self.settings
        if launch_file is None or settings is None or has_errors(self.diagnostics):
            return None, []
        from wsgen.checks.rules.behaviors import launch_not_run  # noqa: PLC0415  as below
        from wsgen.model.behavior import BehaviorRun  # noqa: PLC0415  as below

        to_run = [
            BehaviorRun(entity=behavior.robot or "", behavior=behavior)
            for behavior in settings.behaviors
            if behavior.runs_launch_file
        ]
        try:
            live = self._measure_live(launch_file, to_run, models)
        except WsgenError as error:
            for one in to_run:
                self.diagnostics += launch_not_run(
                    one.behavior, error.message, error.hint, settings.file, Severity.WARNING
                )
            return None, []
        measured = [one for of_engine in live.values() for one in of_engine.values()]
        spawns = {spawn.entity: spawn for one in reversed(measured) for spawn in one.spawned}
        robots = []
        for number, spawn in enumerate(spawns.values()):
            own = folder / f"spawned{number}"
            own.mkdir()
            robot, _ = self.prepare_later(spawn, own)
            robots += [robot] if robot is not None else []
        if not robots:
            from wsgen.pipeline.run_robots import of_all_engines  # noqa: PLC0415  as below

            self.diagnostics += of_all_engines(
                (engine, [*_check_runs(to_run, of_engine, settings.file)])
                for engine, of_engine in live.items()
            )
        return live, robots

    def _measure_live(
        self,
        launch_file: Path,
        to_run: Sequence[BehaviorRun],
        prepared: Sequence[PreparedRobot],
    ) -> Live:
        """Run the launch file for these behaviors, in each engine.

        Raises:
            WsgenError: It cannot be run on this machine.
        """
        assert self.request.run_live is not None  # noqa: S101  callers have looked
        from wsgen.pipeline.run_robots import engines_for  # noqa: PLC0415  as below

        self._require_programs()
        source = self.selected.source
        selected = SelectedLaunchFile(
            file=launch_file,
            package=self.package if self.selected.share else None,
            words=(),
            workspace=None if source is None else workspace_around(source),
            overlay=self.overlay,
        )
        live: dict[str, Mapping[str, LiveMeasurement]] = {}
        with self.clock.step("run", launch_file.name) as step:
            for engine in engines_for(prepared, self.request.engines):
                request = replace(self.request, engines=(engine,))
                try:
                    live[engine] = self.request.run_live(selected, request, to_run)
                except WsgenError:
                    step.succeeded = False
                    raise
            step.succeeded = not any(
                one.problem for measured in live.values() for one in measured.values()
            )
        return live

    def _require_programs(self) -> None:
        """Refuse to run nodes of packages that are not built.

        Raises:
            NotFoundError: One is started.
        """
        processes = () if self.started is None else self.started.plan.processes
        packages = {one.package for one in processes}
        names = sorted(name for name in self.overlay.sources if name in packages)
        if names:
            raise NotFoundError(
                f"The nodes of {', '.join(names)} cannot be started: it is not built."
                if len(names) == 1
                else f"The nodes of {', '.join(names)} cannot be started: they are not built.",
                hint="Run `wsgen build`; then wsgen runs the launch file.",
            )

    def _simulate(
        self, world: World, prepared: list[PreparedRobot], folder: Path, live: Live | None
    ) -> SimulationResult:
        # What simulates takes long to import, and `wsgen check` does not need it.
        from wsgen.pipeline.run_robots import simulate_robots  # noqa: PLC0415

        progress = folder / "progress" if self.request.video else None
        behavior_plan = self.behavior_plan(prepared)
        behavior_plan = (
            self._run_launch_file(behavior_plan, prepared)
            if live is None or behavior_plan is None
            else replace(behavior_plan, live=live)
        )
        with (
            self.clock.step("simulate", name_some(prepared, self.request.all_engines)) as step,
            self.clock.watch(DRAW, progress),
        ):
            simulated = simulate_robots(
                world,
                prepared,
                self.request,
                self.label,
                run=self.run_task,
                behavior_plan=behavior_plan,
                progress=progress,
                gazebo=self._gazebo(folder),
            )
            step.succeeded = all(robot.passed for robot in simulated.robots)
            simulated.report_drawing(step, self.request)
        self.diagnostics = simulated.diagnostics_after(self.diagnostics)
        self.clock.take(simulated.seconds or {})
        return simulated

    def _gazebo(self, folder: Path) -> RealGazebo | None:
        """The user's own Gazebo, for what the launch file spawns, if it is wanted."""
        if self.request.gazebo == "no" or self.started is None:
            return None
        from wsgen.pipeline.launched_simulator import environment_of_simulator  # noqa: PLC0415  as above
        from wsgen.pipeline.real_gazebo import RealGazebo  # noqa: PLC0415  it is seldom wanted

        simulator = self.started.simulator
        place = folder / "gazebo"
        place.mkdir()
        return RealGazebo(
            environment_of_simulator(self.started, self.overlay),
            place,
            self.run_task,
            kind=self.simulator_kind,
            world=self.world_file or (simulator.world if simulator else None),
            is_required=self.request.gazebo == "required",
        )


def _check_runs(
    to_run: Sequence[BehaviorRun], measured: Mapping[str, LiveMeasurement], file: Path
) -> Iterator[Diagnostic]:
    """Check the behaviors for which the launch file has run in one engine."""
    from wsgen.checks.rules.behaviors import check_live  # noqa: PLC0415  as above
    from wsgen.model.behavior import LaunchTask  # noqa: PLC0415  most packages have no behaviors

    for one in to_run:
        if isinstance(one.behavior.task, LaunchTask) and one.behavior.name in measured:
            yield from check_live(
                one.behavior, one.behavior.task, measured[one.behavior.name], file
            )


def may_come_later(found: Diagnostic) -> Diagnostic:
    """That no robot is spawned is no mistake while nodes run, which may spawn one."""
    if found.code != NO_ROBOT.code:
        return found
    hint = "No action is needed if a node spawns the robots at run time."
    return replace(found, severity=Severity.INFO, hint=hint)


def why_nothing_is_simulated(plan: LaunchPlan, found: Sequence[Diagnostic]) -> list[Diagnostic]:
    """The diagnostics with an error: each that says why a robot is missing, or one more."""
    reasons = (DATABASE_MODEL, UNKNOWN_DESCRIPTION, UNPUBLISHED_DESCRIPTION, UNKNOWN_WORLD)
    codes = {rule.code for rule in reasons}
    if codes.isdisjoint(one.code for one in found):
        missing = NO_ROBOT.at(
            plan.launch_file,
            message="No robot is simulated: all spawned models are static.",
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
