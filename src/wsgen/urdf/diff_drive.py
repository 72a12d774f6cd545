"""The differential drive that a robot's `<gazebo><plugin>` describes.

Names and defaults are those of `gazebo_ros_diff_drive.cpp` (gazebo_plugins, Humble and Iron) and of
`DiffDrive.cc` (gz-sim, Fortress to Jetty).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from wsgen.model.behavior import Bounds, DiffDrive, WheelPair
from wsgen.urdf.values import leading_float

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from wsgen.model.robot import Plugin, Robot


CLASSIC, SIM = "classic", "gz"
SIMULATORS = {
    "gazebo_ros_diff_drive": CLASSIC,
    "gz-sim-diff-drive-system": SIM,
    "ignition-gazebo-diff-drive-system": SIM,
}
# What the plugins take for what is not written: m, m, N m.
SEPARATION = {CLASSIC: 0.34, SIM: 1.0}
RADIUS = {CLASSIC: 0.075, SIM: 0.2}
TORQUE = 5.0


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
        there = {CLASSIC: "Gazebo Classic", SIM: "Gazebo Sim"}
        return NoDrive(
            f"its diff drive plugin is for {there[found[0][0]]}, but the launch file starts "
            f"{there[simulator or CLASSIC]}",
            "Use the diff drive plugin of that simulator.",
        )
    kind, plugin = suited[0]
    try:
        return _read(kind, plugin, robot)
    except _UnusableError as error:
        return error.why


class _UnusableError(Exception):
    """The plugin cannot work; never leaves this module."""

    def __init__(self, reason: str, hint: str) -> None:
        super().__init__(reason)
        self.why = NoDrive(reason, hint)


def _plugins(robot: Robot) -> Iterator[tuple[str, Plugin]]:
    for tag in robot.gazebo:
        for plugin in tag.plugins:
            name = plugin.filename.rpartition("/")[2].removeprefix("lib").removesuffix(".so")
            if name in SIMULATORS:
                yield SIMULATORS[name], plugin


def _read(kind: str, plugin: Plugin, robot: Robot) -> DiffDrive:
    values = plugin.values
    pairs = tuple(_pairs(kind, values))
    movable = {joint.name for joint in robot.movable_joints} if not robot.is_static else set()
    for pair in pairs:
        for joint in (pair.left, pair.right):
            if joint not in movable:
                raise _UnusableError(
                    f"its diff drive plugin names the joint `{joint}`, but the robot has no "
                    "revolute or continuous joint of that name",
                    "Write the names of the wheel joints in <left_joint> and <right_joint>.",
                )
    grip = robot.least_grip([joint for pair in pairs for joint in (pair.left, pair.right)])
    if kind == CLASSIC:
        most = _number(values, "max_wheel_acceleration", 0.0) or math.inf
        return DiffDrive(
            simulator=kind,
            pairs=pairs,
            grip=grip,
            torque=_number(values, "max_wheel_torque", TORQUE),
            rim=Bounds(braking=-most, acceleration=most),
        )
    return DiffDrive(
        simulator=kind,
        pairs=pairs,
        grip=grip,
        linear=_bounds(values, "linear"),
        angular=_bounds(values, "angular"),
    )


def _pairs(kind: str, values: Mapping[str, tuple[str, ...]]) -> Iterator[WheelPair]:
    left, right = values.get("left_joint", ()), values.get("right_joint", ())
    count = max(1, round(_number(values, "num_wheel_pairs", 1.0))) if kind == CLASSIC else len(left)
    if not left or not right or len(left) != len(right) or len(left) != count:
        raise _UnusableError(
            f"its diff drive plugin names {len(left)} left and {len(right)} right joints"
            + (f" for {count} pairs of wheels" if kind == CLASSIC else ""),
            "Write one <left_joint> and one <right_joint> for each pair of wheels"
            + (", and the number of pairs in <num_wheel_pairs>." if kind == CLASSIC else "."),
        )
    size, share = ("wheel_diameter", 0.5) if kind == CLASSIC else ("wheel_radius", 1.0)
    for index, (one, other) in enumerate(zip(left, right, strict=True)):
        # Gazebo Sim has one size for all pairs.
        at = index if kind == CLASSIC else 0
        yield WheelPair(
            left=one,
            right=other,
            separation=_size(values, "wheel_separation", SEPARATION[kind], at),
            radius=_size(values, size, RADIUS[kind] / share, at) * share,
        )


def _size(values: Mapping[str, tuple[str, ...]], key: str, default: float, at: int) -> float:
    size = _number(values, key, default, at)
    if not size > 0:
        raise _UnusableError(
            f"the <{key}> of its diff drive plugin is {size:g}", "Write a length in meters."
        )
    return size


def _number(values: Mapping[str, tuple[str, ...]], key: str, default: float, at: int = 0) -> float:
    texts = values.get(key, ())
    if at >= len(texts):
        return default
    number = leading_float(texts[at])
    if number is None or not math.isfinite(number):
        raise _UnusableError(
            f"the <{key}> of its diff drive plugin is `{texts[at][:60]}`, which is not a number",
            "Write one number with a decimal point.",
        )
    return number


def _bounds(values: Mapping[str, tuple[str, ...]], motion: str) -> Bounds:
    """What Gazebo Sim allows; a key without the kind of motion is for both."""

    def bound(side: str, what: str, default: float) -> float:
        both = _number(values, f"{side}_{what}", default)
        return _number(values, f"{side}_{motion}_{what}", both)

    return Bounds(
        slowest=bound("min", "velocity", -math.inf),
        fastest=bound("max", "velocity", math.inf),
        braking=bound("min", "acceleration", -math.inf),
        acceleration=bound("max", "acceleration", math.inf),
    )
