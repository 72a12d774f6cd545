"""What is sent once, and the files that it names."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from simulation.robots import body, single
from sweeping.blueprints import blueprint, prepared
from wsgen.model.robot import Collision, Mesh
from wsgen.sweeping import children
from wsgen.sweeping.children import CopiedFiles, named_as_before, relocated, share

if TYPE_CHECKING:
    import pytest


def test_the_same_content_has_the_same_key() -> None:
    assert share(blueprint()).key == share(blueprint()).key
    assert share(blueprint()).key != share(replace(blueprint(), name="other")).key


def test_paths_are_replaced_wherever_a_value_names_them() -> None:
    robot = single(body(None))
    mesh = Collision(geometry=Mesh(uri="package://p/m.stl", path="/a/m.stl"))
    robot = replace(robot, links=(replace(robot.links[0], collisions=(mesh,)),))
    made = blueprint(prepared(robot))
    moved = relocated(made, {"/a/m.stl": "/b/m.stl"})
    (link,) = moved.prepared[0].lumped.links
    assert link.collisions[0].geometry == Mesh(uri="package://p/m.stl", path="/b/m.stl")
    assert moved.world is made.world
    assert relocated(made, {"/c": "/d"}) is made
    assert relocated([Path("/a"), {"x": ("/a", 1.0)}], {"/a": "/b"}) == [
        Path("/b"),
        {"x": ("/b", 1.0)},
    ]


def test_answers_name_files_as_they_were_named() -> None:
    answer = {"text": ["no mesh /b/m.stl here"], "number": 1.0, "nothing": None}
    assert named_as_before(answer, {"/a/m.stl": "/b/m.stl"}) == {
        "text": ["no mesh /a/m.stl here"],
        "number": 1.0,
        "nothing": None,
    }


def test_copies_have_their_names_and_their_neighbors(tmp_path: Path) -> None:
    copies = CopiedFiles(tmp_path / "copies")
    files = {
        "/a/m.obj": ("hash1", b"one"),
        "/a/m.mtl": ("hash2", b"two"),
        "/b/m.obj": ("hash1", b"one"),
    }
    with copies.lent("k", files) as moved:
        paths = [Path(moved[path]) for path in files]
        assert [path.read_bytes() for path in paths] == [b"one", b"two", b"one"]
        assert [path.name for path in paths] == ["m.obj", "m.mtl", "m.obj"]
        assert paths[0].parent == paths[1].parent != paths[2].parent
        assert paths[0].samefile(paths[2])
    with copies.lent("k", {}) as again:
        assert again == moved
    copies.remove()
    assert not (tmp_path / "copies").exists()


def test_old_copies_are_removed_unless_they_are_in_use(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(children, "MOST_FOLDERS", 2)
    copies = CopiedFiles(tmp_path)
    with copies.lent("used", {"/a": ("used", b"u")}) as used:
        for key in "123":
            with copies.lent(key, {"/a": (key, b"x")}):
                pass
        assert Path(used["/a"]).read_bytes() == b"u"
        assert sorted(one.name for one in tmp_path.iterdir()) == ["3", "contents", "used"]
        assert sorted(one.name for one in (tmp_path / "contents").iterdir()) == ["3", "used"]
