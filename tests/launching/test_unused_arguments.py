"""Arguments that have no effect: of launch files, of includes, of xacro."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from install_space import only_message

if TYPE_CHECKING:
    from install_space import InstallSpace

pytestmark = pytest.mark.slow

ROBOT = """\
<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r">
  <xacro:arg name="size" default="1"/>
  <link name="l$(arg size)"/>
  <xacro:if value="0"><xacro:arg name="seldom" default="1"/></xacro:if>
</robot>
"""
GAZEBO = "IncludeLaunchDescription([FindPackageShare('gazebo_ros'), '/launch/gazebo.launch.py'])"
INNER = """\
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, LogInfo
from launch.substitutions import LaunchConfiguration
def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("speed", default_value="1"),
        LogInfo(msg=LaunchConfiguration("color", default="red")),
    ])
"""


@pytest.mark.parametrize(
    ("entities", "meant"),
    [
        ("DeclareLaunchArgument('height', default_value='1')", "Did you mean `height`?"),
        ("DeclareLaunchArgument('zzz', default_value='1')", "or declare it"),
        ("", "declare it: DeclareLaunchArgument('heigth'"),
        (
            GAZEBO,
            "DeclareLaunchArgument('heigth'",
        ),
    ],
)
def test_argument_of_the_command_line_that_nobody_uses(
    space: InstallSpace, entities: str, meant: str
) -> None:
    plan = space.play(entities, arguments={"heigth": "2"})
    message = only_message(plan, "LCH033")
    assert "`heigth` has no effect" in message
    assert meant in message
    assert plan.diagnostics[0].severity.value == "warning"


@pytest.mark.parametrize(
    "entities",
    [
        "DeclareLaunchArgument('a', default_value='1')",
        "LogInfo(msg=LaunchConfiguration('a', default=''))",
        "LogInfo(msg=LaunchConfiguration(['', TextSubstitution(text='a')], default=''))",
        "LogInfo(msg='x', condition=LaunchConfigurationEquals('a', 'x'))",
        "OpaqueFunction(function=lambda context: print(context.launch_configurations['a']))",
        "OpaqueFunction(function=lambda context: print(context.launch_configurations.get('a')))",
        "OpaqueFunction(function=lambda context: print('a' in context.launch_configurations))",
        "OpaqueFunction(function=lambda context: print(dict(context.launch_configurations)))",
        "OpaqueFunction(function=lambda context: print(context.launch_configurations.items()))",
        # What is not run may read it.
        "OpaqueFunction(function=lambda context: None, condition=IfCondition('false'))",
        "GroupAction([LogInfo(msg=LaunchConfiguration('a'))], condition=IfCondition('false'))",
        "IncludeLaunchDescription([EnvironmentVariable('NO')], condition=IfCondition('false'))",
        "IncludeLaunchDescription([FindPackageShare('nav2_bringup'), '/launch/x.launch.py'])",
    ],
)
def test_argument_that_somebody_uses_or_may_use(space: InstallSpace, entities: str) -> None:
    plan = space.play(entities, arguments={"a": "x"})
    assert not {"LCH033", "LCH034"} & {one.code for one in plan.diagnostics}


@pytest.mark.parametrize("before", ["import sys; sys.argv", "import moveit_configs_utils"])
def test_argument_that_foreign_code_may_use(space: InstallSpace, before: str) -> None:
    assert not space.play("", before=before, arguments={"a": "x"}).diagnostics


def test_argument_that_an_included_file_declares_or_reads(space: InstallSpace) -> None:
    space.add("my_robot", {"launch/inner.launch.py": INNER})
    include = "IncludeLaunchDescription([FindPackageShare('my_robot'), '/launch/inner.launch.py'])"
    assert not space.play(include, arguments={"speed": "2", "color": "blue"}).diagnostics
    assert "`speed`" in only_message(space.play(include, arguments={"sped": "2"}), "LCH033")


def test_argument_of_an_include(space: InstallSpace) -> None:
    space.add("my_robot", {"launch/inner.launch.py": INNER})
    include = (
        "IncludeLaunchDescription([FindPackageShare('my_robot'), '/launch/inner.launch.py'], "
        "launch_arguments={%s}.items())"
    )
    assert not space.play(include % "'speed': '2', 'color': 'blue'").diagnostics
    plan = space.play(include % "'spede': '2'")
    assert "Did you mean `speed`?" in only_message(plan, "LCH034")
    assert plan.diagnostics[0].line is not None
    # It leaks into the includer, which may read it.
    later = ", LogInfo(msg=LaunchConfiguration('spede'))"
    assert not space.play(include % "'spede': '2'" + later).diagnostics


@pytest.mark.parametrize(
    ("name", "codes"), [("wrld", ["LCH034"]), ("quite_another", []), ("world", [])]
)
def test_argument_of_an_include_that_is_not_here(
    space: InstallSpace, name: str, codes: list[str]
) -> None:
    plan = space.play(
        "IncludeLaunchDescription([FindPackageShare('gazebo_ros'), '/launch/gazebo.launch.py'], "
        f"launch_arguments={{'{name}': 'x.world'}}.items())"
    )
    assert [found.code for found in plan.diagnostics] == codes


def test_what_fails_is_not_said_to_lack_the_argument(space: InstallSpace) -> None:
    plan = space.play("", before="1 / 0", arguments={"a": "x"})
    only_message(plan, "LCH004")


@pytest.mark.parametrize("how", ["process_file", "Command"])
@pytest.mark.parametrize(
    ("argument", "meant"), [("sise", "Did you mean `size`?"), ("nope", "It has `size`.")]
)
def test_argument_of_xacro(space: InstallSpace, how: str, argument: str, meant: str) -> None:
    share = space.add("my_robot", {"r.xacro": ROBOT})
    call = (
        f"xacro.process_file('{share}/r.xacro', mappings={{'{argument}': '1', 'size': '2', "
        "'seldom': '3'}).toxml()"
        if how == "process_file"
        else f"ParameterValue(Command(['xacro {share}/r.xacro {argument}:=1 size:=2 seldom:=3']), "
        "value_type=str)"
    )
    plan = space.play(
        "Node(package='robot_state_publisher', executable='robot_state_publisher', "
        f"parameters=[{{'robot_description': {call}}}])",
        before="import xacro",
    )
    message = only_message(plan, "LCH035")
    assert f"`{argument}`" in message
    assert meant in message
    assert plan.diagnostics[0].line is not None
    assert str(plan.diagnostics[0].file).endswith(".launch.py")
    assert "l2" in plan.processes[0].parameters["robot_description"]
