"""Where a joint puts its child, and the joint states that are made up; without ROS.

Transforms are those that robot_state_publisher sends. The description is URDF, or SDF of one model,
which a ROS with Gazebo Sim reads by sdformat_urdf (ros/sdformat_urdf, src/sdformat_urdf.cpp): the
frame of a link is that of the joint above it. A rotation is a unit quaternion x, y, z, w.

States are made up by the rules of joint_state_publisher 2 (ros/joint_state_publisher,
joint_state_publisher.py).
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.descriptions.rules import MALFORMED_XML, NO_LINK, NOT_A_NUMBER, UNKNOWN_JOINT_TYPE
from wsgen.descriptions.urdf.joints import INCOMPLETE_JOINT, MISSING_LIMIT
from wsgen.descriptions.urdf.reader import (
    DUPLICATE_JOINT,
    DUPLICATE_LINK,
    NOT_A_ROBOT,
    UNKNOWN_URDF_VERSION,
    UNNAMED_ROBOT,
    read_urdf,
)
from wsgen.diagnostics import Severity
from wsgen.model.robot import JointType
from wsgen.model.transform import quaternion_of_rpy, rotate, rotation_of_rpy
from wsgen.text.values import dataclass
from wsgen.text.xmltree import Malformed, children, parse

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Joint, Mimic, Robot
    from wsgen.model.transform import Vector


Quaternion = tuple[float, float, float, float]

# What urdfdom refuses; Gazebo refuses more, which does not matter to robot_state_publisher.
REFUSED = frozenset(
    rule.code
    for rule in (
        MALFORMED_XML,
        NOT_A_ROBOT,
        UNNAMED_ROBOT,
        UNKNOWN_URDF_VERSION,
        NO_LINK,
        DUPLICATE_LINK,
        DUPLICATE_JOINT,
        INCOMPLETE_JOINT,
        UNKNOWN_JOINT_TYPE,
        MISSING_LIMIT,
        NOT_A_NUMBER,
    )
)


class RefusedDescriptionError(Exception):
    """A text that no robot can be read from, as urdfdom sees it; the message says why."""


class JointFrame(NamedTuple):
    """A joint, ready to say where its child is."""

    parent: str
    child: str
    xyz: Vector  # m, of the child in the parent at position 0
    xyzw: Quaternion
    axis_in_parent: Vector  # unit
    axis_in_child: Vector  # unit
    slides: bool  # along the axis; otherwise it turns about it

    def at(self, position: float) -> tuple[Vector, Quaternion]:
        """The child in its parent, m and unit quaternion, at a position in m or rad."""
        if self.slides:
            (x, y, z), (ax, ay, az) = self.xyz, self.axis_in_parent
            return (x + position * ax, y + position * ay, z + position * az), self.xyzw
        sine, cosine = math.sin(position / 2), math.cos(position / 2)
        ax, ay, az = self.axis_in_child
        bx, by, bz, bw = sine * ax, sine * ay, sine * az, cosine
        x, y, z, w = self.xyzw
        return self.xyz, (
            w * bx + x * bw + y * bz - z * by,
            w * by - x * bz + y * bw + z * bx,
            w * bz + x * by - y * bx + z * bw,
            w * bw - x * bx - y * by - z * bz,
        )


class JointFrames(NamedTuple):
    """The joints of a robot as written, as robot_state_publisher and KDL see them."""

    moving: Mapping[str, JointFrame]  # by joint name: revolute, continuous and prismatic ones
    fixed: tuple[JointFrame, ...]  # planar ones among them, as in KDL; floating ones are left out
    mimics: Mapping[str, Mimic]

    def positions(self, names: Iterable[str], values: Iterable[float]) -> dict[str, float]:
        """The positions of joints that were sent, and of those that mimic one of them."""
        found: dict[str, float] = {}
        for name, value in zip(names, values, strict=True):
            found.setdefault(name, value)
        for name, mimic in self.mimics.items():
            if mimic.joint in found:
                found.setdefault(name, found[mimic.joint] * mimic.multiplier + mimic.offset)
        return found


def read_joint_frames(text: str) -> tuple[Robot, JointFrames]:
    """The robot of a URDF or SDF, and its joints.

    Raises:
        RefusedDescriptionError: urdfdom, or sdformat_urdf, refuses the text.
    """
    robot = _of_sdf(text) if is_sdf(text) else _of_urdf(text)
    moves = (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC)
    stays = (JointType.FIXED, JointType.PLANAR)
    return robot, JointFrames(
        moving={joint.name: joint_frame(joint) for joint in robot.joints if joint.type in moves},
        fixed=tuple(joint_frame(joint) for joint in robot.joints if joint.type in stays),
        mimics={joint.name: joint.mimic for joint in robot.joints if joint.mimic is not None},
    )


def is_sdf(text: str) -> bool:
    """Whether a description is SDF, as sdformat_urdf and joint_state_publisher ask."""
    root = parse(text)
    return not isinstance(root, Malformed) and root.tag == "sdf"


def _of_urdf(text: str) -> Robot:
    robot, diagnostics = read_urdf(text, file=None)
    errors = [
        found
        for found in diagnostics
        if found.severity is Severity.ERROR and (robot is None or found.code in REFUSED)
    ]
    if robot is None or errors:
        raise RefusedDescriptionError("\n".join(map(_line, errors)) or "It describes no robot.")
    return robot


def read_sdf_robot(text: str) -> tuple[Robot | None, list[Diagnostic]]:
    """The model of an SDF, without joints of two axes, and the errors in it."""
    from wsgen.descriptions.sdf.assembly import is_cross  # noqa: PLC0415  seldom
    from wsgen.descriptions.sdf.models import read_model  # noqa: PLC0415  same

    found = read_model(text, file=None, find_model=lambda _: None)
    errors = [one for one in found.diagnostics if one.severity is Severity.ERROR]
    robot = found.models[0].robot if found.models else None
    if robot is None:
        return None, errors
    joints = [one for one in robot.joints if not (is_cross(one.parent) or is_cross(one.child))]
    return replace(robot, joints=tuple(joints)), errors


def _of_sdf(text: str) -> Robot:
    """The robot, unless sdformat_urdf refuses it."""
    robot, errors = read_sdf_robot(text)
    if robot is None or errors:
        raise RefusedDescriptionError("\n".join(map(_line, errors)) or "It describes no robot.")
    problem = ""
    if _is_posed(text):
        problem = "<model> has a <pose>. Remove it; the spawner places the robot."
    elif robot.fixed_to_world:
        problem = "A joint has the parent `world`. Give the robot a first link that stands for it."
    elif robot.loose:
        names = ", ".join(f"`{joint.child}`" for joint in robot.loose)
        problem = f"The links do not form a tree. Join {names} to it by joints."
    if problem:
        raise RefusedDescriptionError(f"sdformat_urdf refuses the model: {problem}")
    return robot


def _is_posed(text: str) -> bool:
    root = parse(text)
    pose = None if isinstance(root, Malformed) else root.find("model/pose")
    if pose is None:
        return False
    return bool(pose.get("relative_to")) or any(
        number.strip("+-0.") for number in (pose.text or "").split()
    )


def joint_frame(joint: Joint) -> JointFrame:
    """A joint, ready to say where its child is."""
    pose, axis = joint.pose_in_parent, joint.axis_in_joint
    return JointFrame(
        parent=joint.parent,
        child=joint.child,
        xyz=pose.xyz,
        xyzw=quaternion_of_rpy(pose.rpy),
        axis_in_parent=rotate(rotation_of_rpy(pose.rpy), axis),
        axis_in_child=axis,
        slides=joint.type is JointType.PRISMATIC,
    )


def _line(found: Diagnostic) -> str:
    place = "" if found.line is None else f"line {found.line}: "
    return f"{place}{found.message} {found.hint or ''}".rstrip()


LEFT_OUT = frozenset((JointType.FIXED, JointType.FLOATING, JointType.PLANAR))


class DependenceError(Exception):
    """Joints depend on each other in a circle, or on one that is not published."""


class Dependence(NamedTuple):
    """A joint's position = factor × that of its parent + offset."""

    parent: str
    factor: float = 1.0
    offset: float = 0.0  # rad or m


