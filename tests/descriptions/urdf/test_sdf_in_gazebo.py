"""What is in `<gazebo>` elements is SDF, with the elements of SDF."""

from __future__ import annotations

from urdf_texts import link, robot
from wsgen.descriptions.urdf.reader import read_urdf


def test_a_second_axis_is_no_misspelling() -> None:
    joint = """<gazebo><joint name="j" type="universal"><parent>a</parent><child>b</child>
<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2></joint></gazebo>"""
    _, found = read_urdf(robot(link("a") + joint), file=None)
    assert {one.code for one in found} == {"ROB058"}


def test_an_unknown_material_is_reported_once() -> None:
    silver = "".join(
        f'<gazebo reference="{name}"><material>Gazebo/Silver</material></gazebo>' for name in "aa"
    )
    _, found = read_urdf(robot(link("a") + silver), file=None)
    assert [one.code for one in found] == ["ROB032"]
