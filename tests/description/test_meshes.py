"""Finding the files of meshes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.description.meshes import find_meshes
from wsgen.diagnostics import Severity
from wsgen.model.robot import Collision, Link, Mesh, Robot, Visual

if TYPE_CHECKING:
    from pathlib import Path


def robot(uri: str) -> Robot:
    link = Link(
        name="a",
        visuals=(Visual(geometry=Mesh(uri=uri)), Visual(geometry=Mesh(uri=uri))),
        collisions=(Collision(geometry=Mesh(uri=uri)),),
    )
    return Robot(name="r", root="a", links=(link,))


def paths(model: Robot) -> set[str | None]:
    (link,) = model.links
    geometries = [visual.geometry for visual in link.visuals]
    geometries += [collision.geometry for collision in link.collisions]
    return {geometry.path for geometry in geometries if isinstance(geometry, Mesh)}


@pytest.fixture
def share(tmp_path: Path) -> Path:
    folder = tmp_path / "share" / "arm"
    folder.joinpath("meshes").mkdir(parents=True)
    folder.joinpath("meshes", "part one.STL").write_bytes(b"")
    folder.joinpath("meshes", "part.step").write_bytes(b"")
    return folder


@pytest.mark.parametrize(
    "uri",
    [
        "package://arm/meshes/part one.STL",
        "model://arm/meshes/part one.STL",
        "file://{share}/meshes/part%20one.STL",
        "{share}/meshes/part one.STL",
        "meshes/part one.STL",
    ],
)
def test_found(share: Path, uri: str) -> None:
    model, found = find_meshes(
        robot(uri.format(share=share)), share_of={"arm": share}.get, folder=share
    )
    assert found == ()
    assert paths(model) == {str(share / "meshes" / "part one.STL")}


@pytest.mark.parametrize(
    ("uri", "words"),
    [
        ("package://arm/meshes/part one.stl", "is not there"),  # capitals
        ("package://arm/meshes", "is not there"),  # a folder
        ("package://leg/meshes/part.stl", "package `leg`"),
        ("package://arm/meshes/part.step", "format"),
        ("https://example.org/part.stl", "is not a file"),
        ("part.stl", "relative to nothing"),
    ],
)
def test_not_found(share: Path, uri: str, words: str) -> None:
    model, found = find_meshes(robot(uri), share_of={"arm": share}.get)
    assert paths(model) == {None}
    assert [(one.code, one.severity) for one in found] == [
        ("ROB061", Severity.WARNING),
        ("ROB060", Severity.ERROR),
    ]
    assert all(words in one.message and one.hint for one in found)
