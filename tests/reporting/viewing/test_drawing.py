"""What is drawn of a robot: shapes, the box of an inertia, where it stands."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from wsgen.model.robot import (
    Box,
    Collision,
    Inertial,
    Joint,
    JointLimit,
    JointType,
    Link,
    Mesh,
    Robot,
    Sphere,
    Visual,
)
from wsgen.model.transform import Pose, quaternion_of_rpy, rotation_of_quaternion
from wsgen.pipeline.describe import DescribedScene
from wsgen.pipeline.prepare import PreparedRobot
from wsgen.reporting.viewing.drawing import DrawnRobot, draw, draw_simulated, inertia_box

if TYPE_CHECKING:
    from pathlib import Path


def drawn(robot: Robot, surfaces: dict[str, str] | None = None, **values: Any) -> DrawnRobot:
    prepared = PreparedRobot(entity="r", written=robot, lumped=robot, readable=robot, **values)
    found = DescribedScene(
        name="r",
        launch_file=None,
        world=None,
        robots=(prepared,),
        diagnostics=(),
        collision_surfaces=surfaces or {},
        files=(),
    )
    return draw(found)[0]


def box_inertia(mass: float, size: tuple[float, float, float]) -> tuple[float, ...]:
    x, y, z = (edge * edge for edge in size)
    return (mass * (y + z) / 12, 0.0, 0.0, mass * (x + z) / 12, 0.0, mass * (x + y) / 12)


def corners(center: Any, orientation: Any, size: Any) -> set[tuple[float, ...]]:
    """The corners of a box, rounded, in any order."""
    w, x, y, z = orientation
    rotation = np.array(rotation_of_quaternion((x, y, z, w)))
    signs = [(a, b, c) for a in (-0.5, 0.5) for b in (-0.5, 0.5) for c in (-0.5, 0.5)]
    points = [np.array(center) + rotation @ (np.array(size) * sign) for sign in signs]
    return {tuple(round(float(part), 6) + 0.0 for part in point) for point in points}


@pytest.mark.parametrize("rpy", [(0.0, 0.0, 0.0), (0.3, -0.8, 1.2), (math.pi, 0.1, -2.0)])
def test_the_box_of_the_inertia_of_a_box_is_that_box(rpy: tuple[float, float, float]) -> None:
    size = (0.1, 0.4, 0.7)
    six = box_inertia(3.0, size)
    pose = Pose((1.0, 2.0, 3.0), rpy)
    found = inertia_box(Inertial(mass=3.0, pose_in_link=pose, inertia=six))  # type: ignore[arg-type]
    assert found is not None
    x, y, z, w = quaternion_of_rpy(rpy)
    assert corners(found.center, found.orientation, found.size) == corners(
        pose.xyz, (w, x, y, z), size
    )


@pytest.mark.parametrize(
    ("mass", "six"),
    [(0.0, (1.0, 0.0, 0.0, 1.0, 0.0, 1.0)), (math.nan, (1.0,) * 6), (1.0, (math.inf,) * 6)],
)
def test_no_box_is_drawn_of_what_is_no_inertia(mass: float, six: Any) -> None:
    assert inertia_box(Inertial(mass=mass, inertia=six)) is None


def test_an_impossible_inertia_gives_a_flat_box() -> None:
    found = inertia_box(Inertial(mass=1.0, inertia=(1.0, 0.0, 0.0, 1.0, 0.0, 5.0)))
    assert found is not None
    assert min(found.size) == pytest.approx(1e-3)
    assert all(map(math.isfinite, (*found.size, *found.orientation)))


def link(name: str, radius: float, pose: Pose | None = None) -> Link:
    at = pose or Pose()
    return Link(
        name=name,
        visuals=(Visual(geometry=Sphere(radius=radius), pose_in_link=at),),
        collisions=(Collision(geometry=Sphere(radius=radius), pose_in_link=at),),
    )


def test_a_robot_from_a_file_stands_on_the_ground() -> None:
    found = drawn(Robot(name="r", root="a", links=(link("a", 0.5),)), on_the_ground=True)
    assert found.pose_in_world.xyz == pytest.approx((0.0, 0.0, 0.5))
    assert found.low == pytest.approx((-0.5, -0.5, 0.0), abs=1e-6)


def test_a_spawned_robot_is_where_it_is_spawned() -> None:
    found = drawn(Robot(name="r", root="a", links=(link("a", 0.5),)), spawn_pose=Pose((1, 2, 3)))
    assert found.pose_in_world.xyz == (1, 2, 3)
    assert found.high == pytest.approx((1.5, 2.5, 3.5), abs=1e-6)


def test_links_come_behind_their_parents_and_keep_fixed_ones() -> None:
    joints = (
        Joint(name="k", type=JointType.FIXED, parent="b", child="c"),
        Joint(
            name="j",
            type=JointType.REVOLUTE,
            parent="a",
            child="b",
            limit=JointLimit(lower=-1, upper=1),
        ),
    )
    links = tuple(link(name, 0.1) for name in "cba")
    found = drawn(Robot(name="r", root="a", links=links, joints=joints))
    assert [(one.name, one.parent) for one in found.links] == [("a", None), ("b", 0), ("c", 1)]
    assert [slider.joint for slider in found.sliders] == ["j"]


def test_a_robot_without_shapes_can_be_shown() -> None:
    found = drawn(Robot(name="r", root="a", links=(Link(name="a"),)), on_the_ground=True)
    assert found.size == 0.0


def test_the_mesh_of_a_collision_is_drawn_from_its_array(tmp_path: Path) -> None:
    mesh = Mesh(uri="part.stl", path="/part.stl")
    missing = Mesh(uri="other.stl", path="/other.stl")
    one = Link(name="a", collisions=(Collision(geometry=Box(size=(1, 1, 1))),))
    parts = Link(name="b", collisions=(Collision(geometry=mesh), Collision(geometry=missing)))
    robot = Robot(
        name="r",
        root="a",
        links=(one, parts),
        joints=(Joint(name="j", type=JointType.FIXED, parent="a", child="b"),),
    )
    array = np.zeros((3, 3, 1), dtype=np.float32)
    file = tmp_path / "part.npy"
    np.save(file, array)
    found = drawn(robot, {"/part.stl": str(file)})
    assert [part.geometry.path for part in found.links[1].collisions] == [str(file)]  # type: ignore[union-attr]


def test_a_simulated_robot_has_links_that_stand_by_themselves() -> None:
    joints = (Joint(name="j", type=JointType.CONTINUOUS, parent="a", child="b"),)
    robot = Robot(name="r", root="a", links=(link("a", 0.2), link("b", 0.1)), joints=joints)
    found = draw_simulated(robot, Pose((0, 0, 1)), {}, entity="r", is_static_model=False)
    assert [one.parent for one in found.links] == [None, None]
    assert found.pose_in_world == Pose()
    assert found.low[2] == pytest.approx(0.8, abs=1e-6)
