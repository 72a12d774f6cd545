"""The trees that a lumped robot consists of: one, or more where parts are loose."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.model.pose import IDENTITY, Pose
from wsgen.model.transform import compose

if TYPE_CHECKING:
    from wsgen.model.robot import Robot


def split_trees(robot: Robot) -> list[tuple[Robot, Pose]]:
    """Every tree as a robot of its own, with the pose of its root in the frame of `robot.root`.

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
