"""How soft contacts are in PyBullet, so that a body's weight is on all of what it stands on.

On more than three points a rigid body rests in many ways: the one that its contact solver meets
first takes the load there, and wheels beside casters carry nothing and spin. DART, Gazebo's engine,
softens every contact by a share of what a push there moves (its constraint force mixing): the load
is where it is in a body on like springs. PyBullet has the springs, for each link.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsgen.model.inertia import about_link_axes, matrix_of, moved
from wsgen.model.kinematics import link_poses
from wsgen.model.robot import Cylinder, Primitive
from wsgen.model.transform import IDENTITY, compose, rotation_of_rpy
from wsgen.simulation.surfaces import reach_down

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsgen.model.robot import Collision, Link, Robot
    from wsgen.model.transform import Pose

    Numbers = NDArray[np.float64]


# Of what a push at the contact moves. With much less, 50 iterations do not spread the load; DART
# solves exactly and has 1e-5.
SOFTNESS = 0.4
DEEPEST = 1e-4  # m, that a body sinks in by its own weight; for large steps it is less soft
GRAVITY = 9.8  # m/s²
SAME_HEIGHT = 1e-4  # m
# That DART has of a cylinder for one of PyBullet's: a wheel touches the ground at both its edges.
# One that spins has one in PyBullet, one that stands up to three.
WHEEL_CONTACTS = 2.0
NEGLIGIBLE = 1e-9  # of the largest moment; of point masses


def contact_masses(parts: Robot) -> dict[str, float]:
    """What resists a push from below where each link touches level ground, by its name, kg.

    The tree is taken for one rigid body with all joints at zero. Links without collisions are left
    out. One without joints that move has none: it goes the same way wherever its weight is, and a
    light thing must not be soft for what is heavy.
    """
    if not parts.movable_joints:
        return {}
    poses = link_poses(parts, IDENTITY)
    massive = [
        (link.inertial, compose(poses[link.name], link.inertial.pose_in_link).xyz, poses[link.name])
        for link in parts.links
        if link.inertial is not None and link.inertial.mass > 0
    ]
    mass = sum(inertial.mass for inertial, _, _ in massive)
    if not mass:
        return {}
    center: Numbers = np.array([inertial.mass * np.array(at) for inertial, at, _ in massive])
    center = center.sum(axis=0) / mass
    inertia = np.zeros((3, 3))
    for inertial, at, pose in massive:
        turn = np.array(rotation_of_rpy(pose.rpy))
        inertia += turn @ np.array(matrix_of(about_link_axes(inertial))) @ turn.T
        x, y, z = np.array(at) - center
        inertia += np.array(matrix_of(moved((0.0,) * 6, inertial.mass, (x, y, z))))
    inverse = np.linalg.pinv(inertia, rcond=NEGLIGIBLE, hermitian=True).astype(np.float64)
    return {
        link.name: min(
            (WHEEL_CONTACTS if isinstance(shape.geometry, Cylinder) else 1.0)
            / _mobility(mass, inverse, np.subtract(at, center))
            for at, shape in feet
        )
        for link in parts.links
        if (feet := _feet(link, poses[link.name]))
    }


def _mobility(mass: float, inverse: Numbers, at: Numbers) -> float:
    """How fast a point gets by a push of 1 N s upwards, m/s."""
    lever = np.array((at[1], -at[0], 0.0))  # at × z
    return 1.0 / mass + max(0.0, float(lever @ inverse @ lever))  # some inertias no body has


def _feet(link: Link, pose: Pose) -> list[tuple[Numbers, Collision]]:
    """The lowest shapes of a link, and where they are."""
    shapes = []
    for collision in link.collisions:
        at = compose(pose, collision.pose_in_link)
        shape = collision.geometry
        reach = reach_down(shape, at) if isinstance(shape, Primitive) else 0.0
        shapes.append((at.xyz[2] - reach, np.array(at.xyz), collision))
    lowest = min((height for height, _, _ in shapes), default=math.inf)
    return [(at, shape) for height, at, shape in shapes if height < lowest + SAME_HEIGHT]


def spring_of(mass: float, share: float, step_seconds: float) -> tuple[float, float]:
    """Stiffness (N/m) and damping (N s/m) of contacts where that is what resists a push (kg).

    Such a share of an overlap goes in one step.
    """
    softness = min(SOFTNESS, share * DEEPEST / (GRAVITY * step_seconds**2))
    rigidity = mass / (softness * step_seconds)  # N s/m
    return share * rigidity / step_seconds, (1.0 - share) * rigidity
