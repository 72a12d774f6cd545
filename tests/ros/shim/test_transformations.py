"""`tf_transformations`, compared with SciPy's rotations."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import tf_transformations as tf

AXES = [
    f"{frame}{first}{second}{third}"
    for frame in "sr"
    for first, second, third in itertools.product("xyz", repeat=3)
    if first != second != third
]
angles = st.floats(-math.pi, math.pi)
quaternions = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: math.hypot(*q) > 0.1)


def close(left: Rotation, right: Rotation) -> bool:
    return bool((left.inv() * right).magnitude() < 1e-6)


@pytest.mark.parametrize("axes", AXES)
@settings(max_examples=10)
@given(angles, angles, angles)
def test_euler_angles_are_scipys(axes: str, ai: float, aj: float, ak: float) -> None:
    letters = axes[1:].upper() if axes[0] == "r" else axes[1:]
    expected = Rotation.from_euler(letters, [ai, aj, ak])
    quaternion = tf.quaternion_from_euler(ai, aj, ak, axes)
    assert close(expected, Rotation.from_quat(quaternion))
    np.testing.assert_allclose(
        tf.euler_matrix(ai, aj, ak, axes)[:3, :3], expected.as_matrix(), atol=1e-9
    )
    again = tf.quaternion_from_euler(*tf.euler_from_quaternion(quaternion, axes), axes)
    assert close(expected, Rotation.from_quat(again))


@pytest.mark.parametrize("axes", AXES)
@pytest.mark.parametrize("middle", [-math.pi / 2, 0.0, math.pi / 2, math.pi])
def test_gimbal_lock_keeps_the_rotation(axes: str, middle: float) -> None:
    matrix = tf.euler_matrix(0.3, middle, -0.7, axes)
    np.testing.assert_allclose(
        tf.euler_matrix(*tf.euler_from_matrix(matrix, axes), axes), matrix, atol=1e-9
    )


@given(st.floats(-1.5, 1.5), angles)
def test_yaw_of_a_planar_robot(pitch: float, yaw: float) -> None:
    assert tf.euler_from_quaternion(tf.quaternion_from_euler(0, 0, yaw))[2] == pytest.approx(yaw)
    found = tf.euler_from_quaternion(tf.quaternion_from_euler(0.2, pitch, yaw))
    assert found == pytest.approx((0.2, pitch, yaw), abs=1e-6)


@pytest.mark.slow
@given(quaternions, quaternions)
def test_products_are_scipys(left: tuple[float, ...], right: tuple[float, ...]) -> None:
    product = tf.quaternion_multiply(left, right)
    expected = Rotation.from_quat(left) * Rotation.from_quat(right)
    assert close(expected, Rotation.from_quat(product))
    one = tf.quaternion_multiply(left, tf.quaternion_inverse(left))
    assert one == pytest.approx((0, 0, 0, 1), abs=1e-9)


@pytest.mark.slow
@given(quaternions)
def test_matrices_and_quaternions_are_inverse(quaternion: tuple[float, ...]) -> None:
    matrix = tf.quaternion_matrix(quaternion)
    np.testing.assert_allclose(
        matrix[:3, :3], Rotation.from_quat(quaternion).as_matrix(), atol=1e-9
    )
    found = tf.quaternion_from_matrix(matrix)
    assert found[3] >= 0
    assert close(Rotation.from_quat(quaternion), Rotation.from_quat(found))


@pytest.mark.slow
@given(quaternions, quaternions, st.floats(0, 1))
def test_slerp_turns_at_constant_speed(
    start: tuple[float, ...], end: tuple[float, ...], ratio: float
) -> None:
    between = Rotation.from_quat(tf.quaternion_slerp(start, end, ratio))
    first, last = Rotation.from_quat(start), Rotation.from_quat(end)
    whole = (first.inv() * last).magnitude()
    if 1e-3 < whole < math.pi - 1e-3:
        assert (first.inv() * between).magnitude() == pytest.approx(ratio * whole, abs=1e-6)


def test_matrices() -> None:
    turned = tf.rotation_matrix(math.pi / 2, (0, 0, 2), (1, 0, 0))
    np.testing.assert_allclose(turned @ [2, 0, 0, 1], [1, 1, 0, 1], atol=1e-12)
    angle, direction, point = tf.rotation_from_matrix(turned)
    assert angle == pytest.approx(math.pi / 2)
    np.testing.assert_allclose(direction, [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(turned @ point, point, atol=1e-12)
    moved = tf.translation_matrix((1, 2, 3))
    np.testing.assert_allclose(tf.translation_from_matrix(moved), [1, 2, 3])
    both = tf.concatenate_matrices(moved, turned)
    np.testing.assert_allclose(both @ tf.inverse_matrix(both), tf.identity_matrix(), atol=1e-12)
    composed = tf.compose_matrix(angles=(0.1, 0.2, 0.3), translate=(1, 2, 3))
    np.testing.assert_allclose(composed, moved @ tf.euler_matrix(0.1, 0.2, 0.3), atol=1e-12)
    assert tf.vector_norm((3, 4)) == 5
    np.testing.assert_allclose(tf.unit_vector([3, 4]), [0.6, 0.8])


@pytest.mark.parametrize("axes", ["xyz", "sxxy", "txyz", "", "sxyzx"])
def test_unknown_axes_are_refused(axes: str) -> None:
    with pytest.raises(KeyError):
        tf.quaternion_from_euler(0, 0, 0, axes)
