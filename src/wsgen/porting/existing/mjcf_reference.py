"""Where MuJoCo has the masses of a robot in random configurations: what its URDF is compared with.

Importing it loads MuJoCo: it runs in a child.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wsgen.model.robot import JointType
from wsgen.porting.existing.comparison import CONFIGURATIONS
from wsgen.porting.existing.description import Configuration, Reference
from wsgen.simulation.mujoco_body import library as mujoco

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.model.robot import Robot

_SEED = 32
_WIDE = 3.0  # rad or m to both sides of 0, of joints without limits
_BALL = 1.2  # rad, about each axis


def refer_to(
    model: Any, robot: Robot, bodies: Mapping[str, int], joints: Mapping[str, int]
) -> Reference:
    """What MuJoCo has in random configurations; in the first one, all joints are at 0.

    Args:
        model: Of MuJoCo.
        robot: What was made of it.
        bodies: The numbers of bodies by the names of their links.
        joints: The numbers of joints likewise.
    """
    data = mujoco.MjData(model)
    random = np.random.default_rng(_SEED)
    weighing = {link: body for link, body in bodies.items() if model.body_mass[body] > 0}
    found = []
    for number in range(CONFIGURATIONS):
        positions = _place(model, data, robot, joints, random if number else None)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        turn, origin = np.eye(3), np.zeros(3)
        if robot.root in bodies:
            root = bodies[robot.root]
            turn, origin = data.xmat[root].reshape(3, 3).T, data.xpos[root]
        centers, inertias = {}, {}
        for link, body in weighing.items():
            x, y, z = map(float, turn @ (data.xipos[body] - origin))
            centers[link] = (x, y, z)
            axes = turn @ data.ximat[body].reshape(3, 3)
            moments = axes @ np.diag(model.body_inertia[body] / model.body_mass[body]) @ axes.T
            xx, xy, xz, yy, yz, zz = map(float, moments[np.triu_indices(3)])
            inertias[link] = (xx, xy, xz, yy, yz, zz)
        found.append(Configuration(positions, centers, inertias))
    mass = sum(float(model.body_mass[body]) for body in bodies.values())
    return Reference(f"MuJoCo {mujoco.__version__}", mass, tuple(found))


def _place(
    model: Any, data: Any, robot: Robot, joints: Mapping[str, int], random: Any
) -> dict[str, float]:
    """Put the joints somewhere; the positions of those that the URDF has, by name."""
    data.qpos[:] = model.qpos0
    positions: dict[str, float] = {}
    for joint in robot.joints:
        number = joints.get(joint.name)
        if number is None:
            continue
        at, is_ball = model.jnt_qposadr[number], joint.type is JointType.BALL
        wide = _BALL if is_ball else _WIDE
        low, high = (
            (-wide, wide)
            if is_ball or not joint.limit
            else (
                max(joint.limit.lower, -wide),
                min(joint.limit.upper, wide),
            )
        )
        if low >= high:
            low, high = (-wide, wide) if joint.type is JointType.CONTINUOUS else (low, low)
        if is_ball:
            quaternion = np.array([1.0, 0.0, 0.0, 0.0])
            for letter, axis in zip("xyz", np.eye(3), strict=True):
                angle = 0.0 if random is None else random.uniform(low, high)
                turned, before = np.zeros(4), quaternion.copy()
                mujoco.mju_axisAngle2Quat(turned, axis, angle)
                mujoco.mju_mulQuat(quaternion, before, turned)
                positions[f"{joint.name}_{letter}"] = float(angle)
            data.qpos[at : at + 4] = quaternion
        else:
            value = 0.0 if random is None else float(random.uniform(low, high))
            positions[joint.name] = value
            data.qpos[at] = value
    for joint in robot.joints:  # they follow others
        if joint.mimic is not None and joint.name in joints:
            value = joint.mimic.multiplier * positions.get(joint.mimic.joint, 0.0)
            data.qpos[model.jnt_qposadr[joints[joint.name]]] = value + joint.mimic.offset
    return positions
