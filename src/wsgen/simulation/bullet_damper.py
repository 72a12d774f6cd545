"""Dampers and springs that are too stiff for PyBullet.

PyBullet applies damping from the speed before a step. Where that takes away more than all of the
speed in one step, the joint is thrown back faster than it came, and the robot explodes; of the
public robots one in ten has such joints (TIAGo, TALOS, iCub, xArm). Here a motor that wants to
stand still, but is no stronger than the damper, does the same and can only take energy away.

The torque of a spring is applied in the same way, from the position before a step. A spring that
swings faster than steps can follow is made as soft as they can: where it comes to rest is the same
to the eye.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from wsgen.model.inertia import about_link_axes, moved
from wsgen.model.robot import JointType

if TYPE_CHECKING:
    from collections.abc import Collection

    from wsgen.model.robot import Inertial, Joint, Robot
    from wsgen.simulation.bullet_client import Client

STIFF = 0.5  # of the speed, in one step; PyBullet's own damping is exact far below
STRIDE = 5  # steps from one setting of the motors to the next
RESOLVED = 0.25  # of the resistance over the squared step; beyond 4 a swing grows
SMOOTHING = 0.2  # how much of a new speed is taken over; the motor stops the joint now and then


@dataclass
class Dampers:
    """The stiffly damped joints of one body."""

    indices: list[int]  # PyBullet's, of the joints
    damping: list[float]  # N m s/rad or N s/m
    friction: list[float]  # N m or N
    speeds: list[float]  # rad/s or m/s, smoothed

    def without(self, driven: Collection[int]) -> Dampers:
        """Those of the other joints: one that has a motor cannot have a second one."""
        left = [place for place, index in enumerate(self.indices) if index not in driven]
        return Dampers(
            indices=[self.indices[place] for place in left],
            damping=[self.damping[place] for place in left],
            friction=[self.friction[place] for place in left],
            speeds=[self.speeds[place] for place in left],
        )

    def apply(self, client: Client, body: int) -> None:
        """Make the motors as strong as dampers and friction are at this speed."""
        states = client.getJointStates(body, self.indices)
        self.speeds = [
            before + SMOOTHING * (abs(state[1]) - before)
            for before, state in zip(self.speeds, states, strict=True)
        ]
        client.setJointMotorControlArray(
            body,
            self.indices,
            client.VELOCITY_CONTROL,
            targetVelocities=[0.0] * len(self.indices),
            forces=[
                friction + damping * speed
                for friction, damping, speed in zip(
                    self.friction, self.damping, self.speeds, strict=True
                )
            ],
        )


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


def undamped(joints: tuple[Joint, ...], names: set[str]) -> tuple[Joint, ...]:
    """The joints without the damping of those that are named."""
    return tuple(replace(joint, damping=0.0) if joint.name in names else joint for joint in joints)


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
