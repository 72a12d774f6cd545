"""Launch files in Python, from Gazebo Classic to Gazebo Sim: text in, text out."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from textwrap import dedent
from typing import TYPE_CHECKING

import pytest

from wsgen.checks.fixes.source import SourceText, apply
from wsgen.porting.launch_files import Context, WorldTaker, port_launch_file
from wsgen.porting.ported import BridgeRow, FilePort

if TYPE_CHECKING:
    from collections.abc import Sequence

SCAN = BridgeRow("/scan", "LaserScan", "sensor_msgs/msg/LaserScan", "[", "/scan")
STATES = BridgeRow("/world/w/joint_state", "Model", "sensor_msgs/msg/JointState", "[", "/joints")


def ported(
    text: str,
    *,
    world: str | None = None,
    rows: dict[int, list[BridgeRow]] | None = None,
    workspace: Sequence[str] = (),
) -> tuple[str, FilePort]:
    """The text of a launch file after its port; it must be Python, and another port no change."""
    source = SourceText(Path("robot.launch.py"), dedent(text))
    context = Context(rows or {}, "my_robot", "jazzy", default_world=world, workspace=workspace)
    port = port_launch_file(source, context)
    after = apply(source.text, port.edits)
    ast.parse(after)
    again = port_launch_file(SourceText(source.file, after), context)
    assert not again.edits
    return after, port


def arguments_of(body: str, *, world: str | None = None) -> str:
    """What `gz_args` is after the port of an include with this in it."""
    text = (
        "IncludeLaunchDescription(PythonLaunchDescriptionSource("
        f"[FindPackageShare('gazebo_ros'), '/launch/gazebo.launch.py']){body})"
    )
    after, _ = ported(text, world=world)
    assert "FindPackageShare('ros_gz_sim'), '/launch/gz_sim.launch.py'" in after
    return after.partition("launch_arguments={'gz_args': ")[2].rpartition("}.items()")[0]


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ("", "['-r ', 'empty.sdf']"),
        (", launch_arguments={'world': path}.items()", "['-r ', path]"),
        (", launch_arguments={'world': path, 'pause': 'true'}.items()", "[path]"),
        (
            ", launch_arguments={'verbose': 'true', 'gui': 'false', 'world': path}.items()",
            "['-r -s -v 4 ', path]",
        ),
        (
            ", launch_arguments={'world': path, 'gui': LaunchConfiguration('gui')}.items()",
            "['-r ', IfElseSubstitution(LaunchConfiguration('gui'), '', '-s '), path]",
        ),
        (", launch_arguments={'world': [share, '/a.world']}.items()", "['-r ', share, '/a.world']"),
    ],
)
def test_launch_arguments_become_gz_args(given: str, expected: str) -> None:
    assert arguments_of(given) == expected


def test_the_default_world_is_a_file_of_the_package_where_the_robot_needs_systems() -> None:
    after, port = ported(
        """\
        from launch_ros.substitutions import FindPackageShare

        gazebo = IncludeLaunchDescription(
            PythonLaunchDescriptionSource(
                [FindPackageShare('gazebo_ros'), '/launch/gazebo.launch.py']
            ),
        )
        """,
        world="worlds/empty.sdf",
    )
    assert "PathJoinSubstitution([FindPackageShare('my_robot'), 'worlds', 'empty.sdf'])" in after
    assert "from launch.substitutions import PathJoinSubstitution" in after
    assert after.count("import FindPackageShare") == 1
    assert port.files == {"worlds/empty.sdf"}


def test_a_declared_world_is_seen_by_the_included_launch_file() -> None:
    after, _ = ported(
        """\
        share = get_package_share_directory('gazebo_ros')
        declare = DeclareLaunchArgument('world', default_value='empty.world')
        gazebo = IncludeLaunchDescription(
            PythonLaunchDescriptionSource(
                os.path.join(share, 'launch', 'gazebo.launch.py')
            )
        )
        ld.add_action(declare)
        """
    )
    assert "DeclareLaunchArgument('world', default_value='empty.sdf')" in after
    assert "launch_arguments={'gz_args': ['-r ', LaunchConfiguration('world')]}.items()" in after


def test_server_and_client_stay_two() -> None:
    after, _ = ported(
        """\
        share = get_package_share_directory("gazebo_ros")
        server = IncludeLaunchDescription(
            PythonLaunchDescriptionSource(os.path.join(share, "launch", "gzserver.launch.py")),
            launch_arguments={"world": world}.items(),
        )
        client = IncludeLaunchDescription(
            PythonLaunchDescriptionSource(os.path.join(share, "launch", "gzclient.launch.py")),
            condition=IfCondition(gui),  # not in CI
        )
        """
    )
    assert 'launch_arguments={"gz_args": ["-s -r ", world]}.items(),\n' in after
    assert 'condition=IfCondition(gui),\n    launch_arguments={"gz_args": "-g"}' in after
    assert "# not in CI" in after


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (
            "'gzserver', '-s', 'libgazebo_ros_init.so', '-s', 'libgazebo_ros_factory.so', world",
            None,
        ),
        (
            "'gzserver', world, '-s', 'libgazebo_ros_init.so', '-s', 'libgazebo_ros_factory.so'",
            None,
        ),
        ("'gzserver', world, '--ros-args', '--params-file', path", None),
        ("'gzserver', world, 'extra-gazebo-args', '--ros-args', '--params-file', path", None),
        ("'gzserver', '', '--ros-args'", "'gz', 'sim', '-s', '-r', 'empty.sdf'"),
    ],
)
def test_what_gz_does_not_read_goes_from_a_command(words: str, expected: str | None) -> None:
    after, _ = ported(f"ld.add_action(ExecuteProcess(cmd=[{words}]))\n")
    expected = expected or "'gz', 'sim', '-s', '-r', world"
    assert re.search(rf"cmd=\[{expected},? *\]", after)


@pytest.mark.parametrize(
    ("file", "words", "expected", "listed"),
    [
        ("gazebo", ", 'world:={}'.format(w)", ", 'gz_args:=-r {}'.format(w)", 0),
        ("gazebo", ", ['world:=', w], 'gui:=false'", ", ['gz_args:=-r -s ', w]", 0),
        ("gzserver", ", f'world:={w}', 'pause:=true'", ", f'gz_args:=-s {w}'", 0),
        ("gazebo", ", 'world:='", ", ['gz_args:=-r ', 'empty.sdf']", 0),
        ("gazebo", "", ", ['gz_args:=-r ', 'empty.sdf']", 0),
        ("gzclient", ", 'verbose:=true'", ", 'gz_args:=-g -v 4 '", 0),
        ("gazebo", ", 'world:=a.world', 'profile:=x'", ", 'gz_args:=-r a.world'", 1),
        ("gazebo", ", ['gui:=', g], ['world:=', w]", ", ['gz_args:=-r ', w]", 1),
    ],
)
def test_a_launch_file_of_classic_that_a_command_launches(
    file: str, words: str, expected: str, listed: int
) -> None:
    after, port = ported(
        f"ld.add_action(ExecuteProcess(cmd=['ros2', 'launch', 'gazebo_ros', '{file}.launch.py'"
        f"{words}]))\n"
    )
    assert f"cmd=['ros2', 'launch', 'ros_gz_sim', 'gz_sim.launch.py'{expected}]" in after
    assert ("/clock@" in after) == (file != "gzclient")
    assert len(port.unported) == listed


def test_paths_that_no_action_uses_any_more() -> None:
    after, port = ported(
        """\
        share = os.popen("ros2 pkg prefix gazebo_ros").read().strip()
        file = os.path.join(share, "share", "gazebo_ros", "launch", "gazebo.launch.py")
        own = PathJoinSubstitution([share_of_own, "launch", "gazebo.launch.py"])
        demos = get_package_share_directory('gazebo_ros2_control_demos')
        # IncludeLaunchDescription(PythonLaunchDescriptionSource(file))
        SetEnvironmentVariable('GAZEBO_MASTER_URI', 'x')
        """
    )
    assert '"ros2 pkg prefix ros_gz_sim"' in after
    assert '"share", "ros_gz_sim", "launch", "gz_sim.launch.py"' in after
    assert '[share_of_own, "launch", "gazebo.launch.py"]' in after
    assert "'gz_ros2_control_demos'" in after
    assert [one.is_note for one in port.unported] == [True]


def test_a_package_of_the_workspace_keeps_its_name() -> None:
    text = "get_package_share_directory('gazebo_ros2_control_demos')\n"
    assert ported(text)[0] != text
    assert ported(text, workspace=["gazebo_ros2_control_demos"])[0] == text


def test_the_world_that_a_launch_argument_names_by_default() -> None:
    text = """\
        DeclareLaunchArgument('map', default_value='')
        DeclareLaunchArgument('arena', default_value='')
        path = LaunchConfiguration('arena')
        ld.add_action(ExecuteProcess(cmd=['gzserver', path]))
        """
    after, port = ported(text, world="worlds/empty.sdf")
    assert after.count("default_value=''") == 1
    assert after.count("default_value=PathJoinSubstitution([FindPackageShare('my_robot'), ") == 1
    assert port.worlds == {"arena"}


@pytest.mark.parametrize(
    ("given", "worlds"),
    [
        (", launch_arguments={'arena': LaunchConfiguration('world')}.items()", {"world"}),
        (", launch_arguments=[('arena', '')]", set()),
        ("", {"arena"}),
    ],
)
def test_the_world_that_is_passed_to_what_starts_gazebo(given: str, worlds: set[str]) -> None:
    declared = "" if worlds else "1"
    text = dedent(f"""\
        DeclareLaunchArgument('{min(worlds, default="x")}', default_value={declared!r})
        IncludeLaunchDescription(join(share, 'launch', 'simulation.launch.py'){given})
        IncludeLaunchDescription(join(share, 'rviz.launch.py'), launch_arguments=[('a', '')])
        """)
    taker = WorldTaker(
        "simulation.launch.py", "its_world", "worlds/empty.sdf", frozenset({"arena"})
    )
    context = Context({}, "my_robot", "jazzy", takers=[taker])
    port = port_launch_file(SourceText(Path("top.launch.py"), text), context)
    after = apply(text, port.edits)
    share = "PathJoinSubstitution([FindPackageShare('its_world'), 'worlds', 'empty.sdf'])"
    assert after.count(share) == 1
    assert after.count("''") == 1
    assert port.worlds == worlds
    assert not port.files  # the other package has it


def test_an_argument_that_is_declared_in_vain_has_a_default() -> None:
    """Another launch file may still give it, as Classic's own launch file would see it."""
    after, _ = ported("""\
        declare_world = DeclareLaunchArgument('world', default_value=path)
        declare_gui = DeclareLaunchArgument('gui', default_value='false')
        ld.add_action(declare_gui)
        # ld.add_action(declare_world)
        ld.add_action(IncludeLaunchDescription(
            [FindPackageShare('gazebo_ros'), '/launch/gazebo.launch.py']))
        """)
    assert "LaunchConfiguration('world', default='empty.sdf')" in after
    assert "IfElseSubstitution(LaunchConfiguration('gui'), " in after


