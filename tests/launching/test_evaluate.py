"""Plans of launch files that are in order."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from install_space import HEAD, InstallSpace, only_message
from tutorial import TEXT, write_tutorial
from wsgen.diagnostics import Severity
from wsgen.launching.evaluate import evaluate
from wsgen.launching.simulators import find_simulator
from wsgen.launching.spawning import find_spawns

if TYPE_CHECKING:
    from wsgen.model.plan import LaunchPlan


pytestmark = pytest.mark.slow

STRUCTURE_A = """\
    DeclareLaunchArgument(
        "world",
        default_value=PathJoinSubstitution([FindPackageShare("my_robot"), "model", "w.world"]),
        description="the world",
    ),
    DeclareLaunchArgument("x", default_value="0.0"),
    DeclareLaunchArgument("z", default_value="0.3"),
    DeclareLaunchArgument("gui", default_value="true"),
    DeclareLaunchArgument("use_sim_time", default_value="true"),
    IncludeLaunchDescription(
        PythonLaunchDescriptionSource(
            PathJoinSubstitution([FindPackageShare("gazebo_ros"), "launch", "gazebo.launch.py"])
        ),
        launch_arguments={
            "world": LaunchConfiguration("world"),
            "gui": LaunchConfiguration("gui"),
        }.items(),
    ),
    Node(
        package="robot_state_publisher",
        executable="robot_state_publisher",
        parameters=[
            {
                "use_sim_time": LaunchConfiguration("use_sim_time"),
                "robot_description": ParameterValue(
                    Command(
                        [
                            "xacro ",
                            PathJoinSubstitution(
                                [FindPackageShare("my_robot"), "model", "r.xacro"]
                            ),
                            " mass:=",
                            LaunchConfiguration("mass", default="3"),
                        ]
                    ),
                    value_type=str,
                ),
            }
        ],
    ),
    Node(
        package="gazebo_ros",
        executable="spawn_entity.py",
        arguments=[
            "-topic", "robot_description", "-entity", "r",
            "-x", LaunchConfiguration("x"), "-z", LaunchConfiguration("z"),
        ],
    ),
"""

XACRO = """\
<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="mass" default="1"/>
  <xacro:include filename="$(find my_robot)/model/part.xacro"/>
