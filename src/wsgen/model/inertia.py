"""Moments of inertia: principal moments, other axes, other points. Units kg m²."""

from __future__ import annotations

import math

from wsgen.model.robot import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    Geometry,
    Inertial,
    Link,
    Sphere,
)
from wsgen.model.transform import Matrix, Vector, multiply, rotation_of_rpy, transpose

# sdformat's MassMatrix3 allows ten times the rounding of doubles; hand-written files have fewer
# digits, and it accepts moments of exactly zero as well (a point mass).
ROUNDING = 10 * 2.220446049250313e-16

# Jacobi rotations converge quadratically: five sweeps are plenty for 3 by 3.
SWEEPS = 12
PLANES = ((0, 1), (0, 2), (1, 2))
NEGLIGIBLE = 1e-18  # of the diagonal: below the rounding of doubles

Six = tuple[float, float, float, float, float, float]  # ixx ixy ixz iyy iyz izz


def matrix_of(six: Six) -> Matrix:
    """The symmetric matrix of the six numbers of URDF."""
    xx, xy, xz, yy, yz, zz = six
    return ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))


def about_link_axes(inertial: Inertial) -> Six:
    """The inertia about the center of mass, along the axes of the link frame."""
    if inertial.pose_in_link.rpy == (0.0, 0.0, 0.0):
        return inertial.inertia
    return turned(inertial.inertia, rotation_of_rpy(inertial.pose_in_link.rpy))


def turned(six: Six, rotation: Matrix) -> Six:
    """An inertia along the axes of the frame that a rotation leads to."""
    m = multiply(multiply(rotation, matrix_of(six)), transpose(rotation))
    return (m[0][0], m[0][1], m[0][2], m[1][1], m[1][2], m[2][2])


def moved(inertia: Six, mass: float, offset: Vector) -> Six:
    """The inertia about a point `offset` away from the center of mass (parallel axis theorem)."""
    x, y, z = offset
    xx, xy, xz, yy, yz, zz = inertia
    return (
        xx + mass * (y * y + z * z),
        xy - mass * x * y,
        xz - mass * x * z,
        yy + mass * (x * x + z * z),
        yz - mass * y * z,
        zz + mass * (x * x + y * y),
    )


def principal_moments(six: Six) -> Vector:
    """The eigenvalues in rising order, to rounding (Jacobi rotations)."""
    matrix = [list(row) for row in matrix_of(six)]
    for _ in range(SWEEPS):
        if not any(matrix[row][column] for row, column in PLANES):
            break
        for row, column in PLANES:
            _rotate_away(matrix, row, column)
    low, middle, high = sorted(matrix[index][index] for index in range(3))
    return (low, middle, high)


LEAST_MOMENT = 1e-6  # of the largest one


def made_possible(six: Six) -> Six:
    """The inertia itself, or what some body has, with the same principal axes.

    All three moments are raised by the same amount, the smallest that is enough.
    """
    if is_possible(six):
        return six
    low, middle, high = principal_moments(six)
    least = LEAST_MOMENT * max(abs(low), abs(high))
    more = max(high - middle - low, -low) + least
    xx, xy, xz, yy, yz, zz = six
    return (xx + more, xy, xz, yy + more, yz, zz + more)


def _rotate_away(matrix: list[list[float]], row: int, column: int) -> None:
    """Turn the matrix about the third axis so that one element off the diagonal becomes zero."""
    off = matrix[row][column]
    if abs(off) < NEGLIGIBLE * (abs(matrix[row][row]) + abs(matrix[column][column])):
        matrix[row][column] = matrix[column][row] = 0.0
    if off == 0.0:
        return
    slope = (matrix[column][column] - matrix[row][row]) / (2 * off)
    tangent = math.copysign(1.0, slope) / (abs(slope) + math.hypot(slope, 1.0))
    cosine = 1.0 / math.hypot(tangent, 1.0)
    sine = tangent * cosine
    other = 3 - row - column
    first, second = matrix[other][row], matrix[other][column]
    matrix[other][row] = matrix[row][other] = cosine * first - sine * second
    matrix[other][column] = matrix[column][other] = sine * first + cosine * second
    matrix[row][row] -= tangent * off
    matrix[column][column] += tangent * off
    matrix[row][column] = matrix[column][row] = 0.0


def is_possible(six: Six) -> bool:
    """Whether a body can have this inertia: no negative moment, triangle inequality.

    The slack is that of Gazebo's parser, so that both accept the same.
    """
    low, middle, high = principal_moments(six)
    slack = ROUNDING * max(map(abs, six))
    return low >= -slack and low + middle >= high - slack


def is_positive_definite(six: Six) -> bool:
    """Whether all principal moments are positive."""
    xx, xy, xz, yy, yz, zz = six
    minor = xx * yy - xy * xy
    determinant = zz * minor + 2 * xy * xz * yz - xx * yz * yz - yy * xz * xz
    return xx > 0 and minor > 0 and determinant > 0


def of_solid(geometry: Geometry, mass: float) -> Vector | None:
    """Principal moments of an evenly filled body along its frame's axes.

    They are about its center of mass. None for a mesh, an extrusion, a heightmap.
    """
    if isinstance(geometry, Box):
        x, y, z = (edge * edge for edge in geometry.size)
        return (mass * (y + z) / 12, mass * (x + z) / 12, mass * (x + y) / 12)
    if isinstance(geometry, Sphere | Ellipsoid):
        radii = (geometry.radius,) * 3 if isinstance(geometry, Sphere) else geometry.radii
        x, y, z = (radius * radius for radius in radii)
        return (mass * (y + z) / 5, mass * (x + z) / 5, mass * (x + y) / 5)
    if isinstance(geometry, Cylinder):
        across = mass * (3 * geometry.radius**2 + geometry.length**2) / 12
        return (across, across, mass * geometry.radius**2 / 2)
    if isinstance(geometry, Capsule):
        return _of_capsule(geometry.radius, geometry.length, mass)
    if isinstance(geometry, Cone):
        across = mass * (12 * geometry.radius**2 + 3 * geometry.length**2) / 80
        return (across, across, 0.3 * mass * geometry.radius**2)
    return None


def if_filled(link: Link) -> Vector | None:
    """Principal moments of a link of one shape, as an evenly filled body of its mass.

    None where it has no mass, more than one shape, or one that is no primitive.
    """
    shapes = [collision.geometry for collision in link.collisions]
    shapes = shapes or [visual.geometry for visual in link.visuals]
    if link.inertial is None or link.inertial.mass <= 0 or len(shapes) != 1:
        return None
    return of_solid(shapes[0], link.inertial.mass)


def as_attributes(moments: Vector) -> str:
    """Principal moments (kg m²) as attributes of <inertia>."""
    named = zip(("ixx", "iyy", "izz"), moments, strict=True)
    return " ".join(f'{name}="{moment:.4g}"' for name, moment in named)


def _of_capsule(radius: float, length: float, mass: float) -> Vector:
    volume_cylinder, volume_balls = radius**2 * length, 4 / 3 * radius**3  # over pi
    cylinder = mass * volume_cylinder / (volume_cylinder + volume_balls)
    balls = mass - cylinder
    along = cylinder * radius**2 / 2 + balls * 0.4 * radius**2
    across = cylinder * (3 * radius**2 + length**2) / 12 + balls * (
        0.4 * radius**2 + length**2 / 4 + 3 / 8 * length * radius
    )
    return (across, across, along)
