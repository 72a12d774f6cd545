"""Surfaces for pages: all of a robot, in its place and colors, of as few triangles as wanted."""

from __future__ import annotations

import base64
import io
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image

from simulation.fake_engine import FakeEngine
from wsgen.model.robot import Box, Cylinder, Inertial, Link, Mesh, Robot, Sphere, Visual
from wsgen.model.transform import Pose
from wsgen.model.world import World
from wsgen.pipeline.tasks.simulation import simulate
from wsgen.rendering.render_items import list_render_items
from wsgen.rendering.renderer import Renderer
from wsgen.rendering.scene_renderer import AROUND, Triangles, View, merge, simplify
from wsgen.rendering.scene_renderer import view_of as surfaces_of
from wsgen.simulation.engine import State
from wsgen.simulation.scene import Scene, SpawnedRobot

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.outcome import SceneView, ViewPart
    from wsgen.model.robot import Geometry

AT = Pose((0.0, 0.0, 1.0))
RED, BLUE = (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 0.5)
INERTIAL = Inertial(mass=1.0, inertia=(1, 0, 0, 1, 0, 1))


def robot_of(*visuals: Visual) -> Robot:
    return Robot(
        name="r", root="base", links=(Link(name="base", inertial=INERTIAL, visuals=visuals),)
    )


def scene_of(*robots: SpawnedRobot, most: int) -> Scene:
    return Scene(
        world=World(name="w", has_ground_plane=True),
        robots=robots,
        seconds=0.1,
        view_triangles=most,
    )


def view_of(robot: Robot, *others: SpawnedRobot, most: int = 10_000) -> View:
    """The surfaces of a robot whose root is 1 m above the ground."""
    scene = scene_of(SpawnedRobot(entity="e", robot=robot), *others, most=most)
    renderer = Renderer(list_render_items(scene, ()), towards_light=(0.0, 0.0, 1.0))
    renderer.arrange({one.entity: {"base": AT} for one in scene.robots})
    return surfaces_of((placed for _, placed in renderer.placed()), most)


def drawn(robot: Robot, *others: SpawnedRobot) -> SceneView:
    """What a page gets of it."""
    still = State((0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 1.0), 0.0, 0.0, 0.0)

    class Engine(FakeEngine):
        def link_poses(self, entity: str) -> dict[str, Pose]:  # noqa: ARG002
            return {"base": AT}

    scene = scene_of(SpawnedRobot(entity="e", robot=robot), *others, most=1000)
    view = simulate(scene, lambda _: Engine(lambda _seconds: still)).view
    assert view is not None
    return view


def corners_of(part: ViewPart) -> np.ndarray:
    levels = np.frombuffer(base64.b64decode(part.corners), dtype="<u2").reshape(-1, 3)
    corners: np.ndarray = np.array(part.low) + levels * np.array(part.step)
    return corners


def triangles_of(part: ViewPart) -> np.ndarray:
    kind = "<u4" if part.has_wide_numbers else "<u2"
    return np.frombuffer(base64.b64decode(part.triangles), dtype=kind).reshape(-1, 3)


def visual(geometry: Geometry, rgba: tuple[float, float, float, float] = RED) -> Visual:
    return Visual(geometry=geometry, pose_in_link=Pose((2.0, 0.0, 0.0)), rgba=rgba)


def test_a_box_is_where_its_link_is() -> None:
    view = view_of(robot_of(visual(Box(size=(1.0, 2.0, 0.5)))))
    (part,) = view.parts
    assert (part.entity, part.link, part.rgba, part.is_round) == ("e", "base", RED, False)
    corners = corners_of(part)
    assert corners.min(axis=0) == pytest.approx([1.5, -1.0, 0.75], abs=1e-4)
    assert corners.max(axis=0) == pytest.approx([2.5, 1.0, 1.25], abs=1e-4)
    assert len(triangles_of(part)) == view.triangles == view.triangles_before == 12


def test_its_triangles_are_seen_from_outside() -> None:
    (part,) = view_of(robot_of(visual(Box(size=(1.0, 2.0, 0.5))))).parts
    a, b, c = corners_of(part)[triangles_of(part)].transpose(1, 0, 2)
    outwards = (a + b + c) / 3 - np.array([2.0, 0.0, 1.0])
    assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), outwards) > 0).all()


def test_each_color_is_a_part() -> None:
    both = robot_of(visual(Box(size=(1, 1, 1))), visual(Sphere(radius=1.0), BLUE))
    parts = {part.rgba: part for part in view_of(both).parts}
    assert parts.keys() == {RED, BLUE}
    assert [part.is_round for part in parts.values()] == [False, True]


def test_the_edges_of_a_cylinder_stay_sharp() -> None:
    """Corners on its rim are two: one of the side, one of the end."""
    (part,) = view_of(robot_of(visual(Cylinder(radius=1.0, length=1.0)))).parts
    assert part.is_round
    places = {tuple(corner) for corner in np.round(corners_of(part), 3)}
    assert len(places) == 2 * AROUND + 2  # rims, and the middles of both ends
    assert len(corners_of(part)) == 4 * AROUND + 2


@pytest.mark.slow
def test_the_picture_is_webp_and_the_world_has_its_own() -> None:
    robot = robot_of(visual(Box(size=(1, 1, 1))))
    alone = drawn(robot)
    table = SpawnedRobot(entity="table", robot=robot, is_static_model=True)
    both = drawn(robot, table)
    assert alone.has_ground
    assert alone.world_picture is None
    assert both.world_picture is not None
    assert [part.is_robot for part in both.parts] == [True, False]
    with Image.open(io.BytesIO(base64.b64decode(alone.picture or ""))) as image:
        assert (image.format, image.size) == ("WEBP", (960, 720))


