"""Elements that are nearly called as those that Gazebo reads."""

from __future__ import annotations

import pytest

from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.diagnostics import Diagnostic, Severity

ROBOT = """<robot name="r">
  <link name="a">
    {link}
    <inertial><mass value="1"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>{inertial}</inertial>
    <visual><geometry><box size="1 1 1"/></geometry>{visual}</visual>
  </link>
  <link name="b"/>
  <joint name="j" type="fixed"><parent link="a"/><child link="b"/>{joint}</joint>
  {robot}
</robot>
"""
PLACES = ("link", "inertial", "visual", "joint", "robot")


def misspelled(place: str, content: str, code: str = "ROB038") -> list[Diagnostic]:
    text = ROBOT.format(**{**dict.fromkeys(PLACES, ""), place: content})
    _, found = read_urdf(text, file=None)
    return [diagnostic for diagnostic in found if diagnostic.code == code]


@pytest.mark.parametrize(
    ("place", "wrong", "meant"),
    [
        ("link", "colision", "collision"),
        ("link", "Collision", "collision"),
        ("link", "inertal", "inertial"),
        ("link", "inertia", "inertial"),
        ("link", "visul", "visual"),
        ("joint", "parnt", "parent"),
        ("joint", "axs", "axis"),
        ("joint", "limits", "limit"),
        ("visual", "orgin", "origin"),
        ("visual", "materal", "material"),
        ("inertial", "orign", "origin"),
        ("robot", "links", "link"),
    ],
)
def test_the_nearest_name_is_suggested(place: str, wrong: str, meant: str) -> None:
    (found,) = misspelled(place, f"<{wrong}/>")
    assert found.severity is Severity.WARNING
    assert found.message.startswith(f"<{wrong}> is not an element of <{place}>: ")
    assert found.hint == f"Did you mean <{meant}>?"
    assert found.line
    assert (found.element or "").endswith(wrong)


def test_the_element_names_the_part() -> None:
    (found,) = misspelled("visual", "<materal/>")
    assert (found.element, found.line) == ("link[@name='a']/visual/materal", 6)


@pytest.mark.parametrize(
    ("place", "content"),
    [
        ("link", "<contact><lateral_friction value='1'/></contact><self_collision_checking/>"),
        ("link", "<sensor name='s'/><verbose/><group/>"),
        ("joint", "<hardwareInterface/><damping/><friction/><!-- <parnt/> -->"),
        ("robot", "<gazebo><something/></gazebo><ros2_control/><sensor/><version/><loop_joint/>"),
        ("robot", "<transmission><joint name='j'/></transmission><x:links xmlns:x='y'/>"),
    ],
)
def test_what_other_programs_read_is_no_mistake(place: str, content: str) -> None:
    assert misspelled(place, content) == []


@pytest.mark.parametrize(
    ("wrong", "meant"),
    [
        ("mu_1", "mu1"),
        ("MU1", "mu1"),
        ("matrial", "material"),
        ("Material", "material"),
        ("selfColide", "selfCollide"),
        ("turnGravityOf", "turnGravityOff"),
        ("maxContact", "maxContacts"),
        ("plugn", "plugin"),
        ("sensr", "sensor"),
    ],
)
def test_what_gazebo_reads_in_its_own_element(wrong: str, meant: str) -> None:
    (found,) = misspelled("robot", f'<gazebo reference="a"><{wrong}>1</{wrong}></gazebo>')
    assert found.hint == f"Did you mean <{meant}>?"


@pytest.mark.parametrize(
    ("place", "element", "meant"),
    [
        ("link", "<visual><geometry><sphere adius='1'/></geometry></visual>", "radius"),
        ("link", "<visual><geometry><sphere radios='1'/></geometry></visual>", "radius"),
        ("link", "<visual><geometry><mesh file='a.stl'/></geometry></visual>", "filename"),
        ("link", "<visual><geometry><box sise='1 1 1'/></geometry></visual>", "size"),
        ("link", "<visual nam='v'><geometry><box size='1 1 1'/></geometry></visual>", "name"),
        ("joint", "<dynamics dampening='1'/>", "damping"),
        ("joint", "<dynamics damping='1' fiction='1'/>", "friction"),
        ("joint", "<mimic joint='j' multipler='1'/>", "multiplier"),
    ],
)
def test_the_nearest_attribute_is_suggested(place: str, element: str, meant: str) -> None:
    (found,) = misspelled(place, element, "ROB077")
    assert found.hint == f"Did you mean `{meant}`?"


@pytest.mark.parametrize(
    ("place", "element"),
    [
        ("link", "<visual frame='a'><geometry><box size='1 1 1'/></geometry></visual>"),
        ("link", "<visual><geometry><sphere radius='1' filename='a'/></geometry></visual>"),
        ("joint", "<dynamics damping='1' stiction='1'/>"),
        ("joint", "<limit effort='1' velocity='1' power='1'/>"),
        ("joint", "<origin xyz='0 0 0' frame='a'/>"),
    ],
)
def test_the_attributes_of_other_programs_are_no_mistake(place: str, element: str) -> None:
    assert misspelled(place, element, "ROB077") == []


@pytest.mark.parametrize(
    ("written", "wrong", "line"),
    [
        ("link name='b'", "Link name='b'", 3),
        ("joint", "Joint", 4),
        ("link name='b'", "lnik name='b'", 3),
    ],
)
def test_what_lacks_a_misspelled_link_or_joint_is_not_reported(
    written: str, wrong: str, line: int
) -> None:
    tag, meant = wrong.split(maxsplit=1)[0], written.split(maxsplit=1)[0]
    text = (
        "<robot name='r'>\n<link name='a'></link>\n<link name='b'></link>\n"
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint>\n"
        "<gazebo reference='b'><mu1>1</mu1></gazebo></robot>"
    )
    start, _, rest = text.partition(f"<{written}")
    text = f"{start}<{wrong}{rest.replace(f'</{meant}>', f'</{tag}>', 1)}"
    robot, found = read_urdf(text, file=None)
    assert robot is None
    assert [(one.code, one.severity, one.line) for one in found] == [
        ("ROB038", Severity.ERROR, line)
    ]
    assert found[0].hint == f"Did you mean <{meant}>?"


def test_an_attribute_that_is_nearly_reference() -> None:
    (found,) = misspelled("robot", '<gazebo ref="a"><plugin name="p" filename="f"/></gazebo>')
    assert found.message.startswith("`ref` is not an attribute of <gazebo>: ")
    assert found.hint == "Did you mean `reference`?"
    assert misspelled("robot", '<gazebo reference="a"/><gazebo/>') == []
