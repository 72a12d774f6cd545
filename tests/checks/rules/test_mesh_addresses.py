"""Addresses of meshes in a robot that is published, from texts and elements alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.checks.rules.robot_files import mesh_addresses, model_addresses, relative_addresses
from wsgen.text.markup import elements

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic

ROBOT = '<robot name="r">\n  <link name="a"><visual><geometry>\n    {}\n</geometry></visual></link>'


def check(
    rule: Callable[..., Iterator[Diagnostic]], folder: Path, written: str, address: str
) -> list[Diagnostic]:
    """What a rule reports of a robot with a mesh of this address, written so in its file."""
    (folder / "package.xml").write_text("<package><name>bot</name></package>")
    (folder / "meshes").mkdir()
    (folder / "meshes/a.stl").touch()
    (folder / "urdf").mkdir()
    file = folder / "urdf/bot.xacro"
    text = f"{ROBOT.format(written)}</robot>"
    file.write_text(text)
    expanded = ROBOT.format(f'<mesh scale="1 1 1" filename="{address}"/>')
    return list(rule(mesh_addresses(expanded), file, elements(file, text)))


@pytest.mark.parametrize("filename", ["../meshes/a.stl", "${folder}/a.stl"])
def test_a_relative_path(tmp_path: Path, filename: str) -> None:
    mesh = f"<mesh filename='{filename}'/>"
    [found] = check(relative_addresses, tmp_path, mesh, "../meshes/a.stl")
    assert (found.code, found.line) == ("ROB126", 3)
    assert found.hint == "Write package://bot/meshes/a.stl"


@pytest.mark.parametrize(
    "address",
    [
        "package://bot/meshes/a.stl",
        "file:///opt/meshes/a.stl",
        "/opt/meshes/a.stl",
        "model://bot/meshes/a.stl",
        "../meshes/none.stl",  # reported as a mesh that is missing
        "C:\\a.stl",
    ],
)
def test_other_addresses(tmp_path: Path, address: str) -> None:
    assert check(relative_addresses, tmp_path, "", address) == []


def test_an_address_of_a_model(tmp_path: Path) -> None:
    mesh = '<mesh filename="model://bot/meshes/a.stl"/>'
    [found] = check(model_addresses, tmp_path, mesh, "model://bot/meshes/a.stl")
    assert (found.code, found.line) == ("ROB127", 3)
    assert found.hint == "Write package://bot/meshes/a.stl"


@pytest.mark.parametrize("address", ["package://bot/meshes/a.stl", "../meshes/a.stl"])
def test_what_is_no_model(tmp_path: Path, address: str) -> None:
    assert check(model_addresses, tmp_path, "", address) == []
