"""The tree of links and joints: separate parts of it, and which joints gravity can move.

A lumped robot is one tree, or several where parts are loose. Gravity moves arms and legs, not
wheels.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.model.robot import JointType, by_parent
from wsgen.model.transform import (
    IDENTITY,
    UNIT,
    Pose,
    compose,
    invert,
    multiply,
    rotate,
    rotation_of_rpy,
)

if TYPE_CHECKING:
    from wsgen.model.robot import Inertial, Joint, Robot
    from wsgen.model.transform import Matrix


def split_trees(robot: Robot) -> list[tuple[Robot, Pose]]:
    """Every tree as a separate robot, with the pose of its root in the frame of `robot.root`.

    The poses are those with all joints at zero. The tree of the robot's own root comes first; links
    and joints keep their order.
    """
    if not robot.loose:
        return [(robot, IDENTITY)]
    poses, tree_of = _places(robot)
    trees = []
    for root in (robot.root, *(joint.child for joint in robot.loose)):
        inside = {link for link, tree in tree_of.items() if tree == root}
        tree = replace(
            robot,
            root=root,
            links=tuple(link for link in robot.links if link.name in inside),
            joints=tuple(joint for joint in robot.joints if joint.child in inside),
            loose=(),
            fixed_to_world=robot.fixed_to_world and root == robot.root,
        )
        if tree.links:
            trees.append((tree, poses[root]))
    return trees


def link_poses(robot: Robot, root_pose: Pose) -> dict[str, Pose]:
    """The pose of every link with all joints at zero, by name; that of the root is given."""
    poses, _ = _places(robot)
    return {name: compose(root_pose, pose) for name, pose in poses.items()}


def fixed_frames(written: Robot, lumped: Robot) -> dict[str, tuple[str, Pose]]:
    """For each link as written that is left, the lumped link that carries it, and its pose in that.

    Links that Gazebo drops have none.
    """
    beside: dict[str, list[tuple[str, Pose]]] = {}
    for joint in written.joints:
        if not joint.is_movable:
            beside.setdefault(joint.parent, []).append((joint.child, joint.pose_in_parent))
            beside.setdefault(joint.child, []).append((joint.parent, invert(joint.pose_in_parent)))
    carriers = {link.name: (link.name, IDENTITY) for link in lumped.links}
    queue = list(carriers)
    for name in queue:
        carrier, pose = carriers[name]
        for other, pose_of_other in beside.get(name, ()):
            if other not in carriers:
                carriers[other] = carrier, compose(pose, pose_of_other)
                queue.append(other)
    return carriers


def _places(robot: Robot) -> tuple[dict[str, Pose], dict[str, str]]:
    """The pose of every link in the frame of the robot's root, and the root of its tree."""
    below: dict[str, list[tuple[str, Pose, bool]]] = {}
    for joints, is_loose in ((robot.joints, False), (robot.loose, True)):
        for joint in joints:
            below.setdefault(joint.parent, []).append((joint.child, joint.pose_in_parent, is_loose))
    poses, tree_of, queue = {robot.root: IDENTITY}, {robot.root: robot.root}, [robot.root]
    for parent in queue:
        for child, pose, is_loose in below.get(parent, ()):
            poses[child] = compose(poses[parent], pose)
            tree_of[child] = child if is_loose else tree_of[parent]
            queue.append(child)
    return poses, tree_of


ENDLESS = 8 * math.pi  # rad between limits; some write them for wheels
UPRIGHT = math.cos(math.radians(5))
ON_AXIS = 0.005  # m; a wheel's center of mass may be so far from its axle


def unactuated_joints(robot: Robot) -> set[str]:
    """The names of the movable joints that are neither axles of wheels nor upright swivels.

    A wheel turns without end, carries nothing that moves, and its center of mass is on its axle; so
    does a ball in its socket, about its center. A
    swivel, as of a caster, turns about the vertical of the robot with all joints at zero.
    """
    carriers = {joint.parent for joint in robot.joints}
    inertials = {link.name: link.inertial for link in robot.links}
    rotations = _rotations(robot)
    return {
        joint.name
        for joint in robot.movable_joints
        if not _is_axle(joint, inertials[joint.child], is_leaf=joint.child not in carriers)
        and not _is_swivel(joint, rotations.get(joint.child, UNIT))
    }


def _is_swivel(joint: Joint, rotation: Matrix) -> bool:
    if joint.type in {JointType.PRISMATIC, JointType.BALL}:
        return False
    return abs(rotate(rotation, joint.axis_in_joint)[2]) > UPRIGHT


def _rotations(robot: Robot) -> dict[str, Matrix]:
    """The rotation of every link in the root's frame, with all joints at zero."""
    below = by_parent(robot.joints)
    rotations, queue = {robot.root: UNIT}, [robot.root]
    for parent in queue:
        for joint in below.get(parent, ()):
            turned = rotation_of_rpy(joint.pose_in_parent.rpy)
            rotations[joint.child] = multiply(rotations[parent], turned)
            queue.append(joint.child)
    return rotations


def _is_axle(joint: Joint, inertial: Inertial | None, *, is_leaf: bool) -> bool:
    limit = joint.limit
    is_endless = joint.type in {JointType.CONTINUOUS, JointType.BALL} or (
        joint.type is JointType.REVOLUTE
        and limit is not None
        and limit.upper - limit.lower > ENDLESS
    )
    if not is_endless or not is_leaf or inertial is None:
        return False
    (x, y, z), (ax, ay, az) = inertial.pose_in_link.xyz, joint.axis_in_joint
    if joint.type is JointType.BALL:
        return math.hypot(x, y, z) <= ON_AXIS
    off_axis = math.hypot(y * az - z * ay, z * ax - x * az, x * ay - y * ax)
    return off_axis <= ON_AXIS
