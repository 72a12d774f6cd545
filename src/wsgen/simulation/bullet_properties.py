"""Gazebo's properties for the links and joints of a body in PyBullet."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.model.robot import Capsule, Cylinder, Mesh, Sphere
from wsgen.simulation.engine import GROUND_FRICTION
from wsgen.simulation.pairs import may_touch

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.model.robot import Link, Robot
    from wsgen.simulation.bullet_client import Client

# Gazebo damps links only where told so, and only Gazebo Classic does; PyBullet damps every link by
# 0.04 a second.
LINK_DAMPING = 0.0

# Gazebo has no speed limit for passive joints; PyBullet stops them at 100 rad/s.
HIGHEST_JOINT_SPEED = 1e6

# Contact normals of round shapes are off by about 4e-4, at random: on even ground wheels without
# motors start to roll at 4 mm/s², where DART's stand. A rolling resistance as of a slope of one in
# a thousand keeps them, and slows what rolls by no more than 1 cm/s².
ROLLING_RESISTANCE = 1e-3  # times the radius: PyBullet's rolling friction is a length

ROOT = -1  # PyBullet's index of a body's root


def set_links(client: Client, body: int, parts: Robot, index_of: Mapping[str, int]) -> None:
    """Give every part its friction, and take PyBullet's damping from all."""
    # In a call of its own: with one of these, PyBullet takes all the rest of a call for the root's,
    # whichever link is named.
    client.changeDynamics(
        body,
        ROOT,
        linearDamping=LINK_DAMPING,
        angularDamping=LINK_DAMPING,
        maxJointVelocity=HIGHEST_JOINT_SPEED,
    )
    for part in parts.links:
        index = index_of[part.name]
        frictions = (shape.surface.mu1 for shape in part.collisions)
        client.changeDynamics(
            body,
            index,
            lateralFriction=min((GROUND_FRICTION, *frictions)),
            rollingFriction=0.0
            if parts.is_static
            else ROLLING_RESISTANCE * _radius(client, body, index, part),
        )


def _radius(client: Client, body: int, index: int, part: Link) -> float:
    """The largest radius of what can roll, m; a mesh may be a wheel."""
    radii = [
        shape.geometry.radius
        for shape in part.collisions
        if isinstance(shape.geometry, Cylinder | Sphere | Capsule)
    ]
    if any(isinstance(shape.geometry, Mesh) for shape in part.collisions):
        low, high = client.getAABB(body, index)
        # The edges of the box around a wheel: its width, and twice its radius.
        radii.append(sorted(b - a for a, b in zip(low, high, strict=True))[1] / 2)
    return max(radii, default=0.0)


def release_joints(client: Client, body: int, tree: Robot, movable: Mapping[str, int]) -> None:
    """Take the motors that PyBullet puts into all joints to hold them: only friction may."""
    for joint in tree.joints:
        if joint.name in movable:
            client.setJointMotorControl2(
                body, movable[joint.name], client.VELOCITY_CONTROL, force=joint.friction
            )


def keep_apart(
    client: Client, body: int, tree: Robot, index_of: Mapping[str, int], owner: Mapping[str, str]
) -> None:
    """Let only such links touch each other as Gazebo was told to let touch."""
    touching = may_touch(tree)
    parts = list(index_of.items())
    for place, (name, index) in enumerate(parts):
        for other_name, other_index in parts[:place]:
            touches = frozenset((owner[name], owner[other_name])) in touching
            client.setCollisionFilterPair(body, body, index, other_index, int(touches))
