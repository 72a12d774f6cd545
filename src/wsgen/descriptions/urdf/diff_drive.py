"""The differential drive that a robot's `<gazebo><plugin>` describes, for checks and live runs.

How they read it: `gazebo_ros_diff_drive.cpp` (gazebo_plugins, Humble and Iron) and `DiffDrive.cc`
(gz-sim, Fortress to Jetty).
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.descriptions.urdf.values import leading_float
from wsgen.gazebo.plugins import PLUGINS, TWO_WHEELS, stem
from wsgen.model.behavior import Bounds, DiffDrive, WheelPair
from wsgen.model.target import CLASSIC, SIM, SIMULATORS

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from wsgen.model.robot import Plugin, Robot

    Values = Mapping[str, tuple[str, ...]]  # parameter -> its texts


SIMULATOR_OF_STEM = {"gazebo_ros_diff_drive": CLASSIC, "diff-drive": SIM}  # by `stem`
_STEMS = {simulator: name for name, simulator in SIMULATOR_OF_STEM.items()}


class NoDrive(NamedTuple):
    """Why a robot cannot be driven."""

    reason: str
    hint: str
    is_there: bool = True  # a plugin is, but it would not work


ABSENT = NoDrive(
    "its description has no diff drive plugin",
    "Add gz-sim-diff-drive-system (Gazebo Sim) or libgazebo_ros_diff_drive.so (Gazebo Classic) to "
    "its <gazebo>. wsgen does not drive a diff_drive_controller of ros2_control here.",
    is_there=False,
)


def find_diff_drive(robot: Robot, *, simulator: str | None = None) -> DiffDrive | NoDrive:
    """The drive of a robot, lumped or not, or what keeps its plugin from working.

    Of plugins for both simulators the one for that `simulator` counts.
    """
    found = list(_plugins(robot))
    if not found:
        return ABSENT
    suited = [one for one in found if simulator in (None, one[0])]
    if not suited:
        return NoDrive(
            f"its diff drive plugin is for {SIMULATORS[found[0][0]]}, but the launch file "
            f"starts {SIMULATORS[simulator or CLASSIC]}",
            "Use the diff drive plugin of that simulator.",
        )
    kind, plugin = suited[0]
    topic = plugin.values.get("topic")
    try:
        drive = read_drive(kind, plugin.values, robot)
        # Pairs of other sizes have plugins of their own in Gazebo Sim, for the same commands.
        others = [
            read_drive(kind, one.values, robot)
            for other, one in suited[1:]
            if other == kind == SIM and topic and one.values.get("topic") == topic
        ]
        pairs = [pair for one in (drive, *others) for pair in one.pairs]
        return replace(drive, pairs=tuple(pairs), grip=min(one.grip for one in (drive, *others)))
    except UnusableError as error:
        return error.why


class UnusableError(Exception):
    """The plugin cannot work."""

    def __init__(self, reason: str, hint: str) -> None:
        super().__init__(reason)
        self.why = NoDrive(reason, hint)


def _plugins(robot: Robot) -> Iterator[tuple[str, Plugin]]:
    for tag in robot.gazebo:
        for plugin in tag.plugins:
            if (name := stem(plugin.filename)) in SIMULATOR_OF_STEM:
                yield SIMULATOR_OF_STEM[name], plugin


def read_drive(kind: str, values: Values, robot: Robot) -> DiffDrive:
    """The drive of a robot, lumped or not, that a plugin for a simulator describes.

    Raises:
        UnusableError: It cannot work.
    """
    pairs = tuple(_pairs(kind, values, robot))
    grip = robot.least_grip([joint for pair in pairs for joint in (pair.left, pair.right)])
    if kind == CLASSIC:
        most = _number(kind, values, "max_wheel_acceleration") or math.inf
        return DiffDrive(
            simulator=kind,
            pairs=pairs,
            grip=grip,
            torque=_number(kind, values, "max_wheel_torque"),
            rim=Bounds(braking=-most, acceleration=most),
        )
    return DiffDrive(
        simulator=kind,
        pairs=pairs,
        grip=grip,
        linear=read_bounds(values, "linear_"),
        angular=read_bounds(values, "angular_"),
    )


def _pairs(kind: str, values: Values, robot: Robot) -> Iterator[WheelPair]:
    left, right = (tuple(_wheels(kind, side, values, robot)) for side in TWO_WHEELS)
    count = max(len(left), len(right))
    if kind == CLASSIC:
        count = max(1, int(_number(kind, values, "num_wheel_pairs")))
    if not left or not right or (kind == CLASSIC and not len(left) == len(right) == count):
        raise UnusableError(
            f"its diff drive plugin names {len(left)} left and {len(right)} right joints"
            + (f" for {count} pairs of wheels" if kind == CLASSIC else ""),
            "Write one <left_joint> and one <right_joint> for each pair of wheels"
            + (", and the number of pairs in <num_wheel_pairs>." if kind == CLASSIC else "."),
        )
    size, share = ("wheel_diameter", 0.5) if kind == CLASSIC else ("wheel_radius", 1.0)
    for index in range(count):
        # Gazebo Sim has one size for all wheels, which need not be as many on both sides.
        at = index if kind == CLASSIC else 0
        yield WheelPair(
            left=left[min(index, len(left) - 1)],
            right=right[min(index, len(right) - 1)],
            separation=_size(kind, values, "wheel_separation", at),
            radius=_size(kind, values, size, at) * share,
        )


def _wheels(kind: str, side: str, values: Values, robot: Robot) -> Iterator[str]:
    """The joints of one side.

    Gazebo Classic's plugin does not work if one is not there; that of Gazebo Sim names it and turns
    the others.
    """
    movable = set() if robot.is_static else {joint.name for joint in robot.movable_joints}
    named = values.get(side, ())
    missing = next((joint for joint in named if joint not in movable), None)
    there = [joint for joint in named if joint in movable]
    if missing is not None and (kind == CLASSIC or not there):
        raise UnusableError(
            f"its diff drive plugin names the joint `{missing}`, but the robot has no revolute or "
            "continuous joint of that name",
            "Write the names of the wheel joints in <left_joint> and <right_joint>.",
        )
    yield from there


def _size(kind: str, values: Values, key: str, at: int) -> float:
    size = _number(kind, values, key, at)
    if not size > 0:
        raise UnusableError(
            f"the <{key}> of its diff drive plugin is {size:g}", "Write a length in meters."
        )
    return size


def _number(kind: str, values: Values, key: str, at: int = 0) -> float:
    texts = values.get(key, ())
    if at >= len(texts):
        default = PLUGINS[_STEMS[kind]].parameters[key]
        assert isinstance(default, float), key  # noqa: S101  the table says so
        return default
    return _read_number(key, texts[at])


def _read_number(key: str, text: str) -> float:
    number = leading_float(text)
    if number is None or not math.isfinite(number):
        raise UnusableError(
            f"the <{key}> of its diff drive plugin is `{text[:60]}`, which is not a number",
            "Write one number with a decimal point.",
        )
    return number


def read_bounds(values: Values, motion: str = "") -> Bounds:
    """What a drive of Gazebo Sim allows; a key without the kind of motion is for both.

    Raises:
        UnusableError: A bound is not a number.
    """

    def bound(side: str, what: str) -> float:
        for key in (f"{side}_{motion}{what}", f"{side}_{what}"):
            if values.get(key):
                return _read_number(key, values[key][0])
        return -math.inf if side == "min" else math.inf

    return Bounds(
        slowest=bound("min", "velocity"),
        fastest=bound("max", "velocity"),
        braking=bound("min", "acceleration"),
        acceleration=bound("max", "acceleration"),
        least_jerk=bound("min", "jerk"),
        jerk=bound("max", "jerk"),
    )