def test_a_spawner_that_nothing_starts_needs_no_bridge() -> None:
    after, port = ported(
        "spawn = Node(package='gazebo_ros', executable='spawn_entity.py', arguments=[])\n"
        "ld = LaunchDescription([])\n",
        rows={1: [SCAN]},
    )
    assert "executable='create'" in after
    assert "bridge" not in after
    assert not port.unported


def test_lines_of_a_shell() -> None:
    after, port = ported("""\
        ExecuteProcess(cmd=['ros2 run controller_manager spawner.py arm'], shell=True)
        ExecuteProcess(cmd=['gzserver --verbose a.world'], shell=True)
        ExecuteProcess(cmd=['ros2 run gazebo_ros spawn_entity.py -topic a -entity b'], shell=True)
        ExecuteProcess(cmd=['echo no gzserver'], shell=True)
        """)
    assert "'ros2 run controller_manager spawner arm'" in after
    assert [one.line for one in port.unported] == [2, 3]


def test_programs_of_fortress_are_renamed() -> None:
    after, _ = ported("""\
        Node(package='ros_ign_bridge', executable='parameter_bridge')
        Node(package='ros_ign_gazebo', executable='create')
        IncludeLaunchDescription(
            join(get_package_share_directory('ros_ign_gazebo'), 'launch', 'ign_gazebo.launch.py'),
            launch_arguments={'ign_args': world}.items())
        """)
    assert "ign" not in after.replace("ignore", "")
    assert "'ros_gz_sim'), 'launch', 'gz_sim.launch.py'" in after
    assert "{'gz_args': world}" in after


