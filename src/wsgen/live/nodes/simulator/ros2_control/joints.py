"""What Gazebo's plugins for ros2_control do to the joints of a robot.

Source: ros-controls/gazebo_ros2_control, gazebo_ros2_control/src/gazebo_system.cpp (`write`), and
ros-controls/gz_ros2_control, gz_ros2_control/src/gz_system.cpp (`write`):

| interface | Gazebo Classic | Gazebo Sim |
|---|---|---|
| position | the joint is put there | `position_proportional_gain` × update rate × error as speed |
| velocity | it has that speed | it has that speed |
| effort | it acts on the joint | likewise |
| position and velocity, with `pos_kp`, `vel_kp` … | the effort of a PID controller | - |
| none, of joints with a command interface | held (`<hold_joints>`) | held |
| mimic | put where the other joint says | the speed that gets it there by the next update |

Gazebo Sim keeps to the joints' limits of speed and effort, Gazebo Classic does not.
Gazebo Classic puts a joint anew in each step. Here a motor without limits has it there at the next
update, with the speed that it has in between; only where it would have to be faster than
`FASTEST`, it is put there.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple, Protocol

from wsgen.live.nodes.simulator.ros2_control.hardware import EFFORT, POSITION, VELOCITY, Pid
from wsgen.model.robot import JointType
from wsgen.simulation.controllers import HELD, bounds_of, effort_in_classic
from wsgen.simulation.engine import Motor

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from wsgen.live.nodes.simulator.ros2_control.hardware import (
        Component,
        ControlledJoint,
        Interfaces,
    )
    from wsgen.model.robot import Joint, Robot

THERE = 1e-9  # rad or m: no nearer is needed
FASTEST = 50.0  # rad/s or m/s; no motor of a robot turns its joint as fast


class Body(Protocol):
    """What is asked of the simulator's handle of a robot."""

    robot: Robot

    def joint_positions(self) -> Mapping[str, float]:
        """By name, rad or m."""

    def joint_velocities(self) -> Mapping[str, float]:
        """By name, rad/s or m/s."""

    def joint_efforts(self) -> Mapping[str, float]:
        """By name, N m or N."""

    def drive(self, motors: Mapping[str, Motor]) -> None:
        """Put motors into joints."""

    def set_efforts(self, efforts: Mapping[str, float]) -> None:
        """Have efforts act in joints, which lose their motors, until they get others."""

    def set_joint_positions(self, positions: Mapping[str, float]) -> None:
        """Put joints there, at rest."""


class Settings(NamedTuple):
    """What the <plugin> says."""

    simulator: str  # "classic" or "gz"
    rate: float  # Hz, of updates
    hold: bool = True  # joints that nobody commands
    gain: float = 0.1  # of Gazebo Sim: the share of an error that is gone after an update


