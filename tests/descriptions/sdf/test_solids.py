"""Shapes of SDF that become meshes: ellipsoids, cones, polylines, heightmaps."""

from __future__ import annotations

import math
import re
import shutil
from typing import TYPE_CHECKING

import pytest

from gazebo_oracle import is_taken, run_ign
from wsgen.diagnostics import Severity
from wsgen.model.inertia import of_solid
from wsgen.model.robot import Cone, Ellipsoid, Extrusion, Heightmap

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from wsgen.descriptions.sdf.models import SdfFile
    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Geometry, Link

    Read = Callable[..., SdfFile]

ERROR, WARNING = Severity.ERROR, Severity.WARNING
MASS = "<inertial><mass>2</mass></inertial>"
TRIANGLE = "<point>0 0</point><point>2 0</point><point>0 1</point>"


def model(shape: str, tag: str = "collision") -> str:
    return (
        f'<model name="m"><link name="l">{MASS}<{tag} name="s"><geometry>\n'
        f"{shape}</geometry></{tag}></link></model>"
    )


def link_of(file: SdfFile) -> Link:
    robot = file.models[0].robot
    assert robot is not None
    return robot.links[0]


def only(file: SdfFile) -> Diagnostic:
    (found,) = file.diagnostics
    return found


@pytest.mark.parametrize(
    ("shape", "expected"),
    [
        ("<ellipsoid><radii>1 2 3</radii></ellipsoid>", Ellipsoid(radii=(1, 2, 3))),
        ("<ellipsoid/>", Ellipsoid(radii=(1, 1, 1))),
        ("<cone><radius>2</radius><length>3</length></cone>", Cone(radius=2, length=3)),
        ("<cone/>", Cone(radius=0.5, length=1)),
        (
            f"<polyline>{TRIANGLE}<height>4</height></polyline>",
            Extrusion(outlines=(((0, 0), (2, 0), (0, 1)),), height=4, line=3),
        ),
        (
            f"<polyline>{TRIANGLE}</polyline><polyline>{TRIANGLE}<height>2</height></polyline>",
            Extrusion(outlines=(((0, 0), (2, 0), (0, 1)),) * 2, height=1, line=3),
        ),
    ],
)
@pytest.mark.parametrize("tag", ["collision", "visual"])
def test_shapes(read: Read, shape: str, expected: Geometry, tag: str) -> None:
    file = read(model(shape, tag))
    assert file.diagnostics == ()
    link = link_of(file)
    (found,) = link.collisions or link.visuals
    assert found.geometry == expected


def test_heightmap(read: Read, models: Path) -> None:
    image = models / "hills" / "h.PNG"
    image.parent.mkdir()
    image.touch()
    more = "<size>10 20 3</size><pos>1 2 3</pos><sampling>2</sampling>"
    uri = "model://hills/h.PNG"
    file = read(model(f"<heightmap><uri>{uri}</uri>{more}</heightmap>", "visual"))
    assert file.diagnostics == ()
    assert link_of(file).visuals[0].geometry == Heightmap(
        uri=uri, path=str(image), size=(10, 20, 3), pos=(1, 2, 3), sampling=2, line=3
    )
    plain = read(model(f"<heightmap><uri>{uri}</uri></heightmap>"))
    assert link_of(plain).collisions[0].geometry == Heightmap(uri=uri, path=str(image), line=3)
    moved = only(read(model(f"<heightmap><uri>{uri}</uri><pos>0 0 1</pos></heightmap>")))
    assert (moved.code, moved.severity, moved.line) == ("WLD054", WARNING, 3)


@pytest.mark.parametrize("uri", ["no.png", "model://no/h.png", "https://x/h.png", ""])
@pytest.mark.parametrize(("tag", "severity"), [("collision", ERROR), ("visual", WARNING)])
def test_images_that_are_not_there(read: Read, uri: str, tag: str, severity: Severity) -> None:
    found = only(read(model(f"<heightmap><uri>{uri}</uri></heightmap>", tag)))
    assert (found.code, found.severity, found.line) == ("WLD050", severity, 3)
    assert f"`{uri}`" in found.message


@pytest.mark.parametrize("name", ["dem.tif", "dem.hgt", "picture.bmp"])
def test_elevation_data_is_left_out(read: Read, models: Path, name: str) -> None:
    (models.parent / name).touch()
    file = read(model(f"<heightmap><uri>{name}</uri></heightmap>"))
    assert (only(file).code, only(file).severity) == ("WLD031", WARNING)
    assert "elevation" in only(file).message
    assert link_of(file).collisions == ()


