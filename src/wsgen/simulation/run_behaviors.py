"""Runs the behaviors of a robot, and measures; `wsgen.checks.rules` checks.

A robot is driven by its diff drive plugin or by ros2_control, as in Gazebo (`controllers`).
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.simulation.controllers import UPDATE, controller_for
from wsgen.simulation.sampling import Odometer
from wsgen.simulation.scene import RUNNING, BehaviorMeasurement
from wsgen.simulation.simulate import REST_HELD, brake, is_finite, is_moving

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from wsgen.model.behavior import BehaviorRun
    from wsgen.model.transform import Pose
    from wsgen.simulation.controllers import Controller
    from wsgen.simulation.engine import Engine, State
    from wsgen.simulation.scene import RobotRun, Scene
    from wsgen.simulation.simulate import Observer


def run_behaviors(  # noqa: PLR0913  as `run_scene`, and its outcome
    engine: Engine,
    scene: Scene,
    robot_runs: Sequence[RobotRun],
    announce: Callable[[str], None],
    *,
    observe: Observer | None = None,
    begun: Callable[[str, float], None] = lambda _name, _seconds: None,
) -> list[RobotRun]:
    """Run the scene's behaviors one after the other; gives the runs with what was measured.

    For each all robots are put to where they were spawned, and come to rest first. The arguments
    are those of `run_scene`, which was before; simulated time goes on. `begun` is called with the
    name of a behavior and the simulated time when the robot is at rest and begins it; `observe`
    sees what it does from then on.
    """
    spawned = {robot_run.entity: robot_run.spawn_pose for robot_run in robot_runs}
    runs = _Runs(engine, scene, spawned, observe, begun)
    measured: dict[str, list[BehaviorMeasurement]] = {entity: [] for entity in spawned}
    for behavior_run in scene.behavior_runs:
        if behavior_run.entity in spawned:
            announce(RUNNING.format(entity=behavior_run.entity, name=behavior_run.behavior.name))
            measured[behavior_run.entity].append(runs.run(behavior_run))
    return [
        replace(robot_run, behaviors=tuple(measured[robot_run.entity])) for robot_run in robot_runs
    ]


class _Runs:
    """The scene after the robots have stood."""

    def __init__(
        self,
        engine: Engine,
        scene: Scene,
        spawned: Mapping[str, Pose],
        observe: Observer | None,
        begun: Callable[[str, float], None],
    ) -> None:
        self.engine = engine
        self.scene = scene
        self.observe = observe
        self.begun = begun
        self.spawned_robots = {robot.entity: robot for robot in scene.robots}
        self.robots = {robot.entity: robot.robot for robot in scene.robots}
        self.spawned = spawned
        self.steps = max(1, round(UPDATE / engine.step_seconds))  # in an update
        self.seconds = scene.seconds  # simulated until now

    def run(self, behavior_run: BehaviorRun) -> BehaviorMeasurement:
        """Run one behavior."""
        self._reset()
        behavior = behavior_run.behavior
        controller = controller_for(behavior_run, self.robots[behavior_run.entity])
        self._settle(behavior_run.entity, controller)
        odometer = Odometer(self.engine.state(behavior_run.entity))
        controller.has_begun = True
        self.begun(behavior.name, self.seconds)
        self._show()
        for _ in range(self._updates(behavior.seconds)):
            odometer.go(self._update(behavior_run.entity, controller))
            if not odometer.is_finite:
                break
        positions = self.engine.joint_positions(behavior_run.entity)
        self.engine.release(behavior_run.entity)
        brake(self.engine, self.spawned_robots[behavior_run.entity])
        numbers_are_finite = all(map(math.isfinite, positions.values()))
        return BehaviorMeasurement(
            behavior.name, odometer.moved, positions, odometer.is_finite and numbers_are_finite
        )

    def _reset(self) -> None:
        for entity, pose in self.spawned.items():
            if not self.robots[entity].is_static:
                self.engine.place(entity, pose)

    def _settle(self, entity: str, controller: Controller) -> None:
        """Until the robot is at rest, and no longer than it had to stand."""
        held, needed = 0, self._updates(REST_HELD)
        for _ in range(self._updates(self.scene.seconds)):
            state = self._update(entity, controller)
            held = 0 if is_moving(state) else held + 1
            if held >= needed or not is_finite(state):
                break

    def _updates(self, seconds: float) -> int:
        return round(seconds / (self.steps * self.engine.step_seconds))

    def _update(self, entity: str, controller: Controller) -> State:
        """Let the controller set the motors, and time pass to its next update."""
        motors = controller.motors(self.engine.joint_positions(entity))
        self.engine.drive(entity, motors)
        self.engine.advance(self.steps)
        self.seconds += self.steps * self.engine.step_seconds
        if controller.has_begun:
            self._show()
        return self.engine.state(entity)

    def _show(self) -> None:
        if self.observe is not None:
            self.observe(self.seconds, list(self.spawned))
