"""Meshes of the shapes that no engine has."""

from __future__ import annotations

import math
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import trimesh
from PIL import Image

from child_answers import answered
from surface_heights import height_at
from wsgen.descriptions.meshes import shape_worker
from wsgen.descriptions.meshes.shape_meshes import DEATHS, build_shapes
from wsgen.descriptions.meshes.shape_worker import MOST_ROWS, heightmap_surface
from wsgen.diagnostics import Severity
from wsgen.isolation import parent
from wsgen.isolation.result import Answered, Died, Limits
from wsgen.model.robot import (
    Box,
    Collision,
    Cone,
    Ellipsoid,
    Extrusion,
    Geometry,
    Heightmap,
    Link,
    Mesh,
    Robot,
    Visual,
)
from wsgen.model.transform import Pose

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsgen.diagnostics import Diagnostic


WORLD_FILE = Path("scene.sdf")
ERROR, WARNING, INFO = Severity.ERROR, Severity.WARNING, Severity.INFO
Outline = tuple[tuple[float, float], ...]


def square(half: float, x: float = 0.0, y: float = 0.0) -> Outline:
    corners = ((-half, -half), (half, -half), (half, half), (-half, half))
    return tuple((x + dx, y + dy) for dx, dy in corners)


def extrusion(*outlines: Outline, height: float = 1.0, line: int | None = None) -> Extrusion:
    return Extrusion(outlines=outlines, height=height, line=line)


def robot(
    *collisions: Geometry, visuals: tuple[Geometry, ...] = (), is_static: bool = True
) -> Robot:
    link = Link(
        name="arm",
        line=7,
        collisions=tuple(Collision(geometry=geometry) for geometry in collisions),
        visuals=tuple(Visual(geometry=one, pose_in_link=Pose((1, 0, 0))) for one in visuals),
    )
    return Robot(name="r", root="arm", links=(link,), is_static=is_static)


def in_this_process(task: str, *arguments: Any, **_: Any) -> Answered | Died:
    assert task == "wsgen.descriptions.meshes.shape_worker:build"
    return answered(shape_worker.build(*arguments))


def built(model: Robot, folder: Path) -> tuple[Link, tuple[Diagnostic, ...]]:
    new, found = build_shapes(model, file=WORLD_FILE, folder=folder, run=in_this_process)
    return new.links[0], found


def mesh_of(shape: Geometry, folder: Path) -> tuple[Mesh, trimesh.Trimesh]:
    """What a shape becomes, and the same read by a library of others."""
    link, found = built(robot(shape), folder)
    assert found == ()
    mesh = link.collisions[0].geometry
    assert isinstance(mesh, Mesh)
    assert mesh.path is not None
    return mesh, trimesh.load_mesh(mesh.path, file_type="stl")


def image(folder: Path, pixels: NDArray[Any], name: str = "h.png") -> str:
    file = folder / name
    Image.fromarray(pixels).save(file)
    return str(file)


def flat(rows: int, columns: int | None = None) -> NDArray[np.uint8]:
    return np.full((rows, columns or rows), 100, np.uint8)


def test_a_robot_without_such_shapes_starts_no_child(tmp_path: Path) -> None:
    def refuse(*_: Any, **__: Any) -> Answered | Died:
        raise AssertionError("a child was started")

    model = robot(Box(size=(1, 1, 1)), Mesh(uri="x.stl"))
    assert build_shapes(model, file=None, folder=tmp_path, run=refuse) == (model, ())
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("shape", "volume", "box"),
    [
        (Ellipsoid(radii=(0.1, 0.2, 0.3)), 0.008 * math.pi, ((-0.1, -0.2, -0.3), (0.1, 0.2, 0.3))),
        (Cone(radius=2, length=3), 4 * math.pi, ((-2, -2, -1.5), (2, 2, 1.5))),
        (extrusion(square(2), height=3), 48, ((-2, -2, 0), (2, 2, 3))),
        (extrusion(square(2)[::-1], height=3), 48, ((-2, -2, 0), (2, 2, 3))),  # clockwise
        (extrusion((*square(2), (-2, -2))), 16, ((-2, -2, 0), (2, 2, 1))),  # closed
        (extrusion(square(2), square(1)), 12, ((-2, -2, 0), (2, 2, 1))),
        (extrusion(square(1), square(2)), 12, ((-2, -2, 0), (2, 2, 1))),
        (extrusion(square(2), square(1), square(0.5)), 13, ((-2, -2, 0), (2, 2, 1))),
        (extrusion(square(2), square(1, x=5)), 20, ((-2, -2, 0), (6, 2, 1))),
        (
            extrusion(((0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3))),
            5,
            ((0, 0, 0), (3, 3, 1)),
        ),
        (
            extrusion(tuple((math.cos(t / 500), math.sin(t / 500)) for t in range(3000))),
            math.pi,
            ((-1, -1, 0), (1, 1, 1)),
        ),
    ],
)
def test_shapes_are_closed_and_as_large_as_they_should(
    tmp_path: Path, shape: Geometry, volume: float, box: tuple[Any, Any]
) -> None:
    mesh, surface = mesh_of(shape, tmp_path)
    assert surface.is_watertight
    assert surface.volume == pytest.approx(volume, rel=0.02)  # and positive: seen from outside
    assert mesh.scale == (1, 1, 1)
    assert mesh.bounds is not None
    for ours, theirs, expected in zip(mesh.bounds, surface.bounds, box, strict=True):
        assert ours == pytest.approx(theirs, abs=1e-6)
        assert ours == pytest.approx(expected, abs=1e-3)


