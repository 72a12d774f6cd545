"""One package on its way through the stages of `wsgen validate`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsgen.checks.allowances import unknown_rule_allowed, without_allowed
from wsgen.checks.judge import judge_robot, judge_trial
from wsgen.checks.spawn_rules import spawned_twice
from wsgen.description.lump import lump
from wsgen.description.meshes import find_meshes
from wsgen.description.reader import read_urdf
from wsgen.description.source import place_in_source
from wsgen.diagnostics import Diagnostic, Severity, has_errors
from wsgen.isolation.parent import Limits
from wsgen.launch.evaluate import evaluate
from wsgen.launch.spawning import find_simulator, find_spawns
from wsgen.model.outcome import PackageOutcome, Rest, RobotOutcome, Simulated
from wsgen.pipeline.clock import Clock
from wsgen.pipeline.sources import changed_since_build, name_sources
from wsgen.simulation.run import run_trial
from wsgen.simulation.scene import Scene, SpawnedRobot
from wsgen.workspace.settings import read_settings
from wsgen.world.lookup import find_world
from wsgen.world.reader import DEFAULT_WORLD, read_world

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.events import Listener
    from wsgen.model.plan import LaunchPlan, Spawn
    from wsgen.model.robot import Robot
    from wsgen.model.world import World
    from wsgen.pipeline.request import ValidateRequest
    from wsgen.pipeline.selection import Chosen
    from wsgen.simulation.scene import RobotTrial, TrialOutcome
    from wsgen.workspace.overlay import Overlay


@dataclass(frozen=True, kw_only=True)
class _Described:
    """A robot of the plan, as written and as Gazebo has it."""

    spawn: Spawn
    written: Robot
    lumped: Robot
    is_sound: bool  # if not, the engine would try another robot than the described one


class Validation:
    """Evaluates, reads, simulates and judges; collects what is found on the way."""

    def __init__(
        self,
        chosen: Chosen,
        overlay: Overlay,
        request: ValidateRequest,
        listener: Listener | None,
    ) -> None:
        self.chosen = chosen
        self.package = chosen.name
        self.overlay = overlay
        self.request = request
        self.clock = Clock(chosen.name, listener)
        self.diagnostics: list[Diagnostic] = []

    def run(self) -> PackageOutcome:
        """All stages, as far as they go."""
        launch_file = self.chosen.launch_file
        if self.chosen.problem is not None:
            self.diagnostics.append(self.chosen.problem)
        plan = self._evaluate(launch_file) if launch_file else None
        world = self._read_world(plan) if plan else None
        described = self._describe(plan) if plan and world else []
        outcomes, trial = self._try(world, described) if world and described else ((), None)
        return PackageOutcome(
            package=self.package,
            share=self.chosen.share,
            launch_file=launch_file,
            world=world,
            robots=outcomes,
            diagnostics=self._told(),
            picture=trial.picture if trial else None,
            picture_tile=trial.picture_tile if trial else None,
            seconds=self.clock.read(),
        )

    def _told(self) -> tuple[Diagnostic, ...]:
        """The findings as the package's source has them, without what it has on purpose."""
        source, share = self.chosen.source, self.chosen.share
        if source is None or share is None:
            return tuple(self.diagnostics)
        settings, wrong = read_settings(source)
        told = (
            *changed_since_build(share, source),
            *name_sources(self.diagnostics, share, source),
            *wrong,
            *unknown_rule_allowed(settings.allow, settings.file),
        )
        return without_allowed(told, settings.allow)

    def _evaluate(self, launch_file: Path) -> LaunchPlan | None:
        with self.clock.step("launch", launch_file.name) as step:
            plan = evaluate(
                launch_file,
                package=self.package,
                arguments=self.request.launch_arguments,
                environment=self.overlay.environment,
            )
            step.succeeded = not has_errors(plan.diagnostics)
        self.clock.split("launch", "expand", plan.seconds_in_xacro)
        self.diagnostics += plan.diagnostics
        return None if has_errors(plan.diagnostics) else plan

    def _read_world(self, plan: LaunchPlan) -> World | None:
        simulator, diagnostics = find_simulator(plan)
        self.diagnostics += diagnostics
        if simulator is None or not simulator.world:
            return DEFAULT_WORLD
        file = find_world(simulator.world, self.overlay.environment)
        if file is None:
            self.diagnostics.append(
                Diagnostic(
                    code="WLD008",
                    severity=Severity.WARNING,
                    message=f"No file is called {simulator.world}. If it is one of Gazebo's own "
                    "worlds, Gazebo finds it; the trial takes a ground plane instead.",
                    file=plan.launch_file,
                    hint="Give the path of a world file that the package installs.",
                )
            )
            return DEFAULT_WORLD
        world, diagnostics = read_world(file)
        self.diagnostics += diagnostics
        return world

    def _describe(self, plan: LaunchPlan) -> list[_Described]:
        with self.clock.step("expand", "robot description") as step:
            spawns, diagnostics = find_spawns(plan)
            self.diagnostics += (
                *diagnostics,
                *spawned_twice([spawn.entity for spawn in spawns]),
            )
            # Of two with one name the simulator refuses the second.
            unique = {spawn.entity: spawn for spawn in reversed(spawns)}
            described = [
                robot for spawn in reversed(unique.values()) if (robot := self._describe_one(spawn))
            ]
            step.succeeded = len(described) == len(spawns) and all(
                robot.is_sound for robot in described
            )
        return described

    def _describe_one(self, spawn: Spawn) -> _Described | None:
        file = spawn.description_file
        written, wrong = read_urdf(spawn.description, file=file)
        if written is None or has_errors(wrong):
            self._report_in_source(spawn, wrong)
            return None
        located, missing = find_meshes(
            written,
            share_of=self.overlay.share,
            folder=file.parent if file else None,
            file=file,
        )
        lumped, dropped = lump(located, file=file)
        diagnostics = (*wrong, *missing, *dropped, *judge_robot(written, file))
        self._report_in_source(spawn, diagnostics)
        return _Described(
            spawn=spawn, written=written, lumped=lumped, is_sound=not has_errors(diagnostics)
        )

    def _report_in_source(self, spawn: Spawn, diagnostics: tuple[Diagnostic, ...]) -> None:
        self.diagnostics += place_in_source(
            diagnostics,
            text=spawn.description,
            file=spawn.description_file,
            share_of=self.overlay.share,
        )

    def _try(
        self, world: World, described: list[_Described]
    ) -> tuple[tuple[RobotOutcome, ...], TrialOutcome | None]:
        """Simulate the sound robots, if there are any, and judge all."""
        sound = [robot for robot in described if robot.is_sound]
        if not sound:
            return tuple(self._judge(world, robot, None) for robot in described), None
        # Large robots are slower than their own time; this is about hanging, not about slow.
        limits = Limits(seconds=60.0 + 20.0 * self.request.seconds)
        with self.clock.step("simulate", ", ".join(robot.spawn.entity for robot in sound)) as step:
            trial = run_trial(self._make_scene(world, sound), limits=limits)
            measured = {found.entity: found for found in trial.trials}
            outcomes = tuple(
                self._judge(world, robot, measured.get(robot.spawn.entity)) for robot in described
            )
            step.succeeded = all(outcome.passed for outcome in outcomes)
        self.diagnostics += trial.diagnostics
        self.clock.take(trial.seconds)
        return outcomes, trial

    def _make_scene(self, world: World, described: list[_Described]) -> Scene:
        folder = self.request.picture_folder
        return Scene(
            world=world,
            robots=tuple(
                SpawnedRobot(
                    entity=robot.spawn.entity,
                    robot=robot.lumped,
                    pose_in_world=robot.spawn.pose_in_world,
                )
                for robot in described
            ),
            seconds=self.request.seconds,
            picture=folder.absolute() / f"{self.package}.png" if folder else None,
        )

    def _judge(self, world: World, described: _Described, trial: RobotTrial | None) -> RobotOutcome:
        spawn, written = described.spawn, described.written
        diagnostics = (
            judge_trial(described.lumped, spawn.pose_in_world, world, trial) if trial else ()
        )
        self.diagnostics += diagnostics
        return RobotOutcome(
            entity=spawn.entity,
            spawn_pose=spawn.pose_in_world,
            links=len(written.links),
            joints=len(written.joints),
            movable_joints=len(written.movable_joints),
            mass=written.mass,
            simulated=None
            if trial is None
            else Simulated(links=trial.links, movable_joints=trial.movable_joints, mass=trial.mass),
            rest=None
            if trial is None
            else Rest(
                pose_in_world=trial.rest_pose,
                settled_after=trial.settled_after,
                speed=trial.speed,
            ),
            passed=trial is not None and not has_errors(diagnostics),
        )