def test_a_command_becomes_one_of_gz() -> None:
    after, port = ported(
        """\
        gazebo = ExecuteProcess(
            cmd=['gazebo', '--verbose', '-s', 'libgazebo_ros_init.so', world,
                 '-s', 'libgazebo_ros_factory.so'],  # factory last
            output='screen',
        )
        ld.add_action(gazebo)
        """
    )
    assert "cmd=['gz', 'sim', '-r', '-v', '4', world]" in after
    assert "# factory last" in after
    assert not port.unported


SPAWNED = """\
def generate_launch_description():
    spawn = Node(
        package="gazebo_ros", executable="spawn_entity.py",
        arguments=["-topic", "robot_description", "-entity", "rover",
                   "-timeout", "60",
                   "-z", "0.1"],  # above the ground
    )
    {body}
"""


def test_a_spawner_keeps_its_options() -> None:
    after, port = ported(SPAWNED.format(body="return LaunchDescription([spawn])"))
    assert 'package="ros_gz_sim", executable="create",' in after
    assert '"-name", "rover",\n                   "-z", "0.1"],  # above the ground' in after
    assert "timeout" not in after
    assert not port.unported


def test_an_option_without_counterpart_is_listed() -> None:
    text = SPAWNED.replace("-timeout", "-robot_namespace").replace('"60"', "name")
    after, port = ported(text.format(body="return LaunchDescription([spawn])"))
    assert "robot_namespace" not in after
    assert [one.line for one in port.unported] == [5]
    assert "`-robot_namespace` of spawn_entity.py is gone" in port.unported[0].what