</robot>
"""
PART = """\
<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <link name="base"><inertial><mass value="$(arg mass)"/></inertial></link>
</robot>
"""


@pytest.fixture
def robot(space: InstallSpace) -> InstallSpace:
    space.add("my_robot", {"model/r.xacro": XACRO, "model/part.xacro": PART})
    return space


def commands(plan: LaunchPlan) -> list[tuple[str, ...] | None]:
    assert not plan.diagnostics
    return [process.command for process in plan.processes]


def test_structure_a(robot: InstallSpace) -> None:
    plan = robot.play(STRUCTURE_A, arguments={"z": "1", "gui": "false"})
    assert not plan.diagnostics
    assert not plan.unresolved
    share = robot.prefix / "share" / "my_robot"
    world = str(share / "model" / "w.world")
    assert [(one.name, one.default, one.value) for one in plan.arguments] == [
        ("world", world, world),
        ("x", "0.0", "0.0"),
        ("z", "0.3", "1"),
        ("gui", "true", "false"),
        ("use_sim_time", "true", "true"),
    ]
    (include,) = plan.includes
    assert include.package == "gazebo_ros"
    assert include.arguments == {"world": world, "gui": "false"}
    assert not include.evaluated
    publisher, spawner = plan.processes
    assert publisher.parameters["use_sim_time"] is True
    assert '<mass value="3"/>' in publisher.parameters["robot_description"]
    assert spawner.arguments[-1] == "1"
    assert spawner.file == share / "launch" / "test.launch.py"
    assert spawner.line == HEAD.count("\n") + 4 + STRUCTURE_A[: STRUCTURE_A.rindex("Node(")].count(
        "\n"
    )
    simulator, _ = find_simulator(plan)
    assert simulator is not None
    assert (simulator.kind, simulator.world, simulator.is_headless) == (
        "classic",
        world,
        True,
    )
    (spawn,), diagnostics = find_spawns(plan)
    assert not diagnostics
    assert spawn.pose_in_world.xyz == (0.0, 0.0, 1.0)


@pytest.mark.skipif(not TEXT.exists(), reason="the tutorial's text is not here")
def test_the_tutorials_launch_file(tmp_path: Path) -> None:
    package = write_tutorial(tmp_path) / "src" / "gazebo_test"
    space = InstallSpace(tmp_path / "install")
    share = space.add("gazebo_test")
    for folder in ("launch", "model"):
        package.joinpath(folder).rename(share / folder)
    plan = space.evaluate(share / "launch" / "gazebo_model.launch.py", package="gazebo_test")
    assert not plan.diagnostics
    simulator, _ = find_simulator(plan)
    assert simulator is not None
    assert simulator.world == str(share / "model" / "empty_world.world")
    (spawn,), diagnostics = find_spawns(plan)
    assert not diagnostics
    assert spawn.entity == "simple_robot"
    assert '<cylinder length="0.5" radius="0.4"/>' in spawn.description
    assert spawn.pose_in_world.xyz == (0.0, 0.0, 0.0)


def test_an_argument_that_nobody_declares_is_set_all_the_same(space: InstallSpace) -> None:
    plan = space.play("ExecuteProcess(cmd=[LaunchConfiguration('a')])", arguments={"a": "b"})
    assert commands(plan) == [("b",)]


def test_defaults_of_a_known_launch_file_leak_into_the_caller(space: InstallSpace) -> None:
    plan = space.play(
        "IncludeLaunchDescription([FindPackageShare('gazebo_ros'), '/launch/gazebo.launch.py']), "
        "ExecuteProcess(cmd=[LaunchConfiguration('gui'), LaunchConfiguration('pause')])"
    )
    assert commands(plan) == [("true", "false")]


def test_a_callers_value_wins_over_the_default_of_a_known_launch_file(space: InstallSpace) -> None:
    plan = space.play(
        "DeclareLaunchArgument('world', default_value='mine.world'), "
        "IncludeLaunchDescription([FindPackageShare('gazebo_ros'), '/launch/gazebo.launch.py'])"
    )
    simulator, _ = find_simulator(plan)
    assert simulator is not None
    assert simulator.world == "mine.world"
    assert plan.includes[0].arguments == {}


def test_an_installed_package_wins_over_what_is_known_of_it(space: InstallSpace) -> None:
    text = HEAD + (
        "def generate_launch_description():\n"
        "    return LaunchDescription([ExecuteProcess(cmd=['installed'])])\n"
    )
    space.add("gazebo_ros", {"launch/gazebo.launch.py": text})
    plan = space.play(
        "IncludeLaunchDescription([FindPackageShare('gazebo_ros'), '/launch/gazebo.launch.py'])"
    )
    assert commands(plan) == [("installed",)]
    assert plan.includes[0].evaluated


MANIFEST = "<package><name>my_robot</name><exec_depend>their_robot</exec_depend></package>"


def test_a_declared_package_that_is_not_here_is_stood_in_for(space: InstallSpace) -> None:
    space.add("my_robot", {"package.xml": MANIFEST})
    plan = space.play(
        "IncludeLaunchDescription([FindPackageShare('their_robot'), '/launch/x.launch.py'], "
        "launch_arguments={'a': 'b'}.items()), Node(package='their_robot', executable='driver')"
    )
    assert [one.code for one in plan.diagnostics] == ["LCH046"]
    (include,) = plan.includes
    assert (include.package, include.arguments, include.evaluated) == (
        "their_robot",
        {"a": "b"},
        False,
    )
    assert plan.processes[0].executable == "driver"
    (unresolved,) = plan.unresolved
    assert unresolved.what == "their_robot"


def test_a_launch_file_given_relative_to_the_working_folder(
    space: InstallSpace, monkeypatch: pytest.MonkeyPatch
) -> None:
    share = space.add("my_robot", {"launch/test.launch.py": HEAD + NOTHING})
    monkeypatch.chdir(share)
    assert not space.evaluate(Path("launch/test.launch.py")).diagnostics


NOTHING = "def generate_launch_description():\n    return LaunchDescription()\n"


def test_environment_that_the_launch_file_sets(space: InstallSpace) -> None:
    plan = space.play(
        "SetEnvironmentVariable('A', '1'), ExecuteProcess(cmd=['x'], additional_env={'B': '2'}), "
        "GroupAction([SetEnvironmentVariable('C', '3'), ExecuteProcess(cmd=['y'])])",
        before="os.environ['D'] = '4'",
    )
    assert plan.environment == {"A": "1", "D": "4"}
    assert [process.environment for process in plan.processes] == [
        {"A": "1", "B": "2", "D": "4"},
        {"A": "1", "C": "3", "D": "4"},
    ]


def test_the_environment_is_that_of_a_sourced_ros(space: InstallSpace) -> None:
    names = "os.environ['ROS_DISTRO'], os.environ['ROS_VERSION'], os.environ['ROS_PYTHON_VERSION']"
    assert commands(space.play(f"ExecuteProcess(cmd=[{names}])")) == [("iron", "2", "3")]
    plan = space.play(f"ExecuteProcess(cmd=[{names}])", environment={"ROS_DISTRO": "jazzy"})
    assert commands(plan) == [("jazzy", "2", "3")]


def test_a_real_launch_package_on_the_path_does_not_win(
    space: InstallSpace, tmp_path: Path
) -> None:
    for name in ("launch", "launch_ros", "ament_index_python"):
        tmp_path.joinpath("ros", name).mkdir(parents=True)
        tmp_path.joinpath("ros", name, "__init__.py").write_text("raise RuntimeError('real')\n")
    plan = space.play(
        "ExecuteProcess(cmd=['x'])", environment={"PYTHONPATH": str(tmp_path / "ros")}
    )
    assert commands(plan) == [("x",)]


def test_a_process_that_the_launch_file_starts_finds_packages(space: InstallSpace) -> None:
    code = "from ament_index_python.packages import *; print(get_package_prefix('my_robot'))"
    before = (
        "import subprocess, sys\n"
        f"found = subprocess.check_output([sys.executable, '-c', {code!r}], text=True).strip()"
    )
    plan = space.play("ExecuteProcess(cmd=[found])", before=before)
    assert commands(plan) == [(str(space.prefix),)]


@pytest.mark.parametrize(
    "run",
    [
        "os.popen('ros2 pkg prefix {}').read().strip()",
        "os.popen('ros2 pkg prefix --share {}').read().split('/share/')[0]",
        "subprocess.check_output(['ros2', 'pkg', 'prefix', '{}'], text=True).strip()",
        "subprocess.getoutput('ros2 pkg prefix {}')",
    ],
)
def test_what_ros2_pkg_prefix_prints(
    space: InstallSpace, monkeypatch: pytest.MonkeyPatch, run: str
) -> None:
    monkeypatch.setenv("PATH", os.defpath)  # where no ROS is
    before = f"import os, subprocess\nfound = {run.format('my_robot')}"
    plan = space.play("ExecuteProcess(cmd=[found])", before=before)
    assert commands(plan) == [(str(space.prefix),)]
    assert not plan.diagnostics
    # Of a package that is not here it is what get_package_prefix() gives.
    found, looked_up = (
        space.play("ExecuteProcess(cmd=[found])", before=f"import os, subprocess\nfound = {text}")
        for text in (run.format("nav2_bringup"), "get_package_prefix('nav2_bringup')")
    )
    assert commands(found) == commands(looked_up)
    assert [one.code for one in found.diagnostics] == [one.code for one in looked_up.diagnostics]


def test_ros2_pkg_prefix_of_a_package_that_nobody_has(space: InstallSpace) -> None:
    before = "import os\nfound = os.popen('ros2 pkg prefix no_such_robot').read().strip()"
    (found,) = space.play("ExecuteProcess(cmd=['x', found])", before=before).diagnostics
    assert found.code == "LCH007"
    assert found.line is not None  # of the launch file
    assert found.file is not None
    assert found.file.name == "test.launch.py"
    assert "no_such_robot" in found.message


def test_no_bytecode_is_written_beside_the_launch_file(space: InstallSpace) -> None:
    space.play("ExecuteProcess(cmd=['x'])")
    assert [file.name for file in (space.prefix / "share" / "my_robot" / "launch").iterdir()] == [
        "test.launch.py"
    ]


def test_commands_are_not_executed(space: InstallSpace, tmp_path: Path) -> None:
    plan = space.play(f"ExecuteProcess(cmd=[Command(['touch ', '{tmp_path}/made'])])")
    assert not (tmp_path / "made").exists()
    (unresolved,) = plan.unresolved
    assert unresolved.what == f"touch {tmp_path}/made"
    assert unresolved.line is not None


def test_programs_of_ros_are_found_without_ros(robot: InstallSpace) -> None:
    plan = robot.play(
        "ExecuteProcess(cmd=[Command([FindExecutable(name='xacro'), ' ', "
        "FindPackageShare('my_robot'), '/model/r.xacro'])])"
    )
    (command,) = commands(plan)
    assert command is not None
    assert '<mass value="1"/>' in command[0]


def test_two_robots_from_one_xacro_file_do_not_mix(robot: InstallSpace) -> None:
    file = "FindPackageShare('my_robot'), '/model/r.xacro'"
    plan = robot.play(
        f"ExecuteProcess(cmd=[Command(['xacro ', {file}, ' mass:=5'])]), "
        f"ExecuteProcess(cmd=[Command(['xacro ', {file}])])"
    )
    five, one = (command[0] for command in commands(plan) if command)
    assert '<mass value="5"/>' in five
    assert '<mass value="1"/>' in one


@pytest.mark.parametrize(
    "text",
    [
        "ParameterValue(Command(['xacro ', FILE]), value_type=str)",
        "Command(['xacro ', FILE])",
        "Command(['cat ', FILE])",
        "xacro.process_file(FILE).toxml()",
        "xacro.process_file(FILE, mappings={'mass': '3'}).toprettyxml(indent='  ')",
        "xacro.process(FILE)",
        "processed()",
        "open(FILE).read()",
    ],
)
def test_the_plan_knows_the_file_of_a_description(robot: InstallSpace, text: str) -> None:
    file = robot.prefix / "share" / "my_robot" / "model" / "r.xacro"
    plan = robot.play(
        "Node(package='robot_state_publisher', executable='robot_state_publisher', parameters="
        f"[{{'robot_description': {text}}}]), Node(package='gazebo_ros', "
        "executable='spawn_entity.py', arguments=['-topic', 'robot_description', '-entity', 'r'])",
        before=f"""
        import xacro
        FILE = {str(file)!r}
        def processed():
            document = xacro.parse(open(FILE))
            xacro.process_doc(document)
            return document.toxml()
        """,
    )
    (spawn,), diagnostics = find_spawns(plan)
    assert not diagnostics
    assert spawn.description_file == file
    assert (plan.seconds_in_xacro > 0.0) == ("xacro" in text or "processed" in text)


def test_two_descriptions_have_two_files(robot: InstallSpace) -> None:
    node = (
        "Node(package='ros_gz_sim', executable='create', arguments=['-string', "
        "Command(['xacro ', FindPackageShare('my_robot'), '/model/{}'])])"
    )
    plan = robot.play(f"{node.format('r.xacro')}, {node.format('part.xacro mass:=2')}")
    files = [process.description_file for process in plan.processes]
    assert [file.name for file in files if file] == ["r.xacro", "part.xacro"]


def test_a_changed_description_has_no_file(robot: InstallSpace) -> None:
    plan = robot.play(
        "Node(package='robot_state_publisher', executable='robot_state_publisher', parameters=["
        "{'robot_description': open(FILE).read().replace('link', 'rope')}])",
        before=f"FILE = '{robot.prefix}/share/my_robot/model/part.xacro'",
    )
    assert not plan.diagnostics
    assert plan.processes[0].description_file is None


def test_description_without_parameter_value_is_warned_of(robot: InstallSpace) -> None:
    plan = robot.play(
        "Node(package='robot_state_publisher', executable='robot_state_publisher', parameters="
        "[{'robot_description': Command(['cat ', FindPackageShare('my_robot'), "
        "'/model/part.xacro'])}])"
    )
    (diagnostic,) = plan.diagnostics
    assert (diagnostic.code, diagnostic.severity) == ("LCH016", Severity.INFO)


def test_parameter_file(space: InstallSpace) -> None:
    share = space.add(
        "my_robot",
        {
            "config/p.yaml": "/**: {ros__parameters: {a: 1, b: {c: 2020-01-01}}}\n"
            "other: {ros__parameters: {a: 2}}\nme: {ros__parameters: {d: 3}}\n"
        },
    )
    plan = space.play(
        "Node(package='rviz2', executable='rviz2', name='me', "
        f"parameters=['{share}/config/p.yaml', {{'a': 5}}])"
    )
    assert not plan.diagnostics
    assert plan.processes[0].parameters == {"a": 5, "b.c": "2020-01-01", "d": 3}


def test_parameter_file_that_is_missing(space: InstallSpace) -> None:
    plan = space.play("Node(package='rviz2', executable='rviz2', parameters=['/no/p.yaml'])")
    (diagnostic,) = plan.diagnostics
    assert (diagnostic.code, diagnostic.severity) == ("LCH019", Severity.WARNING)


def test_a_robot_in_the_place_of_a_parameter_file(space: InstallSpace) -> None:
    plan = space.play("Node(package='rviz2', executable='rviz2', parameters=['<robot/>'])")
    (found,) = plan.diagnostics
    assert (found.code, found.element) == ("LCH019", "robot_description")
    assert found.hint == "Give the parameter its name: {'robot_description': ...}."


def test_parameters_of_all_nodes(space: InstallSpace) -> None:
    share = space.add("my_robot", {"p.yaml": "n: {ros__parameters: {a: 1}}\n"})
    node = "Node(package='rviz2', executable='rviz2', name="
    plan = space.play(
        f"GroupAction([SetParametersFromFile('{share}/p.yaml'), SetUseSimTime(True), "
        f"{node}'n', parameters=[{{'use_sim_time': False}}]), {node}'m')]), {node}'n')"
    )
    assert not plan.diagnostics
    assert [process.parameters for process in plan.processes] == [
        {"a": 1, "use_sim_time": False},
        {"use_sim_time": True},
        {},
    ]


def test_a_package_shim_can_be_played_itself(space: InstallSpace) -> None:
    space.add("my_robot")
    plan = space.evaluate(Path("/opt/ros/iron/share/gazebo_ros/launch/gazebo.launch.py"))
    assert not plan.diagnostics
    assert not plan.includes


def test_a_launch_service_may_be_imported(space: InstallSpace) -> None:
    before = "from launch import LaunchService\nif __name__ == '__main__':\n    LaunchService()"
    assert commands(space.play("ExecuteProcess(cmd=['x'])", before=before)) == [("x",)]


def test_timers_of_the_past_fire_at_once(space: InstallSpace) -> None:
    plan = space.play("TimerAction(period=-1.0, actions=[ExecuteProcess(cmd=['x'])])")
    assert commands(plan) == [("x",)]
    assert plan.processes[0].start_time == 0.0


def test_what_runs_for_ever_exits_last(space: InstallSpace) -> None:
    plan = space.play(
        "rviz, TimerAction(period=60, actions=[ExecuteProcess(cmd=['late'])]), "
        "RegisterEventHandler(OnProcessExit(target_action=rviz, on_exit=[Shutdown()])), "
        "RegisterEventHandler(OnShutdown(on_shutdown=[ExecuteProcess(cmd=['end'])]))",
        before="rviz = Node(package='rviz2', executable='rviz2')",
    )
    assert not plan.diagnostics
    assert [(process.starts, process.start_time) for process in plan.processes] == [
        ("launch", 0.0),
        ("timer 60.0", 60.0),
        ("shutdown", 60.001),
    ]


def test_an_event_in_the_place_of_an_action(space: InstallSpace) -> None:
    plan = space.play(
        "Node(package='rviz2', executable='rviz2',\non_exit=events.Shutdown()), "
        "ExecuteProcess(cmd=['x'])",
        before="from launch import events",
    )
    (found,) = plan.diagnostics
    assert found.code == "LCH065"
    assert found.severity is Severity.WARNING
    assert "given Shutdown of launch.events, which is not an action" in found.message
    assert (found.hint or "").startswith("Import Shutdown from launch.actions, or write")
    assert found.line is not None
    assert "on_exit" in plan.launch_file.read_text().splitlines()[found.line - 1]
    assert plan.is_complete
    assert plan.processes[-1].command == ("x",)


def test_causes(space: InstallSpace) -> None:
    plan = space.play(
        "spawn, RegisterEventHandler(OnProcessStart(target_action=spawn, on_start=[a])), "
        "RegisterEventHandler(OnProcessExit(target_action=spawn, on_exit=[b])), "
        "RegisterEventHandler(OnExecutionComplete(target_action=spawn, on_completion=[c]))",
        before="spawn = ExecuteProcess(cmd=['/bin/spawn'])\n"
        "a, b, c = (ExecuteProcess(cmd=[name]) for name in 'abc')",
    )
    assert [
        (process.command[0], process.starts) for process in plan.processes if process.command
    ] == [
        ("/bin/spawn", "launch"),
        ("a", "start of spawn"),
        ("b", "exit of spawn"),
        ("c", "exit of spawn"),
    ]


def test_a_prefix_is_no_argument(space: InstallSpace) -> None:
    plan = space.play(
        "Node(package='rviz2', executable='rviz2', arguments=['-d'], prefix=['xterm -e']), "
        "Node(package='rviz2', executable='rviz2', prefix=['xterm -e']), "
        "ExecuteProcess(cmd=['x'], prefix='gdb --args')"
    )
    assert [process.arguments for process in plan.processes] == [("-d",), (), ()]
    assert plan.processes[2].command == ("gdb", "--args", "x")


def test_own_substitutions_and_actions(space: InstallSpace) -> None:
    plan = space.play(
        "Mine(), ExecuteProcess(cmd=[Twice('ab')])",
        before="""
        from launch import Action, Substitution

        class Twice(Substitution):
            def __init__(self, text):
                self.text = text
            def perform(self, context):
                return self.text * 2

        class Mine(Action):
            def execute(self, context):
                return [ExecuteProcess(cmd=['mine'])]
        """,
    )
    assert commands(plan) == [("mine",), ("abab",)]


def test_deep_imports(space: InstallSpace) -> None:
    plan = space.play(
        "launch.actions.ExecuteProcess(cmd=['x'])",
        before="""
        import launch
        import launch_ros.actions
        from launch.launch_context import LaunchContext
        from launch.launch_description_sources.python_launch_description_source import *
        from launch.some_substitutions_type import SomeSubstitutionsType
        from launch.substitutions.launch_configuration import LaunchConfiguration as L
        from launch.utilities import perform_substitutions
        assert L('a', default='b').perform(LaunchContext()) == 'b'
        assert launch.LaunchDescription is LaunchDescription
        assert launch_ros.substitutions.FindPackageShare('my_robot').find('my_robot')
        """,
    )
    assert commands(plan) == [("x",)]


def test_the_time_grows_linearly(space: InstallSpace) -> None:
    plan = space.play("*[ExecuteProcess(cmd=[str(n)]) for n in range(4000)]")
    assert len(commands(plan)) == 4000


def test_every_name_can_be_imported(space: InstallSpace) -> None:
    # The star imports of the head ask for all of them.
    assert not space.play("").diagnostics


def test_few_modules_are_imported_in_the_parent() -> None:
    code = "import sys, wsgen.launching.evaluate; print(*sys.modules)"
    loaded = subprocess.check_output([sys.executable, "-c", code], text=True).split()
    assert not {"xacro", "yaml", "lxml", "click", "rich"} & set(loaded)


def test_the_child_imports_only_what_is_used(space: InstallSpace) -> None:
    text = (
        "import sys\n"
        + STRUCTURE_IMPORTS
        + (
            "def generate_launch_description():\n"
            "    return LaunchDescription([ExecuteProcess(cmd=[' '.join(sys.modules)])])\n"
        )
    )
    share = space.add("my_robot", {"launch/small.launch.py": text})
    plan = evaluate(
        share / "launch" / "small.launch.py",
        package="my_robot",
        arguments={},
        environment={"AMENT_PREFIX_PATH": str(space.prefix)},
    )
    (command,) = commands(plan)
    assert command is not None
    loaded = set(command[0].split())
    assert {"yaml", "logging", "tempfile", "shutil", "asyncio", "launch_ros"} & loaded == set()
    assert not any(name.startswith("wsgen.launching.explain") for name in loaded)
    assert "wsgen.launching.launch_warnings" not in loaded
    assert "launch.actions.timer_action" not in loaded


STRUCTURE_IMPORTS = (
    "from launch import LaunchDescription\nfrom launch.actions import ExecuteProcess\n"
)


@pytest.mark.parametrize(
    ("section", "names"),
    [
        ("a:\n  n:\n    ros__parameters: {p: 1}", {"/a/n"}),
        ("/:\n  n:\n    ros__parameters: {p: 1}", {"/n"}),
        ("/a/n:\n  ros__parameters: {p: 1}", {"/a/n"}),
        ("/**/n:\n  ros__parameters: {p: 1}", {"/n", "/a/n"}),
        ("/*/n:\n  ros__parameters: {p: 1}", {"/a/n"}),
        ("/a/**:\n  ros__parameters: {p: 1}", {"/a/n", "/a/m"}),
        ("/*:\n  ros__parameters: {p: 1}", {"/n"}),
        ("'**':\n  n:\n    ros__parameters: {p: 1}", {"/n", "/a/n"}),
    ],
)
def test_sections_of_parameter_files(space: InstallSpace, section: str, names: set[str]) -> None:
    share = space.add("my_robot", {"p.yaml": section})
    nodes = [
        f"Node(package='rviz2', executable='rviz2', name='{name}', namespace='{namespace}', "
        f"parameters=['{share}/p.yaml'])"
        for namespace, name in (("", "n"), ("a", "n"), ("a", "m"))
    ]
    plan = space.play(", ".join(nodes))
    assert not plan.diagnostics
    assert {f"{n.namespace.rstrip('/')}/{n.name}" for n in plan.processes if n.parameters} == names


def test_sections_of_one_name_are_merged(space: InstallSpace) -> None:
    section = "/**:\n  {}: {{ros__parameters: {{p: {}}}}}\n"
    share = space.add("my_robot", {"p.yaml": section.format("n", 1) + section.format("m", 2)})
    nodes = [
        f"Node(package='rviz2', executable='rviz2', name='{name}', parameters=['{share}/p.yaml'])"
        for name in ("n", "m")
    ]
    plan = space.play(", ".join(nodes))
    assert not plan.diagnostics
    assert [one.parameters for one in plan.processes] == [{"p": 1}, {"p": 2}]


def test_launch_merges_no_sections_for_a_container(space: InstallSpace) -> None:
    text = "/**: {ros__parameters: {p: 1}}\n/**: {ros__parameters: {q: 2}}\n"
    share = space.add("my_robot", {"p.yaml": text})
    plan = space.play(
        "LoadComposableNodes(target_container='box', composable_node_descriptions=["
        "ComposableNode(package='p_a', plugin='p_a::N', name='n', "
        f"parameters=['{share}/p.yaml'])]), "
        f"Node(package='rviz2', executable='rviz2', parameters=['{share}/p.yaml'])",
        before="from launch_ros.actions import LoadComposableNodes\n"
        "from launch_ros.descriptions import ComposableNode",
    )
    assert [one.parameters for one in plan.processes] == [{"q": 2}, {"p": 1, "q": 2}]


def test_a_parameter_file_is_parsed_once(space: InstallSpace) -> None:
    share = space.add("my_robot", {"p.yaml": "/**: {ros__parameters: {p: 1}}"})
    node = f"Node(package='rviz2', executable='rviz2', parameters=['{share}/p.yaml'])"
    plan = space.play(
        f"{node}, {node}, OpaqueFunction(function=lambda context: ["
        "ExecuteProcess(cmd=[str(len(calls))])])",
        before="""
        import yaml
        calls, load = [], yaml.load
        yaml.load = lambda *arguments, **keywords: calls.append(1) or load(*arguments, **keywords)
        """,
    )
    assert not plan.diagnostics
    assert plan.processes[-1].command == ("1",)


def test_a_parameter_file_without_sections(space: InstallSpace) -> None:
    share = space.add("my_robot", {"p.yaml": "a: 1\nb: {c: 2}\n"})
    plan = space.play(
        "ComposableNodeContainer(name='box', namespace='', package='rclcpp_components', "
        f"executable='component_container', parameters=['{share}/p.yaml'], "
        "composable_node_descriptions=[ComposableNode(package='p_a', plugin='p_a::N', "
        f"parameters=['{share}/p.yaml'])])",
        before="from launch_ros.descriptions import ComposableNode",
    )
    container, node = plan.processes
    assert container.parameters == {}
    assert node.parameters == {"a": 1, "b.c": 2}


def test_launch_makes_numbers_of_both_kinds_floats(space: InstallSpace) -> None:
    text = "/**: {ros__parameters: {cov: [1, 2.5], ids: [1, 2], odd: [1, a], flags: [true, 1]}}\n"
    share = space.add("my_robot", {"p.yaml": text})
    plan = space.play(
        "LoadComposableNodes(target_container='box', composable_node_descriptions=["
        "ComposableNode(package='p_a', plugin='p_a::N', name='n', "
        f"parameters=['{share}/p.yaml'])]), "
        f"Node(package='p_a', executable='n', parameters=['{share}/p.yaml'])",
        before="from launch_ros.actions import LoadComposableNodes\n"
        "from launch_ros.descriptions import ComposableNode",
    )
    loaded, node = plan.processes
    as_it_is = {"cov": [1, 2.5], "ids": [1, 2], "odd": [1, "a"], "flags": [True, 1]}
    assert node.parameters == as_it_is
    assert loaded.parameters == {**as_it_is, "cov": [1.0, 2.5]}
    assert [type(one) for one in loaded.parameters["cov"]] == [float, float]


@pytest.mark.parametrize("distro", ["humble", "rolling"])
def test_include_by_the_path_of_a_distribution(space: InstallSpace, distro: str) -> None:
    path = f"/opt/ros/{distro}/share/gazebo_ros/launch/gazebo.launch.py"
    plan = space.play(f"IncludeLaunchDescription('{path}')")
    assert not [one for one in plan.diagnostics if one.code == "LCH005"]
    assert [(one.package, one.evaluated) for one in plan.includes] == [("gazebo_ros", False)]


def test_path_of_a_distribution_beside_an_installed_one(
    space: InstallSpace, tmp_path: Path
) -> None:
    (tmp_path / "prefixes/jazzy").mkdir(parents=True)
    prefixes = tmp_path / "prefixes"
    plan = space.play(
        f"IncludeLaunchDescription('{prefixes}/humble/share/gazebo_ros/launch/gazebo.launch.py')",
        environment={"WSGEN_ROS_PREFIXES": str(prefixes), "ROS_DISTRO": "jazzy"},
    )
    only_message(plan, "LCH005")
