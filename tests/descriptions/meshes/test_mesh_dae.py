"""Where the scene of a COLLADA file puts its geometries: as Gazebo and, told apart, PyBullet do."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import mesh_samples
from wsgen.descriptions.meshes.dae import read_dae

if TYPE_CHECKING:
    from pathlib import Path


SQUARE = "<rotate>0 0 1 90</rotate>"
UP = "<translate>10 0 0</translate>"
LARGE = "<scale>2 4 6</scale>"
MATRIX = "<matrix>0 -1 0 5  1 0 0 0  0 0 1 0  0 0 0 1</matrix>"

# What stands in the node, the box of the whole, and whether PyBullet sees the same.
NODES = {
    "nothing": ("", ((-0.5, -1.0, -1.5), (0.5, 1.0, 1.5)), True),
    "translate": (UP, ((9.5, -1.0, -1.5), (10.5, 1.0, 1.5)), True),
    "rotate": (SQUARE, ((-1.0, -0.5, -1.5), (1.0, 0.5, 1.5)), True),
    "rotate then translate": (SQUARE + UP, ((9.0, -0.5, -1.5), (11.0, 0.5, 1.5)), True),
    "rotate twice": (
        SQUARE + "<rotate>1 0 0 90</rotate>",
        ((-1.5, -0.5, -1.0), (1.5, 0.5, 1.0)),
        False,
    ),
    "rotate by nothing": (
        "<rotate>0 0 1 0</rotate><rotate>0 1 0 0</rotate><rotate>0 0 0 9</rotate>",
        ((-0.5, -1.0, -1.5), (0.5, 1.0, 1.5)),
        True,
    ),
    "scale": (LARGE, ((-1.0, -4.0, -9.0), (1.0, 4.0, 9.0)), True),
    "rotate and scale": (SQUARE + LARGE, ((-4.0, -1.0, -9.0), (4.0, 1.0, 9.0)), False),
    "matrix": (MATRIX, ((4.0, -0.5, -1.5), (6.0, 0.5, 1.5)), True),
    "matrix and translate": (MATRIX + UP, ((4.0, -0.5, -1.5), (6.0, 0.5, 1.5)), False),
}
MARGIN = 0.0025  # m, by which PyBullet makes boxes around shapes larger
UNITS = {"none": ("", 1.0), "tenth": ('<unit meter="0.1"/>', 0.1), "unsaid": ("<unit/>", 1.0)}


def box(corners: Any) -> tuple[list[float], list[float]]:
    points = np.asarray(corners).reshape(-1, 3)
    return points.min(axis=0).tolist(), points.max(axis=0).tolist()


@pytest.mark.parametrize("name", NODES)
def test_a_node_is_placed_as_in_gazebo(name: str) -> None:
    inside, expected, is_plain = NODES[name]
    content = read_dae(mesh_samples.dae(node=inside + mesh_samples.PLACED).encode())
    assert np.allclose(box(content.corners), expected)
    assert content.is_plain == is_plain


@pytest.mark.parametrize("name", UNITS)
def test_the_unit_scales_all(name: str) -> None:
    asset, metres = UNITS[name]
    content = read_dae(mesh_samples.dae(node=UP + mesh_samples.PLACED, asset=asset).encode())
    low, high = box(content.corners)
    assert np.allclose(low, np.array([9.5, -1.0, -1.5]) * metres)
    assert np.allclose(high, np.array([10.5, 1.0, 1.5]) * metres)
    assert content.is_plain == (name != "unsaid")  # PyBullet dies of it


def test_nodes_stand_in_nodes() -> None:
    inner = f"{UP}<node>{SQUARE}{mesh_samples.PLACED}</node>{mesh_samples.PLACED}"
    content = read_dae(mesh_samples.dae(node=inner).encode())
    assert len(content.corners) == 2 * len(mesh_samples.FACES)
    assert np.allclose(box(content.corners), ((9.0, -1.0, -1.5), (11.0, 1.0, 1.5)))
    assert content.is_plain


def test_a_node_stands_for_another() -> None:
    text = mesh_samples.dae(node='<instance_node url="#n"/>').replace(
        "<library_visual_scenes>",
        f'<library_nodes><node id="n">{UP}{mesh_samples.PLACED}</node></library_nodes>'
        "<library_visual_scenes>",
    )
    content = read_dae(text.encode())
    assert np.allclose(box(content.corners), ((9.5, -1.0, -1.5), (10.5, 1.0, 1.5)))
    assert not content.is_plain  # PyBullet passes it over


def test_pybullet_would_read_a_geometry_that_nothing_places() -> None:
    text = mesh_samples.dae()
    at = text.index("</library_geometries>")
    text = text[:at] + '<geometry id="h"><mesh/></geometry>' + text[at:]
    assert not read_dae(text.encode()).is_plain


def bounds_in_pybullet(folder: Path, name: str, text: str) -> Any:
    bullet = pytest.importorskip("wsgen.simulation.bullet")
    (folder / f"{name}.dae").write_text(text)
    (folder / f"{name}.urdf").write_text(
        '<robot name="r"><link name="l"><inertial><mass value="1"/>'
        '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>\n<collision>'
        f'<geometry><mesh filename="{name}.dae"/></geometry></collision></link></robot>'
    )
    client = bullet.Client()
    try:
        return client.getAABB(client.loadURDF(str(folder / f"{name}.urdf")))
    finally:
        client.close()


@pytest.mark.parametrize("up_axis", ["X_UP", "Y_UP", "Z_UP"])
@pytest.mark.parametrize("name", ["nothing", "translate", "rotate", "scale", "matrix"])
def test_what_is_plain_pybullet_reads_alike(tmp_path: Path, name: str, up_axis: str) -> None:
    """The unit is applied, and `up_axis` is not."""
    inside, expected, _ = NODES[name]
    text = mesh_samples.dae(
        node=inside + mesh_samples.PLACED,
        asset=f'<unit meter="0.1"/><up_axis>{up_axis}</up_axis>',
    )
    found = bounds_in_pybullet(tmp_path, "box", text)
    assert np.allclose(found, np.array(expected) * 0.1, atol=MARGIN)
    assert np.allclose(box(read_dae(text.encode()).corners), found, atol=MARGIN)


def test_what_is_not_plain_pybullet_reads_otherwise(tmp_path: Path) -> None:
    inside, expected, _ = NODES["rotate twice"]
    text = mesh_samples.dae(node=inside + mesh_samples.PLACED)
    found = bounds_in_pybullet(tmp_path, "box", text)
    assert np.allclose(found, NODES["rotate"][1], atol=MARGIN)
    assert not np.allclose(found, expected, atol=MARGIN)


def test_angle_brackets_in_names_are_read_as_tinyxml2_reads_them() -> None:
    """MeshLab writes `<node id="<STL_BINARY>">`."""
    text = mesh_samples.dae(node=mesh_samples.PLACED)
    assert "<node" in text
    odd = text.replace("<node", '<node sid="<STL_BINARY>"', 1)
    assert np.array_equal(read_dae(odd.encode()).corners, read_dae(text.encode()).corners)
