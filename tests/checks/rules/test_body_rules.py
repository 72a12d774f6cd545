"""The rules over single links and their shapes, each with its facts and no files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from wsgen.checks.rules.bodies import (
    attached_bodies,
    check_bodies,
    dragging_casters,
    extent_of,
    preserved_movable_joint,
    slippery_wheels,
    sticky_wheels,
    wheel_without_collision,
)
from wsgen.checks.rules.plugins import driven_joints
from wsgen.diagnostics import Severity
from wsgen.model.robot import (
    Box,
    Capsule,
    Collision,
    Cylinder,
    Ellipsoid,
    GazeboTag,
    Geometry,
    Inertial,
    Joint,
    JointType,
    Link,
    Mesh,
    Plugin,
    Sphere,
    Visual,
)
from wsgen.model.transform import Pose

FILE = Path("robot.urdf")
CUBE = Box(size=(0.2, 0.2, 0.2))
MESH = Mesh(uri="a.stl", bounds=((-0.1, -0.1, -0.1), (0.1, 0.1, 0.1)))


def link(*shapes: Geometry, mass: float = 2.0, moment: float = 0.0133, center: float = 0.0) -> Link:
    pose = Pose(xyz=(center, 0.0, 0.0))
    inertia = (moment, 0.0, 0.0, moment, 0.0, moment)
    return Link(
        name="a",
        inertial=Inertial(mass=mass, inertia=inertia, pose_in_link=pose),
        collisions=tuple(Collision(geometry=shape) for shape in shapes),
        line=5,
    )


SOUND = link(CUBE)


def codes(one: Link, *joints: Joint) -> list[tuple[str, Severity]]:
    return [(found.code, found.severity) for found in check_bodies([one], joints, FILE)]


def test_the_box_around_shapes() -> None:
    capsule = Capsule(radius=0.1, length=0.2)
    for shape, size in (
        (CUBE, 0.2),
        (Sphere(radius=0.1), 0.2),
        (Cylinder(radius=0.1, length=0.2), 0.2),
        (capsule, 0.4),
        (replace(MESH, scale=(2.0, 2.0, 2.0)), 0.4),
    ):
        extent = extent_of(link(shape))
        assert extent is not None
        assert extent.size[2] == pytest.approx(size)
    assert extent_of(link(Ellipsoid(radii=(1.0, 1.0, 1.0)))) is None
    assert extent_of(link(Mesh(uri="a.stl"))) is None
    assert extent_of(link()) is None
    turned = Collision(geometry=capsule, pose_in_link=Pose(rpy=(0.0, 1.5707963, 0.0)))
    extent = extent_of(replace(link(), collisions=(turned,)))
    assert extent is not None
    assert extent.size[0] == pytest.approx(0.4)


@pytest.mark.parametrize(
    "sound",
    [
        SOUND,
        link(MESH),
        link(CUBE, CUBE, center=0.3),
        link(Mesh(uri="a.stl"), mass=1e6),
        link(MESH, moment=0.6),
        link(Sphere(radius=0.001), mass=500.0),  # nothing can be said
        replace(SOUND, inertial=None),
    ],
)
def test_sound_links_are_silent(sound: Link) -> None:
    assert not codes(sound)


@pytest.mark.parametrize(
    ("wrong", "code", "severity"),
    [
        (link(CUBE, center=12.0), "ROB117", Severity.WARNING),
        (link(MESH, center=-1.0), "ROB117", Severity.WARNING),
        (link(Sphere(radius=0.05), mass=500.0), "ROB118", Severity.WARNING),
        (link(MESH, mass=900.0, moment=6.0), "ROB118", Severity.WARNING),
        (link(CUBE, mass=0.001), "ROB118", Severity.INFO),
        (link(MESH, moment=100.0), "ROB050", Severity.WARNING),
        (link(MESH, moment=4.0), "ROB050", Severity.INFO),
        (link(CUBE, CUBE, moment=1e-9), "ROB050", Severity.WARNING),
    ],
)
def test_masses_that_do_not_fit_the_shapes(wrong: Link, code: str, severity: Severity) -> None:
    assert codes(wrong) == [(code, severity)]
    fixed = Joint(name="j", type=JointType.FIXED, parent="a", child="b")
    assert not codes(wrong, fixed)


def test_a_visual_in_another_unit() -> None:
    small = link(Box(size=(0.05, 0.05, 0.05)), mass=0.1, moment=4e-5)
    large = Visual(geometry=replace(MESH, scale=(250.0, 250.0, 250.0)))
    (found,) = check_bodies([replace(small, visuals=(large,))], [], FILE)
    assert (found.code, found.line) == ("ROB119", 5)
    assert found.message.startswith("The visual of the link `a` measures 86.6 m")
    marker = Visual(geometry=Sphere(radius=0.001))
    assert not codes(replace(SOUND, visuals=(marker,)))
    enormous = Visual(geometry=replace(MESH, scale=(1000.0, 1000.0, 1000.0)))
    assert not codes(replace(SOUND, visuals=(enormous,)))  # reported of the mesh


WHEEL = Link(name="left_wheel", visuals=(Visual(geometry=CUBE),), line=8)
TURNS = Joint(name="j", type=JointType.CONTINUOUS, parent="a", child="left_wheel")


def test_a_wheel_that_touches_nothing() -> None:
    (found,) = wheel_without_collision([SOUND, WHEEL], [TURNS], FILE)
    assert (found.code, found.line) == ("ROB120", 8)
    tire = Joint(name="k", type=JointType.FIXED, parent="left_wheel", child="tire")
    assert not list(wheel_without_collision([SOUND, WHEEL], [TURNS, tire], FILE))
    assert not list(wheel_without_collision([WHEEL], [TURNS], FILE))
    caster = replace(WHEEL, name="caster")
    ball = Joint(name="b", type=JointType.FIXED, parent="a", child="caster")
    (found,) = wheel_without_collision([SOUND, caster], [ball], FILE)
    assert found.element == "link[@name='caster']"
    radar = replace(WHEEL, name="radar")
    assert not list(wheel_without_collision([SOUND, radar], [replace(TURNS, child="radar")], FILE))


def test_a_movable_joint_is_never_lumped() -> None:
    tag = GazeboTag(reference="j", values={"preserveFixedJoint": "true"}, line=3)
    (found,) = preserved_movable_joint([TURNS], [tag], FILE)
    assert (found.code, found.severity, found.line) == ("ROB121", Severity.INFO, 3)
    assert not list(preserved_movable_joint([replace(TURNS, type=JointType.FIXED)], [tag], FILE))


def test_a_driven_wheel_without_friction() -> None:
    drive = Plugin("gz-sim-diff-drive-system", {"left_joint": ("j",)}, "x", 3)
    tags = (
        GazeboTag(reference=None, plugins=(drive,)),
        GazeboTag(reference="left_wheel", values={"mu1": "0.0", "mu2": "0"}, line=9),
        GazeboTag(reference="caster", values={"mu1": "0.0"}, line=12),
    )
    (found,) = slippery_wheels(driven_joints(tags), [TURNS], tags, FILE)
    assert (found.code, found.line) == ("ROB122", 9)
    (found,) = slippery_wheels((), [TURNS], tags, FILE)  # ros2_control may drive it
    assert (found.line, found.severity) == (9, Severity.INFO)
    free = replace(TURNS, name="caster_wheel_joint")
    assert not list(slippery_wheels((), [free], tags, FILE))
    for mu in ("1.0", "low"):
        tag = replace(tags[1], values={"mu1": mu})
        assert not list(slippery_wheels({"j"}, [TURNS], [tag], FILE))


@pytest.mark.parametrize("key", ["mu1", "mu2"])
def test_a_wheel_that_cannot_slide(key: str) -> None:
    wheel = GazeboTag(reference=TURNS.child, values={key: "200000"}, line=9)
    (found,) = sticky_wheels({TURNS.name}, [TURNS], [wheel, wheel], FILE)
    assert (found.code, found.line, found.severity) == ("ROB129", 9, Severity.INFO)
    assert not list(sticky_wheels((), [TURNS], [wheel], FILE))
    for mu in ("1.0", "100", "low"):
        sound = replace(wheel, values={key: mu})
        assert not list(sticky_wheels({TURNS.name}, [TURNS], [sound], FILE))


def test_a_caster_that_drags() -> None:
    caster = replace(link(CUBE), name="rear_caster")
    held = replace(TURNS, name="caster_joint", type=JointType.FIXED, child=caster.name)
    joints = [TURNS, held]
    (found,) = dragging_casters({TURNS.name}, [caster], joints, [], FILE)
    assert (found.code, found.line, found.severity) == ("ROB130", 5, Severity.INFO)
    slides = GazeboTag(reference=caster.name, values={"mu1": "0.001"}, line=9)
    assert not list(dragging_casters({TURNS.name}, [caster], joints, [slides], FILE))
    assert not list(dragging_casters((), [caster], joints, [], FILE))  # nothing drives
    bare = replace(caster, collisions=())
    assert not list(dragging_casters({TURNS.name}, [bare], joints, [], FILE))
    turning = replace(held, type=JointType.CONTINUOUS)
    assert not list(dragging_casters({TURNS.name}, [caster], [turning], [], FILE))


def test_one_link_may_have_the_mass_of_all_that_are_fixed_to_it() -> None:
    fixed = Joint(name="j", type=JointType.FIXED, parent="a", child="b")
    small = replace(link(Sphere(radius=0.05)), name="b")
    for mass, expected in ((200.0, []), (400.0, ["ROB118"])):
        found = attached_bodies([link(CUBE, mass=mass), small], [fixed], FILE)
        assert [one.code for one in found] == expected
    unknown = replace(small, collisions=(Collision(geometry=Mesh(uri="a.stl")),))
    assert not [*attached_bodies([link(CUBE, mass=400.0), unknown], [fixed], FILE)]
