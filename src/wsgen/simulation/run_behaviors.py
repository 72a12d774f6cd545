"""Runs the behaviors of a robot, and measures; `wsgen.rules` checks.

A robot is driven by its diff drive plugin or by ros2_control, as in Gazebo: a controller says once
every `UPDATE` which motors the joints have until the next time.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Protocol

from wsgen.model.behavior import Drive
from wsgen.model.robot import JointType
from wsgen.model.transform import rotation_of_quaternion
from wsgen.simulation.engine import Motor
from wsgen.simulation.scene import RUNNING, BehaviorMeasurement
from wsgen.simulation.simulate import REST_HELD, is_finite, is_moving

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from wsgen.model.behavior import BehaviorRun, DiffDrive, Reach
    from wsgen.model.robot import Joint, Robot
    from wsgen.model.transform import Pose
    from wsgen.simulation.engine import Engine, State
    from wsgen.simulation.scene import RobotRun, Scene
    from wsgen.simulation.simulate import Observer


UPDATE = 0.01  # s; the usual rate of plugin and controllers is 100 Hz
# gz_ros2_control's position interface: a speed of 0.1 (`position_proportional_gain`) of the error
# for each of its updates.
GAIN = 0.1 / UPDATE  # 1/s
HELD = (JointType.REVOLUTE, JointType.PRISMATIC)


class Controller(Protocol):
    """What gives the commands of a behavior."""

    has_begun: bool  # before, it keeps the robot as it was spawned

    def motors(self, positions: Mapping[str, float]) -> dict[str, Motor]:
        """The motors from now to the next update; `positions` are those of the joints now."""


def controller_for(behavior_run: BehaviorRun, robot: Robot) -> Controller:
    """The controller for a behavior."""
    task = behavior_run.behavior.task
    if isinstance(task, Drive):
        assert behavior_run.drive is not None  # noqa: S101  else it is not run
        return DiffDriveController(behavior_run.drive, task, robot)
    return PositionController(task, robot)


class DiffDriveController:
    """A diff drive plugin: turns wheels; all other joints stay passive."""

    def __init__(self, drive: DiffDrive, task: Drive, robot: Robot) -> None:
        self.has_begun = False
        self._drive = drive
        self._task = task
        self._joints = {joint.name: joint for joint in robot.movable_joints}
        self._linear = self._angular = 0.0  # m/s, rad/s: what the plugin lets through
        self._rims = dict.fromkeys(
            (name for pair in drive.pairs for name in (pair.left, pair.right)), 0.0
        )  # m/s

    def motors(self, positions: Mapping[str, float]) -> dict[str, Motor]:  # noqa: ARG002  it controls speeds
        """The wheels at the speeds that the plugin has reached."""
        linear, angular = (self._task.linear, self._task.angular) if self.has_begun else (0.0, 0.0)
        drive = self._drive
        self._linear = drive.linear.next(self._linear, linear, UPDATE)
        self._angular = drive.angular.next(self._angular, angular, UPDATE)
        motors = {}
        for pair in drive.pairs:
            rims = pair.speeds(self._linear, self._angular)
            for name, wanted in zip((pair.left, pair.right), rims, strict=True):
                self._rims[name] = drive.rim.next(self._rims[name], wanted, UPDATE)
                motors[name] = self._motor(name, self._rims[name] / pair.radius)
        return motors

    def _motor(self, name: str, speed: float) -> Motor:
        """Gazebo Classic has no limits for a joint that has a motor, Gazebo Sim those of the joint.

        The one sets ODE's `vel` and `fmax`, the other the command of a DART servo.
        """
        if self._drive.torque is not None:
            return Motor(speed, self._drive.torque)
        return _limited(self._joints[name], speed)


class PositionController:
    """Position commands: joints go to positions and hold them, at their limits of speed and effort.

    Joints that are not named hold 0 if they have limits, or what is nearest to 0 within them;
    wheels, casters and other joints without an end stay passive. Joints that mimic one that moves
    follow it.
    """

    def __init__(self, task: Reach, robot: Robot) -> None:
        self.has_begun = False
        self._positions = task.positions
        moves = {
            joint.name: joint
            for joint in robot.movable_joints
            if joint.mimic is None and (joint.type in HELD or joint.name in task.positions)
        }
        self._joints = tuple(moves.values())
        self._followers = tuple(
            joint
            for joint in robot.movable_joints
            if joint.mimic is not None and joint.mimic.joint in moves
        )

    def motors(self, positions: Mapping[str, float]) -> dict[str, Motor]:
        """Towards the commands, the faster the farther."""
        motors = {}
        for joint in self._joints:
            target = self._positions.get(joint.name) if self.has_begun else None
            motors[joint.name] = _towards(joint, positions, _rest(joint, target))
        for joint in self._followers:
            mimic = joint.mimic
            if mimic is not None:
                target = mimic.multiplier * positions[mimic.joint] + mimic.offset
                motors[joint.name] = _towards(joint, positions, target)
        return motors


def _rest(joint: Joint, target: float | None) -> float:
    if target is not None:
        return target
    limit = joint.limit if joint.type in HELD else None
    return 0.0 if limit is None else min(limit.upper, max(limit.lower, 0.0))


def _towards(joint: Joint, positions: Mapping[str, float], target: float) -> Motor:
    return _limited(joint, GAIN * (target - positions[joint.name]))


def _limited(joint: Joint, speed: float) -> Motor:
    """A motor that keeps to the joint's limits; below 0 they are none."""
    limit = joint.limit
    fastest, effort = (
        math.inf if bound is None or bound < 0 else bound
        for bound in ((limit.velocity, limit.effort) if limit is not None else (None, None))
    )
    return Motor(min(fastest, max(-fastest, speed)), effort)


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
    session = _Session(engine, scene, spawned, observe, begun)
    measured: dict[str, list[BehaviorMeasurement]] = {entity: [] for entity in spawned}
    for behavior_run in scene.behavior_runs:
        if behavior_run.entity in spawned:
            announce(RUNNING.format(entity=behavior_run.entity, name=behavior_run.behavior.name))
            measured[behavior_run.entity].append(session.run(behavior_run))
    return [
        replace(robot_run, behaviors=tuple(measured[robot_run.entity])) for robot_run in robot_runs
    ]


