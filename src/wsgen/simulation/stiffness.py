"""How stiff joints are for the steps of an engine that computes forces before a step.

Such a force is that of the position before it. A spring that swings faster than steps can follow is
made as soft as they can: where it comes to rest is the same to the eye.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.model.inertia import about_link_axes, moved
from wsgen.model.robot import JointType

if TYPE_CHECKING:
    from wsgen.model.robot import Inertial, Joint, Robot


STIFF = 0.5  # of the speed, in one step; PyBullet's own damping is exact far below
RESOLVED = 0.25  # of the resistance over the squared step; beyond 4 a swing grows
STRONGEST = 1e7  # N m or N; nothing on a robot resists it, and an engine can calculate with it


def stiffness_to_simulate(joint: Joint, tree: Robot, step_seconds: float) -> float:
    """The stiffness of a joint's spring, or what the step can follow (N m/rad or N/m)."""
    most = RESOLVED * _least_resistance(joint, tree) / step_seconds**2
    return min(joint.spring_stiffness, most)


def is_stiff(joint: Joint, tree: Robot, step_seconds: float) -> bool:
    """Whether the damper stops the lighter side of the joint within about a step."""
    if not (joint.damping and joint.is_movable):
        return False
    return joint.damping * step_seconds > STIFF * _least_resistance(joint, tree)


def _least_resistance(joint: Joint, tree: Robot) -> float:
    """That of the side of the joint that is easier to move, kg m² or kg."""
    resistances = [
        _resistance(inertial, joint)
        for inertial in (tree.link(joint.child).inertial, tree.link(joint.parent).inertial)
        if inertial is not None and inertial.mass > 0
    ]
    return min(resistances, default=0.0)


def _resistance(inertial: Inertial, joint: Joint) -> float:
    """How hard a body is to move by a joint at its frame's origin: kg m² or kg.

    Of the parent, which hangs on the joint by another point, it is an estimate.
    """
    if joint.type is JointType.PRISMATIC:
        return inertial.mass
    x, y, z = joint.axis_in_joint
    xx, xy, xz, yy, yz, zz = moved(
        about_link_axes(inertial), inertial.mass, inertial.pose_in_link.xyz
    )
    return xx * x * x + yy * y * y + zz * z * z + 2 * (xy * x * y + xz * x * z + yz * y * z)
