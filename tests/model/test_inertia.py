"""Moments of inertia."""

from __future__ import annotations

import pytest

from wsgen.model.inertia import (
    Six,
    about_link_axes,
    is_possible,
    made_possible,
    moved,
    of_solid,
    principal_moments,
)
from wsgen.model.robot import Box, Capsule, Cylinder, Inertial, Mesh, Sphere
from wsgen.model.transform import Pose


def test_solids() -> None:
    assert of_solid(Box(size=(1, 2, 3)), 12.0) == (13, 10, 5)
    assert of_solid(Sphere(radius=2), 5.0) == (8, 8, 8)
    assert of_solid(Cylinder(radius=0.4, length=0.5), 1.0) == pytest.approx(
        (0.0608333, 0.0608333, 0.08), abs=1e-7
    )
    assert of_solid(Mesh(uri="m"), 1.0) is None


def test_a_capsule_without_cylinder_is_a_sphere() -> None:
    capsule = of_solid(Capsule(radius=2, length=1e-9), 5.0)
    assert capsule == pytest.approx((8, 8, 8))


def test_principal_moments_do_not_depend_on_the_axes() -> None:
    turned = about_link_axes(
        Inertial(mass=1, pose_in_link=Pose(rpy=(0.3, -1.2, 2.0)), inertia=(1, 0, 0, 2, 0, 2.5))
    )
    assert turned[1] != 0
    assert principal_moments(turned) == pytest.approx((1, 2, 2.5), rel=1e-14)


@pytest.mark.parametrize("six", [(0, 0, 0, 0, 0, 0), (2, 0, 0, 2, 0, 2), (1, 0, 0, 1, 0, 2)])
def test_possible(six: Six) -> None:
    assert is_possible(six)


@pytest.mark.parametrize(
    "six", [(1, 0, 0, 1, 0, 2.001), (-1, 0, 0, 1, 0, 1), (1, 2, 0, 1, 0, 1), (1, 0, 0, 1, 0, 9)]
)
def test_impossible(six: Six) -> None:
    assert not is_possible(six)


def test_a_thin_plate_stays_possible_when_it_is_turned() -> None:
    """Its triangle inequality is an equality, which rounding must not break."""
    for step in range(100):
        plate = Inertial(
            mass=1, pose_in_link=Pose(rpy=(step, 2.0 * step, 0.7)), inertia=(1, 0, 0, 2, 0, 3)
        )
        assert is_possible(about_link_axes(plate))


def test_moved() -> None:
    assert moved((1, 0, 0, 1, 0, 1), 2.0, (1, 2, 3)) == (27, -4, -6, 21, -12, 11)


@pytest.mark.parametrize(
    "six",
    [
        (0.1, 0.0, 0.0, 0.1, 0.0, 0.3),
        (1.0, 0.9, 0.1, 1.0, -0.3, 0.2),
        (-1.0, 0.0, 0.0, 1.0, 0.0, 1.0),
    ],
)
def test_an_impossible_inertia_is_made_possible(six: Six) -> None:
    assert not is_possible(six)
    made = made_possible(six)
    assert is_possible(made)
    added = [one - other for one, other in zip(made, six, strict=True)]
    assert added == pytest.approx([added[0], 0.0, 0.0, added[0], 0.0, added[0]])
    assert added[0] < 3.1


def test_a_possible_inertia_stays_as_it_is() -> None:
    assert made_possible((0.1, 0.0, 0.0, 0.1, 0.0, 0.2)) == (0.1, 0.0, 0.0, 0.1, 0.0, 0.2)
