"""Controllers of robots: what Gazebo's diff drive plugin and ros2_control command.

A controller says once every `UPDATE` which motors the joints have until the next time.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Protocol

from wsgen.model.behavior import Drive, LaunchTask
from wsgen.model.robot import JointType
from wsgen.simulation.engine import Motor

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.model.behavior import BehaviorRun, DiffDrive, Reach
    from wsgen.model.robot import Joint, Robot


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
    assert not isinstance(task, LaunchTask)  # noqa: S101  the launch file runs for it, in no scene
    if isinstance(task, Drive):
        assert behavior_run.drive is not None  # noqa: S101  else it is not run
        return DiffDriveController(behavior_run.drive, task, robot)
    return PositionController(task, robot)


class DiffDriveController:
    """A diff drive plugin: turns wheels; all other joints stay passive."""

    def __init__(self, drive: DiffDrive, task: Drive, robot: Robot) -> None:
        self.has_begun = False
        self.task = task  # may be replaced: the plugin goes on from the speeds that it has reached
        self._drive = drive
        self._joints = {joint.name: joint for joint in robot.movable_joints}
        self._let = self._before = (0.0, 0.0)  # m/s, rad/s: what the plugin lets through
        self._rims = dict.fromkeys(
            (name for pair in drive.pairs for name in (pair.left, pair.right)), 0.0
        )  # m/s

    def motors(self, positions: Mapping[str, float]) -> dict[str, Motor]:  # noqa: ARG002  it controls speeds
        """The wheels at the speeds that the plugin has reached."""
        commanded = (self.task.linear, self.task.angular) if self.has_begun else (0.0, 0.0)
        drive = self._drive
        linear, angular = (
            bounds.next(speed, wanted, UPDATE, before)
            for bounds, speed, wanted, before in zip(
                (drive.linear, drive.angular), self._let, commanded, self._before, strict=True
            )
        )
        self._before, self._let = self._let, (linear, angular)
        motors = {}
        for pair in drive.pairs:
            rims = pair.speeds(linear, angular)
            for name, wanted in zip((pair.left, pair.right), rims, strict=True):
                self._rims[name] = drive.rim.next(self._rims[name], wanted, UPDATE)
                motors[name] = self._motor(name, self._rims[name] / pair.radius)
        return motors

    def _motor(self, name: str, speed: float) -> Motor:
        joint = self._joints[name]
        if self._drive.torque is not None:
            return ode_motor(joint, speed, self._drive.torque)
        return limited_motor(joint, speed)


class PositionController:
    """Position commands: joints go to positions and hold them, at their limits of speed and effort.

    Joints that are not named hold 0 if they have limits, or what is nearest to 0 within them;
    wheels, casters and other joints without an end stay passive. Joints that mimic one that moves
    follow it.
    """

    def __init__(self, task: Reach, robot: Robot) -> None:
        self.has_begun = False
        self.commands = task.positions  # rad or m, by joint
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
            target = self.commands.get(joint.name) if self.has_begun else None
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
    return limited_motor(joint, GAIN * (target - positions[joint.name]))


def ode_motor(joint: Joint, speed: float, torque: float) -> Motor:
    """The motor of a joint whose `vel` and `fmax` a plugin of Gazebo Classic sets.

    The limits of the joint do not count. ODE has one `fmax` in a joint, which was its friction
    before: engines here have both.
    """
    return Motor(speed, torque + joint.friction)


def limited_motor(joint: Joint, speed: float) -> Motor:
    """A motor that keeps to the joint's limits; below 0 they are none."""
    fastest, effort = bounds_of(joint)
    return Motor(min(fastest, max(-fastest, speed)), effort)


def bounds_of(joint: Joint) -> tuple[float, float]:
    """The fastest that a motor turns or slides a joint, and its greatest effort; may be infinite.

    rad/s or m/s; N m or N.
    """
    limit = joint.limit
    if limit is None:
        return math.inf, math.inf
    return (
        math.inf if limit.velocity < 0 else limit.velocity,
        math.inf if limit.effort < 0 else limit.effort,
    )


def effort_in_classic(joint: Joint, effort: float, speed: float) -> float:
    """What Gazebo Classic applies of an effort (N m or N) at that speed (rad/s or m/s).

    It takes that to the joint's limit, and drops one that makes a joint faster which is beyond its
    limit of velocity. Source: gazebo, gazebo/physics/Joint.cc, `CheckAndTruncateForce`.
    """
    fastest, most = bounds_of(joint)
    if abs(speed) > fastest and effort * speed > 0:
        return 0.0
    return min(most, max(-most, effort))
