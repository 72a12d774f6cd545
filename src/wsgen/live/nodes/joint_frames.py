"""Where a joint puts its child: the transforms that robot_state_publisher sends.

The description is URDF, or SDF of one model, which a ROS with Gazebo Sim reads by sdformat_urdf
(ros/sdformat_urdf, src/sdformat_urdf.cpp): the frame of a link is that of the joint above it.

A rotation is a unit quaternion x, y, z, w.
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
from wsgen.model.transform import (
    quaternion_of_rpy,
    rotate,
    rotation_of_rpy,
)
from wsgen.text.xmltree import Malformed, parse

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

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
