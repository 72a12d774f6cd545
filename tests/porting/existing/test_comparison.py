"""The comparison finds each thing that a robot can lose on its way into a package."""

# ruff: noqa: E501  elements as people write them

from pathlib import Path

import pytest

from existing_robots import ARM
from wsgen.descriptions.meshes.lookup import find_meshes
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.model.inertia import about_link_axes, turned
from wsgen.model.robot import Robot
from wsgen.model.transform import rotate
from wsgen.porting.existing.comparison import Renamed, compare, compare_with, place_links
from wsgen.porting.existing.description import Configuration, Reference


def read(text: str) -> Robot:
    robot, _ = read_urdf(text, file=None)
    assert robot is not None
    return robot


def differing(before: str, after: str, renamed: Renamed = Renamed()) -> dict[str, tuple[str, ...]]:  # noqa: B008
    rows = compare(read(before), read(after), renamed)
    return {row.aspect.split(" in ")[0]: row.differing for row in rows if not row.is_same}


def reference(robot: Robot, *, mass: float = 0.0, at: float = 0.0, turn: float = 1.0) -> Reference:
    """What the robot has with its joint at 0.3, and what is wrong in it."""
    placed = place_links(robot, {"shoulder": 0.3})
    centers, inertias = {}, {}
    for link in robot.links:
        if link.inertial is not None:
            matrix, origin = placed[link.name]
            x, y, z = rotate(matrix, link.inertial.pose_in_link.xyz)
            centers[link.name] = (origin[0] + x, origin[1] + y, origin[2] + z + at)
            six = turned(about_link_axes(link.inertial), matrix)
            xx, xy, xz, yy, yz, zz = (turn * one / link.inertial.mass for one in six)
            inertias[link.name] = (xx, xy, xz, yy, yz, zz)
    return Reference(
        "Other", robot.mass + mass, (Configuration({"shoulder": 0.3}, centers, inertias),)
    )


@pytest.mark.parametrize("wrong", [{}, {"mass": 1e-5}, {"at": 1e-5}, {"turn": 1.00001}])
def test_what_another_program_has(wrong: dict[str, float]) -> None:
    robot = read(ARM)
    row = compare_with(reference(robot, **wrong), robot, Renamed())
    assert row.is_same == (not wrong)
    assert "(Other)" in row.source


POSES = "poses of links"


@pytest.mark.parametrize(
    ("written", "changed", "aspects"),
    [
        ('<axis xyz="0 1 0"/>', '<axis xyz="0 0 1"/>', {"axes of joints", POSES}),
        ('xyz="0 0 0.1" rpy="0.1', 'xyz="0 0 0.11" rpy="0.1', {"origins of joints", POSES}),
        ('rpy="0.1 0.2', 'rpy="0.1 0.21', {"origins of joints", POSES}),
        ('upper="1.5"', 'upper="1.6"', {"limits, damping, friction and mimics"}),
        ('effort="10"', 'effort="11"', {"limits, damping, friction and mimics"}),
        ('damping="0.5"', 'damping="0.6"', {"limits, damping, friction and mimics"}),
        ('<mass value="2"/>', '<mass value="2.00001"/>', {"masses"}),
        ('xyz="0.01 0 0.1"', 'xyz="0.02 0 0.1"', {"centers of mass"}),
        ('rpy="0 0 0.4"', 'rpy="0 0 0.5"', {"inertias"}),
        ('izz="0.0025"', 'izz="0.0024"', {"inertias"}),
        ('ixy="0.0001"', 'ixy="-0.0001"', {"inertias"}),
        ('xyz="0 0 0.02"', 'xyz="0 0 0.03"', {"visuals"}),
        ('size="0.1 0.1 0.1"', 'size="0.1 0.1 0.2"', {"collisions"}),
        ('scale="1 1 2"', 'scale="1 2 1"', {"visuals", "collisions"}),
    ],
)
def test_what_differs(written: str, changed: str, aspects: set[str]) -> None:
    assert written in ARM
    assert set(differing(ARM, ARM.replace(written, changed))) == aspects
    assert differing(ARM, ARM) == {}


def test_a_fixed_joint_that_was_none() -> None:
    found = differing(ARM, ARM.replace('type="revolute"', 'type="fixed"'))
    assert found["joints"] == ("shoulder",)


def test_rotations_that_are_written_otherwise_are_equal() -> None:
    turned = ARM.replace('rpy="0 0 0.4"', 'rpy="6.283185307179586 0 0.4"')
    assert differing(ARM, turned) == {}


def test_names_that_were_changed() -> None:
    renamed = Renamed({"upper": "upper_2"}, {"shoulder": "s"})
    after = ARM.replace('"upper"', '"upper_2"').replace('"shoulder"', '"s"')
    assert differing(ARM, after, renamed) == {}
    assert set(differing(ARM, after)) >= {"links", "joints"}


def test_a_link_and_a_joint_more() -> None:
    more = '<link name="new"/><joint name="j" type="fixed"><parent link="upper"/><child link="new"/></joint></robot>'
    found = differing(ARM, ARM.replace("</robot>", more))
    assert (found["links"], found["joints"]) == (("new",), ("j",))


def test_meshes_are_equal_by_their_bytes(tmp_path: Path) -> None:
    text = '<robot name="r"><link name="a"><visual><geometry><mesh filename="{}"/></geometry></visual></link></robot>'
    for name in ("one", "two", "three"):
        (tmp_path / f"{name}.stl").write_text("12" if name == "two" else "1")

    def robot(name: str) -> Robot:
        return find_meshes(read(text.format(tmp_path / f"{name}.stl")), share_of=lambda _: None)[0]

    assert all(row.is_same for row in compare(robot("one"), robot("three")))
    rows = compare(robot("one"), robot("two"))
    assert [row.aspect for row in rows if not row.is_same] == ["visuals"]


def test_places_of_links() -> None:
    """A quarter turn about y, a slide, and a follower, by hand."""
    text = """<robot name="r"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
    <joint name="turn" type="continuous"><origin xyz="0 0 1"/><parent link="a"/><child link="b"/>
      <axis xyz="0 1 0"/></joint>
    <joint name="slide" type="prismatic"><origin xyz="1 0 0"/><parent link="b"/><child link="c"/>
      <axis xyz="0 0 1"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint>
    <joint name="follow" type="prismatic"><parent link="c"/><child link="d"/><axis xyz="1 0 0"/>
      <limit lower="-9" upper="9" effort="1" velocity="1"/>
      <mimic joint="slide" multiplier="-2" offset="0.5"/></joint></robot>"""
    placed = place_links(read(text), {"turn": 1.5707963267948966, "slide": 0.25, "follow": 77.0})
    assert placed["b"][1] == pytest.approx((0, 0, 1))
    assert placed["c"][1] == pytest.approx((0.25, 0, 0))
    assert placed["d"][1] == pytest.approx((0.25, 0, 0))
    assert placed["b"][0][2] == pytest.approx((-1, 0, 0))
