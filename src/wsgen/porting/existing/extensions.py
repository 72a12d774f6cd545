"""What the simulator needs beside a robot: what moves its joints, its sensors, and the bridge."""

from __future__ import annotations

import math
import textwrap
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.errors import RequestError
from wsgen.gazebo.bridged_types import PAIRS
from wsgen.gazebo.plugins import stem
from wsgen.gazebo.sensors import SYSTEM_OF_SENSOR
from wsgen.gazebo.successors import STATES
from wsgen.model.kinematics import unactuated_joints
from wsgen.model.robot import Box, Capsule, Cylinder, JointType, Mesh, Sphere
from wsgen.model.target import CLASSIC
from wsgen.model.transform import rotate, rotation_of_rpy, transpose
from wsgen.porting.existing.comparison import place_links
from wsgen.porting.ported import BridgeRow
from wsgen.text.suggestions import ask_for_nearest

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from wsgen.model.robot import Geometry, Joint, Robot
    from wsgen.model.target import Target
    from wsgen.model.transform import Vector


class Controller(NamedTuple):
    """A controller of ros2_control, and what it commands."""

    name: str
    type: str
    interface: str
    joints: tuple[str, ...] = ()
    parameters: Mapping[str, Any] = {}
    is_started: bool = True  # with the robot

    @property
    def text(self) -> str:
        """Its parameters, as YAML below two keys."""
        import yaml  # noqa: PLC0415  20 ms that only robots with controllers pay

        written = yaml.safe_dump(dict(self.parameters), sort_keys=False, allow_unicode=True)
        return textwrap.indent(written, "    ").rstrip()


CONTROLLERS = {
    "position": Controller(
        "joint_trajectory_controller",
        "joint_trajectory_controller/JointTrajectoryController",
        "position",
    ),
    "velocity": Controller(
        "velocity_controller", "velocity_controllers/JointGroupVelocityController", "velocity"
    ),
    "effort": Controller(
        "effort_controller", "effort_controllers/JointGroupEffortController", "effort"
    ),
}
DIFF_DRIVE = "diff_drive"
CONTROLS = ("none", *CONTROLLERS, DIFF_DRIVE)
SENSORS = {"lidar": "gpu_lidar", "camera": "camera", "imu": "imu"}  # with their kinds in Gazebo Sim
SIDES = ("left", "right")
_DRIVEN = (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC)
_SHOWN = 8
_PARALLEL = math.cos(math.radians(5))
_TORQUE = 20.0  # N m, of a wheel whose joint does not say it: the plugin's default


class Sensor(NamedTuple):
    """A sensor that is added to a link."""

    kind: str  # a key of SENSORS
    link: str
    name: str  # in the simulator, and where its topics begin


class Driven(NamedTuple):
    """A joint that a controller may move."""

    name: str
    interfaces: tuple[str, ...]  # what controllers command; none of a joint that follows another
    start: float  # rad or m: 0, or the limit that is next to it
    mimic: str | None  # the joint that it follows
    multiplier: float
    offset: float


class Drive(NamedTuple):
    """Two rows of wheels that a plugin drives."""

    left: tuple[str, ...]  # joints
    right: tuple[str, ...]
    separation: float  # m
    radius: float  # m
    torque: float  # N m, of a wheel
    ahead: float  # rad: where it drives, seen from the x axis of the root link


