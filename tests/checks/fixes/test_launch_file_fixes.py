"""Fixes in launch files, and in what controls a robot, from what rules say."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from checks.fixes.crafted import fixed

if TYPE_CHECKING:
    from pathlib import Path

IMPORT = "from launch_ros.parameter_descriptions import ParameterValue\n"


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (
            (
                '"""A."""\nfrom launch_ros.actions import Node\nimport os\n\n'
                "x = {'robot_description': text}\n"
            ),
            (
                f'"""A."""\nfrom launch_ros.actions import Node\n{IMPORT}import os\n\n'
                "x = {'robot_description': ParameterValue(text, value_type=str)}\n"
            ),
        ),
        (
            "import os\r\nx = {'robot_description': Command(['ä', f])}\r\n",
            (
                f"import os\r\n{IMPORT[:-1]}\r\n"
                "x = {'robot_description': ParameterValue(Command(['ä', f]), value_type=str)}\r\n"
            ),
        ),
        (
            "ä = {'é': 1, 'robot_description': Command(['ä', f])}\n",
            (
                f"{IMPORT}ä = {{'é': 1, 'robot_description': "
                "ParameterValue(Command(['ä', f]), value_type=str)}\n"
            ),
        ),
        ("x = {'robot_description': ParameterValue(text)}\n", None),
        ("x = {'robot_description': a}\ny = {'robot_description': b}\n", None),
        ("x = {'robot_description': (a, b)}\n", None),
        ("x = {'robot_description': '<robot/>'}\n", None),
        ("x = {'robot_description': a\n", None),
    ],
)
def test_a_description_as_text(tmp_path: Path, before: str, after: str | None) -> None:
    file = tmp_path / "a.launch.py"
    file.write_bytes(before.encode())
    assert fixed(file, "description-not-yaml", 1) == after


def test_a_description_in_xml(tmp_path: Path) -> None:
    file = tmp_path / "a.launch.xml"
    node = '<node pkg="p" exec="e">\n  <param name="robot_description"{} value="$(command x)"/>\n'
    file.write_text(f"<launch>{node.format('')}</node></launch>\n")
    typed = node.format(' type="str"')
    text = f"<launch>{typed}</node></launch>\n"
    assert fixed(file, "description-as-yaml", 1) == text
    assert fixed(file, "description-as-yaml", 1) is None


NODE = "Node(\n    package='a', executable='b',{}\n)\n"


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("", None),
        (" parameters=[{'a': 1}],", " parameters=[{'a': 1, 'use_sim_time': True}],"),
        (" parameters=[{'a': 1,}]", " parameters=[{'a': 1, 'use_sim_time': True,}]"),
        (
            " parameters=[{\n        'a': 1,\n    }]",
            " parameters=[{\n        'a': 1,\n        'use_sim_time': True,\n    }]",
        ),
        (" name='ros_gz_bridge'", ""),
        (" parameters=[f]", " parameters=[f, {'use_sim_time': True}]"),
        (" parameters=[]", " parameters=[{'use_sim_time': True}]"),
        (" parameters=[{**a}]", " parameters=[{**a}, {'use_sim_time': True}]"),
        (" parameters=[{'use_sim_time': use}]", ""),
        (" parameters=given", ""),
    ],
)
def test_the_time_of_the_simulator(tmp_path: Path, before: str, after: str | None) -> None:
    file = tmp_path / "a.launch.py"
    file.write_text(NODE.format(before))
    if after is None:
        text = NODE.replace("'b',{}", "'b', parameters=[{'use_sim_time': True}],")
        assert fixed(file, "wall-clock-beside-simulator", 2) == text
    else:
        wanted = NODE.format(after) if after else None
        assert fixed(file, "wall-clock-beside-simulator", 2) == wanted


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("Command(['xacro', f])", "Command(['xacro ', f])"),
        ("Command(['xacro ', f])", None),
        ("Command(['xacro', ' ', f])", None),
        (
            "Command([FindExecutable(name='xacro'), f])",
            "Command([FindExecutable(name='xacro'), ' ', f])",
        ),
        ("Command('xacro')", None),
    ],
)
def test_a_blank_behind_xacro(tmp_path: Path, before: str, after: str | None) -> None:
    file = tmp_path / "a.launch.py"
    file.write_text(before)
    assert fixed(file, "glued-command", 1) == after


@pytest.mark.slow
def test_the_plugin_that_spawns(tmp_path: Path) -> None:
    file = tmp_path / "a.launch.py"
    file.write_text(
        "ExecuteProcess(\n  cmd=['gazebo', '-s', 'libgazebo_ros_init.so', world,],\n)\n"
    )
    hint = "Add '-s', 'libgazebo_ros_init.so', '-s', 'libgazebo_ros_factory.so' to the command."
    assert fixed(file, "no-factory-plugin", 1, "", hint) == (
        "ExecuteProcess(\n  cmd=['gazebo', '-s', 'libgazebo_ros_init.so', world, "
        "'-s', 'libgazebo_ros_factory.so',],\n)\n"
    )
    assert fixed(file, "no-factory-plugin", 1, "", hint) is None


def test_the_direction_of_a_bridge(tmp_path: Path) -> None:
    file = tmp_path / "a.launch.py"
    file.write_text("a = ['/clock@rosgraph_msgs/msg/Clock]gz.msgs.Clock']\n")
    hint = "Write `[` between the types, in YAML `direction: GZ_TO_ROS`."
    assert fixed(file, "wrong-bridge-direction", 1, "", hint, "/clock") == (
        "a = ['/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock']\n"
    )
    assert fixed(file, "wrong-bridge-direction", 1, "", hint, "/clock") is None


@pytest.mark.parametrize(
    ("name", "before", "element", "meant", "after"),
    [
        ("unknown-controller", "a = ['diff_controler']", "diff_controler", "diff_controller", True),
        ("unknown-controller", "a = ['arm']", "arm", "diff_controller", False),
        ("unknown-controller", "a = ['ar', 'ar']", "ar", "arm", False),
        ("unused-include-argument", "a = {'wrold': b}.items()", "wrold", "world", True),
        ("executable-not-found", "Node(executable='creat')", "creat", "create", True),
        ("executable-not-found", "Node(name='creat')", "creat", "create", False),
        ("unused-xacro-argument", "Command(['xacro ', f, ' lenght:=1'])", "lenght", "length", True),
        ("other-world-name", "a = ['-world', 'office']", "office", "default", True),
        ("other-world-name", "a = ['-name', 'office']", "office", "default", False),
    ],
)
def test_a_word(  # noqa: PLR0917
    tmp_path: Path, name: str, before: str, element: str, meant: str, after: bool
) -> None:
    file = tmp_path / "a.launch.py"
    file.write_text(f"# {element}\n{before}\n")
    wanted = f"# {element}\n{before.replace(element, meant)}\n" if after else None
    assert fixed(file, name, 2, "", f"Did you mean `{meant}`?", element) == wanted


def test_markup_of_ros_1(tmp_path: Path) -> None:
    file = tmp_path / "a.launch.xml"
    node = '<launch>\n  <node pkg="rviz2" {}="rviz2" args="-d $({} r)/a $({} r)/b"/>\n</launch>\n'
    file.write_text(node.format("type", "find", "find"))
    fixed(file, "ros-1-launch-file", 2, "", 'Write exec="PROGRAM"; ROS 1 called it `type`.', "exec")
    hint = "Write $(find-pkg-share PACKAGE)."
    assert fixed(file, "ros-1-launch-file", 2, "", hint, "find") == (
        node.format("exec", "find-pkg-share", "find-pkg-share")
    )


CONTROL = """<robot>
  <ros2_control name="arm" type="system">
    <hardware><plugin>{}</plugin></hardware>
    <joint name="{}">
      <command_interface name="{}"/>
    </joint>
  </ros2_control>
