"""The rules over a robot, each with its facts and no files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from wsgen.checks.rules.robots import (
    find_oversized,
    implausible_inertia,
    loose_joint,
    massless_root,
    no_collision,
    no_visual,
    oversized_parts,
    ros_1_plugin,
    starts_outside_limits,
)
from wsgen.diagnostics import Severity
from wsgen.model.robot import (
    Box,
    Collision,
    Cylinder,
    GazeboTag,
    Geometry,
    Inertial,
    Joint,
    JointLimit,
    JointType,
    Link,
    Mesh,
    Plugin,
    Primitive,
    Sphere,
    Visual,
)

FILE = Path("robot.urdf")
CYLINDER = Cylinder(radius=0.4, length=0.5)


def link(moment: float, geometry: Geometry = CYLINDER, mass: float = 1.0) -> Link:
    return Link(
        name="base",
        inertial=Inertial(mass=mass, inertia=(moment, 0, 0, moment, 0, moment)),
        collisions=(Collision(geometry=geometry),),
        line=7,
    )


JOINT = Joint(name="j", type=JointType.FIXED, parent="dummy", child="base")


def test_the_inertia_of_the_tutorial() -> None:
    (found,) = implausible_inertia([link(100.0)], FILE)
    assert (found.code, found.severity, found.line) == ("ROB050", Severity.WARNING, 7)
    assert found.hint is not None
    assert 'ixx="0.06083" iyy="0.06083" izz="0.08"' in found.hint


@pytest.mark.parametrize(
    ("moment", "words"),
    [
        (100.0, "is 1250 times that of"),
        (1e-4, "is only 1/800 of that of"),
        (0.0, "is zero, not that of"),
    ],
)
def test_ratios_are_written_out(moment: float, words: str) -> None:
    (found,) = implausible_inertia([link(moment)], FILE)
    assert words in found.message


@pytest.mark.parametrize("moment", [1e-9, 0.0])
def test_too_small(moment: float) -> None:
    assert [found.code for found in implausible_inertia([link(moment)], None)] == ["ROB050"]


@pytest.mark.parametrize(
    "one",
    [
        link(0.06),
        link(0.5),
        link(100.0, Box(size=(30.0, 30.0, 30.0))),
        link(0.001, Sphere(radius=0.05)),
        link(100.0, Mesh(uri="m.stl")),
        link(100.0, mass=0.0),
        Link(name="empty"),
    ],
)
def test_plausible_or_unknown(one: Link) -> None:
    assert list(implausible_inertia([one], None)) == []


@pytest.mark.parametrize(
    ("parent", "severity"),
    [
        (Link(name="base_footprint"), Severity.WARNING),
        (replace(link(1.0, mass=9.0), name="chassis"), Severity.INFO),
    ],
)
def test_inertia_of_what_is_fixed_to_mass_is_only_a_part(parent: Link, severity: Severity) -> None:
    mount = Link(name="mount")
    part = link(100.0)
    joints = [
        Joint(name="a", type=JointType.FIXED, parent=parent.name, child="mount"),
        Joint(name="b", type=JointType.FIXED, parent="mount", child=part.name),
    ]
    *_, found = implausible_inertia([parent, mount, part], FILE, joints)
    assert found.severity is severity


@pytest.mark.parametrize(
    ("mass", "moment", "code"),
    [
        (2500.0, 0.1, "ROB049"),  # 10,000 kg/m³, and the inertia is that of 2.5 kg
        (250.0, 0.01, "ROB050"),  # it may weigh as much, and its inertia is too small
        (2500.0, 1e-5, "ROB050"),  # nothing fits
        (2500.0, 1e6, "ROB050"),
    ],
)
def test_a_mass_in_grams_is_not_to_be_fitted(mass: float, moment: float, code: str) -> None:
    (found,) = implausible_inertia([link(moment, mass=mass)], FILE)
    assert found.code == code
    if code == "ROB049":
        assert 'write <mass value="2.5"/>' in (found.hint or "")


def wheel(radius: float, length: float = 0.1) -> Link:
    return Link(
        name="wheel",
        collisions=(Collision(geometry=Cylinder(radius=radius, length=length)),),
        line=9,
    )


@pytest.mark.parametrize(
    ("radius", "type_of_joint", "words"),
    [
        (0.1, JointType.CONTINUOUS, None),
        (2.0, JointType.CONTINUOUS, None),  # five times the body: an odd robot
        (10.0, JointType.CONTINUOUS, "for 10 cm, write 0.1."),
        (100.0, JointType.CONTINUOUS, "for 100 mm, write 0.1."),
        (10.0, JointType.FIXED, None),  # the floor around a robot
    ],
)
def test_a_wheel_in_other_units(radius: float, type_of_joint: JointType, words: str | None) -> None:
    joint = Joint(name="j", type=type_of_joint, parent="base", child="wheel")
    oversized = find_oversized([link(0.1), wheel(radius)], [joint])
    found = [*oversized_parts(oversized.values(), FILE)]
    assert [(one.code, one.line) for one in found] == ([] if words is None else [("ROB145", 9)])
    assert all(words in (one.hint or "") for one in found if words)


def part(
    shape: Primitive,
    *,
    mass: float,
    moment: float,
    name: str = "part",
    seen: Primitive | None = None,
) -> Link:
    inertia = (moment, 0.0, 0.0, moment, 0.0, moment)
    return Link(
        name=name,
        inertial=Inertial(mass=mass, inertia=inertia),
        collisions=(Collision(geometry=shape),),
        visuals=() if seen is None else (Visual(geometry=seen),),
    )


@pytest.mark.parametrize(
    ("shape", "mass", "moment", "hint"),
    [
        # Its inertia is that of the shape in meters.
        (Cylinder(radius=0.02, length=15), 1.0, 0.002, "for 15 cm, write 0.15."),
        (Box(size=(40, 30, 10)), 5.0, 0.1, "for 40 30 10 cm, write 0.4 0.3 0.1."),
        (Cylinder(radius=0.08, length=40), 0.5, 0.001, "for 40 mm, write 0.04."),
        (Sphere(radius=5), 0.5, 0.0005, "for 5 cm, write 0.05."),
        # Its inertia is that of the shape as it is, which is lighter than anything.
        (Cylinder(radius=0.04, length=5), 0.2, 0.4, "for 5 cm, write 0.05."),
        # A mast, a part next to nothing, and a part that only has too little inertia.
        (Cylinder(radius=0.02, length=5), 5.0, 10.0, None),
        (Box(size=(0.03, 0.2, 0.03)), 1e-5, 1e-6, None),
        (Cylinder(radius=0.1, length=0.6), 5.0, 0.001, None),
        (Box(size=(2, 1, 1)), 400.0, 1e-3, None),
    ],
)
def test_a_size_in_other_units_by_its_mass(
    shape: Primitive, mass: float, moment: float, hint: str | None
) -> None:
    links = [part(shape, mass=mass, moment=moment), link(0.1)]
    oversized = find_oversized(links, [])
    found = [*oversized_parts(oversized.values(), FILE)]
    assert [one.hint for one in found] == ([] if hint is None else [f"Use meters: {hint}"])
    advised = implausible_inertia(links, FILE, apart_from=oversized)
    assert not hint or not [*advised]


def test_a_visual_in_other_units_that_is_no_beam() -> None:
    small, large = Cylinder(radius=0.1, length=0.4), Cylinder(radius=0.1, length=6)
    wheel = part(small, mass=0.5, moment=1.5, seen=large)
    beam = part(small, mass=0.5, moment=0.001, seen=large, name="beam")
    (found,) = find_oversized([wheel, beam, link(0.1)], []).values()
    assert (found.link, found.shape) == (wheel, large)


def test_massless_root() -> None:
    (found,) = massless_root(Link(name="dummy"), [JOINT], 1.0, FILE)
    assert (found.code, found.severity) == ("ROB051", Severity.INFO)
    assert "`dummy`" in found.message
    assert "`base`" in found.message
    assert "Keep `dummy`: Nav2" in (found.hint or "")
    assert "emove" not in (found.hint or "")


def test_all_that_is_lumped_into_a_massless_root() -> None:
    others = [
        replace(JOINT, name=f"{parent}_{child}", parent=parent, child=child)
        for parent, child in (("base", "mast"), ("mast", "camera"), ("arm", "hand"))
    ]
    turning = Joint(name="t", type=JointType.CONTINUOUS, parent="base", child="arm")
    (found,) = massless_root(Link(name="dummy"), [*others, turning, JOINT], 2.5, FILE)
    assert "`base`, `mast`, `camera` into it and calls the body `dummy`" in found.message
    assert "weighs 2.5 kg" in found.message
    joints = [JOINT, *others]
    (found,) = massless_root(Link(name="dummy"), joints, 2.5, FILE, {"mast_camera"})
    assert "`base`, `mast` into it" in found.message
    assert not list(massless_root(Link(name="dummy"), joints, 2.5, FILE, {"j"}))


def test_roots_that_are_fine() -> None:
    assert list(massless_root(link(0.1), [replace(JOINT, parent="base")], 1.0, None)) == []
    assert (
        list(massless_root(Link(name="world"), [replace(JOINT, parent="world")], 1.0, None)) == []
    )
    turning = replace(JOINT, type=JointType.CONTINUOUS)
    assert list(massless_root(Link(name="dummy"), [turning], 1.0, None)) == []


@pytest.mark.parametrize(
    "name", ["libgazebo_ros_control.so", "gazebo_ros_control", "/opt/lib/libgazebo_ros_laser.so"]
)
def test_ros_1_plugin(name: str) -> None:
    (found,) = ros_1_plugin([GazeboTag(reference=None, plugins=(Plugin(name, {}),), line=3)], FILE)
    assert (found.code, found.severity, found.line) == ("ROB052", Severity.WARNING, 3)


def test_plugins_of_ros_2() -> None:
    names = ("libgazebo_ros_diff_drive.so", "libgazebo_ros2_control.so", "libmine.so")
    plugins = tuple(Plugin(name, {}) for name in names)
    assert list(ros_1_plugin([GazeboTag(reference=None, plugins=plugins)], None)) == []


def test_no_collision() -> None:
    assert [found.code for found in no_collision([Link(name="a")], None)] == ["ROB053"]
    assert list(no_collision([link(0.1), Link(name="a")], None)) == []
    assert list(no_collision([], None)) == []


def test_no_visual() -> None:
    (found,) = no_visual([link(0.1)], None)
    assert (found.code, found.severity) == ("ROB054", Severity.INFO)
    seen = replace(link(0.1), visuals=(Visual(geometry=CYLINDER),))
    assert list(no_visual([seen, Link(name="frame")], None)) == []


@pytest.mark.parametrize(
    ("simulator", "severity"),
    [(None, Severity.WARNING), ("classic", Severity.WARNING), ("gz", Severity.ERROR)],
)
def test_loose_joint(simulator: str | None, severity: Severity) -> None:
    floating = replace(JOINT, type=JointType.FLOATING)
    (found,) = loose_joint([JOINT, floating], [], None, simulator)
    assert (found.code, found.severity) == ("ROB055", severity)
    planar = replace(JOINT, type=JointType.PLANAR)
    assert [one.code for one in loose_joint([planar], [], None, simulator)] == ["ROB055"]
    assert list(loose_joint([JOINT], [], None, simulator)) == []


def limited(lower: float, upper: float, kind: JointType = JointType.REVOLUTE) -> Joint:
    return replace(JOINT, type=kind, limit=JointLimit(lower=lower, upper=upper), line=9)


@pytest.mark.parametrize("kind", [JointType.REVOLUTE, JointType.PRISMATIC])
@pytest.mark.parametrize(("lower", "upper"), [(-3.07, -0.07), (0.1, 0.2)])
def test_a_joint_that_starts_outside_its_limits(
    kind: JointType, lower: float, upper: float
) -> None:
    (found,) = starts_outside_limits([JOINT, limited(lower, upper, kind)], FILE)
    assert (found.code, found.severity, found.line) == ("ROB070", Severity.INFO, 9)
    assert f"{lower:g} to {upper:g}" in found.message
    assert found.element == "joint[@name='j']/limit"


@pytest.mark.parametrize(
    "joint",
    [
        limited(-1.0, 1.0),
        limited(0.0, 1.0),
        limited(-1.0, 0.0),
        limited(0.0, 0.0),
        limited(0.1, 0.2, JointType.CONTINUOUS),
        limited(0.1, 0.2, JointType.FIXED),
        replace(JOINT, type=JointType.REVOLUTE),
    ],
)
def test_joints_that_start_within_their_limits(joint: Joint) -> None:
    assert list(starts_outside_limits([joint], FILE)) == []
