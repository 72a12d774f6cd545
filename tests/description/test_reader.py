"""Every diagnostic of the reader, and what it reads where nothing is wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.description.reader import TEXT_LIMIT, read_urdf
from wsgen.diagnostics import Severity
from wsgen.model.pose import Pose
from wsgen.model.robot import Box, Capsule, Cylinder, JointType, Mesh, Sphere, Surface

FILE = Path("robot.urdf")
MASS = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
)


def robot(body: str, name: str = "r") -> str:
    return f'<robot name="{name}">\n{body}\n</robot>'


def link(name: str, body: str = MASS) -> str:
    return f'<link name="{name}">{body}</link>\n'


def joint(name: str, parent: str, child: str, body: str = "", kind: str = "fixed") -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f"{body}</joint>\n"
    )


def shape(tag: str, geometry: str) -> str:
    return f"<{tag}><geometry>{geometry}</geometry></{tag}>"


TWO = link("a") + link("b")
LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'

ERRORS = {
    "not xml": ("ROB001", "<robot name='r'><link name='a'></robot>"),
    "empty": ("ROB001", ""),
    "entities": ("ROB002", '<!DOCTYPE r [<!ENTITY a "b">]>' + robot(link("a"))),
    "sdf": ("ROB003", "<sdf version='1.9'/>"),
    "no name": ("ROB004", robot(link("a"), name="")),
    "no links": ("ROB005", robot("")),
    "link without name": ("ROB006", robot(link("a") + "<link/>")),
    "joint without name": ("ROB006", robot(TWO + joint("", "a", "b"))),
    "two links of one name": ("ROB007", robot(link("a") + link("a"))),
    "two joints of one name": (
        "ROB008",
        robot(TWO + link("c") + joint("j", "a", "b") + joint("j", "b", "c")),
    ),
    "two roots": ("ROB009", robot(TWO)),
    "world not joined": ("ROB009", robot('<link name="world"/>' + link("a"))),
    "cycle": ("ROB010", robot(TWO + joint("j", "a", "b") + joint("k", "b", "a"))),
    "cycle below a root": (
        "ROB010",
        robot(link("r") + TWO + joint("j", "a", "b") + joint("k", "b", "a")),
    ),
    "two parents": (
        "ROB011",
        robot(TWO + link("c") + joint("j", "a", "c") + joint("k", "b", "c")),
    ),
    "self joint": ("ROB012", robot(link("a") + joint("j", "a", "a"))),
    "unknown link": ("ROB013", robot(TWO + joint("j", "a", "B"))),
    "joint without child": (
        "ROB014",
        robot(TWO + '<joint name="j" type="fixed"><parent link="a"/></joint>'),
    ),
    "joint type": ("ROB015", robot(TWO + joint("j", "a", "b", kind="hinge"))),
    "comma": ("ROB016", robot(TWO + joint("j", "a", "b", '<origin xyz="0,1 0 0"/>'))),
    "two numbers": ("ROB016", robot(TWO + joint("j", "a", "b", '<origin xyz="0 0"/>'))),
    "nan": ("ROB016", robot(TWO + joint("j", "a", "b", '<origin rpy="nan 0 0"/>'))),
    "huge": ("ROB016", robot(link("a", MASS.replace('"1"', '"1e999"')))),
    "underscore": ("ROB016", robot(link("a", MASS.replace('value="1"', 'value="1_0"')))),
    "other digits": ("ROB016", robot(link("a", MASS.replace('value="1"', 'value="٣"')))),
    "missing moment": ("ROB016", robot(link("a", MASS.replace('iyz="0"', "")))),
    "left over": ("ROB017", robot(TWO + joint("j", "a", "b", '<origin xyz="${x} 0 0"/>'))),
    "left over in text": ("ROB017", robot(link("a") + "<gazebo><p>$(find x)</p></gazebo>")),
    "left over macro": (
        "ROB017",
        robot(link("a") + '<xacro:wheel xmlns:xacro="http://www.ros.org/wiki/xacro"/>'),
    ),
    "zero axis": (
        "ROB018",
        robot(TWO + joint("j", "a", "b", '<axis xyz="0 0 0"/>', "continuous")),
    ),
    "no limit": ("ROB020", robot(TWO + joint("j", "a", "b", kind="revolute"))),
    "no effort": (
        "ROB016",
        robot(TWO + joint("j", "a", "b", '<limit velocity="1"/>', "prismatic")),
    ),
    "inertial without mass": ("ROB021", robot(link("a", "<inertial/>"))),
    "negative mass": ("ROB022", robot(link("a", MASS.replace('value="1"', 'value="-1"')))),
    "no geometry": ("ROB024", robot(link("a", MASS + "<collision/>"))),
    "unknown geometry": ("ROB024", robot(link("a", MASS + shape("visual", "<cone/>")))),
    "zero radius": ("ROB028", robot(link("a", shape("collision", '<sphere radius="0"/>')))),
    "negative box": ("ROB028", robot(link("a", shape("visual", '<box size="1 -1 1"/>')))),
    "zero scale": (
        "ROB028",
        robot(link("a", shape("visual", '<mesh filename="a.stl" scale="0 1 1"/>'))),
    ),
    "mesh without name": ("ROB029", robot(link("a", shape("visual", "<mesh/>")))),
    "friction in words": (
        "ROB031",
        robot(link("a") + '<gazebo reference="a"><mu1>low</mu1></gazebo>'),
    ),
    "unknown leader": ("ROB035", robot(TWO + joint("j", "a", "b", '<mimic joint="x"/>'))),
    "mimics itself": ("ROB036", robot(TWO + joint("j", "a", "b", '<mimic joint="j"/>'))),
    "impossible part of a sum that is impossible": (
        "ROB037",
        robot(link("a") + link("b", MASS.replace('izz="1"', 'izz="9"')) + joint("j", "a", "b")),
    ),
    "impossible inertia": ("ROB037", robot(link("a", MASS.replace('izz="1"', 'izz="9"')))),
}

WARNINGS = {
    "long axis": (
        "ROB019",
        robot(TWO + joint("j", "a", "b", '<axis xyz="0 0 2"/>', "continuous")),
    ),
    "limits exchanged": (
        "ROB023",
        robot(TWO + joint("j", "a", "b", LIMIT.replace("-1", "2"), "revolute")),
    ),
    "undefined material": (
        "ROB025",
        robot(
            link(
                "a",
                '<visual><geometry><sphere radius="1"/></geometry><material name="m"/></visual>',
            )
        ),
    ),
    "two colours": (
        "ROB026",
        robot(
            '<material name="m"><color rgba="1 0 0 1"/></material>\n'
            '<material name="m"><color rgba="0 0 1 1"/></material>' + link("a")
        ),
    ),
    "bytes as colour": (
        "ROB027",
        robot('<material name="m"><color rgba="255 0 0 1"/></material>' + link("a")),
    ),
    "unknown reference": ("ROB030", robot(link("wheel") + '<gazebo reference="whel"/>')),
    "unknown colour": (
        "ROB032",
        robot(link("a") + '<gazebo reference="a"><material>Gazebo/Gren</material></gazebo>'),
    ),
    "preserve on a link": (
        "ROB033",
        robot(
            link("a") + '<gazebo reference="a"><preserveFixedJoint>1</preserveFixedJoint></gazebo>'
        ),
    ),
    "joint named like a link": ("ROB034", robot(TWO + joint("b", "a", "b"))),
    "impossible part of a sum that is possible": (
        "ROB037",
        robot(
            link("a", MASS.replace('"1"', '"20"'))
            + link("b", MASS.replace('izz="1"', 'izz="9"'))
            + joint("j", "a", "b")
        ),
    ),
}


@pytest.mark.parametrize(("code", "text"), ERRORS.values(), ids=ERRORS.keys())
def test_error(code: str, text: str) -> None:
    found = [
        diagnostic
        for diagnostic in read_urdf(text, file=FILE)[1]
        if diagnostic.severity is Severity.ERROR
    ]
    assert {diagnostic.code for diagnostic in found} == {code}
    assert all(diagnostic.file == FILE and diagnostic.hint for diagnostic in found)
    assert all(diagnostic.line or code == "ROB002" for diagnostic in found)


@pytest.mark.parametrize(("code", "text"), WARNINGS.values(), ids=WARNINGS.keys())
def test_warning(code: str, text: str) -> None:
    model, found = read_urdf(text, file=FILE)
    assert [(diagnostic.code, diagnostic.severity) for diagnostic in found] == [
        (code, Severity.WARNING)
    ]
    assert found[0].line
    assert model is not None


def test_no_tree_no_robot() -> None:
    for name in ("two roots", "cycle", "two parents", "self joint", "unknown link", "joint type"):
        assert read_urdf(ERRORS[name][1], file=None)[0] is None


def test_all_findings_in_one_pass_with_their_lines() -> None:
    text = robot(
        "<link name='a'>\n<collision>\n<geometry>\n<sphere radius='0'/></geometry></collision>\n"
        "</link>\n<link name='b'/>\n<joint name='j' type='revolute'><parent link='a'/>\n"
        "<child link='b'/>\n<origin xyz='1,2 0 0'/></joint>"
    )
    found = read_urdf(text, file=FILE)[1]
    assert {(diagnostic.code, diagnostic.line) for diagnostic in found} == {
        ("ROB028", 5),
        ("ROB020", 8),
        ("ROB016", 10),
    }


def test_nearest_name_is_offered() -> None:
    text = robot(link("base_link") + link("wheel_left") + joint("j", "base_lnk", "wheel_left"))
    (found,) = read_urdf(text, file=None)[1]
    assert found.hint == "Did you mean `base_link`?"


def test_document_beyond_reason_is_refused() -> None:
    text = robot("<!--" + " " * TEXT_LIMIT + "-->" + link("a"))
    assert [found.code for found in read_urdf(text, file=None)[1]] == ["ROB002"]


def test_deep_nesting_is_refused() -> None:
    text = robot("<x>" * 5000 + "</x>" * 5000 + link("a"))
    assert [found.code for found in read_urdf(text, file=None)[1]] == ["ROB001"]


def test_ten_thousand_links_in_a_chain() -> None:
    count = 10_000
    text = robot(
        "".join(link(f"l{index}") for index in range(count))
        + "".join(joint(f"j{index}", f"l{index}", f"l{index + 1}") for index in range(count - 1))
    )
    model, found = read_urdf(text, file=None)
    assert model is not None
    assert (model.root, len(model.links), found) == ("l0", count, ())


def test_a_declaration_that_gazebo_accepts() -> None:
    model, found = read_urdf('\n<?xml version="0.0" ?>\n' + robot("\n<link/>"), file=None)
    assert model is None
    assert ("ROB006", 5) in {(diagnostic.code, diagnostic.line) for diagnostic in found}


def test_geometry() -> None:
    shapes = (
        '<box size="1 2 3"/>',
        '<cylinder radius="1" length="2"/>',
        '<sphere radius=" 1.5 "/>',
        '<capsule radius="1" length="2"/>',
        '<mesh filename="package://p/m.stl" scale="1e-3 .001 0.001"/>',
    )
    model, found = read_urdf(
        robot(link("a", "".join(shape("collision", text) for text in shapes))), file=None
    )
    assert model is not None
    assert found == ()
    assert [collision.geometry for collision in model.links[0].collisions] == [
        Box(size=(1, 2, 3)),
        Cylinder(radius=1, length=2),
        Sphere(radius=1.5),
        Capsule(radius=1, length=2),
        Mesh(uri="package://p/m.stl", scale=(0.001, 0.001, 0.001)),
    ]


def test_joint() -> None:
    body = (
        '<origin xyz="1 2 3" rpy="0.1 0.2 0.3"/><axis xyz="0 0 -1"/>'
        '<limit lower="-1" upper="2" effort="3" velocity="4"/><dynamics damping="5" friction="6"/>'
        '<calibration rising="0"/><safety_controller k_velocity="1"/>'
    )
    model, found = read_urdf(robot(TWO + joint("j", "a", "b", body, "revolute")), file=None)
    assert model is not None
    assert found == ()
    (read,) = model.joints
    assert read.type is JointType.REVOLUTE
    assert read.pose_in_parent == Pose((1, 2, 3), (0.1, 0.2, 0.3))
    assert read.axis_in_joint == (0, 0, -1)
    assert read.limit is not None
    assert (read.limit.lower, read.limit.upper, read.limit.effort, read.limit.velocity) == (
        *(-1, 2, 3),
        4,
    )
    assert (read.damping, read.friction) == (5, 6)


def test_exchanged_limits_are_put_right() -> None:
    model, _ = read_urdf(WARNINGS["limits exchanged"][1], file=None)
    assert model is not None
    assert model.joints[0].limit is not None
    assert (model.joints[0].limit.lower, model.joints[0].limit.upper) == (1, 2)


def test_colours() -> None:
    sphere = '<geometry><sphere radius="1"/></geometry>'
    model, found = read_urdf(
        robot(
            '<material name="red"><color rgba="1 0 0 1"/></material>'
            + link("a", f'<visual>{sphere}<material name="red"/></visual><visual>{sphere}</visual>')
            + link("b", f'<visual>{sphere}<material name="red"/></visual>')
            + joint("j", "a", "b")
            + '<gazebo reference="b"><material>Gazebo/Green</material></gazebo>'
        ),
        file=None,
    )
    assert model is not None
    assert found == ()
    assert [visual.rgba for visual in model.link("a").visuals] == [(1, 0, 0, 1), None]
    assert [visual.rgba for visual in model.link("b").visuals] == [(0, 1, 0, 1)]


def test_gazebo_tags() -> None:
    model, found = read_urdf(
        robot(
            link("a", shape("collision", '<sphere radius="1"/>'))
            + '<gazebo reference="a"><mu1>0.2</mu1><mu2 value="0.3"/><kp>1e6</kp><kd>2</kd>'
            "<minDepth>0.001</minDepth><maxContacts>4</maxContacts><selfCollide>True</selfCollide>"
            '<turnGravityOff>true</turnGravityOff><sensor name="eye" type="camera">'
            '<plugin name="p" filename="libeye.so"/></sensor></gazebo>\n'
            '<gazebo><plugin name="q" filename="libdrive.so"/></gazebo>'
        ),
        file=None,
    )
    assert model is not None
    assert found == ()
    (a,) = model.links
    assert a.collisions[0].surface == Surface(
        mu1=0.2, mu2=0.3, kp=1e6, kd=2, min_depth=0.001, max_contacts=4
    )
    assert (a.self_collide, a.gravity) == (True, False)
    assert [(tag.reference, tag.plugins, tag.sensors) for tag in model.gazebo] == [
        ("a", ("libeye.so",), ("eye",)),
        (None, ("libdrive.so",), ()),
    ]


def test_self_collision_of_the_whole_robot() -> None:
    model, _ = read_urdf(
        robot(TWO + joint("j", "a", "b") + "<gazebo><selfCollide>1</selfCollide></gazebo>"),
        file=None,
    )
    assert model is not None
    assert all(one.self_collide for one in model.links)


def test_world_is_the_world() -> None:
    model, _ = read_urdf(
        robot('<link name="world"/>' + link("a") + joint("j", "world", "a")), file=None
    )
    assert model is not None
    assert model.fixed_to_world


@pytest.mark.parametrize("name", ["ρομπότ", "a b", "<&>", "x" * 2000])
def test_names_of_any_kind(name: str) -> None:
    escaped = name.replace("&", "&amp;").replace("<", "&lt;")
    model, found = read_urdf(robot(link(escaped)), file=None)
    assert model is not None
    assert (model.root, found) == (name, ())


def test_the_first_of_repeated_elements_counts() -> None:
    """As in `ign sdf -p`."""
    second = MASS.replace('mass value="1"', 'mass value="2"')
    twice = '<inertial><mass value="1"/><mass value="3"/>' + MASS.partition("/>")[2]
    for body in (MASS + second, twice):
        read, _ = read_urdf(robot(link("a", body)), file=FILE)
        assert read is not None
        assert read.mass == 1.0
