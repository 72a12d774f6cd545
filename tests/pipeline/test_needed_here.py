"""Which packages are about the machine that has them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.pipeline.needed_here import Texts, find_needed_here, read_texts

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "home").mkdir()
    (tmp_path / "home" / "mesh.stl").touch()
    monkeypatch.setenv("HOME", str(tmp_path / "home"))


def texts_of(folder: Path, text: str, name: str = "urdf/robot.xacro") -> Texts:
    file = folder / "pkg" / name
    file.parent.mkdir(parents=True)
    file.write_text(text.replace("@HOME@", str(folder / "home")))
    return read_texts(folder / "pkg", (f"{folder / 'pkg'}/",))


@pytest.mark.parametrize(
    "text",
    [
        '<mesh filename="file://@HOME@/mesh.stl"/>',
        '<mesh filename="file://@HOME@/other.stl"/>',  # its message is about what exists of it
        "path = '@HOME@/mesh.stl'",
        "<uri>@HOME@/mesh.stl</uri>",
        "path = expand('~/mesh.stl')",
        "include ../../home/mesh.stl",
        "os.environ['HOME']",
        "import subprocess",
    ],
)
def test_it_is_of_the_machine(tmp_path: Path, text: str) -> None:
    assert texts_of(tmp_path, text).is_of_machine


@pytest.mark.parametrize(
    "text",
    [
        "remappings=[('~/robot_description', '/robot_description')]",
        "share + '/urdf/robot.xacro'",
        "$(find pkg)@HOME@/mesh.stl",
        "</link></robot>",
        "http://host@HOME@/mesh.stl",
        "include ../urdf/robot.xacro",
    ],
)
def test_it_is_the_same_everywhere(tmp_path: Path, text: str) -> None:
    assert not texts_of(tmp_path, text).is_of_machine


def test_documentation_is_of_no_machine(tmp_path: Path) -> None:
    assert not texts_of(tmp_path, "Put it to @HOME@/mesh.stl", "README.md").is_of_machine


def test_paths_that_another_machine_may_have(tmp_path: Path) -> None:
    found = texts_of(tmp_path, "'/nowhere/at/all.stl' package://arm/a.stl model://crate")
    assert found.paths == {"/nowhere/at/all.stl"}
    assert found.models == {"arm", "crate"}


def test_who_names_one_is_one() -> None:
    def texts(*words: bytes, is_of_machine: bool = False) -> Texts:
        return Texts(
            words=frozenset(words),
            models=frozenset(),
            addresses=frozenset(),
            paths=frozenset(),
            is_of_machine=is_of_machine,
        )

    packages = {
        "of_machine": texts(is_of_machine=True),
        "marked": texts(),
        "naming": texts(b"of_machine"),
        "naming_it": texts(b"naming"),
        "other": texts(b"elsewhere"),
    }
    assert find_needed_here(packages, ["marked"]) == {*packages} - {"other"}
