"""Rules over how large and how heavy a robot is."""

from __future__ import annotations

import pytest

from wsgen.checks.rules.robots import implausible_mass, implausible_size, number_beyond_engines
from wsgen.diagnostics import Severity
from wsgen.model.robot import (
    Box,
    Collision,
    Geometry,
    Inertial,
    Joint,
    JointLimit,
    JointType,
    Link,
    Mesh,
    Sphere,
    Visual,
)
from wsgen.model.transform import Pose


def link(name: str = "a", mass: float = 1.0, geometry: Geometry | None = None) -> Link:
    return Link(
        name=name,
        inertial=Inertial(mass=mass, inertia=(1.0, 0.0, 0.0, 1.0, 0.0, 1.0)),
        collisions=() if geometry is None else (Collision(geometry=geometry),),
    )


def joint(x: float = 0.0, kind: JointType = JointType.CONTINUOUS, damping: float = 0.0) -> Joint:
    return Joint(
        name="j",
        type=kind,
        parent="a",
        child="b",
        pose_in_parent=Pose((x, 0.0, 0.0)),
        damping=damping,
        limit=JointLimit(lower=-1e38, upper=1e38, effort=1e38, velocity=1e38),
    )


def test_limits_may_be_as_large_as_they_like() -> None:
    assert list(number_beyond_engines([link()], [joint(1.0)], None)) == []


@pytest.mark.parametrize(
    ("links", "joints"),
    [
        ([link(mass=1e308)], []),
        ([link(geometry=Box(size=(1.0, 1e20, 1.0)))], []),
        ([link(geometry=Sphere(radius=1e20))], []),
        ([link(geometry=Mesh(uri="a.stl", scale=(1e20, 1.0, 1.0)))], []),
        ([link()], [joint(-1e20)]),
        ([link()], [joint(damping=1e20)]),
    ],
)
def test_number_beyond_engines(links: list[Link], joints: list[Joint]) -> None:
    (found,) = number_beyond_engines(links, joints, None)
    assert (found.code, found.severity) == ("ROB056", Severity.ERROR)


@pytest.mark.parametrize(
    ("links", "joints", "measure"),
    [
        ([link(geometry=Box(size=(1000.0, 1.0, 1.0)))], [], "1e+03 m"),
        ([link(geometry=Box(size=(1e-9, 1e-9, 1e-9)))], [], "1e-09 m"),
        ([link(), link("b", geometry=Sphere(radius=1.0))], [joint(200.0)], "201 m"),
        ([Link(name="a", visuals=(Visual(geometry=Sphere(radius=60.0)),))], [], "120 m"),
    ],
)
def test_implausible_size(links: list[Link], joints: list[Joint], measure: str) -> None:
    (found,) = implausible_size(links, joints, None)
    assert (found.code, found.severity) == ("ROB048", Severity.WARNING)
    assert measure in found.message


@pytest.mark.parametrize(
    "links",
    [
        [],
        [link()],
        [link(geometry=Box(size=(1.0, 1.0, 1.0)))],
        [link(geometry=Box(size=(1e-6, 1e-6, 1e-6))), link("b", geometry=Mesh(uri="a.stl"))],
    ],
)
def test_plausible_size(links: list[Link]) -> None:
    assert list(implausible_size(links, [], None)) == []


def test_implausible_mass() -> None:
    (found,) = implausible_mass([link(mass=2e6)], [], None)
    assert (found.code, found.severity) == ("ROB049", Severity.WARNING)
    assert "2e+06 kg" in found.message
    (found,) = implausible_mass([link(), link("b", mass=1e-9)], [joint()], None)
    assert (found.code, found.element) == ("ROB049", "link[@name='b']/inertial/mass")


def test_what_is_fixed_to_something_may_weigh_next_to_nothing() -> None:
    links = [link(), link("b", mass=1e-9)]
    assert list(implausible_mass(links, [joint(kind=JointType.FIXED)], None)) == []