def test_nothing_reaches_beyond_an_ellipsoid(tmp_path: Path) -> None:
    _, surface = mesh_of(Ellipsoid(radii=(1, 2, 3)), tmp_path)
    reach = np.linalg.norm(surface.vertices / (1, 2, 3), axis=1)
    assert reach == pytest.approx(1, abs=1e-6)
    middles = np.linalg.norm(surface.triangles_center / (1, 2, 3), axis=1)
    assert middles.min() > 0.99


@pytest.mark.parametrize(
    "shape",
    [
        extrusion(((0, 0), (2, 2), (2, 0), (0, 2)), line=9),
        extrusion(((0, 0), (1, 0), (2, 0)), line=9),
        extrusion(((1, 1), (1, 1), (1, 1)), line=9),
        extrusion(square(2), square(1, x=2), line=9),
        extrusion(square(2), square(1, x=1), line=9),
        extrusion(square(2), square(2), line=9),
    ],
)
def test_outlines_that_enclose_nothing(tmp_path: Path, shape: Extrusion) -> None:
    link, (touched, seen) = built(robot(shape, visuals=(shape,)), tmp_path)
    assert (touched.code, touched.severity) == ("WLD057", ERROR)
    assert (seen.code, seen.severity) == ("WLD057", WARNING)
    assert (touched.file, touched.line) == (WORLD_FILE, 9)
    assert touched.element == "link[@name='arm']/collision/geometry/polyline"
    assert "link `arm`" in touched.message
    assert touched.hint
    assert link.collisions[0].geometry == Mesh(uri="extrusion")
    assert link.visuals == ()


def test_one_mesh_of_shapes_that_are_the_same(tmp_path: Path) -> None:
    shapes = (extrusion(square(1), line=3), extrusion(square(1), line=5))
    link, _ = built(robot(*shapes, visuals=shapes[:1]), tmp_path)
    (visual,) = link.visuals
    assert {one.geometry for one in link.collisions} == {visual.geometry}
    assert len(list(tmp_path.rglob("*.stl"))) == 1


STEPS = np.zeros((9, 9), np.uint8)
STEPS[:, 4:6] = 100
STEPS[:, 6:] = 200
STEPS[:2, :] = 50  # the first row is at the highest y