class Extensions(NamedTuple):
    """What the templates write beside the robot."""

    controllers: tuple[Controller, ...] = ()
    driven: tuple[Driven, ...] = ()
    published: tuple[str, ...] = ()  # joints whose states a plugin publishes
    drive: Drive | None = None
    sensors: tuple[Sensor, ...] = ()
    bridge: tuple[BridgeRow, ...] = ()
    systems: frozenset[str] = frozenset()  # of Gazebo Sim (class names)
    packages: frozenset[str] = frozenset()  # of ROS

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing to write."""
        return not (self.controllers or self.published or self.drive or self.sensors)


class Wanted(NamedTuple):
    """What is asked for."""

    control: str = "none"
    wheels: tuple[str, ...] = ()  # SIDE:JOINT
    sensors: tuple[str, ...] = ()  # KIND:LINK


def extend(  # noqa: PLR0913, PLR0917  the robot, and what there is for it
    robot: Robot,
    lumped: Robot,
    wanted: Wanted,
    target: Target,
    name: str,
    known: Sequence[Controller] = (),
) -> Extensions:
    """Choose what a robot needs in a simulator.

    Args:
        robot: As it is written.
        lumped: As the simulator has it.
        wanted: What is asked for.
        target: The simulator.
        name: Of the package, and of the robot in the simulator.
        known: Controllers that the source has; the others joints get one more.

    Raises:
        RequestError: A joint or link does not exist, or cannot be what it is to be.
    """
    sensors = _sensors(robot, wanted.sensors)
    joints = [one for one in robot.joints if one.type in _DRIVEN]
    controllers = tuple[Controller, ...]()
    has_own = _publishes_joint_states(robot)
    if wanted.control in CONTROLLERS:
        _refuse_control(robot, wanted.control, joints)
        controllers = (*known, *_of_others(joints, known, wanted.control))
    drive = _drive(robot, lumped, wanted)
    published = () if controllers or has_own else tuple(one.name for one in joints)
    rows = [*_rows_of_sensors(sensors, name)]
    if published:
        rows.append(_row(f"/model/{name}/joint_state", "Model", "[", "/joint_states"))
    if drive:
        rows += [
            _row(f"/model/{name}/cmd_vel", "Twist", "]", "/cmd_vel"),
            _row(f"/model/{name}/odometry", "Odometry", "[", "/odom"),
            _row(f"/model/{name}/tf", "Pose_V", "[", "/tf")._replace(
                ros_type="tf2_msgs/msg/TFMessage"
            ),
        ]
    is_classic = target.simulator == CLASSIC
    return Extensions(
        controllers=controllers,
        driven=tuple(_driven(one, controllers) for one in joints) if controllers else (),
        published=published,
        drive=drive,
        sensors=sensors,
        bridge=() if is_classic else tuple(rows),
        systems=frozenset(SYSTEM_OF_SENSOR[SENSORS[one.kind]] for one in sensors),
        packages=frozenset(
            ["gazebo_plugins"] if is_classic and (published or drive or sensors) else []
        ),
    )


def _publishes_joint_states(robot: Robot) -> bool:
    return any(stem(one.filename) in STATES for tag in robot.gazebo for one in tag.plugins)


def _row(gz_topic: str, gz_type: str, direction: str, ros_topic: str) -> BridgeRow:
    ros_type = PAIRS[gz_type][0].replace("/", "/msg/")
    return BridgeRow(gz_topic, gz_type, ros_type, direction, ros_topic)


def _rows_of_sensors(sensors: Iterable[Sensor], name: str) -> Iterable[BridgeRow]:
    for one in sensors:
        own = f"/model/{name}/{one.name}"
        if one.kind == "camera":
            yield _row(f"{own}/image", "Image", "[", f"/{one.name}/image_raw")
            yield _row(f"{own}/camera_info", "CameraInfo", "[", f"/{one.name}/camera_info")
        else:
            kind = "LaserScan" if one.kind == "lidar" else "IMU"
            yield _row(own, kind, "[", f"/{one.name}")


def _refuse_control(robot: Robot, control: str, joints: Sequence[Joint]) -> None:
    if robot.controls:
        raise RequestError(
            f"--control {control}: the robot has a <ros2_control> already.",
            hint="Omit --control, or remove the element from the source.",
        )
    if not joints:
        raise RequestError(
            f"--control {control}: the robot does not have a joint that a controller could move.",
            hint="Omit --control.",
        )


def _of_others(
    joints: Sequence[Joint], known: Sequence[Controller], control: str
) -> Iterable[Controller]:
    """A controller for the joints that no other one commands."""
    taken = {name for one in known for name in one.joints}
    left = [one.name for one in joints if one.mimic is None and one.name not in taken]
    if not left and known:
        return
    one, names = CONTROLLERS[control], {one.name for one in known}
    name = f"{one.name}_of_others" if one.name in names else one.name
    parameters: dict[str, Any] = {"joints": left}
    if control == "position":
        parameters["command_interfaces"] = ["position"]
        parameters["state_interfaces"] = ["position", "velocity"]
    yield one._replace(name=name, joints=tuple(left), parameters=parameters)


def _driven(joint: Joint, controllers: Iterable[Controller]) -> Driven:
    start = 0.0
    if joint.starts_beyond_limit and joint.limit is not None:
        start = min(max(0.0, joint.limit.lower), joint.limit.upper)
    mimic = joint.mimic
    commands = [one.interface for one in controllers if joint.name in one.joints]
    return Driven(
        joint.name,
        tuple(sorted({*commands})),
        start,
        mimic.joint if mimic else None,
        mimic.multiplier if mimic else 1.0,
        mimic.offset if mimic else 0.0,
    )


def _parted(word: str, option: str, first: Iterable[str], second: str) -> tuple[str, str]:
    """The two parts of KIND:NAME; a name may have colons in it."""
    kind, separator, name = word.partition(":")
    if not separator or kind not in first or not name:
        known = " or ".join(f"{option} {one}:{second}" for one in first)
        raise RequestError(f"{option} {word} is not understood.", hint=f"Write {known}.")
    return kind, name


def _sensors(robot: Robot, words: Sequence[str]) -> tuple[Sensor, ...]:
    links = [one.name for one in robot.links]
    parted = [_parted(word, "--sensor", SENSORS, "LINK") for word in dict.fromkeys(words)]
    found = []
    for kind, link in parted:
        if link not in links:
            raise RequestError(
                f"--sensor {kind}:{link}: the robot does not have a link `{link}`.",
                hint=f"{ask_for_nearest(link, links)}Choose one of {_some(links)}.",
            )
        is_alone = sum(other == kind for other, _ in parted) == 1
        topic = "scan" if kind == "lidar" else kind
        name = topic if is_alone else f"{topic}_{''.join(c if c.isalnum() else '_' for c in link)}"
        found.append(Sensor(kind, link, name))
    return tuple(found)


def _some(names: Sequence[str]) -> str:
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return f"{', '.join(names[:_SHOWN])}{more}"


def _drive(robot: Robot, lumped: Robot, wanted: Wanted) -> Drive | None:
    """The wheels that are named, which must be such."""
    if wanted.control != DIFF_DRIVE:
        if wanted.wheels:
            raise RequestError(
                "--wheel is for --control diff_drive.", hint="Add it, or omit --wheel."
            )
        return None
    by_side: dict[str, list[str]] = {side: [] for side in SIDES}
    for word in wanted.wheels:
        side, name = _parted(word, "--wheel", SIDES, "JOINT")
        by_side[side].append(name)
    passive = unactuated_joints(lumped)
    turning = [one.name for one in robot.joints if one.type is JointType.CONTINUOUS]
    likely = [one for one in turning if one not in passive] or turning
    if not all(by_side.values()) or len(by_side["left"]) != len(by_side["right"]):
        raise RequestError(
            "--control diff_drive drives as many wheels on the left as on the right, which are to"
            " be named.",
            hint=f"Add --wheel left:JOINT --wheel right:JOINT. {_candidates(likely)}",
        )
    joints = {one.name: one for one in robot.joints}
    for name in (*by_side["left"], *by_side["right"]):
        joint = joints.get(name)
        if joint is None or joint.type not in {JointType.CONTINUOUS, JointType.REVOLUTE}:
            problem = "is not a joint that turns" if joint else "does not exist"
            raise RequestError(f"--wheel: the joint `{name}` {problem}.", hint=_candidates(likely))
    return measure_drive(robot, by_side["left"], by_side["right"])


def _candidates(names: Sequence[str]) -> str:
    return f"Choose among {_some(names)}." if names else "Omit --control: no joint turns endlessly."


def measure_drive(robot: Robot, left: Sequence[str], right: Sequence[str]) -> Drive:
    """Where the wheels are, how large, and where they drive.

    Raises:
        RequestError: Their axes differ, or point to the wrong side.
    """
    joints = {one.name: one for one in robot.joints}
    placed = place_links(robot, {})
    axes = {}
    for name in (*left, *right):
        joint = joints[name]
        axes[name] = rotate(placed[joint.child][0], joint.axis_in_joint)
    axis = axes[left[0]]
    for name, other in axes.items():
        along = sum(a * b for a, b in zip(axis, other, strict=True))
        if along < _PARALLEL:
            turned = "the other way round" if along < -_PARALLEL else "in another direction"
            raise RequestError(
                f"The axis of `{name}` points {turned} than that of `{left[0]}`: the plugin drives"
                " all wheels in the same sense.",
                hint=f"Change <axis> and <origin> of `{name}` so that both point to the left.",
            )
    middles = [
        tuple(
            sum(placed[joints[name].child][1][i] for name in names) / len(names) for i in range(3)
        )
        for names in (left, right)
    ]
    across = tuple(a - b for a, b in zip(*middles, strict=True))
    separation = sum(a * b for a, b in zip(axis, across, strict=True))
    if separation < 0:
        raise RequestError(
            "The axes of the wheels point from the left to the right: with these sides the robot"
            " turns the wrong way.",
            hint="Swap left and right: the robot then drives to where its wheels roll.",
        )
    efforts = [one.effort for name in axes if (one := joints[name].limit) and one.effort > 0]
    radii = [_radius(robot, joints[name]) for name in axes]
    return Drive(
        tuple(left),
        tuple(right),
        separation=round(separation, 6),
        radius=round(max(radii), 6),
        torque=min(efforts, default=_TORQUE),
        ahead=math.atan2(-axis[0], axis[1]),
    )


def _radius(robot: Robot, joint: Joint) -> float:
    """How far a wheel reaches from its axle, m."""
    link = robot.link(joint.child)
    for shapes in (link.collisions, link.visuals):
        found = [
            _reach(
                one.geometry,
                rotate(transpose(rotation_of_rpy(one.pose_in_link.rpy)), joint.axis_in_joint),
            )
            for one in shapes
        ]
        known = [one for one in found if one]
        if known:
            return max(known)
    raise RequestError(
        f"The wheel `{link.name}` does not have a shape: its radius is not known.",
        hint="Add a <collision> with a <cylinder> or a mesh to the link.",
    )


def _reach(geometry: Geometry, axis: Vector) -> float:
    """Half of the width of a shape across an axis of its frame, m; 0 if that is not known."""
    if isinstance(geometry, Sphere | Cylinder | Capsule):
        return geometry.radius
    edges: Sequence[float] = ()
    if isinstance(geometry, Box):
        edges = geometry.size
    elif isinstance(geometry, Mesh) and geometry.bounds is not None:
        low, high = geometry.bounds
        edges = [abs(s) * (b - a) for a, b, s in zip(low, high, geometry.scale, strict=True)]
    along = max(range(3), key=lambda one: abs(axis[one]))
    return max((edge for place, edge in enumerate(edges) if place != along), default=0.0) / 2
