"""The images on planes and boxes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from wsgen.model.robot import Box
from wsgen.rendering.surfaces import surface_of

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from wsgen.descriptions.sdf.models import SdfFile

    Read = Callable[..., SdfFile]

SCRIPTS = """
// material floor/track { texture commented.png }
material floor/track
{
  technique { pass { texture_unit
  {
    texture track.png
  } } }
}
material floor/plain
{
  technique { pass { ambient 1 0 0 } }
}
material floor/other : floor/plain
{
  technique { pass { texture_unit
  {
    texture "other.jpg"
  } } }
}
"""
URIS = "<uri>model://floor/materials/scripts</uri><uri>model://floor/materials/textures/</uri>"
PLANE = "<plane><normal>0 0 1</normal><size>3 4</size></plane>"
BOX = "<box><size>1 2 3</size></box>"


@pytest.fixture
def floor(models: Path) -> Path:
    folder = models / "floor" / "materials"
    for name in ("scripts", "textures"):
        (folder / name).mkdir(parents=True)
    (folder / "scripts" / "floor.material").write_text(SCRIPTS)
    for name in ("track.png", "other.jpg", "commented.png"):
        (folder / "textures" / name).touch()
    return folder / "textures"


def _texture(read: Read, shape: str, material: str) -> str | None:
    file = read(
        '<model name="m"><static>1</static><pose>0 0 0.002 0 0 0</pose><link name="l">'
        f'<visual name="v"><geometry>{shape}</geometry><material>{material}</material></visual>'
        "</link></model>"
    )
    (model,) = file.models
    assert model.robot is not None
    (visual,) = model.robot.links[0].visuals
    return visual.texture


@pytest.mark.parametrize("shape", [PLANE, BOX])
@pytest.mark.parametrize(
    ("name", "image"),
    [
        ("floor/track", "track.png"),
        ("floor/other", "other.jpg"),
        ("floor/plain", None),
        ("floor/missing", None),
        ("Gazebo/Red", None),
    ],
)
def test_a_script_names_it(
    read: Read, floor: Path, shape: str, name: str, image: str | None
) -> None:
    found = _texture(read, shape, f"<script>{URIS}<name>{name}</name></script>")
    assert found == (None if image is None else str(floor / image))


def test_a_script_may_be_named_itself(read: Read, floor: Path) -> None:
    uri = "<uri>model://floor/materials/scripts/floor.material</uri>"
    found = _texture(read, PLANE, f"<script>{uri}<name>floor/track</name></script>")
    assert found == str(floor / "track.png")


def test_an_albedo_map_is_one(read: Read, floor: Path) -> None:
    def found(uri: str) -> str | None:
        metal = f"<pbr><metal><albedo_map>{uri}</albedo_map></metal></pbr>"
        return _texture(read, PLANE, metal)

    assert found("model://floor/materials/textures/track.png") == str(floor / "track.png")
    assert found("model://floor/materials/textures/missing.png") is None
    assert found("model://floor/materials/scripts/floor.material") is None


def test_other_shapes_have_none(read: Read, floor: Path) -> None:
    script = f"<script>{URIS}<name>floor/track</name></script>"
    assert _texture(read, "<sphere><radius>1</radius></sphere>", script) is None
    assert floor.is_dir()


def test_the_image_lies_on_a_face_as_x_and_y_do() -> None:
    surface = surface_of(Box(size=(2.0, 4.0, 0.001)))
    assert surface.texture_points is not None
    up = surface.corners[2].min(axis=0) > 0
    assert up.sum() == 2  # triangles
    places = surface.corners[:2, :, up] / np.array([2.0, 4.0])[:, None, None] + 0.5
    np.testing.assert_allclose(surface.texture_points[:, :, up], places, atol=1e-6)
    for triangle in range(12):  # each has half of the image
        one, two, three = surface.texture_points[:, :, triangle].T
        area = np.linalg.det(np.stack([two - one, three - one])) / 2
        assert abs(area) == pytest.approx(0.5)