OWN = [
    BridgeRow("/model/{model}/scan", "LaserScan", SCAN.ros_type, "[", "/{namespace}/scan"),
    BridgeRow("/model/{model}/tf", "Pose_V", "tf2_msgs/msg/TFMessage", "[", "/tf"),
]
IN_LOOP = """\
def generate_launch_description():
    robots = []
    for name, where in PLACES:
        spawn = Node(
            package='gazebo_ros', executable='spawn_entity.py',
            arguments=['-file', model, '-entity', name, '-robot_namespace', [name, '_space']])
        robots.append(spawn)
    return LaunchDescription(robots)
"""
IN_COMPREHENSION = """\
def generate_launch_description():
    robots = [
        Node(
            package='gazebo_ros', executable='spawn_entity.py',
            arguments=['-file', model, '-entity', name, '-robot_namespace', [name, '_space']])
        for name in NAMES]
    return LaunchDescription(robots)
"""
IN_FUNCTION = """\
def spawner(name):
    return Node(
        package='gazebo_ros', executable='spawn_entity.py',
        arguments=['-file', model, '-entity', name, '-robot_namespace', [name, '_space']])
"""


IN_PLACES_OF_A_LIST = """\
def generate_launch_description():
    ld = LaunchDescription()
    robots = []
    for name in NAMES:
        robots.append(Node(
            package='gazebo_ros', executable='spawn_entity.py',
            arguments=['-file', model, '-entity', name, '-robot_namespace', [name, '_space']]))
    for i in range(len(NAMES)):
        ld.add_action(robots[i])
    return ld
"""


@pytest.mark.parametrize(
    ("text", "line"),
    [(IN_LOOP, 4), (IN_COMPREHENSION, 3), (IN_FUNCTION, 2), (IN_PLACES_OF_A_LIST, 5)],
)
def test_each_of_several_robots_has_its_bridge(text: str, line: int) -> None:
    after, port = ported(text, rows={line: OWN})
    assert not port.unported
    assert f"['/model/', name, '/scan@{SCAN.ros_type}[gz.msgs.LaserScan']," in after
    assert "(['/model/', name, '/scan'], [*[name, '_space'], '/scan'])," in after
    assert "(['/model/', name, '/tf'], '/tf')," in after
    assert after.count("namespace='/',") == 1
    forms = ("GroupAction([Node(", "robots.append(Node(\n            package='ros_gz_bridge'")
    assert sum(form in after for form in (*forms, "        ld.add_action(Node(")) == 1
    assert ("from launch.actions import GroupAction" in after) == ("GroupAction([" in after)