</robot>
"""


def test_ros2_control(tmp_path: Path) -> None:
    file = tmp_path / "a.urdf"
    file.write_text(CONTROL.format("gz_ros2_control/GazeboSystem", "arm_jiont", "positon"))
    message = "<ros2_control> names the joint `arm_jiont`, which the robot does not have."
    place = "ros2_control[@name='arm']"
    fixed(file, "unknown-controlled-joint", 4, message, "Did you mean `arm_joint`?", place)
    message = "The joint `arm_joint` has the command interface `positon`, which looks misspelled."
    hint = 'Write <command_interface name="position"/>.'
    fixed(file, "unknown-interface", 4, message, hint, f"{place}/joint[@name='arm_joint']")
    hint = "Write <plugin>gz_ros2_control/GazeboSimSystem</plugin>."
    assert fixed(file, "unknown-hardware", 2, "", hint, place) == CONTROL.format(
        "gz_ros2_control/GazeboSimSystem", "arm_joint", "position"
    )


def test_the_rate_of_a_world(tmp_path: Path) -> None:
    file = tmp_path / "a.world"
    text = (
        "<sdf>\n<physics>\n  <real_time_update_rate> {} </real_time_update_rate>\n</physics></sdf>"
    )
    file.write_text(text.format("100"))
    hint = "Write <real_time_update_rate>1000</real_time_update_rate>."
    assert fixed(file, "not-in-real-time", 2, "", hint, "physics") == text.format("1000")
