"""Values from modules that are not installed are unknown, and all else resolves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from install_space import HEAD, InstallSpace, only_message
from wsgen.launching.simulators import find_simulator
from wsgen.launching.spawning import find_spawns
from wsgen.model.plan import STARTS_UNKNOWN

if TYPE_CHECKING:
    from wsgen.model.plan import LaunchPlan


IMPORT = HEAD.count("\n") + 1  # the line of the first import after the head
RVIZ = "Node(package='rviz2', executable='rviz2', name='n', {})"
WHY_MODULE = "its Python module is not installed"


def unresolved(plan: LaunchPlan) -> list[tuple[str, str, int | None]]:
    return [(entry.what, entry.why, entry.line) for entry in plan.unresolved]


@pytest.mark.slow
def test_the_configuration_of_moveit(space: InstallSpace) -> None:
    plan = space.play(
        RVIZ.format(
            "parameters=[config.robot_description, config.to_dict(), {**config.to_dict()}, "
            "{'r': config.robot_description['robot_description'], 'b': 2}]"
        ),
        before="""
        from moveit_configs_utils import MoveItConfigsBuilder
        config = (
            MoveItConfigsBuilder("r", package_name="r_config")
            .robot_description(file_path="r.xacro")
            .to_moveit_configs()
        )
        """,
    )
    assert not plan.diagnostics
    (node,) = plan.processes
    assert node.parameters["b"] == 2
    assert node.parameters["r"].startswith("$(moveit_configs_utils.MoveItConfigsBuilder()")
    assert {entry.what for entry in plan.unresolved} >= {"moveit_configs_utils"}
    assert all(entry.line for entry in plan.unresolved)


@pytest.mark.slow
@pytest.mark.parametrize(
    "end",
    [
        "return LaunchDescription(demo.entities + [node])",
        "return LaunchDescription([node] + demo.entities)",
        "demo.add_action(node)\n    return demo",
    ],
)
def test_what_is_added_to_an_unknown_description(space: InstallSpace, end: str) -> None:
    text = (
        f"{HEAD}from moveit_configs_utils.launches import generate_demo_launch\n\n"
        "def generate_launch_description():\n    demo = generate_demo_launch('r')\n"
        f"    node = ExecuteProcess(cmd=['known'])\n    {end}\n"
    )
    share = space.add("my_robot", {"demo.launch.py": text})
    plan = space.evaluate(share / "demo.launch.py")
    assert not plan.diagnostics
    assert [process.command for process in plan.processes] == [("known",)]
    assert len(plan.unresolved) >= 2


@pytest.mark.slow
def test_actions_and_what_waits_for_them(space: InstallSpace) -> None:
    plan = space.play(
        "action, RegisterEventHandler(OnProcessExit(target_action=action, on_exit=["
        "ExecuteProcess(cmd=['after'])])), RegisterEventHandler(OnProcessExit(target_action=other, "
        "on_exit=[ExecuteProcess(cmd=['never'])])), Special(condition=IfCondition('false'))",
        before="from launch_testing.actions import Special\naction = Special()\nother = Special()",
    )
    assert not plan.diagnostics
    assert [(process.command, process.starts) for process in plan.processes] == [
        (("after",), "exit of launch_testing.actions.Special()")
    ]
    assert [entry.what for entry in plan.unresolved] == [
        "launch_testing",
        "launch_testing.actions.Special()",
    ]


@pytest.mark.slow
def test_texts_conditions_and_paths(space: InstallSpace) -> None:
    plan = space.play(
        "ExecuteProcess(cmd=[X.word, f'{X.word}', str(X.word)]), "
        "ExecuteProcess(cmd=['if'], condition=IfCondition(X.flag)), "
        "ExecuteProcess(cmd=['unless'], condition=UnlessCondition(PythonExpression(['not ', "
        "X.flag]))), "
        "IncludeLaunchDescription(os.path.join(X.folder, 'a.launch.py'), "
        "launch_arguments={'b': 'c'}.items()), "
        "IncludeLaunchDescription([FindPackageShare(X.package), '/a.launch.py']), "
        "Node(package=X.package, executable='e', name=X.name, namespace=X.space), "
        "Node(package='rviz2', executable=X.program)",
        before="import rclpy as X",
    )
    assert not plan.diagnostics
    assert plan.processes[0].command == ("$(rclpy.word)",) * 3
    assert [process.command for process in plan.processes[1:2]] == [("unless",)]
    assert [str(include.file) for include in plan.includes] == [
        "$(rclpy.folder)/a.launch.py",
        "$(rclpy.package)/a.launch.py",
    ]
    assert not any(include.evaluated for include in plan.includes)
    assert plan.includes[0].arguments == {"b": "c"}
    assert plan.processes[-2].name == "$(rclpy.name)"
    assert plan.processes[-1].executable == "$(rclpy.program)"


@pytest.mark.slow
def test_whatever_python_does_with_a_value(space: InstallSpace) -> None:
    plan = space.play(
        "ExecuteProcess(cmd=['x'])",
        before="""
        import typing
        from geometry_msgs.msg import Pose, Twist
        from sensor_msgs.msg import *
        import tf_transformations, tf2_ros.buffer

        class Mine(Pose):
            pass

        @tf_transformations.decorated
        def f(pose: Pose | None, twist: typing.List[Twist]) -> Pose:
            return pose

        assert f(1, []) == 1
        Mine(1, x=2).y = 3
        with Pose() as pose:
            pose.position.x = 1.0
            pose["a"] = 2
        for one in Pose():
            raise AssertionError
        assert int(Pose.A) == 0 and float(Pose.B) == 0.0 and not Pose.A < 3 and len(Pose) == 0
        assert 1 + Pose.A * 2 - 3 and not isinstance(1, Pose) and 1 not in Pose and Pose == Pose
        dict(**Pose.items); {Pose: 1}; list(Pose.A); repr(Pose)
        """,
    )
    assert not plan.diagnostics
    assert len(plan.processes) == 1


@pytest.mark.slow
def test_a_declared_package_has_modules_too(space: InstallSpace) -> None:
    manifest = "<package><name>my_robot</name><exec_depend>their_launch</exec_depend></package>"
    space.add("my_robot", {"package.xml": manifest})
    before = "from their_launch.tools.more import make"
    plan = space.play("ExecuteProcess(cmd=[make('x')])", before=before)
    assert not plan.diagnostics
    assert plan.processes[0].command == ("$(their_launch.tools.more.make())",)
    assert unresolved(plan)[0] == ("their_launch", WHY_MODULE, IMPORT)


@pytest.mark.slow
@pytest.mark.parametrize(
    "module", ["their_launch", "launch_ross.actions", "launch.nothing", "wsgen.nothing", "os.not"]
)
def test_a_module_that_nobody_knows_is_an_error(space: InstallSpace, module: str) -> None:
    plan = space.play("", before=f"import_ = __import__('{module}', fromlist=['x'])")
    (diagnostic,) = plan.diagnostics
    assert diagnostic.code in {"LCH002", "LCH017"}
    assert not plan.unresolved


@pytest.mark.slow
def test_an_optional_import_stays_optional(space: InstallSpace) -> None:
    before = "try:\n    import their_launch\nexcept ImportError:\n    their_launch = None"
    plan = space.play("ExecuteProcess(cmd=[str(their_launch)])", before=before)
    assert plan.processes[0].command == ("None",)


@pytest.mark.slow
def test_a_file_whose_path_is_unknown(space: InstallSpace) -> None:
    plan = space.play("", before="import rclpy\nopen(rclpy.file)")
    message = only_message(plan, "LCH024")
    assert "$(rclpy.file)" in message
    assert plan.diagnostics[0].line == IMPORT + 1


@pytest.mark.slow
def test_a_condition_on_the_output_of_a_command(space: InstallSpace) -> None:
    plan = space.play(
        "ExecuteProcess(cmd=['x'], condition=IfCondition(Command('nproc'))), "
        "ExecuteProcess(cmd=['y'])"
    )
    assert not plan.diagnostics
    assert [process.command for process in plan.processes] == [("y",)]
    assert [entry.what for entry in plan.unresolved] == ["nproc"]


ACTIONS = """
from launch_ros.parameters_type import ParametersDict, SomeParameters
from launch_ros.remap_rule_type import SomeRemapRules
from ros_gz_sim.actions import GzServer, GzSpawnModel
from ros_gz_bridge.actions import RosGzBridge
C = LaunchConfiguration
"""


@pytest.mark.slow
def test_the_actions_of_gazebo(space: InstallSpace) -> None:
    plan = space.play(
        "DeclareLaunchArgument('x', default_value='1.5'), "
        "GzServer(world_sdf_file='/w/a.sdf', verbosity_level='4'), "
        "Node(package='robot_state_publisher', executable='robot_state_publisher', "
        "parameters=[{'robot_description': '<robot name=\"r\"/>'}]), "
        "GzSpawnModel(topic='robot_description', entity_name='r', x=C('x'), yaw='0.5'), "
        "RosGzBridge(bridge_name='bridge', config_file='/w/b.yaml')",
        before=ACTIONS,
    )
    assert not plan.diagnostics
    assert not plan.unresolved
    assert [(one.package, one.executable) for one in plan.processes] == [
        ("robot_state_publisher", "robot_state_publisher"),
        ("ros_gz_sim", "create"),
    ]
    assert [(one.package, one.file.name) for one in plan.includes] == [
        ("ros_gz_sim", "gz_server.launch.py"),
        ("ros_gz_bridge", "ros_gz_bridge.launch.py"),
    ]
    assert plan.includes[1].arguments == {
        "bridge_name": "bridge",
        "config_file": "/w/b.yaml",
        "container_name": "ros_gz_container",
        "create_own_container": "False",
        "use_composition": "False",
        "namespace": "",
        "use_respawn": "False",
        "log_level": "info",
    }
    simulator, _ = find_simulator(plan)
    assert simulator is not None
    assert (simulator.kind, simulator.world) == ("gz", "/w/a.sdf")
    (spawn,), diagnostics = find_spawns(plan)
    assert not diagnostics
    assert (spawn.entity, spawn.pose_in_world.xyz) == ("r", (1.5, 0.0, 0.0))
    assert spawn.pose_in_world.rpy == (0.0, 0.0, 0.5)


@pytest.mark.slow
@pytest.mark.parametrize("own", [True, False])
def test_the_actions_of_gazebo_in_a_container(space: InstallSpace, *, own: bool) -> None:
    container = f"use_composition='True', create_own_container={own}, container_name='box'"
    plan = space.play(
        f"GzServer(world_sdf_file='/w/a.sdf', {container}), "
        f"RosGzBridge(bridge_name='b', config_file='/w/b.yaml', {container})",
        before=ACTIONS,
    )
    assert not plan.diagnostics
    for include in plan.includes:
        assert include.arguments["use_composition"] == "True"
        assert include.arguments["create_own_container"] == str(own)
        assert include.arguments["container_name"] == "box"
    simulator, _ = find_simulator(plan)
    assert simulator is not None
    assert simulator.world == "/w/a.sdf"


@pytest.mark.slow
def test_the_actions_of_gazebo_in_xml(space: InstallSpace) -> None:
    text = """<launch><gz_server world_sdf_file="/w/a.sdf"/>
    <gz_spawn_model file="/w/r.sdf" entity_name="r" z="$(eval '1 + 1')"/>
    <ros_gz_bridge bridge_name="b" config_file="/w/b.yaml"/></launch>"""
    share = space.add("my_robot", {"a.launch.xml": text})
    plan = space.evaluate(share / "a.launch.xml")
    assert not plan.diagnostics
    assert len(plan.includes) == 2
    assert [one.line for one in plan.processes] == [2]
    assert plan.processes[0].parameters["z"] == 2


@pytest.mark.slow
def test_an_included_spawner_of_gazebo(space: InstallSpace) -> None:
    plan = space.play(
        "IncludeLaunchDescription([FindPackageShare('ros_gz_sim'), "
        "'/launch/gz_spawn_model.launch.py'], launch_arguments={'model_string': "
        "'<robot name=\"r\"/>', 'entity_name': 'r', 'z': '2'}.items())"
    )
    (spawn,), diagnostics = find_spawns(plan)
    assert not diagnostics
    assert (spawn.entity, spawn.pose_in_world.xyz[2]) == ("r", 2.0)
    assert spawn.description.startswith("<robot")


@pytest.mark.slow
def test_the_bridge_must_be_given_its_arguments(space: InstallSpace) -> None:
    include = (
        "IncludeLaunchDescription([FindPackageShare('ros_gz_bridge'), "
        "'/launch/ros_gz_bridge.launch.py'], launch_arguments={}.items())"
    )
    assert "'bridge_name'" in only_message(space.play(include.format("{}")), "LCH006")
    given = "{'bridge_name': 'b', 'config_file': 'c'}"
    plan = space.play(
        f"{include.replace('{}', given)}, ExecuteProcess(cmd=[V('log_level')])",
        before="V = LaunchConfiguration",
    )
    assert not plan.diagnostics
    assert plan.processes[0].command == ("info",)


@pytest.mark.slow
def test_a_value_stays_unknown_whatever_is_done_with_it(space: InstallSpace) -> None:
    plan = space.play(
        "DeclareLaunchArgument('mode', default_value=X.mode, choices=['a', 'b']), "
        "DeclareLaunchArgument('one_of', default_value='a', choices=X.modes), "
        "OpaqueFunction(function=f), TimerAction(period=X.period, actions=["
        "ExecuteProcess(cmd=['later'])]), "
        "ExecuteProcess(cmd=['and', AndSubstitution('true', X.flag)]), "
        "ExecuteProcess(cmd=['equal', EqualsSubstitution(X.mode, 'a')]), "
        "ExecuteProcess(cmd=['other', NotEqualsSubstitution(X.mode, 'a')]), "
        "Node(package='rviz2', executable='rviz2', parameters=[{'a': Command('nproc'), "
        "'b': ParameterValue(Command('nproc'), value_type=int), 'c': [[X.d], [X.e]]}])",
        before="""
        import json, yaml
        import rclpy as X
        a, b = X.pair()
        assert yaml.safe_load(yaml.dump({'a': [X.value]})) == {'a': ['$(rclpy.value)']}
        assert yaml.safe_load(yaml.safe_dump({'a': str(X.value)})) == {'a': '$(rclpy.value)'}
        assert json.loads(json.dumps({'a': X.value})) == {'a': '$(rclpy.value)'}

        def f(context):
            words = [LaunchConfiguration('mode').perform(context)]
            words += [words[0] + '_x', 'x_' + words[0], words[0].lower().strip()]
            numbers = [int(words[0]), float(words[1]) + 1.0, float(words[2].upper())]
            assert not os.path.exists(words[0]) and not os.path.isfile(X.file)
            return [ExecuteProcess(cmd=[*words, os.path.basename(words[0]), str(numbers)])]
        """,
    )
    assert not plan.diagnostics
    mode = "$(rclpy.mode)"
    commands = [one.command for one in plan.processes if one.command]
    assert commands[0] == (mode, f"{mode}_x", f"x_{mode}", mode, mode, "[0, 1.0, 0.0]")
    assert [command[0] for command in commands[1:]] == ["and", "equal", "other", "later"]
    assert all("$(" in command[1] for command in commands[1:4])
    (node,) = [one for one in plan.processes if one.package]
    assert node.parameters == {
        "a": "$(nproc)",
        "b": "$(nproc)",
        "c": ["$(rclpy.d)", "$(rclpy.e)"],
    }


@pytest.mark.slow
def test_what_is_handed_on_as_yaml_or_json(space: InstallSpace) -> None:
    plan = space.play(
        "DeclareLaunchArgument('dump', default_value=yaml.dump(X.config())), "
        "DeclareLaunchArgument('json', default_value=json.dumps(X.config())), "
        "OpaqueFunction(function=f)",
        before="""
        import json, yaml
        import rclpy as X

        def f(context):
            dump = LaunchConfiguration('dump').perform(context)
            read = yaml.load(dump, Loader=yaml.FullLoader)
            text = yaml.safe_load(dump)['robot'].lower()
            again = json.loads(LaunchConfiguration('json').perform(context))
            return [ExecuteProcess(cmd=[read['robot'], text, again['robot']])]
        """,
    )
    assert not plan.diagnostics
    unknown = "$(rclpy.config()['robot']{})"
    command = (unknown.format(""), unknown.format(".lower()"), unknown.format(""))
    assert plan.processes[0].command == command


@pytest.mark.slow
def test_a_loop_over_the_characters_of_what_is_unknown_ends(space: InstallSpace) -> None:
    plan = space.play(
        "OpaqueFunction(function=f), ExecuteProcess(cmd=['goes on'])",
        before="""
        import rclpy as X

        def f(context):
            text, place = str(X.value), 0
            while text[place] != ':':
                place += 1
        """,
    )
    assert [one.command for one in plan.processes] == [("goes on",)]
    assert [one.code for one in plan.diagnostics] == ["LCH024"]


@pytest.mark.slow
@pytest.mark.parametrize("line", ["text.split(':')[1]", "json.loads(text)", "table[text]"])
def test_what_only_the_known_value_could_do(space: InstallSpace, line: str) -> None:
    plan = space.play(
        "OpaqueFunction(function=f), ExecuteProcess(cmd=['goes on'])",
        before=f"""
        import json
        import rclpy as X
        table = {{'a': 1}}

        def f(context):
            text = str(X.value)
            return [ExecuteProcess(cmd=[str({line})])]
        """,
    )
    assert [one.command for one in plan.processes] == [("goes on",)]
    (diagnostic,) = plan.diagnostics
    assert diagnostic.code == "LCH024"


@pytest.mark.slow
def test_a_mistake_beside_a_value_that_is_not_known(space: InstallSpace) -> None:
    before = "import rclpy as X\n\ndef f(context):\n    value = X.y\n    return [vlue, value]"
    plan = space.play("OpaqueFunction(function=f)", before=before)
    assert "vlue" in plan.diagnostics[0].message
    assert plan.diagnostics[0].code != "LCH024"


@pytest.mark.slow
def test_what_an_unknown_description_starts(space: InstallSpace) -> None:
    plan = space.play(
        "generate_demo_launch()",
        before="from moveit_configs_utils.launches import generate_demo_launch",
    )
    assert STARTS_UNKNOWN in [entry.why for entry in plan.unresolved]


@pytest.mark.slow
def test_all_names_of_an_absent_module(space: InstallSpace) -> None:
    plan = space.play(
        "generate_demo_launch(), OpaqueFunction(function=f)",
        before="from moveit_configs_utils.launches import *\n"
        "def f(context):\n    other = [context]\n    return []",
    )
    assert not plan.diagnostics
    assert "moveit_configs_utils.launches.generate_demo_launch()" in [
        entry.what for entry in plan.unresolved if entry.why == STARTS_UNKNOWN
    ]