class JointSystem:
    """The joints of a robot, as hardware of ros2_control."""

    def __init__(
        self,
        body: Body,
        components: Iterable[Component],
        interfaces: Interfaces,
        settings: Settings,
    ) -> None:
        self._body = body
        self._settings = settings
        self._interfaces = interfaces
        self._joints: dict[str, ControlledJoint] = {
            joint.name: joint
            for component in components
            if component.is_simulated
            for joint in component.joints
        }
        self._model: dict[str, Joint] = {joint.name: joint for joint in body.robot.joints}
        self._modes: dict[str, set[str]] = {name: set() for name in self._joints}
        self._mode_of: dict[str, str | None] = dict.fromkeys(self._joints)  # the one that counts
        self._bounds = {
            name: (math.inf, math.inf)
            if settings.simulator == "classic"
            else bounds_of(self._model[name])
            for name in self._joints
        }
        self._ends = {
            name: (joint.limit.lower, joint.limit.upper)
            if joint.limit is not None and joint.type in HELD
            else (-math.inf, math.inf)
            for name, joint in self._model.items()
        }
        self._now: dict[str, tuple[str, Motor | None]] = {}  # the last of each joint
        self._pids = {
            (name, kind): Pid(gains)
            for name, joint in self._joints.items()
            for kind, gains in (
                (POSITION, joint.position_gains),
                (VELOCITY, joint.velocity_gains),
            )
            if gains is not None and settings.simulator == "classic"
        }
        states = interfaces.states
        self._reads = [
            (name, kind, f"{name}/{kind}")
            for name in self._joints
            for kind in (POSITION, VELOCITY)
            if f"{name}/{kind}" in states
        ]
        self._read_efforts = [
            (name, f"{name}/{EFFORT}") for name in self._joints if f"{name}/{EFFORT}" in states
        ]
        self._efforts: dict[str, float] = {}  # that act now

    def begin(self) -> None:
        """Put the joints where their hardware says that they begin."""
        positions = {
            name: joint.initial[POSITION]
            for name, joint in self._joints.items()
            if POSITION in joint.initial
        }
        at = {**self._body.joint_positions(), **positions}
        for name, joint in self._joints.items():
            follows = joint.follows
            if follows is not None and follows.joint in at:
                positions[name] = at[follows.joint] * follows.multiplier + follows.offset
        moved = {
            name: value
            for name, value in positions.items()
            if abs(value - self._body.joint_positions()[name]) > THERE
        }
        if moved:
            self._body.set_joint_positions(moved)
        self.read()
        self.write(1.0 / self._settings.rate)

    def switch(self, start: Iterable[str], stop: Iterable[str]) -> None:
        """Change which interfaces of the joints are commanded."""
        for names, change in ((stop, set.discard), (start, set.add)):
            for name in names:
                joint, _, kind = name.rpartition("/")
                if joint in self._modes:
                    change(self._modes[joint], kind)
        self._mode_of = {name: self._mode(joint) for name, joint in self._joints.items()}
        for key, pid in self._pids.items():
            if key[1] not in self._modes[key[0]]:
                pid.reset()

    def read(self) -> None:
        """Take the state of the joints from the simulator."""
        states = self._interfaces.states
        values = {
            POSITION: self._body.joint_positions(),
            VELOCITY: self._body.joint_velocities(),
        }
        for name, kind, full in self._reads:
            states[full] = values[kind][name]
        if self._read_efforts:
            efforts = self._body.joint_efforts()
            for name, full in self._read_efforts:
                states[full] = efforts.get(name, 0.0)

    def write(self, seconds: float) -> None:
        """Give the commands to the simulator, for that time until the next update."""
        positions = self._body.joint_positions()
        demands = {
            name: self._demand(joint, positions, seconds) for name, joint in self._joints.items()
        }
        motors = {
            name: motor
            for name, (_, motor) in demands.items()
            if motor is not None and self._now.get(name) != demands[name]
        }
        put = {name: self._target(name) for name, (kind, _) in demands.items() if kind == "put"}
        if put:
            self._body.set_joint_positions(put)
            motors.update({name: Motor(0.0, math.inf) for name in put})
        if motors:
            self._body.drive(motors)
        efforts = {
            name: self._effort(name, kind, positions, seconds)
            for name, (kind, motor) in demands.items()
            if motor is None and kind != "put"
        }
        if efforts and efforts != self._efforts:
            self._body.set_efforts(efforts)
        self._efforts = efforts
        self._now = demands

    def _target(self, name: str) -> float:
        """The position that a joint is commanded to, within its ends."""
        follows = self._joints[name].follows
        if follows is not None:
            at = self._body.joint_positions().get(follows.joint, 0.0)
            target = at * follows.multiplier + follows.offset
        else:
            target = self._interfaces.commands[f"{name}/{POSITION}"]
        lower, upper = self._ends[name]
        return min(upper, max(lower, target))

    def _demand(
        self, joint: ControlledJoint, positions: Mapping[str, float], seconds: float
    ) -> tuple[str, Motor | None]:
        """What a joint has until the next update: a motor, or an effort that comes later."""
        if joint.follows is not None and joint.follows.joint in positions:
            return self._position(joint, positions, seconds, share=1.0)
        mode = self._mode_of[joint.name]
        if mode == POSITION:
            share = 1.0 if self._settings.simulator == "classic" else self._settings.gain
            return self._position(joint, positions, seconds, share=share)
        if mode == VELOCITY:
            return mode, self._motor(joint.name, self._command(joint.name, VELOCITY))
        if mode is not None:
            return mode, None
        if joint.commands and self._settings.hold:
            return "held", self._motor(joint.name, 0.0)
        return "free", None

    def _mode(self, joint: ControlledJoint) -> str | None:
        """Which of the interfaces counts that are commanded; None without one."""
        modes = self._modes[joint.name]
        if self._settings.simulator != "classic":
            return next((kind for kind in (VELOCITY, POSITION, EFFORT) if kind in modes), None)
        plain = [
            kind
            for kind in (POSITION, VELOCITY, EFFORT)
            if kind in modes and (joint.name, kind) not in self._pids
        ]
        by_pid = [f"pid_{kind}" for kind in (VELOCITY, POSITION) if kind in modes]
        return next(iter((*plain, *by_pid)), None)

    def _position(
        self,
        joint: ControlledJoint,
        positions: Mapping[str, float],
        seconds: float,
        *,
        share: float,
    ) -> tuple[str, Motor | None]:
        target = self._target(joint.name)
        if not math.isfinite(target):
            return "held", self._motor(joint.name, 0.0)
        speed = share * (target - positions[joint.name]) / seconds
        if self._settings.simulator == "classic" and abs(speed) > FASTEST:
            return "put", None
        return "position", self._motor(joint.name, speed)

    def _motor(self, name: str, speed: float) -> Motor:
        fastest, effort = self._bounds[name]
        return Motor(min(fastest, max(-fastest, speed)), effort)

    def _command(self, name: str, kind: str) -> float:
        value = self._interfaces.commands[f"{name}/{kind}"]
        return value if math.isfinite(value) else 0.0

    def _effort(
        self, name: str, kind: str, positions: Mapping[str, float], seconds: float
    ) -> float:
        if kind == "free":
            return 0.0
        if kind == EFFORT:
            effort = self._command(name, EFFORT)
        elif kind == "pid_position":
            error = self._target(name) - positions[name]
            effort = self._pids[name, POSITION].command(error, seconds)
        else:
            error = self._command(name, VELOCITY) - self._body.joint_velocities()[name]
            effort = self._pids[name, VELOCITY].command(error, seconds)
        if self._settings.simulator == "classic":
            speed = self._body.joint_velocities()[name]
            return effort_in_classic(self._model[name], effort, speed)
        limit = self._model[name].limit
        if limit is not None and limit.effort > 0 and self._model[name].type is not JointType.BALL:
            effort = min(limit.effort, max(-limit.effort, effort))
        return effort
