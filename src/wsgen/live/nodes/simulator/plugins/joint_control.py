"""Plugins that move single joints by messages.

Sources: gazebosim/gz-sim, src/systems/joint_position_controller, joint_controller,
joint_traj_control and apply_joint_force; ros-simulation/gazebo_ros_pkgs,
gazebo_plugins/src/gazebo_ros_joint_pose_trajectory.cpp (branch ros2).

PID controllers are updated in each step, as in Gazebo.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Literal

from std_msgs.msg import Float32, Float64
from trajectory_msgs.msg import JointTrajectory

from wsgen.live.nodes.simulator.elements import boolean, default_of, number, numbers, topics_of
from wsgen.live.nodes.simulator.host import CannotWorkError, Plugin
from wsgen.live.nodes.simulator.plugins.joint_commands import (
    Gains,
    GzPid,
    actuator_number,
    listen_to_actuator,
)
from wsgen.simulation.controllers import limited_motor

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.devices import Element

WORLD = ("world", "map")  # what a trajectory of joints may be seen from, besides a link


class _GzJoints(Plugin):
    """What a plugin does to the joints that it names."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        self._host, self._robot = host, robot
        self._joints = _named_joints(host, robot, element)
        if not self._joints:
            raise CannotWorkError("it does not name a joint of the robot. Write <joint_name>.")
        self._models = {joint.name: joint for joint in robot.robot.movable_joints}
        self._target = 0.0

    def _listen(self, element: Element, values: Literal["position", "velocity"]) -> None:
        self._pid = GzPid(_gains(element))
        host, robot = self._host, self._robot
        element, actuator = actuator_number(host, robot, element)
        topics = topics_of(host, robot, element)
        if actuator is not None:
            listen_to_actuator(host, robot, topics["actuators"], (values, actuator), self._take)
        else:
            self._listen_to(topics["command"])

    def _listen_to(self, topic: str) -> None:
        self._host.subscription(
            self._robot, Float64, topic, lambda message: self._take(message.data)
        )

    def _take(self, wanted: float) -> None:
        if math.isfinite(wanted):
            self._target = wanted
        else:
            self._host.warn(
                f"`{self._robot.entity}`: a command for the joint `{self._joints[0]}` is "
                f"{wanted}, which no joint can have."
            )

    def _drive(self, speed: float) -> None:
        self._robot.drive({name: limited_motor(self._models[name], speed) for name in self._joints})

    def _push(self, error: float) -> None:
        # As in Gazebo: one controller, updated once for each joint.
        self._robot.set_efforts(
            {
                name: _within(self._models[name], self._pid.command(error, self._host.step_seconds))
                for name in self._joints
            }
        )

    def reset(self) -> None:
        """Begin again."""
        self._pid.reset()


class GzJointPosition(_GzJoints):
    """`gz-sim-joint-position-controller-system`."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        super().__init__(host, robot, element)
        self._target = number(element, "initial_position")
        self._by_speed = boolean(element, "use_velocity_commands")
        self._fastest = number(element, "cmd_max", math.inf)  # by speed there is no default
        self.period = None if self._by_speed else host.step_seconds
        self._listen(element, "position")

    def update(self) -> None:
        """Go on towards the position."""
        error = self._robot.joint_positions()[self._joints[0]] - self._target
        if self._by_speed:
            speed = -error / self._host.update_seconds
            self._drive(min(self._fastest, max(-self._fastest, speed)))
        else:
            self._push(error)


class GzJointVelocity(_GzJoints):
    """`gz-sim-joint-controller-system`."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        super().__init__(host, robot, element)
        self._target = number(element, "initial_velocity")
        self._by_effort = boolean(element, "use_force_commands")
        self.period = host.step_seconds if self._by_effort else None
        self._driven: float | None = None
        self._listen(element, "velocity")

    def update(self) -> None:
        """Keep the speed."""
        if self._by_effort:
            self._push(self._robot.joint_velocities()[self._joints[0]] - self._target)
        elif self._driven != self._target:
            self._drive(self._target)
            self._driven = self._target

    def reset(self) -> None:
        """Begin again."""
        super().reset()
        self._driven = None


