"""Cars, whose front wheels are steered: of Gazebo Classic and of Gazebo Sim.

Sources: ros-simulation/gazebo_ros_pkgs, gazebo_plugins/src/gazebo_ros_ackermann_drive.cpp (branch
ros2); gazebosim/gz-sim, src/systems/ackermann_steering/AckermannSteering.cc. Neither stops when
commands cease. What Classic's plugin calls the angular velocity of a command is the angle of the
steering, times the sign of the speed.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

from geometry_msgs.msg import Twist
from std_msgs.msg import Float32, Float64

from wsgen.live.nodes.simulator.elements import boolean, number, text, topics_of, vector
from wsgen.live.nodes.simulator.host import CannotWorkError, Plugin
from wsgen.live.nodes.simulator.messages import can_follow_twist
from wsgen.live.nodes.simulator.plugins.drives import (
    ClassicOdometry,
    DrivePublisher,
    GzDrive,
    driven_joints,
    length,
    limited_motors,
    limits,
)
from wsgen.live.nodes.simulator.plugins.joint_commands import (
    Gains,
    GzPid,
    actuator_number,
    listen_to_actuator,
)
from wsgen.live.nodes.simulator.timing import Timer, until_next
from wsgen.model.robot import Cylinder, Sphere
from wsgen.model.transform import compose

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.devices import Element
    from wsgen.model.robot import Joint
    from wsgen.model.transform import Vector
    from wsgen.simulation.engine import Motor

STRAIGHT = 0.001  # rad/s; Gazebo Sim takes less for a command to drive straight on
FAR = 1e9  # m, the radius of the turn then
SLOW_STEERING = 0.1  # of an error, that one update removes at most; else each step is an update


class CarOdometry:
    """Where a car is by its rear wheels and its steering, as AckermannSteering.cc counts.

    Gazebo counts in each step, and turns before it goes on; here the steps of an update are summed
    up, as if the speeds had been the same in each of them.

    Attributes:
        x: m, where it began to the front.
        y: m, to the left.
        heading: rad.
        linear: m/s, in the last update.
        angular: rad/s, likewise.
    """

    def __init__(self, wheel_base: float, radius: float, step_seconds: float) -> None:
        self._wheel_base, self._radius, self._step = wheel_base, radius, step_seconds
        self.reset()

    def reset(self) -> None:
        """Begin again."""
        self._last: tuple[float, float] | None = None
        self.x = self.y = self.heading = self.linear = self.angular = 0.0

    def update(self, wheels: float, steering: float, now: float) -> None:
        """Take in how far both wheels have turned (rad, the mean) and the angle of the steering."""
        last, self._last = self._last, (wheels, now)
        if last is None or now <= last[1]:
            return
        way = self._radius * (wheels - last[0])
        turn = way * math.tan(steering) / self._wheel_base
        steps = max(1, round((now - last[1]) / self._step))
        half = turn / steps / 2
        share = 1.0 if abs(half) < 1e-9 else math.sin(steps * half) / (steps * math.sin(half))  # noqa: PLR2004  rad
        mean = self.heading + (steps + 1) * half
        self.x += way * share * math.cos(mean)
        self.y += way * share * math.sin(mean)
        self.heading = math.remainder(self.heading + turn, math.tau)
        self.linear, self.angular = way / (now - last[1]), turn / (now - last[1])


class Steering(NamedTuple):
    """What a command comes to."""

    left: float  # rad, of the left front wheel
    right: float
    left_speed: float  # rad/s, of the left rear wheel
    right_speed: float


class Car(NamedTuple):
    """The measures of a car, m and rad."""

    wheel_base: float  # from the front axle to the rear one
    separation: float  # of the wheels
    kingpins: float  # distance of the axes about which front wheels are steered
    radius: float  # of wheels
    limit: float  # of the steering

    def steering(self, linear: float, angular: float) -> Steering:
        """For a speed ahead (m/s) and a turn (rad/s), within the limit of the steering."""
        nearest = self.wheel_base / math.sin(self.limit)
        if abs(angular) < STRAIGHT:
            radius = FAR
        elif linear == 0.0:
            radius = math.copysign(nearest, angular)
        else:
            radius = linear / angular
            radius = math.copysign(max(nearest, abs(radius)), radius)
        half, share = self.kingpins / 2, self.separation / (2 * radius)
        return Steering(
            _arctangent(self.wheel_base, radius - half),
            _arctangent(self.wheel_base, radius + half),
            linear * (1.0 - share) / self.radius,
            linear * (1.0 + share) / self.radius,
        )

    def steered(self, angle: float) -> tuple[float, float]:
        """The angles of the left and the right wheel for one in the middle between them (rad)."""
        angle = min(self.limit, max(-self.limit, angle))
        way, side = 2 * self.wheel_base * math.sin(angle), self.separation * math.sin(angle)
        ahead = 2 * self.wheel_base * math.cos(angle)
        return _arctangent(way, ahead - side), _arctangent(way, ahead + side)


def _arctangent(way: float, aside: float) -> float:
    """As C++ has `atan(way / aside)`: a quarter of a turn where the second is 0."""
    return math.atan(way / aside) if aside else math.atan2(way, 0.0)


class GzAckermann(GzDrive):
    """`gz-sim-ackermann-steering-system`."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        element, actuator = actuator_number(host, robot, element)
        self._steers_only = actuator is not None or boolean(element, "steering_only")
        tags = ("left_steering_joint", "right_steering_joint")
        self._steered = driven_joints(host, robot, element, *tags)
        self._driven: list[list[Joint]] = []
        if not self._steers_only:
            self._driven = driven_joints(host, robot, element, "left_joint", "right_joint")
        self._car = Car(
            wheel_base=length(element, "wheel_base"),
            separation=number(element, "wheel_separation"),
            kingpins=number(element, "kingpin_width"),
            radius=1.0 if self._steers_only else length(element, "wheel_radius"),
            limit=_steering_limit(element),
        )
        self._gain = number(element, "steer_p_gain")
        # Where it is steered alone, the second one is an angle, rad.
        bounds = (limits(element),) * 2
        is_slow = self._gain * host.update_seconds <= SLOW_STEERING
        super().__init__(host, robot, bounds, None if is_slow else host.step_seconds)
        self._odometry = CarOdometry(self._car.wheel_base, self._car.radius, host.step_seconds)
        self._listen(element, actuator)
        if not self._steers_only:
            self._publisher = DrivePublisher(host, robot, element)

    def _listen(self, element: Element, actuator: int | None) -> None:
        host, robot = self._host, self._robot
        use = "angle" if self._steers_only else "command"
        self._topic = topics_of(host, robot, element)[use if actuator is None else "actuators"]
        if actuator is not None:
            listen_to_actuator(host, robot, self._topic, ("position", actuator), self._take_angle)
        elif self._steers_only:
            host.subscription(robot, Float64, self._topic, lambda one: self._take_angle(one.data))
        else:
            host.subscription(robot, Twist, self._topic, self._take)

    def _take_angle(self, angle: float) -> None:
        if math.isfinite(angle):
            self._wanted = 0.0, angle
        else:
            self._host.warn(f"A message on {self._topic} has the angle {angle}. It is ignored.")

    def _motors(self, speeds: tuple[float, ...]) -> dict[str, Motor]:
        linear, angular = speeds
        motors: dict[str, Motor] = {}
        if self._steers_only:
            angular = min(self._car.limit, max(-self._car.limit, angular))
            self._last = linear, angular
            angles = self._car.steered(angular)
        else:
            steering = self._car.steering(linear, angular)
            angles = steering.left, steering.right
            motors = limited_motors(self._driven, (steering.left_speed, steering.right_speed))
        positions = self._robot.joint_positions()
        turning = (
            self._gain * (angle - positions[side[0].name])
            for side, angle in zip(self._steered, angles, strict=True)
        )
        return motors | limited_motors(self._steered, turning)

    def _count(self, now: float) -> None:
        positions = self._robot.joint_positions()
        wheels, steering = (
            sum(positions[side[0].name] for side in sides) / 2
            for sides in (self._driven, self._steered)
        )
        self._odometry.update(wheels, steering, now)


