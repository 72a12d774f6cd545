"""What launch files of ROS 1 become: to the letter, and what it means when it is evaluated."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING, Any

import pytest

from install_space import InstallSpace
from wsgen.model.target import choose_target
from wsgen.porting.existing.launch_of_ros1 import port_launch_file
from wsgen.porting.existing.launch_port import PortedLaunch, Source, ported_name

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from wsgen.model.plan import LaunchPlan, Process

GAZEBO = '<include file="$(find gazebo_ros)/launch/empty_world.launch"{}'
PUBLISHER = '<node pkg="robot_state_publisher" type="robot_state_publisher" name="rsp"/>'
URDF = '<robot name="r"><link name="base"/></robot>'
DESCRIBED = '<param name="robot_description" textfile="$(find my_robot)/urdf/r.urdf"/>'


class Package:
    """A package of ROS 1, whose launch files are ported and evaluated."""

    def __init__(self, folder: Path, files: Mapping[str, str], target: str = "jazzy") -> None:
        self.folder = folder / "old"
        for name, text in {"urdf/r.urdf": URDF, **files}.items():
            file = self.folder / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")
        self.space = InstallSpace(folder / "install")
        simulator = "classic" if target == "humble" else "gz"
        self.source = Source(self.folder, "my_robot", "my_robot", choose_target(target, simulator))

    def port(self, name: str = "launch/a.launch") -> PortedLaunch:
        """What a launch file becomes."""
        file = self.folder / name
        return port_launch_file(file, file.read_text(encoding="utf-8"), self.source)

    def plan(self, **arguments: str) -> LaunchPlan:
        """What the ported launch file starts; all of the package is installed."""
        files = {
            path.relative_to(self.folder).as_posix(): path.read_text(encoding="utf-8")
            for path in self.folder.rglob("*")
            if path.is_file()
        }
        for name in [one for one in files if one.endswith((".launch", ".launch.xml"))]:
            ported = self.port(name)
            assert ported.text is not None
            files[ported_name(name)] = ported.text
            files.update(ported.files)
        share = self.space.add("my_robot", files)
        plan = self.space.evaluate(share / "launch" / "a.launch.py", arguments=arguments)
        assert not [one for one in plan.diagnostics if one.severity.value == "error"], (
            plan.diagnostics
        )
        return plan


@pytest.fixture
def package(tmp_path: Path) -> Any:
    """Make a package of the elements of a launch file, and of other files."""

    def make(launch: str, target: str = "jazzy", **files: str) -> Package:
        named = {name.replace("__", "/").replace("_dot_", "."): one for name, one in files.items()}
        text = f"<launch>\n{launch}\n</launch>\n"
        return Package(tmp_path, {"launch/a.launch": text, **named}, target)

    return make


def notes(ported: PortedLaunch) -> list[str]:
    """What is listed, with its lines."""
    return [f"{one.line}: {one.what}" for one in ported.notes]


def process(plan: LaunchPlan, executable: str) -> Process:
    """The only process of a program."""
    (found,) = [one for one in plan.processes if one.executable == executable]
    return found


SLIDERS = """\
<launch>
  <!-- the robot to show -->
  <arg name="model" default="$(find my_robot)/urdf/robot.xacro" doc="File of the robot"/>
  <arg name="gui" default="true"/>
  <param name="robot_description" command="$(find xacro)/xacro --inorder '$(arg model)' a:=1"/>
  <param name="use_gui" value="$(arg gui)"/>
  <node name="joint_state_publisher" pkg="joint_state_publisher" type="joint_state_publisher"/>
  <node name="rsp" pkg="robot_state_publisher" type="state_publisher" output="screen"/>
  <node name="rviz" pkg="rviz" type="rviz" args="-d $(find my_robot)/rviz/r.rviz" required="true"/>