def ball(rings: int) -> np.ndarray:
    """A sphere of radius 1 as n triangles, n by 3 by 3."""
    up = np.linspace(-np.pi / 2, np.pi / 2, rings + 1)
    around = np.linspace(0, 2 * np.pi, 2 * rings + 1)
    points = np.stack(
        [
            np.cos(up)[:, None] * np.cos(around),
            np.cos(up)[:, None] * np.sin(around),
            np.sin(up)[:, None] * np.ones_like(around),
        ],
        axis=-1,
    )
    a, b, c, d = points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]
    return np.concatenate(
        [
            np.stack([a, b, c], axis=2).reshape(-1, 3, 3),
            np.stack([a, c, d], axis=2).reshape(-1, 3, 3),
        ]
    )


@pytest.mark.parametrize("most", [100, 1000, 5000])
def test_a_simpler_surface_is_almost_where_it_was(most: int) -> None:
    mesh = merge(np.round(ball(60), 9))
    (found,) = simplify([mesh], most)
    assert most / 3 < len(found.triangles) <= most
    far = np.abs(np.linalg.norm(found.corners, axis=1) - 1)
    assert far.max() < 3.0 / most**0.5


def test_what_is_simple_enough_stays_as_it_is() -> None:
    mesh = merge(ball(10))
    assert simplify([mesh], 10_000)[0] is mesh


def test_what_is_tiny_stays_as_a_box() -> None:
    large, tiny = merge(np.round(ball(60), 9)), merge(ball(4) * 1e-4 + 2.0)
    _, found = simplify([large, tiny], 500)
    assert len(found.triangles) == 12
    assert found.corners.min(axis=0) == pytest.approx([2 - 1e-4] * 3, abs=1e-6)


def test_corners_are_merged_and_what_has_no_area_is_left_out() -> None:
    square = np.array([[[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [1, 1, 0], [0, 1, 0.0]]])
    line = np.array([[[0, 0, 0], [1, 0, 0], [1, 0, 0.0]]])
    mesh = merge(np.concatenate([square, line]))
    assert (len(mesh.corners), len(mesh.triangles)) == (4, 2)
    assert isinstance(mesh, Triangles)


@pytest.mark.slow
def test_the_robot_keeps_more_than_the_world(tmp_path: Path) -> None:
    file = tmp_path / "ball.npy"
    np.save(file, np.round(ball(60), 6).astype(np.float32).transpose(2, 1, 0))
    mesh = Mesh(uri="ball", path=str(file), bounds=((-1, -1, -1), (1, 1, 1)))
    robot = robot_of(visual(mesh))
    table = SpawnedRobot(entity="table", robot=robot, is_static_model=True)
    view = view_of(robot, table, most=2000)
    counts = {part.is_robot: len(triangles_of(part)) for part in view.parts}
    assert counts[True] > 2 * counts[False] > 0
    assert sum(counts.values()) == view.triangles <= 2000 < view.triangles_before


def test_a_texture_colors_its_triangles(tmp_path: Path) -> None:
    Image.new("RGB", (2, 1)).save(tmp_path / "t.png")
    with Image.open(tmp_path / "t.png") as image:
        image.putpixel((0, 0), (255, 0, 0))
        image.putpixel((1, 0), (0, 0, 255))
        image.save(tmp_path / "t.png")
    corners = np.array(
        [[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 1], [1, 0, 1], [0, 1, 1]]], dtype=np.float32
    ).transpose(2, 1, 0)
    normals = np.full_like(corners, np.nan)
    points = np.empty((2, 3, 2), dtype=np.float32)
    points[0, :, 0], points[0, :, 1], points[1] = 0.25, 0.75, 0.5
    np.save(tmp_path / "m.npy", np.concatenate([corners, normals, points]))
    mesh = Mesh(uri="m", path=str(tmp_path / "m.npy"), bounds=((0, 0, 0), (1, 1, 1)))
    textured = replace(visual(mesh), rgba=None, texture=str(tmp_path / "t.png"))
    colors = {part.rgba[:3] for part in view_of(robot_of(textured)).parts}
    assert colors == {(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)}


def test_what_cannot_be_drawn_is_said() -> None:
    broken = robot_of(visual(Mesh(uri="gone", path="/no/such.npy", bounds=None)))
    assert "No such file" in (drawn(broken).problem or "")


@pytest.mark.slow
def test_a_video_does_not_move_it(tmp_path: Path) -> None:
    """The frames of a video show other moments than the end of the standing."""
    robot = robot_of(visual(Box(size=(1, 1, 1))))
    poses = iter([Pose((0.0, 0.0, z)) for z in (1.0, 2.0, 3.0, 4.0, 5.0)])
    still = State((0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 1.0), 0.0, 0.0, 0.0)
    asked: list[Pose] = []

    class Engine(FakeEngine):
        def link_poses(self, entity: str) -> dict[str, Pose]:  # noqa: ARG002
            asked.append(next(poses, AT))
            return {"base": asked[-1]}

    scene = scene_of(SpawnedRobot(entity="e", robot=robot), most=1000)
    result = simulate(
        replace(scene, record=tmp_path / "v.gif"), lambda _: Engine(lambda _seconds: still)
    )
    assert (tmp_path / "v.gif").is_file()
    assert result.view is not None
    (part,) = result.view.parts
    assert corners_of(part)[:, 2].mean() == pytest.approx(asked[-1].xyz[2], abs=1e-3)


@pytest.mark.slow
def test_a_robot_without_visuals_has_a_picture_alone() -> None:
    empty = Robot(name="r", root="base", links=(Link(name="base", inertial=INERTIAL),))
    view = drawn(empty)
    assert view.picture is not None
    assert view.parts == ()
