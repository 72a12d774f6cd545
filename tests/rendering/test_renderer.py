"""The renderer: depth and segmentation, what is cut off, shadows on things, edges, dense meshes."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from rendering.showpieces import BLUE, GROUND, photograph, piece, pixels_of, spawned
from wsgen.model.engines import ENGINES
from wsgen.model.robot import Box, Collision, Cylinder, Inertial, Link, Sphere, Visual
from wsgen.model.transform import Pose
from wsgen.rendering.camera import Camera, sun_view
from wsgen.rendering.render_items import RenderItem
from wsgen.rendering.renderer import NOTHING, Renderer, Shadow
from wsgen.simulation.run import missing_engines, run_simulation
from wsgen.simulation.scene import Scene, SpawnedRobot

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from rendering.showpieces import Pixels
    from wsgen.model.robot import Primitive
    from wsgen.model.transform import Vector
    from wsgen.rendering.render_items import Rgba

RED: Rgba = (1.0, 0.0, 0.0, 1.0)
WHITE: Rgba = (1.0, 1.0, 1.0, 1.0)


def world_of(*things: tuple[Primitive, Vector, Rgba]) -> Renderer:
    """Things at places; the link of each has its number as name."""
    items = [
        RenderItem(entity="e", link=str(number), geometry=geometry, rgba=rgba)
        for number, (geometry, _, rgba) in enumerate(things)
    ]
    renderer = Renderer(items, towards_light=(0.0, 0.0, 1.0))
    renderer.arrange({"e": {str(number): Pose(at) for number, (_, at, _) in enumerate(things)}})
    return renderer


def camera(eye: Vector, target: Vector) -> Camera:
    return Camera(eye, target, 40.0, 0.1, 1000.0, 160, 120)


def rays(taken: Camera) -> NDArray[np.float64]:
    """Where pixels look, height by width by 3: directions in the world, 1 along the axis."""
    slope = np.tan(np.radians(taken.field_of_view / 2))
    across = ((np.arange(taken.width) + 0.5) / taken.width * 2 - 1) * slope * taken.aspect
    up = (1 - (np.arange(taken.height) + 0.5) / taken.height * 2) * slope
    right, upwards, forward = taken.axes
    directions: NDArray[np.float64] = (
        forward + across[None, :, None] * right + up[:, None, None] * upwards
    )
    return directions


# What a depth camera sees


def test_the_depth_of_a_plane_is_exact() -> None:
    table = world_of((Box(size=(50.0, 50.0, 0.2)), (0.0, 0.0, 0.9), WHITE))
    taken = camera((-2.0, 1.0, 4.0), (3.0, 0.0, 1.0))
    depth = table.sense(taken).depth
    towards = rays(taken)
    expected = (1.0 - 4.0) / towards[..., 2]
    on_top = expected * np.hypot(*np.moveaxis(towards[..., :2], -1, 0)) < 20
    assert on_top.mean() > 0.9
    assert np.abs(depth / expected - 1)[on_top].max() < 2e-6


def test_the_depth_of_a_ball() -> None:
    ball = world_of((Sphere(radius=1.0), (0.0, 0.0, 1.0), WHITE))
    sensed = ball.sense(camera((6.0, 0.0, 1.0), (0.0, 0.0, 1.0)))
    assert sensed.depth[59:61, 79:81].mean() == pytest.approx(5.0, abs=0.01)
    assert np.isinf(sensed.depth[0, 0])
    assert ((sensed.item == NOTHING) == np.isinf(sensed.depth)).all()
    assert (sensed.item >= 0).mean() == pytest.approx(0.127, abs=0.002)


def test_each_pixel_names_the_item_that_it_shows() -> None:
    glass = (0.0, 0.0, 1.0, 0.4)
    renderer = world_of(
        (Box(size=(1.0, 1.0, 1.0)), (0.0, 1.0, 0.5), glass),
        (Box(size=(1.0, 1.0, 1.0)), (0.0, -1.0, 0.5), RED),
        (Sphere(radius=0.2), (-3.0, 1.0, 0.5), RED),  # behind the glass
    )
    taken = camera((8.0, 0.0, 3.0), (0.0, 0.0, 0.5))
    sensed = renderer.sense(taken)

    def at(point: Vector) -> str:
        column, row, _ = taken.view.project(
            (taken.view.matrix @ (np.array(point) - taken.eye)).astype(np.float32)
        )
        number = int(sensed.item[int(row), int(column)])
        return renderer.items[number].link if number >= 0 else str(number)

    assert at((0.5, 1.0, 0.5)) == "0"
    assert at((0.5, -1.0, 0.5)) == "1"
    assert at((3.0, 0.0, 0.0)) == at((-992.0, 0.0, 33.0)) == str(NOTHING)


def test_what_reaches_behind_the_camera_is_cut_off_before_it() -> None:
    floor = world_of((Box(size=(400.0, 3.0, 1.0)), (0.0, 0.0, -0.5), WHITE))
    taken = camera((0.0, 0.0, 1.0), (10.0, 0.0, 0.5))
    sensed = floor.sense(taken)
    towards = rays(taken)
    expected = -1.0 / towards[..., 2]
    is_floor = (expected > 0) & (expected < 150) & (np.abs(expected * towards[..., 1]) < 1.45)
    assert is_floor.mean() > 0.1
    assert (sensed.item[is_floor] == 0).all()
    assert np.abs(sensed.depth / expected - 1)[is_floor].max() < 1e-4
    beside = (expected > 0) & (np.abs(expected * towards[..., 1]) > 1.6)
    assert (sensed.item[beside & (expected < 50)] == NOTHING).all()


def test_what_is_nearer_than_the_near_plane_is_not_seen() -> None:
    wall = world_of((Box(size=(0.1, 9.0, 9.0)), (4.0, 0.0, 0.0), RED))
    taken = camera((5.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    assert (wall.sense(taken).item == 0).all()
    assert (wall.sense(replace(taken, near=1.2)).item == NOTHING).all()


# Shadows


def spot(pixels: Pixels, rows: slice, columns: slice) -> float:
    return float(pixels[rows, columns].mean())


@pytest.mark.slow
def test_a_thing_throws_its_shadow_on_another(tmp_path: Path) -> None:
    plate = Visual(geometry=Box(size=(2.0, 2.0, 0.1)), rgba=WHITE)
    ball = Visual(geometry=Sphere(radius=0.3), rgba=BLUE, pose_in_link=Pose((0.0, 0.0, 0.8)))
    noon = replace(GROUND, sun_direction=(0.0, 0.0, -1.0))
    alone, _ = photograph(tmp_path, spawned(Link(name="base", visuals=(plate,))), world=noon)
    link = Link(name="base", visuals=(plate, ball))
    below, _ = photograph(tmp_path, spawned(link), world=noon)
    white = below[(below.min(axis=2) > 100) & (np.ptp(below, axis=2) < 8)]
    lit = float(alone[360, 480].mean())
    # The plate has the same light as before, or none of the sun's.
    assert (np.abs(white.mean(axis=1) - lit) < 3).any()
    assert (np.abs(white.mean(axis=1) - lit * 0.6) < 25).mean() > 0.01


@pytest.mark.parametrize("sun", [(0.0, -0.1, 1.0), (0.7, -0.3, 0.5), (1.0, -0.6, 0.3)])
@pytest.mark.parametrize(
    "geometry", [Box(size=(1.0, 1.0, 0.5)), Cylinder(radius=0.5, length=0.5), Sphere(radius=0.5)]
)
def test_a_thing_throws_no_shadow_on_its_lit_side(geometry: Primitive, sun: Vector) -> None:
    renderer = world_of((geometry, (0.0, 0.0, 0.25), WHITE))
    taken = camera((1.5, -1.0, 2.0), (0.0, 0.0, 0.25))
    (points,) = renderer.points().values()
    shadow = Shadow(renderer.see(sun_view(points, sun, 300)), renderer)
    sensed = renderer.sense(taken)
    is_seen = sensed.item == 0
    places = rays(taken)[is_seen] * sensed.depth[is_seen][:, None] + taken.eye
    if isinstance(geometry, Sphere):
        normals = (places - (0.0, 0.0, 0.25)) / 0.5
    else:  # its top
        normals = np.where(places[:, 2:] > 0.5 - 1e-4, (0.0, 0.0, 1.0), 0.0)
    is_lit = normals @ sun / np.linalg.norm(sun) > 0.2
    assert is_lit.sum() > 500
    in_view = taken.view.matrix @ (places - taken.eye)[is_lit].T
    light = shadow.light_at(
        taken.view, in_view.astype(np.float32), normals[is_lit].T.astype(np.float32)
    )
    assert light.min() > 0.99


@pytest.mark.slow
def test_a_shadow_begins_where_the_thing_stands(tmp_path: Path) -> None:
    plate = Visual(geometry=Box(size=(2.0, 2.0, 0.1)), rgba=WHITE)
    post = Visual(geometry=Box(size=(0.2, 0.2, 0.8)), rgba=RED, pose_in_link=Pose((0.0, 0.0, 0.45)))
    world = replace(GROUND, sun_direction=(0.6, 0.6, -0.6))
    pixels, _ = photograph(tmp_path, spawned(Link(name="base", visuals=(plate, post))), world=world)
    is_red = (pixels[..., 0] > 80) & (pixels[..., 1] < 60)
    foot = np.nonzero(is_red.any(axis=1))[0].max()
    right = np.nonzero(is_red[foot - 14])[0].max()
    beside = pixels[foot - 14, right + 4 : right + 8].mean()
    assert beside < 200  # not a bright line between the post and its shadow


# Edges


@pytest.mark.slow
def test_edges_are_smooth(tmp_path: Path) -> None:
    pixels, _ = photograph(tmp_path, piece(Sphere(radius=0.5), rgba=BLUE, at=Pose((0, 0, 0.5))))
    red = pixels[300:420, :, 0].astype(int)
    inside = (pixels[300:420, :, 2].astype(int) - red) > 60
    first = inside.argmax(axis=1)
    # Where the ball begins, a pixel is partly ball: its level is between those of its neighbors.
    between = 0
    for row, column in enumerate(first):
        outer, inner = red[row, column - 3], red[row, column + 3]
        edge = red[row, column - 1 : column + 2]
        between += bool(((edge > inner + 20) & (edge < outer - 20)).any())
    assert between > 0.5 * len(first)


# Dense meshes

DENSE = """
import re, resource, sys, time
resource.setrlimit(resource.RLIMIT_AS, (4 * 2**30, 4 * 2**30))
import numpy as np
from pathlib import Path
from wsgen.model.robot import Mesh
from wsgen.model.transform import Pose
from rendering.showpieces import BLUE, piece, scene_renderer_of
folder = Path(sys.argv[1])
steps = 708
u, v = np.meshgrid(np.linspace(0, np.pi, steps + 1), np.linspace(0, 2 * np.pi, steps + 1))
grid = np.stack([np.sin(u) * np.cos(v), np.sin(u) * np.sin(v), np.cos(u)]).astype(np.float32)
a, b, c, d = grid[:, :-1, :-1], grid[:, 1:, :-1], grid[:, 1:, 1:], grid[:, :-1, 1:]
parts = [np.stack(part, axis=1).reshape(3, 3, -1) for part in ([a, b, c], [a, c, d])]
rows = np.concatenate(parts, axis=2)
np.save(folder / "dense.npy", rows)
assert rows.shape[2] > 1_000_000
mesh = Mesh(uri="dense", path=str(folder / "dense.npy"))
started = time.process_time()
scene_renderer_of(piece(mesh, rgba=BLUE, at=Pose((0, 0, 1)))).draw(folder / "dense.png")
# `ru_maxrss` begins with that of the process of the tests, whatever has run in it.
(most,) = re.findall(r"VmHWM:\\s+(\\d+) kB", Path("/proc/self/status").read_text())
print(time.process_time() - started, int(most) / 1024)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="macOS knows no limit of memory")
def test_a_million_triangles_are_drawn_as_they_are(tmp_path: Path) -> None:
    run = subprocess.run(
        [sys.executable, "-c", DENSE, str(tmp_path)],
        capture_output=True,
        check=False,
        text=True,
        env={"PYTHONPATH": ":".join(sys.path), "OPENBLAS_NUM_THREADS": "1"},
    )
    assert run.returncode == 0, run.stderr
    seconds, megabytes = map(float, run.stdout.split())
    assert seconds < 6
    assert megabytes < 700
    ball, _ = photograph(tmp_path, piece(Sphere(radius=1.0), rgba=BLUE, at=Pose((0, 0, 1))))
    dense = pixels_of(tmp_path / "dense.png")
    assert np.abs(dense.astype(int) - ball).mean() < 1.0  # levels of 256


# Engines


@pytest.mark.slow
def test_every_engine_has_the_same_picture_of_things_at_the_same_places(tmp_path: Path) -> None:
    geometry = Cylinder(radius=0.2, length=0.6)
    link = Link(
        name="base",
        inertial=Inertial(mass=1.0, inertia=(0.1, 0.0, 0.0, 0.1, 0.0, 0.1)),
        visuals=(Visual(geometry=geometry, rgba=BLUE),),
        collisions=(Collision(geometry=geometry),),
    )
    standing = spawned(link, at=Pose((0.3, 0.2, 0.3), (0.0, 0.0, 0.7)))
    fixed = SpawnedRobot(
        entity=standing.entity,
        robot=replace(standing.robot, is_static=True),
        pose_in_world=standing.pose_in_world,
    )
    pictures = []
    for engine in ENGINES:
        if not missing_engines([engine]):
            file = tmp_path / f"{engine}.png"
            scene = Scene(world=GROUND, robots=(fixed,), seconds=0.1, engine=engine, picture=file)
            assert run_simulation(scene).picture == file
            pictures.append(pixels_of(file).astype(int))
    assert all(np.abs(other - pictures[0]).max() <= 2 for other in pictures)