</launch>
"""
SLIDERS_PORTED = '''\
"""Start what display.launch started in ROS 1."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, Shutdown
from launch.conditions import IfCondition, UnlessCondition
from launch.substitutions import Command, LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    """Declare the arguments; describe what is started."""
    share = FindPackageShare('my_robot')

    arguments = [
        # the robot to show
        DeclareLaunchArgument(
            'model',
            default_value=PathJoinSubstitution([share, 'urdf', 'robot.xacro']),
            description='File of the robot',
        ),
        DeclareLaunchArgument('gui', default_value='true'),
    ]

    joint_state_publisher_gui = Node(
        package='joint_state_publisher_gui',
        executable='joint_state_publisher_gui',
        name='joint_state_publisher',
        condition=IfCondition(LaunchConfiguration('gui')),
    )

    joint_state_publisher = Node(
        package='joint_state_publisher',
        executable='joint_state_publisher',
        condition=UnlessCondition(LaunchConfiguration('gui')),
    )

    rsp = Node(
        package='robot_state_publisher',
        executable='robot_state_publisher',
        name='rsp',
        output='screen',
        parameters=[{'robot_description': ParameterValue(
            Command(['xacro "', LaunchConfiguration('model'), '" a:=1'], on_stderr='warn'),
            value_type=str,
        )}],
    )

    rviz = Node(
        package='rviz2',
        executable='rviz2',
        name='rviz',
        arguments=['-d', PathJoinSubstitution([share, 'rviz', 'r.rviz'])],
        on_exit=Shutdown(),
    )

    return LaunchDescription([
        *arguments,
        joint_state_publisher_gui,
        joint_state_publisher,
        rsp,
        rviz,
    ])