def test_a_namespace_may_be_a_list_of_substitutions() -> None:
    once = "    space = ['/', name]\n"
    text = IN_FUNCTION.replace("[name, '_space']", "space").replace(
        "    return", f"{once}    return"
    )
    for written in (text, text.replace(once, once + once)):
        line = 3 + (written != text)
        after, _ = ported(written, rows={line: OWN})
        assert "(['/model/', name, '/scan'], [*space, '/scan'])," in after


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (IN_LOOP.replace("(robots)", "([robots[0]])"), 4),
        (IN_FUNCTION + "OnProcessExit(target_action=spawner('a'))\n", 2),
    ],
)
def test_lists_a_bridge_without_a_certain_place(text: str, line: int) -> None:
    after, port = ported(text, rows={line: OWN})
    assert ["where the bridge of the topics belongs" in one.what for one in port.unported] == [True]
    assert "parameter_bridge" not in after


@pytest.mark.parametrize(("space", "topic"), [("/a", "/a/scan"), ("a", "/a/scan"), ("", "/scan")])
def test_a_namespace_that_is_written_out_is_that_of_the_topics(space: str, topic: str) -> None:
    text = SPAWNED.replace("-timeout", "-robot_namespace").replace("60", space)
    after, port = ported(text.format(body="return LaunchDescription([spawn])"), rows={2: OWN})
    assert f'"/model/rover/scan@{SCAN.ros_type}[gz.msgs.LaserScan",' in after
    assert f'("/model/rover/scan", "{topic}"),' in after
    assert "namespace=" not in after
    assert not port.unported


def test_frames_that_a_launch_file_writes_are_those_that_were_named() -> None:
    text = "for tag in root.iter('frame_name'):\n    tag.text = 'a/scan'\n# gazebo\n"
    source = SourceText(Path("robot.launch.py"), text)
    context = Context(rows={}, package="p", distro="jazzy", frames={"imu_link"})
    after = apply(text, port_launch_file(source, context).edits)
    tags = "[one for one in root.iter('gz_frame_id') if one.text not in {'imu_link'}]"
    assert after == text.replace("root.iter('frame_name')", tags)
    assert port_launch_file(SourceText(source.file, after), context).edits == ()


def test_frames_that_a_launch_file_writes_into_a_model() -> None:
    after, port = ported(
        """\
        share = get_package_share_directory('gazebo_ros')
        for tag in tree.iter('odometry_frame'):
            tag.text = 'a/odom'
        tree.find('.//frame_name').text = 'a/scan'
        tree.find('.//sensor/plugin/frame_name').text = 'a/scan'
        """
    )
    assert "tree.iter('odom_frame')" in after
    assert "tree.find('.//gz_frame_id')" in after
    assert "tree.find('.//sensor/plugin/frame_name')" in after
    assert ["may be elsewhere" in one.what for one in port.unported] == [True]


HANDLED = """handler = RegisterEventHandler(OnProcessStart(on_start=spawn))
    return LaunchDescription([
        handler,
    ])"""


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (
            "return LaunchDescription([\n        spawn,\n        other,\n    ])",
            '        spawn,\n        Node(\n            package="ros_gz_bridge",',
        ),
        (
            "ld = LaunchDescription()\n    ld.add_action(spawn)\n    return ld",
            '    ld.add_action(spawn)\n    ld.add_action(Node(\n        package="ros_gz_bridge",',
        ),
        (
            HANDLED,
            '        handler,\n        Node(\n            package="ros_gz_bridge",',
        ),
    ],
)
def test_the_bridge_starts_beside_the_spawner(body: str, expected: str) -> None:
    after, port = ported(SPAWNED.format(body=body), rows={2: [SCAN, STATES]})
    assert expected in after
    assert '"/scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan",' in after
    assert '("/world/w/joint_state", "/joints"),' in after
    assert after.count("parameter_bridge") == 1
    assert "from launch_ros.actions import Node" in after
    assert port.packages == {"ros_gz_sim", "ros_gz_bridge"}


