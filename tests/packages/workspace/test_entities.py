"""The names of robots that a workspace's launch files spawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.packages.workspace.layout import Workspace, spawned_entities

if TYPE_CHECKING:
    from pathlib import Path


def test_names_that_are_written_out(tmp_path: Path) -> None:
    for package, text in {
        "classic": "arguments=['-topic', 'robot_description', '-entity', 'one']",
        "sim": 'arguments=["-name",\n  "two", "-x", "0"]',
        "computed": "arguments=['-entity', NAME]",
        "none": "",
    }.items():
        folder = tmp_path / "src" / package
        (folder / "launch").mkdir(parents=True)
        manifest = f"<package format='3'><name>{package}</name><version>0.0.0</version></package>"
        (folder / "package.xml").write_text(manifest)
        (folder / "launch" / "a.launch.py").write_text(text)
    (tmp_path / "src" / "none" / "launch" / "b.launch.py").mkdir()
    assert spawned_entities(Workspace(root=tmp_path)) == {"one", "two"}


def test_no_workspace_yet(tmp_path: Path) -> None:
    assert spawned_entities(Workspace(root=tmp_path / "ws")) == frozenset()
