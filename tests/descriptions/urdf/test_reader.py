"""Every diagnostic of the reader, and what it reads where nothing is wrong."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from urdf_texts import ERRORS, MASS, SPHERE, TWO, WARNINGS, joint, link, robot, shape
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import TEXT_LIMIT, read_urdf
from wsgen.diagnostics import Severity
from wsgen.model.robot import Box, Cylinder, JointType, Mesh, Plugin, Sensor, Sphere
from wsgen.model.transform import Pose

FILE = Path("robot.urdf")


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


def test_all_diagnostics_in_one_pass_with_their_lines() -> None:
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


@pytest.mark.parametrize(
    ("shape_text", "message", "hint"),
    [
        (
            '<box size="1 1"/>',
            'size="1 1": it has 2 instead of 3 numbers.',
            "Write 3 finite numbers, with a decimal point, separated by blanks. ",
        ),
        (
            '<sphere radius="1,5"/>',
            'radius="1,5": `1,5` has a comma.',
            'Write radius="1.5". ',
        ),
    ],
)
def test_a_number_that_cannot_be_read(shape_text: str, message: str, hint: str) -> None:
    body = f"<collision><geometry>{shape_text}</geometry></collision>"
    (found,) = read_urdf(robot(f'<link name="a">{MASS}{body}</link>'), file=None)[1]
    assert found.message == message
    assert (found.hint or "").startswith(hint)


def test_a_number_of_gazebo_that_cannot_be_read() -> None:
    tag = '<gazebo reference="a"><mu1>zero</mu1></gazebo>'
    (found,) = read_urdf(robot(link("a") + tag), file=None)[1]
    assert found.message == (
        "<mu1>: `zero` is not a number, and Gazebo terminates with an exception."
    )
    assert found.hint == "Write one number with a decimal point."


def test_a_repeated_name_is_reported_without_a_line_of_the_expanded_text() -> None:
    _, (found,) = read_urdf(robot(link("a") + link("a")), file=None)
    assert found.message == "Two links have the name `a`."


def test_nearest_name_is_offered() -> None:
    text = robot(link("base_link") + link("wheel_left") + joint("j", "base_lnk", "wheel_left"))
    (found,) = read_urdf(text, file=None)[1]
    assert found.hint == "Did you mean `base_link`?"


@pytest.mark.parametrize(
    ("child", "hint"),
    [
        ("", 'Add <child link="LINK"/>.'),
        ('<child link=""/>', 'Write <child link="LINK"/>.'),
        ("<child>b</child>", 'Write <child link="LINK"/>.'),
        ('<child link="b "/>', "Did you mean `b`?"),
    ],
)
def test_a_child_that_is_not_named(child: str, hint: str) -> None:
    connected = joint("j", "a", "b").replace('<child link="b"/>', child)
    found = read_urdf(robot(link("a") + link("b") + connected), file=None)[1]
    assert hint in {one.hint for one in found}


@pytest.mark.parametrize(
    ("element", "declaration"),
    [
        ("<gz:x/>", 'xmlns:gz="http://gazebosim.org/schema"'),
        ('<a xacro:x="1"/>', 'xmlns:xacro="http://www.ros.org/wiki/xacro"'),
        ("<own:x/>", 'xmlns:own="own"'),
    ],
)
def test_a_prefix_that_nothing_declares(element: str, declaration: str) -> None:
    text = robot(link("a") + f"<gazebo>{element}</gazebo>")
    (found,) = [one for one in read_urdf(text, file=None)[1] if one.code == "ROB001"]
    assert "nothing declares the prefix" in found.message
    assert found.hint == f"Add {declaration} to the root element."
    declared = text.replace("<robot ", f"<robot {declaration} ", 1)
    assert not [one for one in read_urdf(declared, file=None)[1] if one.code == "ROB001"]


def test_document_beyond_reason_is_refused() -> None:
    text = robot("<!--" + " " * TEXT_LIMIT + "-->" + link("a"))
    assert [found.code for found in read_urdf(text, file=None)[1]] == ["ROB002"]


def test_deep_nesting_is_refused() -> None:
    text = robot("<x>" * 5000 + "</x>" * 5000 + link("a"))
    assert [found.code for found in read_urdf(text, file=None)[1]] == ["ROB001"]


@pytest.mark.slow
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
        '<sphere radius=" 1.5"/>',
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


def test_colors() -> None:
    sphere = '<geometry><sphere radius="1"/></geometry>'
    model, found = read_urdf(
        robot(
            '<material name="red"><color rgba="1 0 0 1"/></material>'
            + link("a", f'<visual>{sphere}<material name="red"/></visual><visual>{sphere}</visual>')
            + link("b", f'<visual>{sphere}<material name="red"/></visual>')
            + joint("j", "a", "b")
        ),
        file=None,
    )
    assert model is not None
    assert found == ()
    assert [visual.rgba for visual in model.link("a").visuals] == [(1, 0, 0, 1), None]
    assert [visual.rgba for visual in model.link("b").visuals] == [(1, 0, 0, 1)]


def test_gazebo_tags() -> None:
    model, found = read_urdf(
        robot(
            link("a", shape("collision", SPHERE))
            + '<gazebo reference="a"><mu1>0.2</mu1><mu2 value="0.3">0.5</mu2>'
            "<collision><surface><friction><ode><mu>0.7</mu></ode></friction></surface></collision>"
            '<sensor name="eye" type="camera">'
            '<plugin name="p" filename="libeye.so"/></sensor></gazebo>\n'
            '<gazebo><plugin name="q" filename="libdrive.so">'
            "<joint> l </joint><rate>30</rate><joint>r</joint></plugin></gazebo>"
            '<gazebo reference=""><static>true</static></gazebo>'
        ),
        file=None,
    )
    assert model is not None
    assert found == ()
    values = model.gazebo[0].values
    assert (values["mu1"], values["mu2"]) == ("0.2", "0.3")
    assert values["collision/surface/friction/ode/mu"] == "0.7"
    assert "sensor" not in values
    eye = Plugin("libeye.so", {}, "p", 3)
    drive = Plugin("libdrive.so", {"joint": ("l", "r"), "rate": ("30",)}, "q", 4)
    camera = Sensor("eye", "camera", {"plugin": ("",)}, (eye,), 3)
    assert [(tag.reference, tag.plugins, tag.sensors) for tag in model.gazebo] == [
        ("a", (eye,), (camera,)),
        (None, (drive,), ()),
        (None, (), ()),
    ]


def test_what_cannot_be_read_ends_the_link() -> None:
    """urdfdom reads inertial, visuals and collisions in this order, and stops at an error."""
    broken = shape("visual", "<cone/>")
    ball, touch = shape("visual", SPHERE), shape("collision", SPHERE)
    model, found = read_urdf(robot(link("a", touch + ball + broken + ball + ball)), file=FILE)
    assert model is not None
    (read,) = model.links
    assert (len(read.visuals), len(read.collisions)) == (1, 0)
    (only,) = found
    assert only.code == "ROB024"
    assert only.message.endswith("drops 2 visuals and 1 collision.")


@pytest.mark.parametrize(
    ("inertial", "mass"),
    [
        ("<mass value='x'/>", None),
        ("<mass value='3'/>", 3.0),
        ("<mass value='3'/><inertia ixx='1' iyy='1' izz='1'/>", 3.0),
    ],
)
def test_what_is_left_of_an_inertial(inertial: str, mass: float | None) -> None:
    """As in `ign sdf -p`: the mass may stay, the moments are 0, and the shapes are lost."""
    model, found = read_urdf(
        robot(link("a", f"<inertial>{inertial}</inertial>" + shape("collision", SPHERE))), file=FILE
    )
    assert model is not None
    (read,) = model.links
    assert (read.inertial.mass if read.inertial else None) == mass
    assert read.inertial is None or read.inertial.inertia == (0.0,) * 6
    assert read.collisions == ()
    assert "drops 1 collision." in found[0].message


def test_a_mirrored_mesh_can_be_seen() -> None:
    model, found = read_urdf(
        robot(link("a", shape("visual", '<mesh filename="a.stl" scale="1 -1 1"/>'))), file=None
    )
    assert model is not None
    assert (len(model.links[0].visuals), found) == (1, ())


def test_default_namespace_means_nothing() -> None:
    text = robot(link("a", MASS)).replace("<robot", "<robot xmlns='http://www.ros.org'")
    model, found = read_urdf(text, file=None)
    assert model is not None
    assert (model.mass, found) == (1.0, ())


def test_lumped_joint_may_be_called_like_a_link() -> None:
    assert read_urdf(robot(TWO + joint("b", "a", "b")), file=None)[1] == ()


def test_impossible_inertia_with_a_possible_sum_is_a_warning_also_at_the_parent() -> None:
    heavy = MASS.replace('"1"', '"20"')
    _, found = read_urdf(
        robot(
            link("a", MASS.replace('izz="1"', 'izz="9"')) + link("b", heavy) + joint("j", "a", "b")
        ),
        file=None,
    )
    assert [(one.code, one.severity) for one in found] == [("ROB037", Severity.WARNING)]


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


def test_no_inertia_comes_with_that_of_the_shape() -> None:
    zero = re.sub(r'(i[xyz]{2})="[^"]*"', r'\1="0"', MASS)
    model, _ = read_urdf(
        robot(link("a", zero + shape("collision", '<box size="1 1 1"/>'))), file=None
    )
    assert model is not None
    (found,) = lump(model, file=None)[1]
    assert found.code == "ROB037"
    assert 'ixx="0.1667" iyy="0.1667" izz="0.1667"' in (found.hint or "")


@pytest.mark.parametrize("moment", ["-1", "9"])
def test_an_impossible_inertia_comes_with_that_of_the_shape(moment: str) -> None:
    box = shape("collision", '<box size="1 1 1"/>')
    _, found = read_urdf(
        robot(link("a", MASS.replace('izz="1"', f'izz="{moment}"') + box)), file=None
    )
    assert [one.code for one in found] == ["ROB037"]
    assert 'ixx="0.1667" iyy="0.1667" izz="0.1667"' in (found[0].hint or "")


XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


@pytest.mark.parametrize(
    ("body", "code", "severity", "lost"),
    [
        (f'<xacro:macro {XACRO} name="w"><link name="${{p}}w"/></xacro:macro>', "ROB143",
         "warning", "does not add anything to the robot by itself"),
        (f'<xacro:property {XACRO} name="x" value="1"/>', "ROB143", "warning", "not add anything"),
        (f'<xacro:include {XACRO} filename="wheels.xacro"/>', "ROB143", "error",
         "the content of the file `wheels.xacro` is missing"),
        (f'<xacro:wheel {XACRO} side="left"/>', "ROB143", "error", "to the robot are missing"),
        (f'<xacro:if {XACRO} value="1"><link name="b"/><joint name="j"/></xacro:if>',
         "ROB143", "error", "the 1 link and 1 joint in it are missing"),
        ('<gazebo><plugin filename="a.so" name="a"><ns>$(arg ns)</ns></plugin></gazebo>',
         "ROB017", "warning", "the plugin reads it as it is written"),
        ('<gazebo reference="a"><mu1>${mu}</mu1></gazebo>', "ROB017", "error", "parser ends"),
    ],
)  # fmt: skip
def test_what_is_left_of_xacro_says_what_is_lost(
    body: str, code: str, severity: str, lost: str
) -> None:
    """As `ign sdf -p` and `check_urdf` do with these texts."""
    made, found = read_urdf(robot(link("a") + body), file=None)
    (one,) = [found for found in found if found.code in {"ROB017", "ROB143"}]
    assert (one.code, one.severity.value) == (code, severity)
    assert lost in one.message
    assert made is not None
    assert [one.name for one in made.links] == ["a"]


@pytest.mark.parametrize(
    ("text", "severity", "lost"),
    [
        (robot(link("a"), name="${name}"), "warning", "takes it as it is"),
        (robot(link("${p}a")), "warning", "takes it as it is"),
        (robot(link("a", MASS.replace('"1"', '"${m}"', 1))), "error", "drops the <inertial>"),
        (
            robot(link("a", MASS + shape("collision", '<sphere radius="${r}"/>'))),
            "error",
            "drops collisions",
        ),
        (
            robot(TWO + joint("j", "a", "b", '<origin xyz="${x} 0 0"/>')),
            "error",
            "it refuses the robot",
        ),
    ],
)
def test_an_expression_of_xacro_says_what_is_lost(text: str, severity: str, lost: str) -> None:
    _, found = read_urdf(text, file=None)
    (one,) = [found for found in found if found.code == "ROB017"]
    assert one.severity.value == severity
    assert lost in one.message