@pytest.mark.parametrize(
    "pixels",
    [
        STEPS,
        np.dstack([STEPS, STEPS // 2, STEPS // 3]),  # the red channel counts
        np.dstack([STEPS, STEPS, STEPS, 255 - STEPS]),
        np.dstack([STEPS, 255 - STEPS]),
        STEPS.astype(np.uint16) * 257,
        STEPS.astype(np.uint16) * 50,  # the brightest pixel is as high as the size says
    ],
)
def test_heights(tmp_path: Path, pixels: NDArray[Any]) -> None:
    shape = Heightmap(uri="h", path=image(tmp_path, pixels), size=(9, 18, 4))
    corners = heightmap_surface(shape).corners
    # A row of pixels is a ninth of the size; the outermost are half a ninth from the border.
    assert np.ptp(corners.reshape(-1, 3), axis=0) == pytest.approx((8, 16, 4))
    assert height_at(corners, 0.5, 0) == pytest.approx(2)
    assert height_at(corners, 3, -5) == pytest.approx(4)
    assert height_at(corners, 1.5, 0) == pytest.approx(3)  # between two
    assert height_at(corners, 3, 7) == pytest.approx(1)
    assert height_at(corners, -3, -7) == pytest.approx(0)
    assert math.isnan(height_at(corners, 4.2, 0))
    edges = np.diff(corners, axis=1)
    assert (np.cross(edges[:, 0], edges[:, 1])[:, 2] > 0).all()  # seen from above


def test_which_pixel_is_the_brightest_all_channels_say(tmp_path: Path) -> None:
    pixels = np.dstack([STEPS] * 3)
    pixels[8, 8] = (100, 255, 255)
    shape = Heightmap(uri="h", path=image(tmp_path, pixels), size=(9, 9, 4))
    assert height_at(heightmap_surface(shape).corners, 3, 0) == pytest.approx(8)


def test_the_fold_between_four_pixels(tmp_path: Path) -> None:
    def middle(row: int, column: int) -> float:
        pixels = np.zeros((2, 2), np.uint8)
        pixels[row, column] = 255
        shape = Heightmap(uri="h", path=image(tmp_path, pixels), size=(1, 1, 2))
        return height_at(heightmap_surface(shape).corners, 0, 0)

    assert [middle(0, 0), middle(0, 1), middle(1, 0), middle(1, 1)] == pytest.approx([0, 1, 1, 0])


def test_sampling_rounds_nothing(tmp_path: Path) -> None:
    path = image(tmp_path, STEPS)
    surface = heightmap_surface(Heightmap(uri="h", path=path, size=(17, 17, 4), sampling=2))
    assert surface.rows == 17
    assert np.ptp(surface.corners.reshape(-1, 3), axis=0) == pytest.approx((16, 16, 4))
    assert height_at(surface.corners, 2, -2) == pytest.approx(2)
    assert height_at(surface.corners, 3, -2) == pytest.approx(3)


@pytest.mark.parametrize(("z", "expected"), [(-1.0, (0.5, 0)), (2.0, (1, 2))])
def test_negative_sizes_turn_it_upside_down(
    tmp_path: Path, z: float, expected: tuple[float, float]
) -> None:
    shape = Heightmap(uri="h", path=image(tmp_path, STEPS), size=(9, 9, z))
    corners = heightmap_surface(shape).corners
    assert (height_at(corners, 0.5, 0), height_at(corners, 3, 0)) == pytest.approx(expected)


def test_a_black_image_is_flat(tmp_path: Path) -> None:
    shape = Heightmap(uri="h", path=image(tmp_path, np.zeros((5, 5), np.uint8)), size=(9, 9, 2))
    assert not heightmap_surface(shape).corners[..., 2].any()


def test_what_is_seen_of_a_heightmap_is_moved_by_its_offset(tmp_path: Path) -> None:
    shape = Heightmap(uri="h", path=image(tmp_path, flat(5)), pos=(1, 2, 3))
    link, found = built(robot(shape, visuals=(shape,)), tmp_path)
    assert found == ()
    assert link.collisions[0].pose_in_link == Pose()
    assert link.visuals[0].pose_in_link == Pose((2, 2, 3))
    assert link.collisions[0].geometry == link.visuals[0].geometry


@pytest.mark.slow
def test_large_images_are_thinned_out(tmp_path: Path) -> None:
    pixels = np.add.outer(np.arange(1025), np.arange(1025)).astype(np.uint8)
    shape = Heightmap(uri="h", path=image(tmp_path, pixels), size=(1025, 1025, 1), line=4)
    link, (found,) = built(robot(shape), tmp_path)
    assert (found.code, found.severity, found.line) == ("WLD053", INFO, 4)
    assert f"uses {MOST_ROWS} × {MOST_ROWS}" in found.message
    mesh = link.collisions[0].geometry
    assert isinstance(mesh, Mesh)
    assert mesh.bounds is not None
    assert mesh.bounds[1][:2] == (512, 512)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("size", "words"),
    [
        ((8, 9), "8 × 9|9 × 8"),
        ((1, 1), "single pixel"),
        ((4098, 4098), "4098 × 4098"),
        ((10_000, 10_000), "hundred million"),
    ],
)
def test_images_that_are_no_terrain(tmp_path: Path, size: tuple[int, int], words: str) -> None:
    shape = Heightmap(uri="h.png", path=image(tmp_path, flat(*size)), line=4)
    started = time.process_time()
    link, (found,) = built(robot(shape), tmp_path)
    assert time.process_time() - started < 1
    assert (found.code, found.severity, found.line) == ("WLD051", ERROR, 4)
    assert any(word in found.message for word in words.split("|"))
    assert "`h.png`" in found.message
    assert link.collisions[0].geometry == Mesh(uri="h.png")


@pytest.mark.parametrize("name", ["empty", "text", "cut off", "gif", "header", "gone", "folder"])
def test_broken_images(tmp_path: Path, name: str) -> None:
    whole = Path(image(tmp_path, np.arange(65**2).reshape(65, 65).astype(np.uint8), "whole.png"))
    file = tmp_path / "h.png"
    if name == "gif":
        Image.fromarray(flat(5)).save(file, format="GIF")
    elif name == "folder":
        file.mkdir()
    elif name != "gone":
        content = {"empty": b"", "text": b"hello", "cut off": whole.read_bytes()[:-200]}
        file.write_bytes(content.get(name, whole.read_bytes()[:30]))
    shape = Heightmap(uri="h.png", path=str(file))
    link, (found,) = built(robot(visuals=(shape,)), tmp_path)
    assert (found.code, found.severity, found.line) == ("WLD051", WARNING, 7)
    wrong = "is a folder" if name == "folder" else "is not a valid PNG or JPEG file"
    assert wrong in found.message
    assert link.visuals == ()


def test_the_world_reports_missing_images(tmp_path: Path) -> None:
    missing = Heightmap(uri="h.png")
    link, found = built(robot(missing, visuals=(missing,)), tmp_path)
    assert found == ()
    assert link.collisions[0].geometry == Mesh(uri="h.png")
    assert link.visuals == ()


def test_what_gazebo_makes_of_a_heightmap(tmp_path: Path) -> None:
    odd = Heightmap(uri="h.png", path=image(tmp_path, flat(6)))
    _, (drawn,) = built(robot(visuals=(odd,)), tmp_path)
    assert (drawn.code, drawn.severity) == ("WLD055", WARNING)
    _, (moves,) = built(robot(odd, is_static=False), tmp_path)
    assert (moves.code, moves.severity) == ("WLD056", WARNING)


@pytest.mark.slow
def test_a_child_makes_them(tmp_path: Path) -> None:
    new, found = build_shapes(robot(Cone(radius=1, length=1)), file=None, folder=tmp_path)
    assert found == ()
    (mesh,) = [one.geometry for one in new.links[0].collisions]
    assert isinstance(mesh, Mesh)
    assert mesh.path is not None
    assert Path(mesh.path).stat().st_size > 84


def test_what_the_child_dies_of_is_reported(tmp_path: Path) -> None:
    asked = []

    def die(task: str, *arguments: Any, **__: Any) -> Answered | Died:
        asked.append(len(arguments[0]))
        return Died(reason="crashed (SIGSEGV)", step="0", output="")

    shapes = [extrusion(square(half)) for half in range(1, 6)]
    _, found = build_shapes(robot(*shapes), file=None, folder=tmp_path, run=die)
    assert asked == [5, 4, 3][:DEATHS]
    assert [one.code for one in found] == ["WLD057"] * 2  # one sentence for those alike
    assert "crashed (SIGSEGV)" in found[0].message


def test_a_child_that_does_not_start(tmp_path: Path) -> None:
    def die(*_: Any, **__: Any) -> Answered | Died:
        return Died(reason="did not end", step="", output="", cause="wall-clock time")

    _, found = build_shapes(robot(Cone(radius=1, length=1)), file=None, folder=tmp_path, run=die)
    assert [(one.code, one.severity) for one in found] == [("WLD057", ERROR)]
    assert "machine is less busy" in (found[0].hint or "")


@pytest.mark.slow
def test_a_huge_picture_needs_little(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    limits = Limits(seconds=10.0, memory=2 * 2**30)
    monkeypatch.setattr("wsgen.descriptions.meshes.shape_meshes.LIMITS", limits)
    pixels = np.add.outer(np.arange(4097), np.arange(4097)).astype(np.uint16)
    shape = Heightmap(uri="h", path=image(tmp_path, pixels), size=(100, 100, 10))
    _, found = build_shapes(robot(shape), file=None, folder=tmp_path, run=parent.run)
    assert [one.code for one in found] == ["WLD053"]
