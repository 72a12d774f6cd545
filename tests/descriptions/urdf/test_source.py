"""Diagnostics about an expanded robot, placed in the xacro files."""

from pathlib import Path

import pytest

from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.descriptions.xacro.reader import place_in_source, without_call
from wsgen.diagnostics import Diagnostic, Severity

MAIN = """<?xml version="1.0"?>
<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r">
  <xacro:include filename="$(find some_robot)/model/robot.gazebo"/>
  <xacro:include filename="wheels.xacro"/>
  <xacro:include filename="${somewhere}/else.xacro"/>
  <!-- <link name="base_link"/> <link name="gone"/> -->
  <link
    name="base_link"/>
  <link name="${prefix}camera"/>
  <xacro:macro name="arm" params="name">
    <link name="${name}"/>
    <link name="${name}_arm_$(arg side)"/>
    <joint name="${name}_joint"/>
    <joint name="left_${name}_joint"/>
    <link name="${name}.a"/>
    <link name="a.${name}"/>
  </xacro:macro>
</robot>
"""
GAZEBO = '<robot>\n<gazebo reference="base_link">\n<mu1>x</mu1></gazebo></robot>'
WHEELS = '<robot>\n\n\n<link name="wheel"/>\n<xacro:include filename="robot.xacro"/></robot>'


@pytest.fixture
def model(tmp_path: Path) -> Path:
    folder = tmp_path / "share" / "some_robot" / "model"
    folder.mkdir(parents=True)
    (folder / "robot.xacro").write_text(MAIN)
    (folder / "robot.gazebo").write_text(GAZEBO)
    (folder / "wheels.xacro").write_text(WHEELS)
    return folder


def place(element: str | None, file: Path | None, text: str = "<expanded/>") -> Diagnostic:
    found = Diagnostic(
        name="some-rule",
        code="ROB050",
        severity=Severity.WARNING,
        message="m",
        file=file,
        line=99,
        element=element,
    )
    (placed,) = place_in_source(
        [found],
        text=text,
        file=file,
        share_of=lambda name: file.parents[1] if file and name == "some_robot" else None,
    )
    return placed


@pytest.mark.parametrize(
    ("element", "file", "line"),
    [
        ("link[@name='base_link']/inertial", "robot.xacro", 7),
        ("link[@name='front_camera']", "robot.xacro", 9),
        ("link[@name='camera']", "robot.xacro", 9),
        ("link[@name='upper_arm_left']", "robot.xacro", 12),
        ("joint[@name='left_upper_joint']", "robot.xacro", 14),
        ("joint[@name='right_upper_joint']", "robot.xacro", 13),
        ("joint[@name='camera']", "robot.xacro", None),
        # two could be meant
        ("link[@name='a.a']", "robot.xacro", None),
        # only in a comment
        ("link[@name='gone']", "robot.xacro", None),
        ("link[@name='wheel']", "wheels.xacro", 4),
        ("gazebo[@reference='base_link']/mu1", "robot.gazebo", 2),
        ("link[@name='made_by_a_macro']", "robot.xacro", None),
        (None, "robot.xacro", None),
    ],
)
def test_an_element_is_found_by_its_name(
    model: Path, element: str | None, file: str, line: int | None
) -> None:
    placed = place(element, model / "robot.xacro")
    assert (placed.file, placed.line) == (model / file, line)


def test_a_urdf_keeps_its_lines(model: Path) -> None:
    placed = place("link[@name='wheel']", model / "robot.xacro", text=MAIN)
    assert (placed.file, placed.line) == (model / "robot.xacro", 99)


def test_a_text_from_nowhere_has_no_line() -> None:
    placed = place("link[@name='base_link']", None)
    assert (placed.file, placed.line) == (None, None)


def test_files_that_cannot_be_read_are_passed_over(model: Path) -> None:
    (model / "wheels.xacro").write_bytes(b"\xff\xfe")
    (model / "robot.gazebo").unlink()
    assert place("link[@name='wheel']", model / "robot.xacro").line is None


def test_a_misspelled_child_of_gazebo_is_found_by_its_reference(tmp_path: Path) -> None:
    file = tmp_path / "robot.xacro"
    file.write_text(
        """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="unused" value="1"/>
  <link name="a"/>
  <gazebo reference="a">
    <mu1>0.5</mu1>
  </gazebo>
  <gazebo reference="a">
    <selfColide>true</selfColide>
  </gazebo>
</robot>
"""
    )
    text = (
        "<robot name='r'>\n<link name='a'/><gazebo reference='a'>\n<mu1>0.5</mu1></gazebo>"
        "\n<gazebo reference='a'>\n<selfColide>true</selfColide></gazebo></robot>"
    )
    _, found = read_urdf(text, file=file)
    wrong = [one for one in found if one.code == "ROB038"]
    (placed,) = place_in_source(wrong, text=text, file=file, share_of=lambda _: None)
    assert placed.element == "gazebo[@reference='a']/selfColide"
    assert (placed.file, placed.line) == (file, 8)