class Settings(NamedTuple):
    """The parameters of the node."""

    zeros: Mapping[str, float] = {}  # rad or m, by joint
    dependences: Mapping[str, Dependence] = {}  # by joint
    use_mimic_tags: bool = True
    use_smallest_limits: bool = True
    publish_positions: bool = True
    publish_velocities: bool = False
    publish_efforts: bool = False


class States(NamedTuple):
    """A joint state: what is not published is empty."""

    names: list[str]
    positions: list[float]
    velocities: list[float]
    efforts: list[float]


@dataclass
class FreeJoint:
    """A joint with a position of its own."""

    lower: float
    upper: float
    position: float | None = None
    velocity: float | None = None
    effort: float | None = None
    turns_on: bool = False  # without end
    is_forward: bool = True


class PublishedJoints:
    """The joints of a robot and where they are said to be."""

    def __init__(self, settings: Settings, warn: Callable[[str], None]) -> None:
        self._settings = settings
        self._warn = warn
        self._names: list[str] = []  # in the order of the description
        self._free: dict[str, FreeJoint] = {}
        self._dependent: dict[str, Dependence] = dict(settings.dependences)

    def configure(self, text: str) -> None:
        """Take the joints of a URDF or SDF; what is none is refused, and the joints stay.

        Raises:
            DependenceError: They depend on each other in a circle, or on one that is not there.
        """
        robot = (read_sdf_robot(text) if is_sdf(text) else read_urdf(text, file=None))[0]
        if robot is None:
            self._warn("Invalid robot_description given, ignoring")
            return
        self._names, self._free = [], {}
        self._dependent = dict(self._settings.dependences)
        soft = soft_limits(text) if self._settings.use_smallest_limits else {}
        for joint in robot.joints:
            if joint.type not in LEFT_OUT:
                self._add(joint, soft.get(joint.name, (-math.inf, math.inf)))
        for name in self._names:
            self._resolve(name)

    def take(
        self,
        names: Sequence[str],
        positions: Sequence[float],
        velocities: Sequence[float],
        efforts: Sequence[float],
    ) -> None:
        """Joint states of a source; a sequence may be empty."""
        for index, name in enumerate(names):
            joint = self._free.get(name)
            if joint is None:
                continue
            if index < len(positions):
                joint.position = positions[index]
            if index < len(velocities):
                joint.velocity = velocities[index]
            if index < len(efforts):
                joint.effort = efforts[index]

    def move(self, delta: float) -> None:
        """Move each joint by that (rad or m), back and forth between its limits."""
        for joint in self._free.values():
            if joint.position is None:
                continue
            joint.position += delta if joint.is_forward else -delta
            if joint.position > joint.upper:
                joint.position = joint.lower if joint.turns_on else joint.upper
                joint.is_forward = joint.turns_on
            elif joint.position < joint.lower:
                joint.position, joint.is_forward = joint.lower, True

    def states(self) -> States:
        """What is to be published; without names where nothing is known."""
        resolved = [self._resolve(name) for name in self._names]
        free = self._free.values()
        has_positions = bool(self._dependent) or any(j.position is not None for j in free)
        has_velocities = any(j.velocity is not None for j in free)
        has_efforts = any(j.effort is not None for j in free)
        return States(
            names=list(self._names),
            positions=[
                0.0 if joint.position is None else joint.position * factor + offset
                for joint, factor, offset in resolved
            ]
            if has_positions
            else [],
            velocities=[(joint.velocity or 0.0) * factor for joint, factor, _ in resolved]
            if has_velocities
            else [],
            efforts=[joint.effort or 0.0 for joint, _, _ in resolved] if has_efforts else [],
        )

    def _add(self, joint: Joint, soft: tuple[float, float]) -> None:
        if joint.type is JointType.CONTINUOUS:
            lower, upper = -math.pi, math.pi
        elif joint.limit is None:
            self._warn(f"{joint.name} is not fixed, nor continuous, but limits are not specified!")
            return
        else:
            lower, upper = joint.limit.lower, joint.limit.upper
        lower, upper = max(lower, soft[0]), min(upper, soft[1])
        settings, name = self._settings, joint.name
        self._names.append(name)
        if settings.use_mimic_tags and joint.mimic is not None:
            mimic = joint.mimic
            self._dependent[name] = Dependence(mimic.joint, mimic.multiplier, mimic.offset)
        elif name not in self._dependent:
            zero = settings.zeros.get(name, 0.0 if lower <= 0 <= upper else (lower + upper) / 2)
            self._free[name] = FreeJoint(
                lower=lower,
                upper=upper,
                position=zero if settings.publish_positions else None,
                velocity=0.0 if settings.publish_velocities else None,
                effort=0.0 if settings.publish_efforts else None,
                turns_on=joint.type is JointType.CONTINUOUS,
            )

    def _resolve(self, name: str) -> tuple[FreeJoint, float, float]:
        """The free joint that a joint depends on, with factor and offset."""
        chain, factor, offset = [name], 1.0, 0.0
        while name in self._dependent and name not in self._free:
            dependence = self._dependent[name]
            offset += factor * dependence.offset
            factor *= dependence.factor
            name = dependence.parent
            if name in chain:
                raise DependenceError(f"Found an infinite recursive mimic chain: {[*chain, name]}")
            chain.append(name)
        if name not in self._free:
            raise DependenceError(
                f"Joint `{chain[0]}` depends on `{name}`, which is not a joint that moves."
            )
        return self._free[name], factor, offset