'''


def test_it_is_written_as_the_templates_are(tmp_path: Path) -> None:
    package = Package(tmp_path, {"launch/display.launch": SLIDERS})
    ported = package.port("launch/display.launch")
    assert ported.text == SLIDERS_PORTED
    assert notes(ported) == []
    assert ported.packages == {
        *("joint_state_publisher", "joint_state_publisher_gui", "launch", "launch_ros"),
        *("robot_state_publisher", "ros2launch", "rviz2", "xacro"),
    }


def test_files_of_ros_2_stay(package: Any) -> None:
    for text in (
        '<node pkg="a" exec="b"/>',
        '<arg name="a" default="$(find-pkg-share b)"/>',
        '<let name="a" value="b"/>',
    ):
        assert package(text).port() == PortedLaunch(None)


def test_what_is_no_xml_is_listed(tmp_path: Path) -> None:
    package = Package(tmp_path, {"launch/a.launch": "<launch>\n<node\n</launch>"})
    ported = package.port()
    assert ported.text is None
    assert len(ported.notes) == 1
    assert "is not well-formed XML" in ported.notes[0].what


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("arg('word') == 'abc'", "True"),
        ("word != 'abc' or truth", "True"),
        ("not truth", "False"),
        ("truth and not lie", "True"),
        ("truth == true", "True"),
        ("number * 2", "6"),
        ("arg('number') + 0.5", "3.5"),
        ("'x_' + word + '.yaml'", "x_abc.yaml"),
        ("word + '/' + arg('number')", "abc/3"),
        ("'yes' if truth else 'no'", "yes"),
        ("word in ['abc', 'b']", "True"),
        ("word.upper()", "ABC"),
        ("round(sin(pi / 2))", None),
        ("floor(3.7)", "3"),
        ("int(number) > 2", "True"),
        ("env('HOME_OF_ROBOT') + '/x'", "/home/r/x"),
        ("optenv('NOT_THERE_AT_ALL', 'd')", "d"),
        ("find('my_robot').split('/')[-1]", "my_robot"),
        ("__import__('os')", None),
        ("word.__class__", None),
        ("[one for one in word]", None),
        ("lambda: 1", None),
        ("unknown == 1", None),
        ("1 +", None),
    ],
)
def test_expressions(package: Any, expression: str, value: str | None) -> None:
    """Roslaunch gives arguments the types that they look like; it has few functions."""
    quoted = expression.replace("<", "&lt;").replace(">", "&gt;")
    made = package(
        '<arg name="word" default="abc"/><arg name="number" default="3"/>\n'
        '<arg name="truth" default="true"/><arg name="lie" default="false"/>\n'
        f'<param name="a/b" type="str" value="$(eval {quoted})"/>\n'
        '<node pkg="rqt_graph" type="rqt_graph" name="a"/>'
    )
    if value is None:
        assert len(notes(made.port())) == 1
        return
    made.space.add("my_robot")
    found = process(made.plan() if "env" not in expression else _with_variable(made), "rqt_graph")
    assert found.parameters == {"b": value}


def _with_variable(package: Package) -> LaunchPlan:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HOME_OF_ROBOT", "/home/r")
        return package.plan()


@pytest.mark.slow
def test_parameters_reach_the_nodes_that_read_them(package: Any) -> None:
    plan = package(
        '<param name="use_all" value="true"/>\n'
        '<param name="one/rate" value="10"/>\n'
        '<rosparam ns="one">{gains: {p: 1.5}, names: [a, b]}</rosparam>\n'
        '<group ns="robot">\n'
        '  <rosparam param="limits">[1, 2.5]</rosparam>\n'
        '  <node pkg="rqt_graph" type="rqt_graph" name="two">\n'
        '    <param name="~text" type="str" value="1"/>\n'
        "  </node>\n"
        "</group>\n"
        '<node pkg="rqt_graph" type="rqt_graph" name="one" args="_x:=2 in:=out -s"/>\n'
    ).plan()
    two, one = plan.processes
    assert (one.name, one.namespace) == ("one", "")
    assert one.parameters == {
        "use_all": True,
        "rate": 10,
        "gains.p": 1.5,
        "names": ["a", "b"],
        "x": 2,
    }
    assert (one.arguments, one.remappings) == (("-s",), (("in", "out"),))
    assert (two.name, two.namespace) == ("two", "/robot")
    assert two.parameters == {"use_all": True, "limits": [1.0, 2.5], "text": "1"}


@pytest.mark.slow
def test_parameters_are_set_before_nodes_start(package: Any) -> None:
    """As by roslaunch: also those that stand behind a node, in a group or in another file."""
    plan = package(
        f"{PUBLISHER}\n"
        '<arg name="is_on" default="true"/>\n'
        '<include file="$(dirname)/upload.launch"/>\n'
        '<group if="$(arg is_on)"><param name="b" value="2"/></group>',
        launch__upload_dot_launch=f'<launch>{DESCRIBED}<param name="a" value="1"/></launch>',
    ).plan()
    found = process(plan, "robot_state_publisher")
    assert {**found.parameters, "robot_description": "..."} == {
        "robot_description": "...",
        "a": 1,
        "b": 2,
    }
    assert str(found.parameters["robot_description"]).endswith("</robot>\n")


@pytest.mark.slow
def test_an_argument_may_name_the_launch_file_that_is_included(package: Any) -> None:
    plan = package(
        f'<arg name="file" default="$(dirname)/upload.launch"/>\n{PUBLISHER}\n'
        '<include file="$(arg file)"/>',
        launch__upload_dot_launch=f"<launch>{DESCRIBED}</launch>",
    ).plan()
    assert "robot_description" in process(plan, "robot_state_publisher").parameters


YAML = """\
# of two nodes, and of all
one:
  rate: 10  # Hz
common: text
two: {names: [a, b]}
"""


@pytest.mark.slow
def test_files_of_parameters(package: Any) -> None:
    made = package(
        '<rosparam file="$(find my_robot)/config/all.yaml" command="load"/>\n'
        '<node pkg="rqt_graph" type="rqt_graph" name="one">\n'
        '  <rosparam file="$(find my_robot)/config/own.yaml" ns="inner"/>\n</node>\n'
        '<node pkg="rqt_graph" type="rqt_graph" name="two"/>',
        config__all_dot_yaml=YAML,
        config__own_dot_yaml="a: 1\nb:\n  c: x\n",
    )
    files = made.port().files
    assert files["config/all.yaml"] == (
        "/**:\n  ros__parameters:\n    # of two nodes, and of all\n    common: text\n"
        "/**/one:\n  ros__parameters:\n      rate: 10  # Hz\n"
        "/**/two:\n  ros__parameters: {names: [a, b]}\n"
    )
    assert files["config/own.yaml"] == (
        "/**:\n  ros__parameters:\n    inner:\n      a: 1\n      b:\n        c: x\n"
    )
    one, two = made.plan().processes
    assert one.parameters == {"common": "text", "rate": 10, "inner.a": 1, "inner.b.c": "x"}
    assert two.parameters == {"common": "text", "names": ["a", "b"]}


@pytest.mark.parametrize(
    ("yaml", "what"),
    [
        ("a: [[1, 2], [3]]", "config.yaml:1: A parameter is a list of lists"),
        ("a: 1\nb: [1, x]", "config.yaml:2: A parameter is a list of lists"),
        ("a: 1\nb:\n", "config.yaml:2: A parameter has no value."),
        ("c: {type: effort_controllers/JointPositionController}", "config.yaml has controllers"),
        ("- 1", "config.yaml has no names"),
        ("a: [", "config.yaml is not a file of parameters"),
        ("", "config.yaml is not a file of parameters"),
    ],
)
def test_what_parameters_cannot_be(package: Any, yaml: str, what: str) -> None:
    ported = package('<rosparam file="$(find my_robot)/config.yaml"/>', config_dot_yaml=yaml).port()
    assert not ported.files
    assert notes(ported)[0].startswith(f"2: {what}")


@pytest.mark.slow
def test_the_simulator_of_gazebo_sim(package: Any) -> None:
    plan = package(
        '<arg name="gui" default="false"/>\n'
        + GAZEBO.format(">\n")
        + '  <arg name="gui" value="$(arg gui)"/>\n'
        '  <arg name="world_name" value="$(find my_robot)/worlds/a.world"/>\n</include>\n'
        f"{DESCRIBED}\n{PUBLISHER}\n"
        '<node pkg="gazebo_ros" type="spawn_model" name="s" args="-urdf -model r -z 0.5 -param '
        'robot_description -unpause"/>',
        worlds__a_dot_world="<sdf version='1.6'/>",
    ).plan()
    (include,) = plan.includes
    assert include.file.name == "gz_sim.launch.py"
    words = include.arguments["gz_args"]
    assert words.startswith('-r -s "')
    assert words.endswith('/share/my_robot/worlds/a.world"')
    spawner = process(plan, "create")
    assert spawner.arguments == ("-topic", "robot_description", "-name", "r", "-z", "0.5")
    assert {one.parameters["use_sim_time"] for one in plan.processes} == {True}
    assert process(plan, "parameter_bridge").arguments == (
        "/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock",
    )


@pytest.mark.slow
def test_worlds_that_do_not_exist(package: Any) -> None:
    """The simulator starts with an empty one, and the line is listed."""
    worlds = {
        "a": "$(find my_robot)/worlds/gone.world",
        "b": "/home/ada/.gazebo/models/gone.world",
        "c": "$(find my_robot)/worlds/there.world",
        "d": "/home/ada/ws/src/my_robot/worlds/there.world",  # of another computer
    }
    arguments = "".join(f'<arg name="{key}" default="{path}"/>\n' for key, path in worlds.items())
    includes = "".join(
        f'{GAZEBO.format("")}><arg name="world_name" value="$(arg {key})"/></include>'
        for key in worlds
    )
    made = package(arguments + includes, worlds__there_dot_world="<sdf version='1.6'/>")
    ported = made.port()
    assert notes(ported) == [
        f"{line}: The world `{worlds[key]}` does not exist: the simulator starts with an empty one."
        for line, key in ((2, "a"), (3, "b"))
    ]
    declared = dict(re.findall(r"'([abcd])',\s+default_value=(.+)\),\n", ported.text or ""))
    assert declared["a"] == declared["b"] == "'empty.sdf'"
    assert declared["c"] == declared["d"]
    assert declared["c"].startswith("PathJoinSubstitution([share, 'worlds', 'there.world']")


def test_the_simulator_under_a_condition(package: Any) -> None:
    """Each start has its bridge; the remappings of a group end with it, its parameters do not."""
    group = (
        '<group {}="$(arg one)"><remap from="a" to="b"/>' + GAZEBO + "\n"
        '<arg name="paused" value="true"/><arg name="world_name" value="$(arg world)"/></include>'
        "</group>\n"
    )
    made = package(
        '<arg name="one" default="true"/><arg name="world" default="worlds/empty.world"/>\n'
        + group.format("if", ">")
        + group.format("unless", ">")
        + '<node pkg="gazebo_ros" type="spawn_model" name="s" args="-sdf -file '
        '$(find my_robot)/a.sdf -model a -unpause"/>'
    )
    for one in ("true", "false"):
        plan = made.plan(one=one)
        assert plan.includes[0].arguments["gz_args"] == '-r "empty.sdf"'
        bridge, spawner = plan.processes
        assert bridge.executable == "parameter_bridge"
        assert (bridge.remappings, spawner.remappings) == ((("a", "b"),), ())
        assert spawner.parameters["use_sim_time"] is True


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("$(find my_robot)/a/b.yaml", "PathJoinSubstitution([share, 'a', 'b.yaml'])"),
        (
            "$(dirname)/$(arg x)/b.yaml",
            "PathJoinSubstitution([ThisLaunchFileDir(), LaunchConfiguration('x'), 'b.yaml'])",
        ),
        ("$(find my_robot)/a_$(arg x).yaml", "[share, '/a_', LaunchConfiguration('x'), '.yaml']"),
        ("$(find my_robot)$(arg x)", "[share, LaunchConfiguration('x')]"),
        ("$(find my_robot)/a/", "[share, '/a/']"),
        ("$(find my_robot)", "share"),
        ("$(arg x)/", "[LaunchConfiguration('x'), '/']"),
        ("/$(arg x)/y", "['/', LaunchConfiguration('x'), '/y']"),
        ("", "''"),
    ],
)
def test_paths_and_texts(package: Any, text: str, code: str) -> None:
    """Parts of paths are joined; slashes of names and at ends stay."""
    ported = package(f'<arg name="x" default="{text}"/><arg name="y" default="$(arg x)"/>').port()
    call = next(
        one
        for one in ast.walk(ast.parse(str(ported.text)))
        if isinstance(one, ast.Call) and ast.unparse(one.func) == "DeclareLaunchArgument"
    )
    assert ast.unparse(call.keywords[0].value) == code


@pytest.mark.slow
def test_the_simulator_of_gazebo_classic(package: Any) -> None:
    plan = package(
        GAZEBO.format("/>\n")
        + f"{DESCRIBED}\n"
        + '<node pkg="gazebo_ros" type="spawn_model" name="s" args="-urdf -model r -param '
        'robot_description -unpause"/>',
        target="humble",
    ).plan()
    assert plan.includes[0].file.name == "gazebo.launch.py"
    assert process(plan, "spawn_entity.py").arguments == (
        *("-topic", "robot_description", "-entity", "r", "-unpause"),
    )
    # spawn_entity.py has no -param: somebody has to publish the robot.
    assert "robot_description" in process(plan, "robot_state_publisher").parameters


@pytest.mark.slow
@pytest.mark.parametrize("target", ["jazzy", "humble"])
def test_the_robot_with_what_the_simulator_needs(package: Any, target: str) -> None:
    """The template's file has it; spawners of ROS 2 do not expand xacro."""
    made = package(
        '<arg name="file" default="$(find my_robot)/urdf/r.urdf"/>\n'
        '<param name="other" textfile="$(arg file)"/>\n'
        '<node pkg="gazebo_ros" type="spawn_model" name="s" args="-urdf -model r -file '
        '$(find my_robot)/urdf/r.urdf"/>',
        target,
        model__robot_dot_xacro=URDF.replace('"r"', '"whole"'),
    )
    made.source = made.source._replace(
        robot="urdf/r.urdf", model="model/robot.xacro", entity="my_robot"
    )
    plan = made.plan()
    assert str(plan.arguments[0].default).endswith("/model/robot.xacro")
    if target == "humble":
        spawner = process(plan, "spawn_entity.py")
        assert spawner.arguments == ("-topic", "robot_description", "-entity", "my_robot")
        text = process(plan, "robot_state_publisher").parameters["robot_description"]
    else:
        spawner = process(plan, "create")
        assert (spawner.arguments[0], *spawner.arguments[2:]) == ("-string", "-name", "my_robot")
        text = spawner.arguments[1]
    assert '<robot name="whole">' in text


@pytest.mark.slow
def test_a_robot_in_a_parameter(package: Any) -> None:
    plan = package(
        f"{DESCRIBED}\n"
        '<node pkg="gazebo_ros" type="spawn_model" name="s" args="-param robot_description -urdf"/>'
    ).plan()
    spawner = process(plan, "create")
    assert spawner.arguments == ("-param", "robot_description")
    assert str(spawner.parameters["robot_description"]).endswith("</robot>\n")


def test_words_in_an_argument(package: Any) -> None:
    """ROS 2 splits the arguments of nodes before the values of launch arguments are known."""
    ported = package(
        '<arg name="more" default=""/><arg name="file" default="a b.xacro"/>\n'
        '<param name="d" command="$(find xacro)/xacro x/$(arg file) $(arg more)"/>\n'
        '<node pkg="rqt_graph" type="rqt_graph" name="a" args="$(arg more)"/>'
    ).port()
    assert "'xacro \"x/', LaunchConfiguration('file'), '\" ', LaunchConfiguration('more')" in str(
        ported.text
    )
    assert notes(ported) == [
        "4: `$(arg more)` held several words, or none; ROS 2 passes it as one."
    ]


@pytest.mark.parametrize(
    ("package_name", "words", "arguments"),
    [
        (
            "tf",
            "1 0 0 0.1 0 0 /base tool 100",
            "--x 1 --y 0 --z 0 --yaw 0.1 --pitch 0 --roll 0 --frame-id base --child-frame-id tool",
        ),
        (
            "tf2_ros",
            "1 0 0 0 0 0 1 base tool",
            "--x 1 --y 0 --z 0 --qx 0 --qy 0 --qz 0 --qw 1 --frame-id base --child-frame-id tool",
        ),
        ("tf", "1 0 0 base tool 100", None),
    ],
)
def test_static_transforms(
    package: Any, package_name: str, words: str, arguments: str | None
) -> None:
    made = package(
        f'<node pkg="{package_name}" type="static_transform_publisher" name="t" args="{words}"/>'
    )
    if arguments is None:
        assert notes(made.port()) == [
            "2: static_transform_publisher has 6 arguments: what each of them is, is not known."
        ]
    else:
        assert " ".join(process(made.plan(), "static_transform_publisher").arguments) == arguments


STAYS = "--times 1 --wait-matching-subscriptions 0 --qos-durability transient_local --keep-alive"


@pytest.mark.parametrize(
    ("words", "command"),
    [
        ("pub /on std_msgs/Bool true", f"{STAYS} 1000000 /on std_msgs/msg/Bool {{data: true}}"),
        ("pub -1 /on std_msgs/String a", "--once /on std_msgs/msg/String {data: a}"),
        (
            "pub -r 5 /v geometry_msgs/Twist '{linear: {x: 1}}'",
            "--rate 5 /v geometry_msgs/msg/Twist {linear: {x: 1}}",
        ),
        ("pub /v geometry_msgs/Twist '[1, 0, 0]' '[0, 0, 0]'", None),
        ("pub -f file /v geometry_msgs/Twist", None),
        ("list", None),
    ],
)
def test_topics(package: Any, words: str, command: str | None) -> None:
    made = package(f'<node pkg="rostopic" type="rostopic" name="t" args="{words}"/>')
    if command is None:
        assert len(notes(made.port())) == 1
    else:
        (found,) = made.plan().processes
        assert " ".join(found.command or ()) == f"ros2 topic pub {command}"
        assert "ros2topic" in made.port().packages


def test_what_is_listed(package: Any) -> None:
    made = package(
        '<node pkg="my_robot" type="driver" name="driver"/>\n'
        '<node pkg="my_robot" type="talk.py" name="talk"/>\n'
        '<node pkg="move_base" type="move_base" name="m"/>\n'
        '<node pkg="nobody_knows" type="it" name="it"/>\n'
        '<include file="$(find nobody_knows)/launch/it.launch"/>\n'
        '<include file="$(find my_robot)/launch/gone.launch"/>\n'
        '<machine name="m" address="a"/>\n'
        '<test test-name="t" pkg="a" type="b"/>\n'
        '<node pkg="controller_manager" type="spawner" name="c" args="arm --timeout 5"/>\n'
        '<param name="x" value="$(arg not_declared)"/>\n'
        '<node pkg="rqt_graph" type="rqt_graph" name="a-b" cwd="node"/>',
        scripts__talk_dot_py="#!/usr/bin/env python\nimport sys\nimport rospy\n",
    )
    ported = made.port()
    assert notes(ported) == [
        "2: The program `driver` of my_robot is compiled from code for ROS 1, or is not there.",
        "3: The program `talk.py` of my_robot is written for ROS 1 (scripts/talk.py:3).",
        "4: ROS 2 has no `move_base` of move_base with the same parameters.",
        "5: The package `nobody_knows` is not released for ROS 2 Jazzy.",
        "6: The package `nobody_knows` is not released for ROS 2 Jazzy.",
        "7: The launch file $(find my_robot)/launch/gone.launch does not exist.",
        "8: ROS 2 has no counterpart of <machine>.",
        "9: ROS 2 has no counterpart of <test>.",
        "10: The controllers arm are of ros_control.",
        "11: The launch file does not declare the argument `not_declared`.",
        "12: `a-b` cannot be the name of a node in ROS 2; it is `a_b` now.",
        "12: The node ran in the folder of its program.",
    ]
    assert all(one.advice.endswith(".") for one in ported.notes)
    assert [one.name for one in made.plan().processes] == ["a_b"]


HOSTILE = [
    "'); import os; os.system('x') #",
    '"""\\\n\n"""',
    "\\",
    "$(",
    "$(arg",
    "$(eval )",
    "$(eval '''",
    "$(find ../..)/x",
    "$(env $(arg x))",
    "#\x7f\u202e",
    "{{}}" * 500,
    "(" * 3000,
    "a" * 10_000,
]


