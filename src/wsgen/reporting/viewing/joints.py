"""Where the joints of a robot are: a slider for each, and what follows from their positions.

Angles are in rad, distances in m; a slider shows degrees or m.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.model.robot import JointType
from wsgen.model.transform import IDENTITY, quaternion_of_rpy, rotate, rotation_of_rpy
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.model.robot import Joint, Robot
    from wsgen.model.transform import Vector

    Quaternion = tuple[float, float, float, float]  # w, x, y, z


TURNING = frozenset((JointType.REVOLUTE, JointType.CONTINUOUS))
ENDLESS = 8 * math.pi  # rad between limits; some write them for wheels
FARTHEST = 10.0  # m either way, of a sliding joint whose limits are no limits
STEPS = 1000  # that a slider has at least
FINEST = 1e-4  # m
DEGREES = 0.1
SLACK = 1e-6  # steps that rounding may add to a limit
DIGITS = 6  # after the point
MOST_MIMICS = 100  # of a chain of joints that mimic each other


@dataclass(frozen=True, kw_only=True)
class Slider:
    """The range of a joint that a person may move."""

    joint: str
    lower: float
    upper: float
    start: float  # where `joint_state_publisher_gui` has it, too: 0, or the middle of its limits
    is_angle: bool
    is_endless: bool = False  # a continuous joint, or one whose limits are many turns apart
    followers: tuple[str, ...] = ()  # joints that mimic it

    @property
    def unit(self) -> str:
        """What the slider counts in."""
        return "°" if self.is_angle else "m"

    def shown(self, position: float) -> float:
        """A position in the unit of the slider."""
        return math.degrees(position) if self.is_angle else position

    def position(self, shown: float) -> float:
        """The position that a slider shows; within the limits, which the slider has rounded."""
        position = math.radians(shown) if self.is_angle else shown
        return min(max(position, self.lower), self.upper)

    @property
    def step(self) -> float:
        """The smallest change, in the unit of the slider."""
        if self.is_angle:
            return DEGREES
        exponent = math.floor(math.log10(max(self.upper - self.lower, FINEST) / STEPS))
        return float(max(FINEST, 10.0**exponent))

    @property
    def range_shown(self) -> tuple[float, float]:
        """The limits in the unit of the slider, rounded outwards to whole steps."""
        lower, upper = self.shown(self.lower), self.shown(self.upper)
        return (
            round(math.floor(lower / self.step + SLACK) * self.step, DIGITS),
            round(math.ceil(upper / self.step - SLACK) * self.step, DIGITS),
        )

    @property
    def middle(self) -> float:
        """The middle of its range."""
        return 0.0 if self.is_endless else (self.lower + self.upper) / 2


def sliders(robot: Robot) -> tuple[Slider, ...]:
    """A slider for each joint that turns or slides and mimics no other one of the robot."""
    names = {joint.name for joint in robot.joints}
    leaders = {
        joint.name: joint.mimic.joint
        for joint in robot.joints
        if joint.mimic is not None and joint.mimic.joint in names
    }
    return tuple(
        _slider(joint, tuple(name for name, leader in leaders.items() if leader == joint.name))
        for joint in robot.joints
        if joint.type in {*TURNING, JointType.PRISMATIC} and joint.name not in leaders
    )


def _slider(joint: Joint, followers: tuple[str, ...]) -> Slider:
    is_angle = joint.type in TURNING
    limit = None if joint.type is JointType.CONTINUOUS else joint.limit
    lower, upper = (limit.lower, limit.upper) if limit is not None else (-math.inf, math.inf)
    if not (math.isfinite(lower) and math.isfinite(upper)) and limit is not None:
        lower = lower if math.isfinite(lower) else -math.inf
        upper = upper if math.isfinite(upper) else math.inf
    lower, upper = min(lower, upper), max(lower, upper)
    room = ENDLESS if is_angle else 2 * FARTHEST
    is_endless = upper - lower > room
    if is_endless:
        most = math.pi if is_angle else FARTHEST
        lower, upper = max(lower, -most), min(upper, most)
        lower, upper = min(lower, upper), max(lower, upper)
    return Slider(
        joint=joint.name,
        lower=lower,
        upper=upper,
        start=0.0 if lower <= 0 <= upper else (lower + upper) / 2,
        is_angle=is_angle,
        is_endless=is_endless,
        followers=followers,
    )


def all_positions(robot: Robot, chosen: Mapping[str, float]) -> dict[str, float]:
    """The positions of all joints, those that mimic others included; 0 where none is chosen.

    Joints that mimic each other in a circle stay at 0.
    """
    joints = {joint.name: joint for joint in robot.joints}
    positions: dict[str, float] = {}
    for name in joints:
        factor, offset, leader = 1.0, 0.0, name
        for _ in range(MOST_MIMICS):
            mimic = joints[leader].mimic
            if mimic is None or mimic.joint not in joints:
                positions[name] = factor * chosen.get(leader, 0.0) + offset
                break
            offset += factor * mimic.offset
            factor *= mimic.multiplier
            leader = mimic.joint
        else:
            positions[name] = 0.0
        if not math.isfinite(positions[name]):
            positions[name] = 0.0
    return positions


def place_in_parent(joint: Joint, position: float) -> tuple[Vector, Quaternion]:
    """Where the child of a joint is, seen from the parent: its origin (m), and its quaternion."""
    pose = joint.pose_in_parent
    if not pose.is_finite:
        return IDENTITY.xyz, (1.0, 0.0, 0.0, 0.0)
    x, y, z, w = quaternion_of_rpy(pose.rpy)
    turned = (w, x, y, z)
    axis = unit_axis(joint)
    if axis is None or position == 0:
        return pose.xyz, turned
    if joint.type in TURNING:
        sine = math.sin(position / 2)
        about = (math.cos(position / 2), *(sine * part for part in axis))
        return pose.xyz, _product(turned, about)
    if joint.type is JointType.PRISMATIC:
        along = rotate(rotation_of_rpy(pose.rpy), axis)
        moved = tuple(a + position * b for a, b in zip(pose.xyz, along, strict=True))
        return (moved[0], moved[1], moved[2]), turned
    return pose.xyz, turned


def unit_axis(joint: Joint) -> Vector | None:
    """The axis in the frame of the child, of length 1; None where it has none."""
    x, y, z = joint.axis_in_joint
    length = math.hypot(x, y, z)
    if not math.isfinite(length) or length == 0:
        return None
    return (x / length, y / length, z / length)


def _product(one: Quaternion, other: tuple[float, ...]) -> Quaternion:
    """The rotation by `other`, then by `one`."""
    (a, b, c, d), (e, f, g, h) = one, other
    return (
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    )