@pytest.mark.parametrize(
    ("shape", "code"),
    [
        ("<ellipsoid><radii>1 0 3</radii></ellipsoid>", "ROB028"),
        ("<cone><length>-1</length></cone>", "ROB028"),
        (f"<polyline>{TRIANGLE}<height>0</height></polyline>", "ROB028"),
        ("<polyline/>", "WLD057"),
        ("<polyline><point>0 0</point><point>1 0</point></polyline>", "WLD057"),
        (f"<polyline>{TRIANGLE}</polyline><polyline><point>0 0</point></polyline>", "WLD057"),
        (f"<polyline>{'<point>0 0</point>' * 10_001}</polyline>", "WLD057"),
        ("<polyline><point>0 0 0</point></polyline>", "ROB016"),
        ("<polyline><point>nan 0</point></polyline>", "ROB016"),
        ("<polyline><point>1e300 0</point></polyline>", "ROB016"),
        ("<heightmap><uri>h.png</uri><size>0 1 1</size></heightmap>", "ROB028"),
        ("<heightmap><uri>h.png</uri><sampling>0</sampling></heightmap>", "WLD034"),
        ("<heightmap><uri>h.png</uri><sampling>1e9</sampling></heightmap>", "WLD034"),
    ],
)
def test_what_is_wrong_with_a_shape(read: Read, models: Path, shape: str, code: str) -> None:
    (models.parent / "h.png").touch()
    found = only(read(model(shape)))
    assert (found.code, found.severity, found.line) == (code, ERROR, 3)
    assert found.hint


@pytest.mark.parametrize(
    ("shape", "geometry", "volume"),
    [
        (
            "<ellipsoid><radii>1 2 3</radii></ellipsoid>",
            Ellipsoid(radii=(1, 2, 3)),
            8 * math.pi,
        ),
        ("<cone><radius>1</radius><length>3</length></cone>", Cone(radius=1, length=3), math.pi),
    ],
)
def test_inertia_from_the_collisions(
    read: Read, shape: str, geometry: Geometry, volume: float
) -> None:
    text = model(shape).replace(MASS, '<inertial auto="true"/>')
    inertial = link_of(read(text, "1.11")).inertial
    assert inertial is not None
    assert inertial.mass == pytest.approx(1000 * volume)
    xx, _, _, yy, _, zz = inertial.inertia
    assert (xx, yy, zz) == pytest.approx(of_solid(geometry, inertial.mass))


def test_no_inertia_comes_from_a_polyline(read: Read) -> None:
    text = model(f"<polyline>{TRIANGLE}</polyline>").replace(MASS, '<inertial auto="true"/>')
    assert only(read(text, "1.11")).code == "WLD040"


@pytest.mark.slow
@pytest.mark.oracle
@pytest.mark.skipif(shutil.which("ign") is None, reason="ign (Debian: ignition-tools) is missing")
@pytest.mark.parametrize(
    "shape",
    [
        "<ellipsoid/>",
        "<ellipsoid><radii>0.5 2 3</radii></ellipsoid>",
        f"<polyline>{TRIANGLE}</polyline>",
        f"<polyline>{TRIANGLE}<height>2</height></polyline>",
        f"<polyline>{TRIANGLE}</polyline><polyline><point>5 5</point>{TRIANGLE}</polyline>",
    ],
)
def test_sizes_are_those_that_gazebos_parser_sees(read: Read, tmp_path: Path, shape: str) -> None:
    geometry = link_of(read(model(shape))).collisions[0].geometry
    file = tmp_path / "scene.sdf"
    assert is_taken(file, tmp_path)
    _, printed = run_ign("-p", file, tmp_path)
    if isinstance(geometry, Ellipsoid):
        assert numbers_of(printed, "radii") == [geometry.radii]
    else:
        assert isinstance(geometry, Extrusion)
        assert numbers_of(printed, "point") == [at for line in geometry.outlines for at in line]
        assert numbers_of(printed, "height")[0] == (geometry.height,)


def numbers_of(printed: str, tag: str) -> list[tuple[float, ...]]:
    found = re.findall(f"<{tag}>([^<]*)</{tag}>", printed)
    return [tuple(map(float, text.split())) for text in found]


@pytest.mark.parametrize(
    ("written", "direction", "inside"),
    [
        ('<fdir1 gz:expressed_in="base">1 -1 0</fdir1>', (1, -1, 0), "base"),
        ('<fdir1 xmlns:gz="g" gz:expressed_in="base">1 -1 0</fdir1>', (1, -1, 0), "base"),
        ('<fdir1 ignition:expressed_in="base">1 -1 0</fdir1>', (1, -1, 0), "base"),
        ("<fdir1>0 1 0</fdir1>", (0, 1, 0), None),
        ("<fdir1>0 0 0</fdir1>", None, None),
        ("", None, None),
    ],
)
def test_the_direction_of_friction(
    read: Read, written: str, direction: tuple[float, ...] | None, inside: str | None
) -> None:
    ball = "<sphere><radius>1</radius></sphere>"
    surface = f"<surface><friction><ode><mu2>0</mu2>{written}</ode></friction></surface>"
    file = read(model(ball).replace("</geometry>", f"</geometry>{surface}"))
    assert not [found for found in file.diagnostics if found.severity is ERROR]
    (found,) = link_of(file).collisions
    assert (found.surface.fdir1, found.surface.fdir1_in) == (direction, inside)