class GzJointForce(_GzJoints):
    """`gz-sim-apply-joint-force-system`: the effort of the last message acts on a joint.

    It reads the first <joint_name> alone.
    """

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        super().__init__(host, robot, element)
        self._joints = [name for name in self._joints if name == element.get("joint_name")]
        if not self._joints:
            raise CannotWorkError("the robot does not have its first <joint_name>.")
        self._listen_to(topics_of(host, robot, element)["command"])
        self._acting = 0.0

    def update(self) -> None:
        """Have it act."""
        if self._target != self._acting:
            self._acting = self._target
            self._robot.set_efforts(
                {name: _within(self._models[name], self._target) for name in self._joints}
            )

    def reset(self) -> None:
        """Let go."""
        self._target = 0.0


class GzJointTrajectory(Plugin):
    """`gz-sim-joint-trajectory-controller-system`: goes from point to point, by PID controllers."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        self._host, self._robot = host, robot
        named = element.find("joint_name") is not None
        self._models = {joint.name: joint for joint in robot.robot.movable_joints}
        joints = _named_joints(host, robot, element) if named else list(self._models)
        if not joints:
            raise CannotWorkError("the robot has no joints that it could move.")
        self._initial = {
            name: _nth(element, "initial_position", index) for index, name in enumerate(joints)
        }
        self._pids = {
            name: tuple(
                GzPid(_gains(element, f"{kind}_", index)) for kind in ("position", "velocity")
            )
            for index, name in enumerate(joints)
        }
        self.period = host.step_seconds
        # As in gz-sim, by an attribute.
        self._waits = element.attributes.get("use_header_start_time", "") in {"true", "1"}
        topics = topics_of(host, robot, element)
        host.subscription(robot, JointTrajectory, topics["command"], self._take)
        self._progress = host.publisher(robot, Float32, topics["progress"])
        self.reset()

    def reset(self) -> None:
        """Begin again."""
        # Of each joint: position, velocity, effort.
        self._targets = {name: [position, 0.0, 0.0] for name, position in self._initial.items()}
        self._points: list[Any] = []
        self._names: list[str] = []
        self._start = 0.0
        self._index = -1  # of the point that is aimed at
        for pids in self._pids.values():
            for pid in pids:
                pid.reset()

    def _take(self, message: Any) -> None:
        values = [
            value
            for point in message.points
            for values in (point.positions, point.velocities, point.effort)
            for value in values
        ]
        if not message.joint_names or not all(map(math.isfinite, values)):
            self._host.warn(
                f"`{self._robot.entity}`: a trajectory without joints, or with values that "
                "are not numbers, is not followed."
            )
            return
        stamp = message.header.stamp
        begin = stamp.sec + stamp.nanosec * 1e-9 if self._waits else 0.0
        self._points, self._names = list(message.points), list(message.joint_names)
        self._start, self._index = begin or self._host.now, -1

    def update(self) -> None:
        """Aim at the point that is due, and push towards it."""
        self._aim()
        positions, speeds = self._robot.joint_positions(), self._robot.joint_velocities()
        step = self._host.step_seconds
        efforts = {}
        for name, (position, speed, effort) in self._targets.items():
            by_position, by_speed = self._pids[name]
            push = by_position.command(positions[name] - position, step)
            push += by_speed.command(speeds[name] - speed, step)
            efforts[name] = _within(self._models[name], push + effort)
        self._robot.set_efforts(efforts)

    def _aim(self) -> None:
        if not self._points or self._host.now < self._start:
            return
        before, passed = self._index, self._host.now - self._start
        index = max(0, before)
        while index + 1 < len(self._points) and _seconds(self._points[index]) < passed:
            index += 1
        if index == before:
            return
        self._index = index
        point = self._points[index]
        for place, name in enumerate(self._names):
            if name in self._targets:
                for kind, values in enumerate((point.positions, point.velocities, point.effort)):
                    if place < len(values):
                        self._targets[name][kind] = values[place]
        self._progress.publish(Float32(data=(index + 1) / len(self._points)))
        if index + 1 == len(self._points):
            self._points = []


class ClassicPoseTrajectory(Plugin):
    """`libgazebo_ros_joint_pose_trajectory.so`: puts joints where a trajectory says.

    As in Gazebo Classic, `time_from_start` of a point is how long after it the next one comes.
    """

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        self._host, self._robot = host, robot
        rate = number(element, "update_rate")
        self.period = 1 / rate if rate > 0 else host.step_seconds
        self._node = host.node(robot, element)
        topic = topics_of(host, robot, element)["command"]
        host.subscription(robot, JointTrajectory, topic, self._take, node=self._node, depth=1)
        self.reset()

    def reset(self) -> None:
        """Forget the trajectory."""
        self._points: list[Any] = []
        self._names: list[str] = []
        self._next = 0.0

    def _take(self, message: Any) -> None:
        names = list(message.joint_names)
        problem = self._problem(message, names)
        if problem is not None:
            self._node.get_logger().error(problem)
            return
        stamp = message.header.stamp
        self._points, self._names = list(message.points), names
        self._next = max(self._host.now, stamp.sec + stamp.nanosec * 1e-9)

    def _problem(self, message: Any, names: list[str]) -> str | None:
        frame = message.header.frame_id.rpartition("::")[2]
        if frame not in WORLD and frame not in self._robot.link_poses():
            return f"Plugin needs a reference link [{frame}] as frame_id, aborting."
        if frame not in WORLD and frame != self._robot.robot.root:
            self._host.warn(
                f"`{self._robot.entity}`: its joint trajectories are seen from the link `{frame}`. "
                f"In wsgen the link `{self._robot.robot.root}` stays where it is."
            )
        there = self._robot.joint_positions()
        for name in names:
            if name not in there:
                return f"Joint [{name}] not found. Trajectory not set."
        for index, point in enumerate(message.points, 1):
            if len(point.positions) != len(names):
                return (
                    f"point[{index}] has different number of joint names[{len(names)}] and "
                    f"positions[{len(point.positions)}]."
                )
            if not all(map(math.isfinite, point.positions)):
                return f"point[{index}] has a position that is not a number."
        return None

    def update(self) -> None:
        """Put the joints where the next point says, when it is due."""
        if self._points and self._host.now >= self._next:
            point = self._points.pop(0)
            self._robot.set_joint_positions(dict(zip(self._names, point.positions, strict=True)))
            self._next += _seconds(point)


def _named_joints(host: Host, robot: RobotHandle, element: Element) -> list[str]:
    movable = {joint.name for joint in robot.robot.movable_joints}
    names = [found.text for found in element.find_all("joint_name") if found.text]
    for name in names:
        if name not in movable:
            host.warn(
                f"`{robot.entity}`: the plugin `{element.attributes.get('filename', '')}` names "
                f"the joint `{name}`, which the robot does not have or which is fixed."
            )
    return [name for name in dict.fromkeys(names) if name in movable]


def _nth(element: Element, name: str, index: int) -> float:
    """The number of one of several joints, where each element may be repeated."""
    values = numbers(element, name)
    if index < len(values):
        return values[index]
    default = default_of(element, name)
    assert isinstance(default, float), name  # noqa: S101  a table of wsgen says so
    return default


def _gains(element: Element, prefix: str = "", index: int = 0) -> Gains:
    """Those of one of several joints."""
    tags = {
        "p": "p_gain",
        "i": "i_gain",
        "d": "d_gain",
        "i_max": "i_max",
        "i_min": "i_min",
        "most": "cmd_max",
        "least": "cmd_min",
        "offset": "cmd_offset",
    }
    return Gains(**{name: _nth(element, f"{prefix}{tag}", index) for name, tag in tags.items()})


def _within(joint: Any, effort: float) -> float:
    """The effort, as far as the joint's limit lets it."""
    limit = joint.limit
    if limit is None or limit.effort <= 0:
        return effort
    most: float = limit.effort
    return min(most, max(-most, effort))


def _seconds(point: Any) -> float:
    duration = point.time_from_start
    return float(duration.sec + duration.nanosec * 1e-9)
