"""Finding the files of meshes."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from wsgen.descriptions.meshes.lookup import find_meshes
from wsgen.diagnostics import Severity
from wsgen.model.robot import Collision, Link, Mesh, Robot, Visual


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
        "file://meshes/part one.STL",
        "file://arm/meshes/part one.STL",  # Gazebo has folders for resources
    ],
)
def test_found(share: Path, uri: str) -> None:
    model, found = find_meshes(
        robot(uri.format(share=share)), share_of={"arm": share}.get, folder=share
    )
    assert found == ()
    assert paths(model) == {str(share / "meshes" / "part one.STL")}


@pytest.mark.parametrize(
    ("uri", "words", "hint"),
    [
        ("package://arm/meshes/part two.STL", "does not exist", "installs it"),
        ("package://arm/meshes/part one.stl", "/part one.STL` does", "same upper and lower case"),
        (
            "package://arm/Meshes/PART one.stl",
            "/meshes/part one.STL` does",
            "same upper and lower case",
        ),
        (
            "file://{share}/meshes/Part%20one.STL",
            "/part one.STL` does",
            "same upper and lower case",
        ),
        ("package://arm/meshes", "is a folder", "Name a mesh file"),
        ("package://arm", "is a folder", "Name a mesh file"),
        ("package://arm/meshes/pipe.stl", "is a named pipe", "Name a mesh file"),
        ("package://arm/meshes/gone.stl", "a link to ", "Name a mesh file"),
        ("package://leg/meshes/part.stl", "package `leg`", "Build and source"),
        ("package://arm/meshes/part.step", "format", "Convert it"),
        (
            "package:///meshes/part.stl",
            "does not name a package",
            "package://PACKAGE/meshes/part.stl",
        ),
        ("model://", "does not name a model", "model://PACKAGE/meshes/…"),
        ("https://fuel.gazebosim.org/1.0/part.stl", "network address", "Download it"),
        ("ftp://example.org/part.stl", "(`ftp://`)", "package://PACKAGE"),
        ("$(find arm)/meshes/part one.STL", "is not expanded", "xacro"),
        ("${{folder}}/part one.STL", "is not expanded", "xacro"),
        ("/nowhere/somebody/part.stl", "of another machine", "package://PACKAGE"),
        ("file:///nowhere/somebody/part.stl", "of another machine", "package://PACKAGE"),
        ("C:\\robots\\part.stl", "a Windows path", "package://PACKAGE"),
        ("package://arm/meshes\\part one.STL", "backslashes", "meshes/part one.STL"),
        ("  ", "has no name", "package://PACKAGE"),
        (f"{{share}}/{'long' * 100}.stl", "does not exist", "Check its spelling"),
    ],
)
def test_not_found(share: Path, uri: str, words: str, hint: str) -> None:
    os.mkfifo(share / "meshes" / "pipe.stl")
    (share / "meshes" / "gone.stl").symlink_to("nowhere")
    model, found = find_meshes(
        robot(uri.format(share=share)), share_of={"arm": share}.get, folder=share
    )
    assert paths(model) == {None}
    assert [(one.code, one.severity) for one in found] == [
        ("ROB061", Severity.WARNING),
        ("ROB060", Severity.ERROR),
    ]
    for one in found:
        assert words in one.message
        assert hint in (one.hint or "")


def test_paths_are_absolute(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "part.stl").write_bytes(b"")
    monkeypatch.chdir(tmp_path)
    for uri in ("part.stl", "package://arm/part.stl"):
        located, _ = find_meshes(robot(uri), share_of={"arm": Path()}.get, folder=Path())
        (shape,) = located.links[0].collisions
        assert isinstance(shape.geometry, Mesh)
        assert shape.geometry.path == str(tmp_path / "part.stl")


def test_relative_to_nothing() -> None:
    _, found = find_meshes(robot("part.stl"), share_of=lambda _: None)
    assert "relative path" in found[0].message


def test_two_names_that_differ_in_capitals_alone_are_not_chosen_from(share: Path) -> None:
    (share / "meshes" / "PART one.STL").write_bytes(b"")
    _, found = find_meshes(robot("package://arm/meshes/part one.stl"), share_of={"arm": share}.get)
    assert "Check its spelling" in (found[0].hint or "")


@pytest.mark.parametrize(
    "uri", ["meshes/part.stl", "package://meshes/part.stl", "package://arm/part.stl"]
)
def test_a_mesh_that_is_in_the_package_has_its_address_as_hint(tmp_path: Path, uri: str) -> None:
    for folder in ("meshes", "urdf"):
        (tmp_path / folder).mkdir()
    (tmp_path / "meshes" / "part.stl").touch()
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
    _, found = find_meshes(robot(uri), share_of={"arm": tmp_path}.get, folder=tmp_path / "urdf")
    assert {one.hint for one in found} == {"Write package://arm/meshes/part.stl"}


def robot_of(*uris: str) -> Robot:
    """A link for each address, with a visual and a collision."""
    links = [
        Link(
            name=f"l{number}",
            line=number,
            visuals=(Visual(geometry=Mesh(uri=uri)),),
            collisions=(Collision(geometry=Mesh(uri=uri)),),
        )
        for number, uri in enumerate(uris)
    ]
    return Robot(name="r", root="l0", links=tuple(links))


def test_a_folder_that_is_not_there_is_reported_once(share: Path) -> None:
    uris = [f"package://arm/mesches/arm/{name}.stl" for name in "abcde"]
    others = ["package://arm/meshes/f.stl", "package://arm/else/g.stl", "package://hand/h.stl"]
    _, found = find_meshes(
        robot_of(*uris, *uris[:2], *others), share_of={"arm": share}.get, file=Path("r.urdf")
    )
    codes = [one.code for one in found]
    assert sorted(codes) == ["ROB060"] * 4 + ["ROB061"] * 4
    collisions = [one for one in found if one.code == "ROB060"]
    assert [one.line for one in collisions] == [0, 7, 8, 9]
    assert collisions[0].message == (
        f"The folder {share}/mesches of 5 collision meshes of the robot does not exist: "
        f"`{uris[0]}`, `{uris[1]}`, `{uris[2]}` and 2 more."
    )
    assert "git" in (collisions[0].hint or "")
    assert "The folder" not in "".join(one.message for one in collisions[1:])


def test_two_meshes_of_a_missing_folder_are_reported_by_themselves(share: Path) -> None:
    uris = [f"package://arm/mesches/{name}.stl" for name in "ab"]
    _, found = find_meshes(robot_of(*uris, *uris), share_of={"arm": share}.get)
    assert len(found) == 8


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("base_lnik.stl", "base_link.stl"),
        ("base-link.stl", "base_link.stl"),
        ("wheel.stl", "wheel.dae"),
        ("link_3.stl", None),  # it may be yet to be made
        ("right_arm.stl", None),
    ],
)
def test_a_mesh_of_nearly_the_same_name(tmp_path: Path, name: str, meant: str | None) -> None:
    for there in ("base_link.stl", "wheel.dae", "link_1.stl", "left_arm.stl", "right_arm.txt"):
        (tmp_path / there).touch()
    _, found = find_meshes(robot(name), share_of=lambda _: None, folder=tmp_path)
    hints = {one.hint for one in found}
    assert len(hints) == 1
    assert (f"Did you mean `{meant}`?" in hints) == (meant is not None), hints