@pytest.mark.parametrize("text", HOSTILE)
def test_texts_stay_texts(package: Any, text: str) -> None:
    """None of them gets into the code, and none of them stops the port."""
    for character, entity in (("&", "&amp;"), ("<", "&lt;"), ('"', "&quot;"), ("\n", "&#10;")):
        text = text.replace(character, entity)
    element = (
        f'<arg name="{text}" default="{text}" doc="{text}"/>\n'
        f'<node pkg="rqt_graph" type="rqt_graph" name="{text}" args="{text}" if="{text}">\n'
        f'  <param name="{text}" value="{text}"/><remap from="{text}" to="{text}"/>\n'
        f'  <rosparam param="{text}">{text}</rosparam>\n'
        f'  <rosparam file="{text}"/><env name="{text}" value="{text}"/>\n</node>\n'
        f'<include file="{text}"><arg name="{text}" value="{text}"/></include>\n'
        f'<group ns="{text}"><param name="{text}" command="{text}"/></group>\n'
        f'<!-- {text.replace("--", "")} --><param name="{text}" textfile="{text}"/>'
    )
    ported = package(element).port()
    assert ported.text is not None
    module = ast.parse(ported.text)
    calls = {ast.unparse(one.func) for one in ast.walk(module) if isinstance(one, ast.Call)}
    assert not calls & {"__import__", "eval", "exec", "os.system"}
    assert {type(one) for one in module.body} == {ast.Expr, ast.ImportFrom, ast.FunctionDef}
    assert all(one.line >= 1 and one.advice for one in ported.notes)


