"""Rotations and changes of frame."""

from __future__ import annotations

import math

import pytest

from wsgen.model.transform import (
    Pose,
    compose,
    quaternion_of_rpy,
    rotate,
    rotation_of_quaternion,
    rotation_of_rpy,
    rpy_of_rotation,
)

ANGLES = [(0.1, 0.2, 0.3), (-3.0, 1.5, 2.0), (1.0, -1.0, -2.5), (0.0, 0.0, 3.0)]


@pytest.mark.parametrize("rpy", ANGLES)
def test_there_and_back(rpy: tuple[float, float, float]) -> None:
    assert rpy_of_rotation(rotation_of_rpy(rpy)) == pytest.approx(rpy)
    for ours, theirs in zip(
        rotation_of_rpy(rpy), rotation_of_quaternion(quaternion_of_rpy(rpy)), strict=True
    ):
        assert ours == pytest.approx(theirs)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("short_of", [0.0, 1e-13, 1e-11, 1e-9, 2.7e-8, 1e-6, -4e-6, 1e-4, 1e-2])
def test_gimbal_lock(sign: int, short_of: float) -> None:
    rotation = rotation_of_rpy((0.4, sign * (math.pi / 2 - short_of), 1.0))
    again = rotation_of_rpy(rpy_of_rotation(rotation))
    for ours, theirs in zip(rotation, again, strict=True):
        assert ours == pytest.approx(theirs, abs=2e-12)


def test_roll_comes_first_about_fixed_axes() -> None:
    rotation = rotation_of_rpy((math.pi / 2, 0.0, math.pi / 2))
    assert rotate(rotation, (0.0, 1.0, 0.0)) == pytest.approx((0.0, 0.0, 1.0))
    assert rotate(rotation, (1.0, 0.0, 0.0)) == pytest.approx((0.0, 1.0, 0.0))


def test_compose() -> None:
    outer = Pose((1.0, 0.0, 0.0), (0.0, 0.0, math.pi / 2))
    pose = compose(outer, Pose((1.0, 0.0, 0.0), (0.0, 0.0, math.pi / 4)))
    assert pose.xyz == pytest.approx((1.0, 1.0, 0.0))
    assert pose.rpy == pytest.approx((0.0, 0.0, 3 * math.pi / 4))


def test_composing_with_nothing_is_exact() -> None:
    pose = Pose((0.1, 0.2, 0.3), (0.4, 0.5, 0.6))
    assert compose(Pose(), pose) == pose
    assert compose(pose, Pose()) == pose