class _Session:
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
        odometer = _Odometer(self.engine.state(behavior_run.entity))
        controller.has_begun = True
        self.begun(behavior.name, self.seconds)
        self._show()
        for _ in range(self._updates(behavior.seconds)):
            odometer.go(self._update(behavior_run.entity, controller))
            if not odometer.is_finite:
                break
        positions = self.engine.joint_positions(behavior_run.entity)
        self.engine.release(behavior_run.entity)
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


class _Odometer:
    """How far a robot has come since it began."""

    def __init__(self, start: State) -> None:
        self.is_finite = is_finite(start)
        self._xyz = start.xyz
        self._heading = self._last = _heading(start) if self.is_finite else 0.0
        self.moved = (0.0, 0.0, 0.0)  # m, m, rad

    def go(self, state: State) -> None:
        """Take in where it is an update later."""
        self.is_finite = self.is_finite and is_finite(state)
        if not self.is_finite:
            return
        heading = _heading(state)
        turned = self.moved[2] + math.remainder(heading - self._last, math.tau)
        self._last = heading
        east, north = state.xyz[0] - self._xyz[0], state.xyz[1] - self._xyz[1]
        sin, cos = math.sin(self._heading), math.cos(self._heading)
        self.moved = (cos * east + sin * north, cos * north - sin * east, turned)


def _heading(state: State) -> float:
    """Of the root link's x axis on the ground, rad."""
    rotation = rotation_of_quaternion(state.xyzw)
    return math.atan2(rotation[1][0], rotation[0][0])
