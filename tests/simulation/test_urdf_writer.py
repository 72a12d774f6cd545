"""The text that the engine gets."""

from __future__ import annotations

from dataclasses import replace

import pytest

from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.model.robot import (
    Box,
    Capsule,
    Collision,
    Cylinder,
    Ellipsoid,
    Inertial,
    Joint,
    JointLimit,
    JointType,
    Link,
    Mesh,
    Robot,
    Sphere,
)
from wsgen.model.transform import Pose
from wsgen.simulation.urdf_writer import write_urdf

ROBOT = Robot(
    name='r "&" <x>',
    root="a",
    links=(
        Link(
            name="a",
            inertial=Inertial(
                mass=1 / 3,
                pose_in_link=Pose((0.1, 1e-20, 3.0), (0.1, 0.2, 0.3)),
                inertia=(1.0, 0.1, 0.2, 2.0, 0.3, 2.5),
            ),
            collisions=tuple(
                Collision(geometry=geometry, pose_in_link=Pose((1.0, 2.0, 3.0)))
                for geometry in (
                    Box(size=(1.0, 2.0, 3.0)),
                    Cylinder(radius=0.1, length=0.2),
                    Sphere(radius=0.3),
                )
            ),
        ),
        Link(name="b", inertial=Inertial(mass=1.0, inertia=(1.0, 0.0, 0.0, 1.0, 0.0, 1.0))),
    ),
    joints=(
        Joint(
            name="j",
            type=JointType.REVOLUTE,
            parent="a",
            child="b",
            pose_in_parent=Pose((1.0, 2.0, 3.0), (0.1, 0.2, 0.3)),
            axis_in_joint=(0.0, 0.6, 0.8),
            limit=JointLimit(lower=-1.5, upper=0.25, effort=3.0, velocity=4.0),
            damping=0.5,
            friction=0.25,
        ),
    ),
)


def test_what_is_written_is_read_back_the_same() -> None:
    read, found = read_urdf(write_urdf(ROBOT), file=None)
    assert found == ()
    assert read is not None
    assert (read.name, read.root) == (ROBOT.name, ROBOT.root)
    for ours, theirs in zip(ROBOT.links, read.links, strict=True):
        assert (ours.inertial, ours.collisions) == (theirs.inertial, theirs.collisions)
    (joint,) = read.joints
    (wanted,) = ROBOT.joints
    assert joint.limit == wanted.limit
    assert joint.pose_in_parent == wanted.pose_in_parent
    assert (joint.damping, joint.friction) == (0.5, 0.25)


def test_a_capsule_as_pybullet_reads_it() -> None:
    """Gazebo knows none in a URDF, but in an SDF."""
    link = Link(name="a", collisions=(Collision(geometry=Capsule(radius=0.1, length=0.2)),))
    text = write_urdf(Robot(name="r", root="a", links=(link,)))
    assert '<geometry><capsule radius="0.1" length="0.2"/></geometry>' in text


def test_what_is_static_collides_with_its_triangles() -> None:
    mesh, box = Mesh(uri="a", path="/a.stl"), Box(size=(1.0, 1.0, 1.0))
    link = Link(name="a", collisions=(Collision(geometry=mesh), Collision(geometry=box)))
    robot = Robot(name="r", root="a", links=(link,))
    assert "concave" not in write_urdf(robot)
    assert write_urdf(replace(robot, is_static=True)).count('<collision concave="yes">') == 1


def test_what_is_no_mesh_yet_is_left_out() -> None:
    shapes = (Ellipsoid(radii=(1.0, 1.0, 1.0)), Mesh(uri="gone.stl"))
    link = Link(name="a", collisions=tuple(Collision(geometry=shape) for shape in shapes))
    assert "<collision" not in write_urdf(Robot(name="r", root="a", links=(link,)))


@pytest.mark.parametrize("kind", [JointType.REVOLUTE, JointType.PRISMATIC])
def test_no_limit_is_one_that_is_upside_down(kind: JointType) -> None:
    """PyBullet demands one."""
    free = replace(ROBOT.joints[0], type=kind, limit=None)
    text = write_urdf(replace(ROBOT, joints=(free,)))
    assert '<limit lower="0.0" upper="-1.0"' in text
    endless = replace(free, type=JointType.CONTINUOUS)
    assert "<limit" not in write_urdf(replace(ROBOT, joints=(endless,)))


def test_no_line_is_too_long_for_the_engine() -> None:
    assert max(map(len, write_urdf(ROBOT).splitlines())) < 8192