@pytest.mark.slow
def test_what_uses_an_argument_that_is_left_out(package: Any) -> None:
    made = package(
        '<arg name="file" default="$(find nobody_knows)/a.xacro"/>\n'
        '<param name="robot_description" command="$(find xacro)/xacro $(arg file)"/>\n' + PUBLISHER
    )
    assert [one.partition(":")[0] for one in notes(made.port())] == ["3", "2"]
    assert len(made.plan().processes) == 1


def test_launch_files_that_include_each_other(package: Any) -> None:
    ported = package('<include file="$(dirname)/a.launch"/>').port()
    assert "a.launch.py" in str(ported.text)


def test_launch_files_that_are_nested(package: Any) -> None:
    assert package("<group>" * 50 + PUBLISHER + "</group>" * 50).port().text is not None
    ported = package("<group>" * 250 + PUBLISHER + "</group>" * 250).port()
    assert notes(ported) == ["1: a.launch is nested too deeply."]


def test_what_was_printed_as_it_is_may_be_xacro_now(package: Any) -> None:
    """The robot's file is model/robot.xacro now, also where an argument names it."""
    made = package(
        '<arg name="file" default="$(find my_robot)/urdf/r.urdf"/>'
        '<param name="robot_description" command="cat $(arg file)"/>' + PUBLISHER
    )
    made.source = made.source._replace(robot="urdf/r.urdf", model="model/robot.xacro")
    text = made.port().text
    assert "PathJoinSubstitution([share, 'model', 'robot.xacro'])" in text
    assert "Command(['xacro \"', LaunchConfiguration('file'), '\"']" in text