def _steering_limit(element: Element) -> float:
    value = number(element, "steering_limit")
    if not 0.0 < value < math.pi:
        raise CannotWorkError(f"its <steering_limit> is {value:g}. Write an angle in radians.")
    return value


def _angle(element: Element, name: str) -> float:
    value = number(element, name)
    if not value > 0.0:
        raise CannotWorkError(f"its <{name}> is {value:g}. Write an angle in radians, above 0.")
    return value


class ClassicAckermann(Plugin):
    """`libgazebo_ros_ackermann_drive.so`, by efforts of PID controllers."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        self._host, self._robot = host, robot
        self._joints = {
            name: _joint(robot, text(element, name, robot))
            for name in (
                *("front_right_joint", "front_left_joint", "rear_right_joint", "rear_left_joint"),
                *("right_steering_joint", "left_steering_joint"),
            )
        }
        self._wheel = _steering_wheel(host, robot, element)
        self._fastest = number(element, "max_speed")
        self._most = _angle(element, "max_steer")
        self._ratio = self._most / _angle(element, "max_steering_angle")
        self._pushed = tuple(
            self._joints[name].name
            for name in (
                *("rear_right_joint", "rear_left_joint"),
                *("right_steering_joint", "left_steering_joint"),
            )
        )
        self._pids = {
            name: GzPid(_gains(element, name))
            for name in ("right_steering", "left_steering", "linear_velocity")
        }
        self._measure()
        rate = number(element, "update_rate")
        self._every = Timer(1 / rate if rate > 0 else 0.0, host.now)
        self._node = host.node(robot, element)
        self._open(element)
        self._place = robot.state().xyz
        self._updated = host.now
        self.reset()

    def _open(self, element: Element) -> None:
        host, robot, node = self._host, self._robot, self._node
        topics = topics_of(host, robot, element)
        host.subscription(robot, Twist, topics["command"], self._take, node=node, depth=1)
        self._distance_publisher, self._angle_publisher = (
            host.publisher(robot, Float32, topics[use], node=node, depth=1)
            if use in topics
            else None
            for use in ("distance", "steerangle")
        )
        moving = (*self._joints.values(), *((self._wheel,) if self._wheel is not None else ()))
        wheels = moving if boolean(element, "publish_wheel_tf") else ()
        self._odometry = ClassicOdometry(host, robot, element, node, wheels)

    def _measure(self) -> None:
        """Radius and distances of the wheels, by their shapes, as the plugin does."""
        poses, centers = self._robot.link_poses(), {}
        for name in ("front_right", "front_left", "rear_right", "rear_left"):
            joint = self._joints[f"{name}_joint"]
            collisions = self._robot.robot.link(joint.child).collisions
            if not collisions:
                raise CannotWorkError(
                    f"the wheel `{joint.child}` has no <collision>, by which it measures the robot."
                )
            centers[name] = compose(poses[joint.child], collisions[0].pose_in_link).xyz
            shape = collisions[0].geometry
            if name == "rear_right":
                if not isinstance(shape, (Cylinder, Sphere)):
                    raise CannotWorkError(
                        f"the <collision> of the wheel `{joint.child}` is not a cylinder or "
                        "sphere, whose radius it needs."
                    )
                self._radius = shape.radius
                if not self._radius > 0.0:
                    raise CannotWorkError(
                        f"the radius of the wheel `{joint.child}` is {self._radius:g}. Write a "
                        "length in meters into the <collision>."
                    )
        self._separation = math.dist(centers["front_left"], centers["front_right"])
        self._wheel_base = math.dist(
            _middle(centers["front_left"], centers["front_right"]),
            _middle(centers["rear_left"], centers["rear_right"]),
        )
        if not self._wheel_base:
            raise CannotWorkError("its front wheels are where its rear wheels are.")

    def _take(self, message: Any) -> None:
        if can_follow_twist(self._host, message, self._node.resolve_topic_name("cmd_vel")):
            self._linear, self._angle = message.linear.x, message.angular.z

    def update(self) -> None:
        """Publish where the robot is, then push wheels and steering, for one step.

        `Joint::SetForce` acts in the next step of the world alone: at 100 Hz, in each tenth one.
        """
        now, step = self._host.now, self._host.step_seconds
        if self._every.is_due(now):
            self._publish()
            self._drive()
            self.period = step
        else:
            self._robot.release(self._pushed)
            self.period = until_next(now, self._every)

    def _publish(self) -> None:
        place = self._robot.state().xyz
        self._distance += math.dist(place[:2], self._place[:2])
        self._place = place
        if self._distance_publisher is not None:
            self._distance_publisher.publish(Float32(data=self._distance))
        self._odometry.publish_true()

    def _drive(self) -> None:
        seconds = self._host.now - self._updated
        self._updated = self._host.now
        positions, speeds = self._robot.joint_positions(), self._robot.joint_velocities()
        joints, efforts = self._joints, {}
        wanted = min(self._fastest, max(-self._fastest, self._linear)) / self._radius
        error = speeds[joints["rear_right_joint"].name] - wanted
        push = self._pids["linear_velocity"].command(error, seconds)
        for name in ("rear_right_joint", "rear_left_joint"):
            efforts[joints[name].name] = push
        angle = self._angle * math.copysign(1.0, self._linear)
        tangent = math.tan(min(self._most, max(-self._most, angle)))
        share = self._separation / 2 / self._wheel_base * tangent
        there = []
        for side, sign in (("left", -1.0), ("right", 1.0)):
            target = math.atan2(tangent, 1.0 + sign * share)
            joint = joints[f"{side}_steering_joint"]
            there.append(positions[joint.name])
            pid = self._pids[f"{side}_steering"]
            efforts[joint.name] = pid.command(there[-1] - target, seconds)
        self._robot.set_efforts(efforts)
        mean = sum(there) / 2
        if self._angle_publisher is not None:
            self._angle_publisher.publish(Float32(data=mean))
        if self._wheel is not None:
            self._robot.set_joint_positions({self._wheel.name: mean / self._ratio})

    def reset(self) -> None:
        """Stand still; the distance is 0."""
        self._linear = self._angle = self._distance = 0.0
        self._updated = self._host.now
        self._every.reset(self._host.now)
        for pid in self._pids.values():
            pid.reset()


def _joint(robot: RobotHandle, name: str) -> Joint:
    joint = next((one for one in robot.robot.movable_joints if one.name == name), None)
    if joint is None:
        raise CannotWorkError(f"the robot has no joint `{name}` that can turn.")
    return joint


def _steering_wheel(host: Host, robot: RobotHandle, element: Element) -> Joint | None:
    name = text(element, "steering_wheel_joint", robot)
    found = next((one for one in robot.robot.movable_joints if one.name == name), None)
    if found is None and element.get("steering_wheel_joint"):
        host.warn(f"`{robot.entity}`: its Ackermann drive finds no steering wheel joint `{name}`.")
    return found


def _gains(element: Element, name: str) -> Gains:
    """As `gazebo::common::PID` has them: without limits of the command."""
    p, i, d = vector(element, f"{name}_pid_gain")
    least, most = vector(element, f"{name}_i_range")
    return Gains(p=p, i=i, d=d, i_max=most, i_min=least, most=-1.0, least=0.0)


def _middle(one: Vector, other: Vector) -> Vector:
    a, b, c = ((first + second) / 2 for first, second in zip(one, other, strict=True))
    return a, b, c
