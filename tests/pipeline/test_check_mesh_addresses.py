"""`wsgen check` of a robot whose meshes RViz does not find."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from cart_package import LAUNCH, check_cart

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.slow

BOX = '<visual name="v"><geometry><box size="1 1 0.2"/>'
ROBOT = "urdf/cart.urdf.xacro"
# A triangle of a meter.
MESH = """\
solid a
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
endsolid a
"""


def check(folder: Path, address: str, old: str = "LaunchD", new: str = "LaunchD") -> list[str]:
    """The rules about addresses that report the cart with a mesh of this address."""
    assert old in LAUNCH
    (folder / "src/cart/urdf").mkdir(parents=True)
    (folder / "src/cart/urdf/a.stl").write_text(MESH)
    mesh = BOX.replace('<box size="1 1 0.2"/>', f'<mesh filename="{address}"/>')
    _, outcome = check_cart(folder, {ROBOT: (BOX, mesh), "launch/cart.launch.py": (old, new)})
    names = {"relative-mesh-address", "model-address-in-rviz"}
    found = [one for one in outcome.diagnostics if one.name in names]
    assert all(one.file == folder / "src/cart" / ROBOT and one.line == 7 for one in found)
    return [one.name for one in found]


@pytest.mark.parametrize("address", ["a.stl", "../urdf/a.stl"])
def test_a_relative_path(tmp_path: Path, address: str) -> None:
    assert check(tmp_path, address) == ["relative-mesh-address"]


def test_an_address_of_gazebo(tmp_path: Path) -> None:
    assert check(tmp_path, "model://cart/urdf/a.stl") == ["model-address-in-rviz"]


def test_an_address_of_gazebo_without_rviz(tmp_path: Path) -> None:
    assert check(tmp_path, "model://cart/urdf/a.stl", "executable='rviz2'", "executable='x'") == []


@pytest.mark.parametrize("address", ["package://cart/urdf/a.stl", "file://$(find cart)/urdf/a.stl"])
def test_addresses_that_both_find(tmp_path: Path, address: str) -> None:
    assert check(tmp_path, address) == []