def test_each_branch_has_its_bridge() -> None:
    body = """if rviz:
        return [
            spawn,
            rviz_node,
        ]
    return [
        spawn,
    ]"""
    with_else = body.replace(
        "    return [\n        spawn,\n    ]", "    else:\n        return [spawn]"
    )
    after, _ = ported(SPAWNED.format(body=with_else), rows={2: [SCAN]})
    assert after.count("parameter_bridge") == 2


def test_the_clock_starts_with_the_simulator() -> None:
    after, _ = ported(
        """\
        share = FindPackageShare('gazebo_ros').find('gazebo_ros')
        gazebo = IncludeLaunchDescription(
            PythonLaunchDescriptionSource(share + '/launch/gazebo.launch.py'))
        ld.add_action(gazebo)
        """
    )
    assert "FindPackageShare('ros_gz_sim').find('ros_gz_sim')" in after
    assert after.count("'/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock'") == 1


def test_a_path_of_the_installed_ros_is_ported() -> None:
    after, _ = ported(
        """\
        IncludeLaunchDescription(PythonLaunchDescriptionSource(
            os.path.join('/opt/ros/humble/share/gazebo_ros/launch', 'gazebo.launch.py')))
        """
    )
    assert "'/opt/ros/jazzy/share/ros_gz_sim/launch', 'gz_sim.launch.py'" in after


def test_variables_of_the_environment_are_renamed() -> None:
    after, _ = ported("SetEnvironmentVariable('GAZEBO_MODEL_PATH', models)\n")
    assert after == "SetEnvironmentVariable('GZ_SIM_RESOURCE_PATH', models)\n"


def test_variables_that_become_one_add_up() -> None:
    after, _ = ported(
        """\
        from launch.actions import SetEnvironmentVariable
        SetEnvironmentVariable('GAZEBO_MODEL_PATH', models)
        SetEnvironmentVariable('GAZEBO_RESOURCE_PATH', worlds)
        """
    )
    assert "\nSetEnvironmentVariable('GZ_SIM_RESOURCE_PATH', models)" in after
    assert "\nAppendEnvironmentVariable('GZ_SIM_RESOURCE_PATH', worlds)" in after
    assert "from launch.actions import AppendEnvironmentVariable\n" in after


def test_what_is_not_understood_is_listed_and_stays() -> None:
    text = (
        "IncludeLaunchDescription(source('gazebo_ros', 'gazebo.launch.py'), launch_arguments=f())\n"
    )
    after, port = ported(text)
    assert "launch_arguments=f()" in after
    assert "computed" in port.unported[0].what


@pytest.mark.parametrize("text", ["def broken(:\n    'gazebo_ros'\n", "print('hello')\n"])
def test_other_files_stay_as_they_are(text: str) -> None:
    source = SourceText(Path("robot.launch.py"), text)
    assert (
        port_launch_file(source, Context(rows={}, package="my_robot", distro="jazzy")) == FilePort()
    )


def test_line_ends_of_windows_stay() -> None:
    text = SPAWNED.format(body="return LaunchDescription([\n        spawn,\n    ])")
    source = SourceText(Path("robot.launch.py"), text.replace("\n", "\r\n"))
    port = port_launch_file(source, Context(rows={2: [SCAN]}, package="my_robot", distro="jazzy"))
    after = apply(source.text, port.edits)
    assert after.count("\n") == after.count("\r\n")


def test_a_topic_with_two_names_in_ros_has_two_bridges() -> None:
    info, depth = (
        BridgeRow("/c/camera_info", "CameraInfo", "sensor_msgs/msg/CameraInfo", "[", name)
        for name in ("/c/camera_info", "/c/depth/camera_info")
    )
    text = """
        LaunchDescription([
            Node(package='gazebo_ros', executable='spawn_entity.py'),
        ])
    """
    after, _ = ported(text, rows={3: [info, depth, SCAN]})
    first, second = after.split("executable='parameter_bridge'")[1:]
    assert "/scan@" in first
    assert "remappings" not in first
    assert "remappings=[\n            ('/c/camera_info', '/c/depth/camera_info'),\n" in second
    assert after.count("'/c/camera_info@") == len((info, depth))
