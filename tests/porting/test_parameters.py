"""What becomes of files of parameters, to the letter."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.checks.fixes.source import SourceText, apply
from wsgen.model.target import Target
from wsgen.porting.launch_files import Context, port_launch_file
from wsgen.porting.launch_markup import port_markup
from wsgen.porting.parameters import Stamper, port_parameters

FILE = Path("/nowhere/p.yaml")


def ported(text: str, distro: str = "jazzy") -> tuple[str, list[str], tuple[Stamper, ...]]:
    """The text afterwards, which a second port leaves as it is, and what is listed."""
    target = Target(distro=distro, simulator="gz")
    source = SourceText(FILE, text)
    port, stampers = port_parameters(source, target)
    after = apply(text, port.edits)
    again, _ = port_parameters(SourceText(source.file, after), target)
    assert apply(after, again.edits) == after
    return after, [f"{one.line}: {one.what}" for one in port.unported], stampers


CONTROLLERS = """controller_manager:
  ros__parameters:
    update_rate: 30
    joints:
      type: {}
    cont:
      type: {}
cont:
  ros__parameters:
    publish_rate: 50.0
{}    left_wheel_names: ['left']
"""
BROADCASTER = "joint_state_broadcaster/JointStateBroadcaster"
DIFF = "diff_drive_controller/DiffDriveController"


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_commands_without_a_time(newline: str) -> None:
    """The controllers of later distributions take no others."""
    text = CONTROLLERS.format(BROADCASTER, DIFF, "    use_stamped_vel: false  # Twist\n")
    after = CONTROLLERS.format(BROADCASTER, DIFF, "    # Twist\n")
    stamper = Stamper(FILE, 11, "cont", "/cont/cmd_vel_unstamped", "/cont/cmd_vel")
    assert ported(text.replace("\n", newline)) == (after.replace("\n", newline), [], (stamper,))


def test_commands_of_a_controller_in_any_namespace() -> None:
    text = """/**:
  controller_manager:
    ros__parameters:
      cont:
        type: diff_drive_controller/DiffDriveController
  cont:
    ros__parameters:
      use_stamped_vel: false
"""
    stamper = Stamper(FILE, 8, "cont", "cont/cmd_vel_unstamped", "cont/cmd_vel")
    assert ported(text)[1:] == ([], (stamper,))


def test_commands_with_a_time_stay() -> None:
    text = CONTROLLERS.format(BROADCASTER, DIFF, "    use_stamped_vel: true\n")
    assert ported(text) == (text, [], ())


def test_a_controller_of_another_kind_is_listed() -> None:
    kind = "tricycle_controller/TricycleController"
    text = CONTROLLERS.format(BROADCASTER, kind, "    use_stamped_vel: false\n")
    after, listed, stampers = ported(text)
    assert (after, stampers) == (text, ())
    assert [line.partition(" takes")[0] for line in listed] == ["11: The controller `cont`"]


def test_types_of_controllers() -> None:
    text = CONTROLLERS.format(
        "joint_state_controller/JointStateController  # all",
        "position_controllers/JointTrajectoryController",
        "",
    )
    after, listed, _ = ported(text)
    assert after == text.replace("joint_state_controller/JointStateController", BROADCASTER)
    assert [line.partition(" have ")[0] for line in listed] == ["7: ROS 2 jazzy does not"]


def test_controllers_that_pass_commands_on() -> None:
    """Lyrical has one type for all interfaces."""
    kind = "velocity_controllers/JointGroupVelocityController"
    text = CONTROLLERS.format(BROADCASTER, kind, "    joints: [a]\n")
    assert ported(text, "kilted") == (text, [], ())
    after = text.replace(kind, "forward_command_controller/ForwardCommandController").replace(
        "    publish_rate", "    interface_name: velocity\n    publish_rate"
    )
    assert ported(text, "lyrical") == (after, [], ())


def test_grippers_are_listed() -> None:
    text = CONTROLLERS.format(BROADCASTER, "position_controllers/GripperActionController", "")
    assert ported(text) == (text, [], ())
    assert len(ported(text, "kilted")[1]) == 1


NAV2 = """planner_server:
  ros__parameters:
    GridBased:
      plugin: "nav2_navfn_planner/NavfnPlanner"  # not nav2_smac_planner/SmacPlanner2D
controller_server:
  ros__parameters:
    use_sim_time: true
    progress_checker_plugin: "progress_checker"
    FollowPath:
      plugin: "dwb_core::DWBLocalPlanner"
"""


def test_plugins_of_nav2() -> None:
    after = NAV2.replace("planner/N", "planner::N").replace(
        '_plugin: "progress_checker"', '_plugins: ["progress_checker"]'
    )
    assert ported(NAV2) == (after, [], ())


def test_commands_of_nav2_have_no_time_in_kilted() -> None:
    before = NAV2.replace('    progress_checker_plugin: "progress_checker"\n', "")
    line = "    use_sim_time: true\n"
    after = before.replace("planner/N", "planner::N").replace(
        line, f"    enable_stamped_cmd_vel: false\n{line}"
    )
    assert ported(before, "kilted") == (after, [], ())


def test_twist_mux_mixes_commands_without_a_time() -> None:
    text = "twist_mux:\n  ros__parameters:\n    topics:\n      nav: {topic: cmd_vel}\n"
    line = "    topics:\n"
    assert ported(text)[0] == text.replace(line, f"    use_stamped: false\n{line}")


LIBRARIES = """bt_navigator:
  ros__parameters:
    plugin_lib_names:
{}
    odom_topic: /odom
"""


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (
            "    - nav2_spin_action_bt_node  # turn\n    # my own\n    - own_bt_node",
            "    # turn\n    # my own\n    - own_bt_node",
        ),
        ("      - nav2_spin_action_bt_node\n      - nav2_wait_action_bt_node", None),
    ],
)
def test_libraries_that_nav2_loads_by_itself(before: str, after: str | None) -> None:
    text = LIBRARIES.format(before)
    kept = "" if after is None else f"    plugin_lib_names:\n{after}\n"
    assert ported(text)[0] == (f"bt_navigator:\n  ros__parameters:\n{kept}    odom_topic: /odom\n")


def test_libraries_on_one_line() -> None:
    names = "nav2_spin_action_bt_node, nav2_wait_action_bt_node"
    text = LIBRARIES.replace(":\n{}", f": [{names}]")
    assert ported(text)[0] == "bt_navigator:\n  ros__parameters:\n    odom_topic: /odom\n"
    own = text.replace(names, f"{names}, own")
    after, listed, _ = ported(own)
    assert after == own
    assert len(listed) == 1


def test_renamed_parameters() -> None:
    text = "jtc:\n  ros__parameters:\n    open_loop_control: true\n"
    assert ported(text)[0] == text
    assert ported(text, "kilted")[0] == text.replace(
        "open_loop_control", "interpolate_from_desired_state"
    )


LAUNCH = """from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    spawner = Node(package='controller_manager', executable='spawner{}', arguments=['cont'])
    return LaunchDescription([
        Node(package='gazebo_ros', executable='spawn_entity.py', arguments=['-entity', 'r']),
        spawner,
    ])
"""
STAMPED = """        spawner,
        Node(
            package='twist_stamper',
            executable='twist_stamper',
            parameters=[
                {'use_sim_time': True},
            ],
            remappings=[
                ('/cmd_vel_in', '/cmd_vel'),
                ('/cmd_vel_out', '/cont/cmd_vel'),
            ],
            output='screen',
        ),
"""


def test_a_launch_file_gives_commands_their_time() -> None:
    stamper = Stamper(FILE, 10, "cont", "/cmd_vel", "/cont/cmd_vel")
    context = Context(rows={}, package="p", distro="jazzy", stampers=[stamper])
    text = LAUNCH.format(".py")
    port = port_launch_file(SourceText(Path("/nowhere/a.launch.py"), text), context)
    assert port.packages == {"ros_gz_sim", "twist_stamper"}
    after = LAUNCH.format("").replace("        spawner,\n", STAMPED)
    after = after.replace("gazebo_ros", "ros_gz_sim").replace("spawn_entity.py", "create")
    assert apply(text, port.edits) == after.replace("-entity", "-name")


def test_a_launch_file_in_xml_gives_commands_their_time() -> None:
    stamper = Stamper(FILE, 11, "cont", "/cont/cmd_vel_unstamped", "/cont/cmd_vel")
    context = Context(rows={}, package="p", distro="jazzy", stampers=[stamper])
    text = (
        "<launch>\n"
        '  <node pkg="controller_manager" exec="spawner.py" args="joints cont -c /c"/>\n'
        "</launch>\n"
    )
    port = port_markup(SourceText(Path("/nowhere/a.launch.xml"), text), context)
    assert apply(text, port.edits) == (
        "<launch>\n"
        '  <node pkg="controller_manager" exec="spawner" args="joints cont -c /c"/>\n'
        '  <node pkg="twist_stamper" exec="twist_stamper" output="screen">\n'
        '    <remap from="/cmd_vel_in" to="/cont/cmd_vel_unstamped"/>\n'
        '    <remap from="/cmd_vel_out" to="/cont/cmd_vel"/>\n'
        "  </node>\n</launch>\n"
    )
