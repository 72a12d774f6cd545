"""Planes: the one at z = 0 is the ground, other static ones are boxes under their upper side."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

from wsgen.descriptions.sdf.lookup import model_finder
from wsgen.descriptions.sdf.models import read_model, read_sdf
from wsgen.descriptions.sdf.worlds import default_world
from wsgen.model.robot import Box, Surface
from wsgen.model.transform import Pose, compose, rotate, rotation_of_rpy

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from wsgen.descriptions.sdf.models import SdfFile
    from wsgen.model.robot import Collision, Robot

    Read = Callable[..., SdfFile]

STATIC = "<static>1</static>"
GROUND_PLANE = "<include><uri>model://ground_plane</uri>{}</include>"
FUEL = "https://fuel.gazebosim.org/1.0/OpenRobotics/models"


def plane(
    content: str = "", *, static: str = STATIC, pose: str = "0 0 0 0 0 0", normal: str = "0 0 1"
) -> str:
    shape = f"<geometry><plane><normal>{normal}</normal><size>3 4</size></plane></geometry>"
    return (
        f'<model name="floor">{static}<pose>{pose}</pose><link name="l"><inertial/>'
        f'<collision name="c">{shape}{content}</collision><visual name="v">{shape}</visual>'
        "</link></model>"
    )


def world(content: str) -> str:
    return f'<world name="w">{content}</world>'


def robot_of(file: SdfFile) -> Robot:
    (model,) = file.models
    assert model.robot is not None
    return model.robot


def upper_side(collision: Collision, link_in_world: Pose) -> tuple[Pose, tuple[float, ...]]:
    """Where the middle of the upper side of a box is, and where it faces."""
    assert isinstance(collision.geometry, Box)
    middle = Pose((0, 0, collision.geometry.size[2] / 2))
    pose = compose(compose(link_in_world, collision.pose_in_link), middle)
    return pose, rotate(rotation_of_rpy(pose.rpy), (0, 0, 1))


@pytest.mark.parametrize(
    "content",
    [
        plane(),
        plane(pose="5 6 0 0 0 1"),
        plane(pose="0 0 0 1.5707963267948966 0 0", normal="0 1 0"),
        plane(normal="0 0 5"),
        GROUND_PLANE.format(""),
        GROUND_PLANE.format("<pose>7 0 0 0 0 2</pose><name>floor</name>"),
        f"<include><uri>{FUEL}/Ground Plane</uri></include>",
        f"<include><uri>{FUEL}/Ground%20Plane/tip</uri></include>",
    ],
)
def test_the_ground(read: Read, content: str) -> None:
    file = read(world(content))
    assert file.diagnostics == ()
    assert file.world is not None
    assert file.world.has_ground_plane
    assert len(file.world.models) == 1
    assert file.models == ()  # what is nothing but ground is no model beside it


@pytest.mark.parametrize(
    ("pose", "normal"),
    [
        ("0 0 1 0 0 0", "0 0 1"),
        ("0 0 -2 0 0 0.3", "0 0 1"),
        ("1 2 0 0.1 -0.2 0.3", "0 0 1"),
        ("0 0 0 0 0 0", "0.1 0 1"),
        ("0 0 0 0 0 0", "1 0 0"),
        ("1 2 3 1 0 0", "1 -2 -0.5"),
        ("0 0 0 0 0 0", "0 0 -1"),  # a ceiling on the ground
    ],
)
def test_other_static_planes_are_boxes(read: Read, pose: str, normal: str) -> None:
    friction = "<surface><friction><ode><mu>0.3</mu><mu2>0.2</mu2></ode></friction></surface>"
    file = read(world(plane(friction, pose=pose, normal=normal)))
    assert file.diagnostics == ()  # something static carries: no word about a missing ground
    assert file.world is not None
    assert not file.world.has_ground_plane
    x, y, z, roll, pitch, yaw = map(float, pose.split())
    link_in_world = Pose((x, y, z), (roll, pitch, yaw))
    assert file.models[0].pose_in_world == link_in_world
    (link,) = robot_of(file).links
    (collision,) = link.collisions
    assert collision.geometry == Box(size=(1000, 1000, 10))
    assert collision.surface == Surface(mu1=0.3, mu2=0.2)
    assert collision.name == "c"
    middle, direction = upper_side(collision, link_in_world)
    assert middle.xyz == pytest.approx((x, y, z), abs=1e-12)
    nx, ny, nz = map(float, normal.split())
    expected = rotate(rotation_of_rpy(link_in_world.rpy), (nx, ny, nz))
    assert direction == pytest.approx([part / math.hypot(nx, ny, nz) for part in expected])


def test_a_plane_is_seen_in_its_size(read: Read) -> None:
    file = read(world(plane(pose="0 0 1 0 0 0")))
    (visual,) = robot_of(file).links[0].visuals
    assert isinstance(visual.geometry, Box)
    assert visual.geometry.size[:2] == (3, 4)
    assert visual.geometry.size[2] < 0.01
    assert visual.pose_in_link.xyz[2] + visual.geometry.size[2] / 2 == pytest.approx(0)


@pytest.mark.parametrize("uri", ["model://ground_plane", f"{FUEL}/Ground Plane/2"])
def test_gazebos_ground_elsewhere(read: Read, uri: str) -> None:
    file = read(world(f"<include><uri>{uri}</uri><pose>0 0 -0.5 0 0 0</pose></include>"))
    assert file.diagnostics == ()
    assert file.world is not None
    assert not file.world.has_ground_plane
    assert [(one.name, one.is_static, one.pose_in_world) for one in file.models] == [
        ("ground_plane", True, Pose((0, 0, -0.5)))
    ]
    (link,) = robot_of(file).links
    assert link.collisions[0].surface.mu1 == 100
    assert link.visuals[0].geometry == Box(size=(100, 100, 0.001))


def test_gazebos_ground_in_a_model(read: Read) -> None:
    file = read(
        world(f'<model name="yard">{STATIC}<link name="l"/>{GROUND_PLANE.format("")}</model>')
    )
    assert file.diagnostics == ()
    assert file.world is not None
    assert file.world.has_ground_plane


def test_a_plane_that_moves_is_left_out(read: Read) -> None:
    file = read(world(plane(static="")))
    assert [found.code for found in file.diagnostics] == ["WLD031", "WLD006"]
    assert robot_of(file).links[0].collisions == ()
    file = read(world(GROUND_PLANE.format("<static>0</static>")))
    assert [found.code for found in file.diagnostics] == ["WLD035", "WLD031", "WLD006"]


def test_more_than_the_ground_remains(read: Read) -> None:
    """A model with the ground and a wall is the wall."""
    box = '<collision name="wall"><geometry><box/></geometry></collision>'
    file = read(world(plane().replace("</link>", f"{box}</link>")))
    assert file.world is not None
    assert file.world.has_ground_plane
    (link,) = robot_of(file).links
    assert [one.name for one in link.collisions] == ["wall"]
    assert link.visuals == ()


@pytest.mark.parametrize(
    ("content", "codes"),
    [
        (plane(normal="0 0 0"), ["WLD034", "WLD034", "WLD006"]),
        (plane(normal="0 0 nan"), ["ROB016"]),
        (plane(pose="0 0 1 0 0 0").replace("3 4", "0 4"), ["ROB028"]),
        (plane(pose="0 0 1 0 0 0").replace("3 4", "4"), ["ROB016"]),
    ],
)
def test_what_is_wrong_with_planes(read: Read, content: str, codes: list[str]) -> None:
    found = [one.code for one in read(world(content)).diagnostics]
    assert list(dict.fromkeys(found)) == list(dict.fromkeys(codes))


@pytest.mark.parametrize(("height", "is_ground"), [(0.0, True), (0.5, False)])
def test_a_ground_that_is_spawned(*, height: float, is_ground: bool) -> None:
    text = f'<sdf version="1.6">{plane(pose="0 0 9 0 0 0")}</sdf>'
    file = read_model(
        text, file=None, find_model=lambda _: None, pose_in_world=Pose((0, 0, height))
    )
    assert file.diagnostics == ()
    assert [one.ground_friction is not None for one in file.models] == [is_ground]
    (link,) = robot_of(file).links
    assert len(link.collisions) == len(link.visuals) == (0 if is_ground else 1)


def test_static_terrain_carries(read: Read) -> None:
    terrain = (
        f'<model name="hill">{STATIC}<link name="l"><collision name="c"><geometry><heightmap>'
        "<uri>model://hill/hill.png</uri></heightmap></geometry></collision></link></model>"
    )
    file = read(world(terrain))
    assert "WLD006" not in {found.code for found in file.diagnostics}


def test_ground_that_is_a_missing_mesh(tmp_path: Path) -> None:
    """The mesh is the one error: what is spawned stands on a plane, and does not fall as well."""
    mesh = '<collision name="c"><geometry><mesh><uri>field.stl</uri></mesh></geometry></collision>'
    content = (
        '<sdf version="1.9"><world name="w"><model name="field"><static>1</static>'
        f'<link name="l">{mesh}</link></model></world></sdf>'
    )
    file = tmp_path / "w.sdf"
    found = read_sdf(file, find_model=model_finder(file, {}), content=content)
    assert [one.code for one in found.diagnostics] == ["ROB060"]
    assert found.world is not None
    assert found.world.has_ground_plane


@pytest.mark.parametrize(
    ("content", "friction"),
    [
        (GROUND_PLANE.format(""), 100.0),
        (plane(), 1.0),
        (plane("<surface><friction><ode><mu>0.3</mu></ode></friction></surface>"), 0.3),
    ],
)
def test_the_friction_of_the_ground(read: Read, content: str, friction: float) -> None:
    file = read(world(content))
    assert file.world is not None
    assert file.world.ground_friction == friction


def test_the_friction_in_worlds_that_simulators_bring_along() -> None:
    assert default_world("classic").ground_friction == 100.0
    assert default_world("gz").ground_friction == 1.0
