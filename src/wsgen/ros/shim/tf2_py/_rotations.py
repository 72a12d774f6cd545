"""Rotations as unit quaternions x, y, z, w, on plain tuples, which are faster than arrays here.

A rotation takes a vector from the child's frame to its parent's.
"""

from __future__ import annotations

import math

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

NO_TRANSLATION: Vector = (0.0, 0.0, 0.0)
NO_ROTATION: Quaternion = (0.0, 0.0, 0.0, 1.0)


def multiply(left: Quaternion, right: Quaternion) -> Quaternion:
    """The rotation by `right`, then by `left`."""
    ax, ay, az, aw = left
    bx, by, bz, bw = right
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def invert(quaternion: Quaternion) -> Quaternion:
    """The rotation back."""
    x, y, z, w = quaternion
    return (-x, -y, -z, w)


def rotate(quaternion: Quaternion, vector: Vector) -> Vector:
    """The vector, rotated."""
    x, y, z, w = quaternion
    vx, vy, vz = vector
    # v + 2 w (q × v) + 2 q × (q × v)
    tx, ty, tz = 2 * (y * vz - z * vy), 2 * (z * vx - x * vz), 2 * (x * vy - y * vx)
    return (
        vx + w * tx + y * tz - z * ty,
        vy + w * ty + z * tx - x * tz,
        vz + w * tz + x * ty - y * tx,
    )


def add(left: Vector, right: Vector) -> Vector:
    """The sum of two vectors."""
    return (left[0] + right[0], left[1] + right[1], left[2] + right[2])


def subtract(left: Vector, right: Vector) -> Vector:
    """The difference of two vectors."""
    return (left[0] - right[0], left[1] - right[1], left[2] - right[2])


def lerp(start: Vector, end: Vector, ratio: float) -> Vector:
    """The point on the straight line between two, at 0 to 1 of the way."""
    rest = 1.0 - ratio
    return (
        rest * start[0] + ratio * end[0],
        rest * start[1] + ratio * end[1],
        rest * start[2] + ratio * end[2],
    )


def slerp(start: Quaternion, end: Quaternion, ratio: float) -> Quaternion:
    """The rotation on the shortest way between two at constant speed, at 0 to 1 of the way."""
    cosine = sum(a * b for a, b in zip(start, end, strict=True))
    if cosine < 0.0:  # the same rotation, from the other side
        cosine, end = -cosine, (-end[0], -end[1], -end[2], -end[3])
    angle = math.acos(min(cosine, 1.0))
    if angle < 1e-7:  # noqa: PLR2004  rad; its sine is the angle, which cancels
        first, second = 1.0 - ratio, ratio
    else:
        sine = math.sin(angle)
        first, second = math.sin((1.0 - ratio) * angle) / sine, math.sin(ratio * angle) / sine
    return normalize(
        (
            first * start[0] + second * end[0],
            first * start[1] + second * end[1],
            first * start[2] + second * end[2],
            first * start[3] + second * end[3],
        )
    )


def normalize(quaternion: Quaternion) -> Quaternion:
    """The unit quaternion with the sign that tf2 gives it when it reads it from a matrix.

    Its w is positive for rotations of less than 120 degrees; of others, the largest of x, y and z.
    Not-a-number stays, and (0, 0, 0, 0) becomes it.
    """
    x, y, z, w = quaternion
    length = math.sqrt(x * x + y * y + z * z + w * w)
    if not 0.0 < length < math.inf:
        return (math.nan, math.nan, math.nan, math.nan)
    leading = w if abs(w) > 0.5 * length else max((x, y, z), key=abs)
    scale = math.copysign(1.0 / length, leading)
    return (x * scale, y * scale, z * scale, w * scale)