def soft_limits(text: str) -> dict[str, tuple[float, float]]:
    """The limits of <safety_controller>, rad or m, by joint; infinite where none is written."""
    root = parse(text)
    if isinstance(root, Malformed):
        return {}
    found = {}
    for joint in children(root, "joint"):
        controllers = list(children(joint, "safety_controller"))
        if len(controllers) == 1:
            found[joint.get("name") or ""] = (
                _number(controllers[0].get("soft_lower_limit"), -math.inf),
                _number(controllers[0].get("soft_upper_limit"), math.inf),
            )
    return found


def read_dependences(values: Mapping[str, object]) -> dict[str, Dependence]:
    """The dependent joints of parameters `JOINT.parent`, `JOINT.factor` and `JOINT.offset`.

    Raises:
        DependenceError: A parameter has another name, or a joint has no parent.
    """
    found: dict[str, dict[str, object]] = {}
    for name, value in values.items():
        joint, _, key = name.rpartition(".")
        if not joint or "." in joint:
            raise DependenceError(f"Invalid dependent_joint name '{name}'")
        if key not in Dependence._fields:
            raise DependenceError(
                f"Invalid dependent_joint name '{key}' (allowed values are 'parent', 'factor', and "
                "'offset')"
            )
        found.setdefault(joint, {})[key] = value
    return {name: _dependence(parts) for name, parts in found.items()}


def _dependence(parts: Mapping[str, object]) -> Dependence:
    if not isinstance(parts.get("parent"), str):
        raise DependenceError("All dependent_joints must at least have a parent")
    factor, offset = parts.get("factor", 1.0), parts.get("offset", 0.0)
    if not isinstance(factor, float | int) or not isinstance(offset, float | int):
        raise DependenceError("factor and offset of dependent_joints must be numbers")
    return Dependence(str(parts["parent"]), float(factor), float(offset))


def numbers(values: Mapping[str, object], what: str) -> dict[str, float]:
    """The numbers of parameters by name.

    Raises:
        DependenceError: One is no number.
    """
    found: dict[str, float] = {}
    for name, value in values.items():
        if not isinstance(value, float | int):
            raise DependenceError(f"{what}.{name} must be a number")
        found[name] = float(value)
    return found


def _number(text: str | None, default: float) -> float:
    try:
        return default if text is None else float(text)
    except ValueError:
        return default
