"""Poses, rotations and changes of frame, on plain tuples.

A rotation is a 3 by 3 matrix as a tuple of rows; it takes a vector from the rotated frame to the
frame it is seen from. Quaternions are ordered x, y, z, w.
"""

from __future__ import annotations

import math

from wsgen.text.values import dataclass


@dataclass(frozen=True)
class Pose:
    """A frame seen from another one, as URDF, SDF and the spawners write it."""

    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0)  # m
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)  # rad; fixed-axis roll, pitch, yaw

    @property
    def x(self) -> float:
        """Of its origin, m."""
        return self.xyz[0]

    @property
    def y(self) -> float:
        """Of its origin, m."""
        return self.xyz[1]

    @property
    def z(self) -> float:
        """Of its origin, m."""
        return self.xyz[2]

    @property
    def roll(self) -> float:
        """About the fixed x axis, rad."""
        return self.rpy[0]

    @property
    def pitch(self) -> float:
        """About the fixed y axis, rad."""
        return self.rpy[1]

    @property
    def yaw(self) -> float:
        """About the fixed z axis, rad."""
        return self.rpy[2]

    @property
    def is_finite(self) -> bool:
        """Whether no number is infinite or not-a-number."""
        return all(math.isfinite(number) for number in (*self.xyz, *self.rpy))


IDENTITY = Pose()


Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]

UNIT: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

# With a cosine of the pitch below this, roll and yaw turn about the same axis.
GIMBAL_LOCK = 1e-12
STEEP = 1e-3  # likewise


def rotation_of_rpy(rpy: Vector) -> Matrix:
    """The rotation about the fixed x axis by roll, then y by pitch, then z by yaw (rad)."""
    if rpy == (0.0, 0.0, 0.0):
        return UNIT
    (sin_r, sin_p, sin_y), (cos_r, cos_p, cos_y) = map(math.sin, rpy), map(math.cos, rpy)
    return (
        (
            cos_y * cos_p,
            cos_y * sin_p * sin_r - sin_y * cos_r,
            cos_y * sin_p * cos_r + sin_y * sin_r,
        ),
        (
            sin_y * cos_p,
            sin_y * sin_p * sin_r + cos_y * cos_r,
            sin_y * sin_p * cos_r - cos_y * sin_r,
        ),
        (-sin_p, cos_p * sin_r, cos_p * cos_r),
    )


def rotation_of_quaternion(xyzw: tuple[float, float, float, float]) -> Matrix:
    """The rotation of a unit quaternion."""
    x, y, z, w = xyzw
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )


def rpy_of_rotation(rotation: Matrix) -> Vector:
    """Fixed-axis roll, pitch and yaw of a rotation, rad; the roll is 0 in gimbal lock."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation
    cos_p = math.hypot(xx, yx)
    pitch = math.atan2(-zx, cos_p)
    if cos_p < GIMBAL_LOCK:
        return 0.0, pitch, math.atan2(-xy, yy)
    if cos_p > STEEP:
        return math.atan2(zy, zz), pitch, math.atan2(yx, xx)
    # Near 90° the numbers above have lost digits: the roll is what the yaw leaves over.
    yaw = math.atan2(yx, xx)
    sin_y, cos_y = math.sin(yaw), math.cos(yaw)
    return math.atan2(sin_y * xz - cos_y * yz, cos_y * yy - sin_y * xy), pitch, yaw


def quaternion_of_rpy(rpy: Vector) -> tuple[float, float, float, float]:
    """The unit quaternion x, y, z, w of fixed-axis roll, pitch and yaw (rad)."""
    (sin_r, sin_p, sin_y) = (math.sin(angle / 2) for angle in rpy)
    (cos_r, cos_p, cos_y) = (math.cos(angle / 2) for angle in rpy)
    return (
        sin_r * cos_p * cos_y - cos_r * sin_p * sin_y,
        cos_r * sin_p * cos_y + sin_r * cos_p * sin_y,
        cos_r * cos_p * sin_y - sin_r * sin_p * cos_y,
        cos_r * cos_p * cos_y + sin_r * sin_p * sin_y,
    )


def rotate(rotation: Matrix, vector: Vector) -> Vector:
    """The vector seen from the frame that the rotation leads to."""
    x, y, z = vector
    a, b, c = rotation
    return (
        a[0] * x + a[1] * y + a[2] * z,
        b[0] * x + b[1] * y + b[2] * z,
        c[0] * x + c[1] * y + c[2] * z,
    )


def transpose(matrix: Matrix) -> Matrix:
    """The inverse, when the matrix is a rotation."""
    a, b, c = matrix
    return ((a[0], b[0], c[0]), (a[1], b[1], c[1]), (a[2], b[2], c[2]))


def multiply(left: Matrix, right: Matrix) -> Matrix:
    """The matrix product left · right."""
    columns = [rotate(left, column) for column in transpose(right)]
    return transpose((columns[0], columns[1], columns[2]))


def angle_between(first: Pose, second: Pose) -> float:
    """By how much the one is turned as against the other, rad, from 0 to pi."""
    turned = multiply(rotation_of_rpy(first.rpy), transpose(rotation_of_rpy(second.rpy)))
    cosine = (turned[0][0] + turned[1][1] + turned[2][2] - 1) / 2
    return math.acos(min(1.0, max(-1.0, cosine)))


def compose(outer: Pose, inner: Pose) -> Pose:
    """The pose of a frame in the outer frame, when `inner` is its pose in `outer`'s frame."""
    rotation = rotation_of_rpy(outer.rpy)
    x, y, z = rotate(rotation, inner.xyz)
    if rotation is UNIT:  # exact, where turning back and forth would round
        rpy = inner.rpy
    elif inner.rpy == (0.0, 0.0, 0.0):
        rpy = outer.rpy
    else:
        rpy = rpy_of_rotation(multiply(rotation, rotation_of_rpy(inner.rpy)))
    return Pose(xyz=(outer.xyz[0] + x, outer.xyz[1] + y, outer.xyz[2] + z), rpy=rpy)


def invert(pose: Pose) -> Pose:
    """The pose of the outer frame seen from the inner one."""
    rotation = transpose(rotation_of_rpy(pose.rpy))
    x, y, z = rotate(rotation, pose.xyz)
    return Pose(xyz=(-x, -y, -z), rpy=rpy_of_rotation(rotation))
