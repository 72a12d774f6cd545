"""`tf_transformations` for nodes where it is not installed: matrices, quaternions, Euler angles.

Names, arguments and conventions are those of ROS's package (DLu/tf_transformations): a quaternion
is x, y, z, w; a matrix has 4 rows and columns; angles are radians. `axes` names how Euler angles
turn: `s` about the axes of the world or `r` about those that turn along, then the three axes.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]
    Quaternion = tuple[float, float, float, float]
    Angles = tuple[float, float, float]

TOLERANCE = 4 * np.finfo(float).eps
TRANSLATION, ROTATION = slice(0, 3), (slice(0, 3), slice(0, 3))
LETTERS = "xyz"


def identity_matrix() -> Array:
    """Nothing is moved."""
    return np.eye(4)


def translation_matrix(direction: ArrayLike) -> Array:
    """A translation."""
    found = np.eye(4)
    found[:3, 3] = np.asarray(direction, dtype=float)[:3]
    return found


def translation_from_matrix(matrix: ArrayLike) -> Array:
    """The translation of a transform."""
    return np.array(matrix, dtype=float)[:3, 3]


def rotation_matrix(angle: float, direction: ArrayLike, point: ArrayLike | None = None) -> Array:
    """A rotation about an axis through a point."""
    found = quaternion_matrix(quaternion_about_axis(angle, direction))
    if point is not None:
        center = np.asarray(point, dtype=float)[:3]
        found[:3, 3] = center - found[:3, :3] @ center
    return found


def rotation_from_matrix(matrix: ArrayLike) -> tuple[float, Array, Array]:
    """Angle, direction (3 numbers) and a point (4 numbers) of the axis of a rotation."""
    transform = np.asarray(matrix, dtype=float)
    x, y, z, w = quaternion_from_matrix(transform)
    length = math.sqrt(x * x + y * y + z * z)
    direction = np.array([x, y, z]) / length if length else np.array([0.0, 0.0, 1.0])
    angle = 2.0 * math.atan2(length, w)
    # The point of the axis that is nearest to the origin.
    point = np.linalg.pinv(np.eye(3) - transform[:3, :3]) @ transform[:3, 3]
    return angle, direction, np.append(point, 1.0)


def concatenate_matrices(*matrices: ArrayLike) -> Array:
    """The product of transforms, from left to right."""
    found = np.eye(4)
    for matrix in matrices:
        found = found @ np.asarray(matrix, dtype=float)
    return found


def inverse_matrix(matrix: ArrayLike) -> Array:
    """The transform back."""
    return np.linalg.inv(np.asarray(matrix, dtype=float))


def euler_matrix(ai: float, aj: float, ak: float, axes: str = "sxyz") -> Array:
    """The rotation of Euler angles."""
    return quaternion_matrix(quaternion_from_euler(ai, aj, ak, axes))


def euler_from_matrix(matrix: ArrayLike, axes: str = "sxyz") -> Angles:
    """The Euler angles of a rotation; where two axes fall together, one of the angles is 0."""
    turning, (i, j, k) = _axes(axes)
    rotation = np.asarray(matrix, dtype=float)[:3, :3]
    # As angles about axes that turn along: the first is the outermost rotation.
    if i == k:
        first, second, third = _proper_angles(rotation, i, j)
    else:
        first, second, third = _three_axes_angles(rotation, i, j, k)
    return (first, second, third) if turning else (third, second, first)


def euler_from_quaternion(quaternion: ArrayLike, axes: str = "sxyz") -> Angles:
    """The Euler angles of a rotation."""
    return euler_from_matrix(quaternion_matrix(quaternion), axes)


def quaternion_from_euler(ai: float, aj: float, ak: float, axes: str = "sxyz") -> Quaternion:
    """The rotation of Euler angles."""
    turning, order = _axes(axes)
    angles = (ai, aj, ak) if turning else (ak, aj, ai)
    found: Quaternion = (0.0, 0.0, 0.0, 1.0)
    for axis, angle in zip(order, angles, strict=True):
        found = quaternion_multiply(found, quaternion_about_axis(angle, np.eye(3)[axis]))
    return found


def quaternion_about_axis(angle: float, axis: ArrayLike) -> Quaternion:
    """A rotation about an axis of any length."""
    x, y, z = (float(number) for number in np.asarray(axis, dtype=float)[:3])
    length = math.sqrt(x * x + y * y + z * z)
    scale = math.sin(angle / 2.0) / length if length > TOLERANCE else 0.0
    return (x * scale, y * scale, z * scale, math.cos(angle / 2.0))


def quaternion_matrix(quaternion: ArrayLike) -> Array:
    """The matrix of a rotation; the identity for a quaternion without length."""
    numbers = np.asarray(quaternion, dtype=float)
    length = float(numbers @ numbers)
    found = np.eye(4)
    if length < TOLERANCE:
        return found
    x, y, z, w = numbers * math.sqrt(2.0 / length)
    found[:3, :3] = (
        (1.0 - y * y - z * z, x * y - z * w, x * z + y * w),
        (x * y + z * w, 1.0 - x * x - z * z, y * z - x * w),
        (x * z - y * w, y * z + x * w, 1.0 - x * x - y * y),
    )
    return found


def quaternion_from_matrix(matrix: ArrayLike) -> Quaternion:
    """The rotation of a matrix, w not negative."""
    m = np.asarray(matrix, dtype=float)[:3, :3]
    # The eigenvector of the largest eigenvalue: the nearest rotation, also of a matrix with errors.
    symmetric = (
        np.array(
            [
                [
                    m[0, 0] - m[1, 1] - m[2, 2],
                    m[0, 1] + m[1, 0],
                    m[0, 2] + m[2, 0],
                    m[2, 1] - m[1, 2],
                ],
                [
                    m[0, 1] + m[1, 0],
                    m[1, 1] - m[0, 0] - m[2, 2],
                    m[1, 2] + m[2, 1],
                    m[0, 2] - m[2, 0],
                ],
                [
                    m[0, 2] + m[2, 0],
                    m[1, 2] + m[2, 1],
                    m[2, 2] - m[0, 0] - m[1, 1],
                    m[1, 0] - m[0, 1],
                ],
                [
                    m[2, 1] - m[1, 2],
                    m[0, 2] - m[2, 0],
                    m[1, 0] - m[0, 1],
                    m[0, 0] + m[1, 1] + m[2, 2],
                ],
            ]
        )
        / 3.0
    )
    _, vectors = np.linalg.eigh(symmetric)
    x, y, z, w = (float(number) for number in vectors[:, -1])
    return (-x, -y, -z, -w) if w < 0 else (x, y, z, w)


def quaternion_multiply(quaternion1: Sequence[float], quaternion0: Sequence[float]) -> Quaternion:
    """The rotation by the second one, then by the first one."""
    ax, ay, az, aw = (float(number) for number in quaternion1)
    bx, by, bz, bw = (float(number) for number in quaternion0)
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def quaternion_conjugate(quaternion: Sequence[float]) -> Quaternion:
    """The rotation back, of a unit quaternion."""
    x, y, z, w = (float(number) for number in quaternion)
    return (-x, -y, -z, w)


def quaternion_inverse(quaternion: Sequence[float]) -> Quaternion:
    """What gives 1 when it is multiplied with the quaternion."""
    x, y, z, w = quaternion_conjugate(quaternion)
    square = x * x + y * y + z * z + w * w
    return (x / square, y / square, z / square, w / square)


def quaternion_slerp(
    quat0: ArrayLike,
    quat1: ArrayLike,
    fraction: float,
    spin: int = 0,
    shortestpath: bool = True,
) -> Any:
    """The rotation between two, at 0 to 1 of the way; `spin` adds half turns."""
    start, end = unit_vector(quat0), unit_vector(quat1)
    if fraction in (0.0, 1.0):
        return start if fraction == 0.0 else end
    cosine = float(start @ end)
    if abs(abs(cosine) - 1.0) < TOLERANCE:
        return start
    if shortestpath and cosine < 0.0:
        cosine, end = -cosine, -end
    angle = math.acos(min(1.0, max(-1.0, cosine))) + spin * math.pi
    if abs(angle) < TOLERANCE:
        return start
    return (
        math.sin((1.0 - fraction) * angle) * start + math.sin(fraction * angle) * end
    ) / math.sin(angle)


def unit_vector(data: ArrayLike, axis: int | None = None, out: Array | None = None) -> Any:
    """The vector, or the vectors along an axis, with length 1."""
    found = np.array(data, dtype=float)
    length = np.sqrt(np.sum(found * found, axis=axis, keepdims=axis is not None))
    found /= length
    if out is None:
        return found
    out[:] = found
    return None


def vector_norm(data: ArrayLike, axis: int | None = None, out: Array | None = None) -> Any:
    """The length of a vector, or of the vectors along an axis."""
    found = np.linalg.norm(np.asarray(data, dtype=float), axis=axis)
    if out is None:
        return found
    out[:] = found
    return None


def compose_matrix(
    scale: ArrayLike | None = None,
    shear: ArrayLike | None = None,
    angles: Sequence[float] | None = None,
    translate: ArrayLike | None = None,
    perspective: ArrayLike | None = None,
) -> Array:
    """A transform from its parts: perspective, translation, rotation, shear, scale."""
    found = np.eye(4)
    if perspective is not None:
        found[3, :] = np.asarray(perspective, dtype=float)[:4]
    if translate is not None:
        found = found @ translation_matrix(translate)
    if angles is not None:
        found = found @ euler_matrix(angles[0], angles[1], angles[2], "sxyz")
    if shear is not None:
        sheared = np.eye(4)
        sheared[0, 1], sheared[0, 2], sheared[1, 2] = np.asarray(shear, dtype=float)
        found = found @ sheared
    if scale is not None:
        found = found @ np.diag([*np.asarray(scale, dtype=float), 1.0])
    return np.asarray(found / found[3, 3])


def _axes(axes: str) -> tuple[bool, tuple[int, int, int]]:
    """Whether the axes turn along, and the axes of the rotations from the outermost to the last."""
    letters = axes[1:] if isinstance(axes, str) else ""
    is_known = (
        len(letters) == 3  # noqa: PLR2004
        and axes[0] in "sr"
        and set(letters) <= set(LETTERS)
        and letters[0] != letters[1] != letters[2]
    )
    if not is_known:
        raise KeyError(axes)
    first, second, third = (LETTERS.index(letter) for letter in letters)
    turning = axes[0] == "r"
    return turning, (first, second, third) if turning else (third, second, first)


def _three_axes_angles(m: Array, i: int, j: int, k: int) -> Angles:
    """Of a rotation about i, then about j and k as they have turned."""
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    cosine = math.hypot(m[i, i], m[i, j])
    second = math.atan2(sign * m[i, k], cosine)
    if cosine > TOLERANCE:
        return (
            math.atan2(-sign * m[j, k], m[k, k]),
            second,
            math.atan2(-sign * m[i, j], m[i, i]),
        )
    return 0.0, second, math.atan2(sign * m[j, i], m[j, j])


def _proper_angles(m: Array, i: int, j: int) -> Angles:
    """Of a rotation about i, then about j and i as they have turned."""
    k = 3 - i - j
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    sine = math.hypot(m[i, j], m[i, k])
    second = math.atan2(sine, m[i, i])
    if sine > TOLERANCE:
        return (math.atan2(m[j, i], -sign * m[k, i]), second, math.atan2(m[i, j], sign * m[i, k]))
    return 0.0, second, math.atan2(-sign * m[j, k], m[j, j])
