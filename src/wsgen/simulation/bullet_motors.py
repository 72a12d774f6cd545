"""Motors in the joints of a body in PyBullet."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsgen.model.robot import Joint
    from wsgen.simulation.bullet_client import Client
    from wsgen.simulation.engine import Motor

# PyBullet makes nonsense of an infinite force; nothing on a robot resists this one.
STRONGEST = 1e7  # N m or N


def set_motor(client: Client, body: int, index: int, joint: Joint, motor: Motor) -> None:
    """Have a motor keep the joint's speed.

    A joint has one motor in PyBullet, which until now was its friction: that is taken from the
    motor's strength. `joint.damping` is what PyBullet does not do by itself.
    """
    left = min(motor.effort, STRONGEST) - joint.friction
    speed = motor.speed if left > 0 else 0.0
    if joint.damping and left > 0:  # no faster than damping lets it
        highest = left / joint.damping
        speed = min(highest, max(-highest, speed))
    client.setJointMotorControl2(
        body, index, client.VELOCITY_CONTROL, targetVelocity=speed, force=abs(left)
    )