CONTROLLED = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r">
  <ros2_control name="${prefix}arm" type="system">
    <joint name="elbow"/>
    <xacro:if value="true">
      <joint name="${prefix}wrist">
        <command_interface name="position"/>
      </joint>
    </xacro:if>
  </ros2_control>
  <joint name="elbow"/>
</robot>
"""


@pytest.mark.parametrize(
    ("element", "line"),
    [
        ("ros2_control[@name='left_arm']", 2),
        ("ros2_control[@name='left_arm']/joint[@name='elbow']", 3),
        ("ros2_control[@name='left_arm']/joint[@name='left_wrist']", 5),
        ("joint[@name='elbow']", 10),
    ],
)
def test_a_joint_in_another_element_is_another_one(element: str, line: int, tmp_path: Path) -> None:
    file = tmp_path / "robot.xacro"
    file.write_text(CONTROLLED)
    text = CONTROLLED.replace("${prefix}", "left_")
    text = text.replace('<xacro:if value="true">', "").replace("</xacro:if>", "")
    assert place(element, file, text).line == line


CALLED = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r">
  <xacro:macro name="wheel" params="prefix reflect:=1">
    <link name="${prefix}_wheel"/>
    <link name="hub"/>
  </xacro:macro>
  <xacro:wheel prefix="left"/>
  <xacro:wheel prefix="right" reflect="-1"/>
  <xacro:wheel prefix="$(arg third)"/>
</robot>
"""


@pytest.mark.parametrize(
    ("link", "words"),
    [
        ("left_wheel", "m"),  # the third call may give it, too
        ("hub", "m"),
    ],
)
def test_calls_that_may_be_meant_are_not_named(link: str, words: str, tmp_path: Path) -> None:
    file = tmp_path / "robot.xacro"
    file.write_text(CALLED)
    assert place(f"link[@name='{link}']", file).message == words


def test_the_call_of_a_macro_is_named(tmp_path: Path) -> None:
    file = tmp_path / "robot.xacro"
    file.write_text(CALLED.replace("$(arg third)", "third"))
    found = place("link[@name='right_wheel']/inertial", file)
    assert found.message == "m The macro `wheel` is called in line 7."
    assert found.line == 3
    main = tmp_path / "main.xacro"
    include = '<xacro:include filename="robot.xacro"/>'
    main.write_text(f"<robot>{include}\n<xacro:wheel prefix='front'/></robot>")
    found = place("link[@name='front_wheel']", main)
    assert found.message == "m The macro `wheel` is called in line 2 of main.xacro."
    assert (found.file, found.line) == (file, 3)
    assert without_call(found).message == "m"


ALIKE = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r">
  <xacro:macro name="laser" params="prefix">
    <link name="${prefix}_link"/>
  </xacro:macro>
  <xacro:macro name="camera" params="prefix">
    <link name="${prefix}_link"/>
  </xacro:macro>
  <xacro:macro name="box" params="name">
    <link name="${name}"/>
  </xacro:macro>
  <xacro:laser prefix="front"/>
  <xacro:camera prefix="top"/>
  <xacro:box name="crate"/>
  <gazebo>
    <mu1>0.1</mu1>
  </gazebo>
</robot>
"""


@pytest.mark.parametrize(
    ("element", "line"),
    [
        ("link[@name='front_link']", 3),
        ("link[@name='top_link']", 6),
        ("link[@name='side_link']", None),
        ("link[@name='crate']", 9),
        ("link[@name='barrel']", None),
        ("gazebo/mu1", 15),
        ("gazebo/mu2", None),
    ],
)
def test_of_names_alike_the_call_tells_which_is_meant(
    tmp_path: Path, element: str, line: int | None
) -> None:
    file = tmp_path / "robot.xacro"
    file.write_text(ALIKE)
    assert place(element, file).line == line


def test_an_element_of_a_macro_that_its_link_calls(tmp_path: Path) -> None:
    (tmp_path / "inertia.xacro").write_text(
        "<robot>\n<xacro:macro name='box' params='mass'>\n<inertial>\n<inertia ixx='x'/></inertial>"
        "\n</xacro:macro></robot>"
    )
    main = tmp_path / "main.xacro"
    main.write_text(
        "<robot><xacro:include filename='inertia.xacro'/>\n<link name='a'>\n"
        "<xacro:box mass='1'/></link>\n<link name='b'><visual/></link></robot>"
    )
    found = place("link[@name='a']/inertial/inertia/@ixx", main)
    assert (found.file, found.line) == (tmp_path / "inertia.xacro", 4)
    assert found.message == "m The macro `box` is called in line 3 of main.xacro."
    found = place("link[@name='b']/inertial/inertia/@ixx", main)
    assert (found.file, found.line) == (main, 4)
