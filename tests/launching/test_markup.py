"""Launch files in XML and YAML give the plan of the Python file that says the same."""

from __future__ import annotations

from textwrap import dedent
from typing import TYPE_CHECKING

import pytest

from install_space import InstallSpace, essence, only_message

if TYPE_CHECKING:
    from wsgen.model.plan import LaunchPlan


pytestmark = pytest.mark.slow


@pytest.fixture
def robot(space: InstallSpace) -> InstallSpace:
    space.add(
        "my_robot",
        {
            "r.xacro": "<robot name='r'><!-- a: b --></robot>",
            "config/p.yaml": "/**: {ros__parameters: {rate: 10}}\n",
            "config/s.yaml": "/**: {ros__parameters: {where: $(var place)}}\n",
            "launch/child.launch.xml": "<launch><arg name='c' default='d'/>"
            "<executable cmd='echo $(var c)'/></launch>",
        },
    )
    space.add_program("my_robot", "driver")
    return space


def python(space: InstallSpace, text: str) -> LaunchPlan:
    return space.play(
        dedent(text),
        before="from launch_ros.descriptions import ComposableNode\n"
        "from launch_ros.actions import PushROSNamespace as Push\n"
        "D = lambda **k: Node(package='my_robot', executable='driver', **k)\n"
        "V = LaunchConfiguration\nE = lambda *words, **k: ExecuteProcess(cmd=list(words), **k)",
    )


def markup(space: InstallSpace, text: str, form: str = "xml") -> LaunchPlan:
    share = space.add("my_robot", {f"launch/m.launch.{form}": text})
    return space.evaluate(share / "launch" / f"m.launch.{form}")


SAME = {
    "arg and var": (
        """
        DeclareLaunchArgument('a', default_value='1', description='d'), DeclareLaunchArgument('b',
        default_value=['x', V('a')]), E('echo', V('b'), V('c', default='e'))
        """,
        """
        <arg name="a" default="1" description="d"/><arg name="b" default="x$(var a)"/>
        <executable cmd="echo $(var b) $(var c e)"/>
        """,
    ),
    "choices": (
        """
        DeclareLaunchArgument('a', default_value='x', choices=['x', 'y'])
        """,
        """
        <arg name="a" default="x"><choice value="x"/><choice value="y"/></arg>
        """,
    ),
    "let and unset": (
        """
        SetLaunchConfiguration('a', '1'), E('echo', V('a')), UnsetLaunchConfiguration('a'),
        E('echo', V('a', default='no'))
        """,
        """
        <let name="a" value="1"/><executable cmd="echo $(var a)"/><unset name="a"/>
        <executable cmd="echo $(var a no)"/>
        """,
    ),
    "executable": (
        """
        ExecuteProcess(cmd=['my prog', '-x', [V('a', default='v'), 'w'], 'z z'], name='n',
        cwd='/tmp', additional_env={'A': 'b'}, prefix='xterm -e', shell=True, output='screen')
        """,
        """
        <executable cmd="'my prog' -x $(var a v)w 'z z'" name="n" cwd="/tmp" shell="true"
        launch-prefix="xterm -e" output="screen"><env name="A" value="b"/></executable>
        """,
    ),
    "node": (
        """
        D(name='n', namespace='s', arguments=['-x', '1'], exec_name='e', respawn=True,
        remappings=[('a', 'b'), ('c', V('d', default='e'))], output='log', emulate_tty=True)
        """,
        """
        <node pkg="my_robot" exec="driver" name="n" namespace="s" args="-x 1" exec_name="e"
        respawn="true" output="log" emulate_tty="true">
        <remap from="a" to="b"/><remap from="c" to="$(var d e)"/></node>
        """,
    ),
    "parameters": (
        """
        D(parameters=[{'i': 1, 'f': 1.5, 'b': True, 's': 'x', 'l': [1, 2], 'q': '1', 'e': '',
        'none': ParameterValue(V('i', default=''))}, {'n': {'a': 1, 'm': {'b': 'c'}}},
        {'v': ParameterValue(V('i', default='7'))},
        {'t': ParameterValue(V('i', default='7'), value_type=str)}, {'list': ['p', 'q']},
        FindPackageShare('my_robot').find('my_robot') + '/config/p.yaml', {'last': '1e-3'}])
        """,
        """
        <node pkg="my_robot" exec="driver"><param name="i" value="1"/>
        <param name="f" value="1.5"/>
        <param name="b" value="true"/><param name="s" value="x"/><param name="l" value="[1, 2]"/>
        <param name="q" value="1" type="str"/><param name="e" value=""/>
        <param name="none" value="$(var i '')"/>
        <param name="n"><param name="a" value="1"/><param name="m"><param name="b" value="c"/>
        </param></param><param name="v" value="$(var i 7)"/>
        <param name="t" value="$(var i 7)" type="str"/>
        <param name="list" value="p;q" value-sep=";"/>
        <param from="$(find-pkg-share my_robot)/config/p.yaml"/><param name="last" value="1e-3"/>
        </node>
        """,
    ),
    "parameter file with substitutions": (
        """
        SetLaunchConfiguration('place', 'here'),
        D(parameters=[ParameterFile([FindPackageShare('my_robot'), '/config/s.yaml'],
        allow_substs=True)])
        """,
        """
        <let name="place" value="here"/><node pkg="my_robot" exec="driver">
        <param from="$(find-pkg-share my_robot)/config/s.yaml" allow_substs="true"/></node>
        """,
    ),
    "robot description": (
        """
        D(parameters=[{'robot_description': ParameterValue(Command(['xacro ',
        FindPackageShare('my_robot'), '/r.xacro']), value_type=str)}])
        """,
        """
        <node pkg="my_robot" exec="driver"><param name="robot_description" type="str"
        value="$(command 'xacro $(find-pkg-share my_robot)/r.xacro')"/></node>
        """,
    ),
    "group and namespace": (
        """
        SetLaunchConfiguration('a', '0'), GroupAction([Push('g'), D(), SetLaunchConfiguration('a',
        '1')]), GroupAction([Push('h'), D()], scoped=False), D(), E('echo', V('a'))
        """,
        """
        <let name="a" value="0"/><group><push-ros-namespace namespace="g"/>
        <node pkg="my_robot" exec="driver"/><let name="a" value="1"/></group>
        <group scoped="false"><push_ros_namespace namespace="h"/>
        <node pkg="my_robot" exec="driver"/>
        </group><node pkg="my_robot" exec="driver"/><executable cmd="echo $(var a)"/>
        """,
    ),
    "group that forwards nothing": (
        """
        SetLaunchConfiguration('a', '0'), GroupAction([E('echo', V('a', default='no'), V('k'))],
        forwarding=False, launch_configurations={'k': V('a')})
        """,
        """
        <let name="a" value="0"/><group forwarding="false"><keep name="k" value="$(var a)"/>
        <executable cmd="echo $(var a no) $(var k)"/></group>
        """,
    ),
    "conditions": (
        """
        SetLaunchConfiguration('a', 'true'), E('1', condition=IfCondition(V('a'))), E('2',
        condition=UnlessCondition(V('a'))), GroupAction([E('3')],
        condition=IfCondition(PythonExpression(['"', V('a'), '" == "true"'])))
        """,
        """
        <let name="a" value="true"/><executable cmd="1" if="$(var a)"/>
        <executable cmd="2" unless="$(var a)"/>
        <group if="$(eval '&quot;$(var a)&quot; == &quot;true&quot;')">
        <executable cmd="3"/></group>
        """,
    ),
    "include": (
        """
        IncludeLaunchDescription([FindPackageShare('my_robot'), '/launch/child.launch.xml'],
        launch_arguments={'c': 'x'}.items()),
        IncludeLaunchDescription([FindPackageShare('gazebo_ros'), '/launch/gazebo.launch.py'],
        launch_arguments={'gui': V('no', default='false')}.items()), E('echo', V('pause'))
        """,
        """
        <include file="$(find-pkg-share my_robot)/launch/child.launch.xml">
        <arg name="c" value="x"/></include>
        <include file="$(find-pkg-share gazebo_ros)/launch/gazebo.launch.py">
        <arg name="gui" value="$(var no false)"/></include><executable cmd="echo $(var pause)"/>
        """,
    ),
    "environment": (
        """
        SetEnvironmentVariable('A', '1'), AppendEnvironmentVariable('A', '2'),
        AppendEnvironmentVariable('A', '3', prepend=True, separator=';'), E('echo',
        EnvironmentVariable('A'), EnvironmentVariable('NO', default_value='n')),
        UnsetEnvironmentVariable('A'), SetEnvironmentVariable('B', 'b')
        """,
        """
        <set_env name="A" value="1"/><append_env name="A" value="2"/>
        <append_env name="A" value="3" prepend="true" separator=";"/>
        <executable cmd="echo $(env A) $(env NO n)"/><unset_env name="A"/>
        <set_env name="B" value="b"/>
        """,
    ),
    "substitutions": (
        """
        E(ThisLaunchFileDir(), FindPackagePrefix('my_robot'), ExecutableInPackage('driver',
        'my_robot'), FindExecutable(name='sh'), AnonName('n'), AnonName('n'), Command(['date']),
        NotSubstitution('true'), AndSubstitution('true', 'false'), IfElseSubstitution('1', 'y',
        'n'), EqualsSubstitution('1', '1.0'), PythonExpression(['2 * pi > 6']))
        """,
        """
        <executable cmd="$(dirname) $(find-pkg-prefix my_robot) $(exec-in-pkg driver my_robot)
        $(find-exec sh) $(anon n) $(anon n) $(command date) $(not true) $(and true false)
        $(if 1 y n) $(equals 1 1.0) $(eval '2 * pi &gt; 6')"/>
        """,
    ),
    "timer": (
        """
        TimerAction(period=2.5, actions=[E('a'), E('b')]), TimerAction(period=V('p', default='1'),
        actions=[E('c')]), RosTimer(period=3.0, actions=[E('d')])
        """,
        """
        <timer period="2.5"><executable cmd="a"/><executable cmd="b"/></timer>
        <timer period="$(var p 1)"><executable cmd="c"/></timer>
        <ros_timer period="3.0"><executable cmd="d"/></ros_timer>
        """,
    ),
    "set parameter and remap": (
        """
        SetParameter('a', 1), SetParameter('s', V('x', default='y')), SetRemap('p', 'q'),
        SetUseSimTime(True), D(parameters=[{'b': 2}]),
        SetParametersFromFile([FindPackageShare('my_robot'), '/config/p.yaml']), D()
        """,
        """
        <set_parameter name="a" value="1"/><set_parameter name="s" value="$(var x y)"/>
        <set_remap from="p" to="q"/><set_use_sim_time value="true"/>
        <node pkg="my_robot" exec="driver"><param name="b" value="2"/></node>
        <set_parameters_from_file filename="$(find-pkg-share my_robot)/config/p.yaml"/>
        <node pkg="my_robot" exec="driver"/>
        """,
    ),
    "composable nodes": (
        """
        Push('g'), ComposableNodeContainer(package='rclcpp_components',
        executable='component_container', name='box', namespace='',
        composable_node_descriptions=[ComposableNode(package='p', plugin='p::A', name='a',
        parameters=[{'x': 1}], remappings=[('i', 'o')])]),
        LoadComposableNodes(target_container='/g/box',
        composable_node_descriptions=[ComposableNode(package='p', plugin='p::B', name='b',
        namespace='n')])
        """,
        """
        <push-ros-namespace namespace="g"/>
        <node_container pkg="rclcpp_components" exec="component_container" name="box" namespace="">
        <composable_node pkg="p" plugin="p::A" name="a"><param name="x" value="1"/>
        <remap from="i" to="o"/><extra_arg name="use_intra_process_comms" value="true"/>
        </composable_node></node_container>
        <load_composable_node target="/g/box">
        <composable_node pkg="p" plugin="p::B" name="b" namespace="n"/></load_composable_node>
        """,
    ),
    "loops": (
        """
        *[E('echo', str(i)) for i in range(2)], E('echo', 'x', '1'), E('echo', 'y', 'none')
        """,
        """
        <for len="2" name="i"><executable cmd="echo $(index i)"/></for>
        <for_each values="{n: x, v: 1};{n: y}">
        <executable cmd="echo $(for-var n) $(for-var v none)"/></for_each>
        """,
    ),
    "shutdown": (
        """
        E('x', on_exit=[Shutdown()]), LogInfo(msg=['m', V('a', default='b')])
        """,
        """
        <executable cmd="x" on_exit="shutdown"/><log message="m$(var a b)"/>
        """,
    ),
}


@pytest.mark.parametrize("name", SAME)
def test_xml_says_the_same_as_python(robot: InstallSpace, name: str) -> None:
    text, same = SAME[name]
    wanted = essence(python(robot, text))
    found = essence(markup(robot, f"<launch>\n{dedent(same)}\n</launch>"))
    assert found == wanted


YAML = """\
launch:
- arg: {name: a, default: '1', description: d}
- let: {name: b, value: $(var a)2}
- set_env: {name: A, value: $(var b)}
- group:
  - push_ros_namespace: {namespace: g}
  - node:
      pkg: my_robot
      exec: driver
      name: n
      args: -x $(var a)
      param:
      - {name: i, value: 1}
      - {name: s, value: '1'}
      - {name: l, value: [1.5, 2.5]}
      - {name: t, value: $(var b), type: str}
      - name: n
        param:
        - {name: m, value: true}
      - {from: $(find-pkg-share my_robot)/config/p.yaml}
      remap:
      - {from: p, to: q}
      env:
      - {name: E, value: $(env A)}
- group:
    scoped: false
    if: $(eval '$(var a) == 1')
    children:
    - timer:
        period: 2
        children:
        - executable: {cmd: echo $(var b)}
- include:
    file: $(find-pkg-share my_robot)/launch/child.launch.xml
    arg:
    - {name: c, value: x}
- node_container:
    pkg: rclcpp_components
    exec: component_container
    name: box
    namespace: ''
    composable_node:
    - {pkg: p, plugin: 'p::A', name: a}
"""
YAML_IN_PYTHON = """
DeclareLaunchArgument('a', default_value='1', description='d'),
SetLaunchConfiguration('b', [V('a'), '2']), SetEnvironmentVariable('A', V('b')),
GroupAction([Push('g'), D(name='n', arguments=['-x', V('a')], parameters=[{'i': 1, 's': '1',
'l': [1.5, 2.5], 't': ParameterValue(V('b'), value_type=str), 'n': {'m': True}},
FindPackageShare('my_robot').find('my_robot') + '/config/p.yaml'], remappings=[('p', 'q')],
additional_env={'E': EnvironmentVariable('A')})]),
GroupAction([TimerAction(period=2.0, actions=[E('echo', V('b'))])], scoped=False),
IncludeLaunchDescription([FindPackageShare('my_robot'), '/launch/child.launch.xml'],
launch_arguments={'c': 'x'}.items()),
ComposableNodeContainer(package='rclcpp_components', executable='component_container', name='box',
namespace='', composable_node_descriptions=[ComposableNode(package='p', plugin='p::A', name='a')]),
"""


@pytest.mark.parametrize("form", ["yaml", "yml"])
def test_yaml_says_the_same_as_python(robot: InstallSpace, form: str) -> None:
    assert essence(markup(robot, YAML, form)) == essence(python(robot, YAML_IN_PYTHON))


def test_lines_of_xml_and_yaml(robot: InstallSpace) -> None:
    plan = markup(robot, '<launch>\n\n<executable\n cmd="a"/>\n<executable cmd="b"/></launch>')
    assert [(one.file and one.file.name, one.line) for one in plan.processes] == [
        ("m.launch.xml", 3),
        ("m.launch.xml", 5),
    ]
    plan = markup(robot, "launch:\n- executable:\n    cmd: a\n\n- executable: {cmd: b}\n", "yaml")
    assert [one.line for one in plan.processes] == [2, 5]


def test_xml_included_from_python(robot: InstallSpace) -> None:
    plan = python(
        robot,
        "IncludeLaunchDescription(__import__('launch_xml.launch_description_sources', "
        "fromlist=['x']).XMLLaunchDescriptionSource([FindPackageShare('my_robot'), "
        "'/launch/child.launch.xml'])), IncludeLaunchDescription(FrontendLaunchDescriptionSource("
        "[ThisLaunchFileDir(), '/child.launch.xml']), launch_arguments={'c': 'e'}.items())",
    )
    assert not plan.diagnostics
    assert [one.command for one in plan.processes] == [("echo", "d"), ("echo", "e")]
    assert [one.file.name for one in plan.includes] == ["child.launch.xml"] * 2


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("$(var a)", ["<a>"]),
        (r"\$(var a) \\x", ["$(var a) \\x"]),
        ('it\'s "so"', ['it\'s "so"']),
        ("x$(var a)y", ["x", "<a>", "y"]),
        ("$(var 'a b')", ["<a b>"]),
        ("$(var $(var a))", ["<<a>>"]),
        ("$(env '$(var a) b' c)", ["<<a> b>"]),
        (r"$(var a\)b)", ["<a)b>"]),
        (r"$(var 'it\'s')", ["<it's>"]),
        ("$(env A '')", ["<A>"]),
    ],
)
def test_templates(space: InstallSpace, text: str, found: list[str]) -> None:
    plan = space.play(
        "*[ExecuteProcess(cmd=[text(part)]) for part in parse_substitution(TEXT)]",
        before=f"""
        from launch.frontend.template import parse_substitution
        TEXT = {text!r}
        def text(part):
            if isinstance(part, TextSubstitution):
                return part.text
            name = getattr(part, 'variable_name', None) or part.name
            return '<' + ''.join(text(one) for one in name) + '>'
        """,
    )
    assert not plan.diagnostics
    assert [one.command for one in plan.processes] == [(one,) for one in found]


@pytest.mark.parametrize(
    ("text", "code", "message", "line"),
    [
        ("<launch>\n<node>\n</launch>", "LCH023", "<node> is not closed", 2),
        ("", "LCH023", "the file is empty", 1),
        ("<launch>\n<nod pkg='a'/></launch>", "LCH010", "Unrecognized entity of the type: nod", 2),
        ("<robot/>", "LCH010", "Expected 'launch' as root tag", 1),
        ("<launch><let name='a' valu='b'/></launch>", "LCH010", "'value' of type", 1),
        (
            "<launch><executable cmd='a' foo='b'/></launch>",
            "LCH010",
            "Unexpected attribute(s) found in `executable`: {'foo'}",
            1,
        ),
        (
            "<launch><executable cmd='a'><foo/></executable></launch>",
            "LCH010",
            "Unexpected nested tag(s) found in `executable`: {'foo'}",
            1,
        ),
        (
            "<launch>\n<executable cmd='a' if='1' unless='1'/></launch>",
            "LCH010",
            "can't be used simultaneously",
            2,
        ),
        ("<launch>\n<log message='$(vr a)'/></launch>", "LCH010", "Unknown substitution: vr", 2),
        ("<launch>\n<log message='$(var a'/></launch>", "LCH010", "')' is missing", 2),
        ("<launch>\n<log message='$(var)'/></launch>", "LCH010", "is given 0", 2),
        ("<launch>\n<log message='a$b'/></launch>", "LCH010", "must be written as", 2),
        ("<launch>\n<log message='$(var a)'/></launch>", "LCH009", "'a' does not exist", 2),
        (
            "<launch>\n<node pkg='no_such' exec='a'/></launch>",
            "LCH007",
            "'no_such' is not found",
            2,
        ),
        (
            "<launch><arg name='a'/></launch>",
            "LCH006",
            "'a' has no default",
            None,
        ),
        (
            (
                "<launch>\n<node pkg='my_robot' exec='driver'>"
                "<param name='a' value='x' type='int'/></node></launch>"
            ),
            "LCH010",
            "not an instance of <class 'int'>",
            2,
        ),
        ("<launch>\n<timer period='soon'/></launch>", "LCH010", "could not convert", 2),
    ],
)
def test_what_is_wrong_with_xml(
    robot: InstallSpace, text: str, code: str, message: str, line: int | None
) -> None:
    plan = markup(robot, text)
    assert message in only_message(plan, code)
    (diagnostic,) = plan.diagnostics
    assert diagnostic.file is not None
    assert (diagnostic.file.name, diagnostic.line) == ("m.launch.xml", line)


@pytest.mark.parametrize(
    ("text", "code", "message", "line"),
    [
        ("launch:\n- let: {name: a\n", "LCH023", "not YAML", 3),
        ("", "LCH023", "must have the one key 'launch'", 1),
        ("a: 1\nb: 2\n", "LCH023", "must have the one key 'launch'", 1),
        ("launch:\n- let: {name: a, value: 1}\n", "LCH010", "got '<class 'int'>'", 2),
        ("launch:\n- let: {name: a, value: b}\n  log: {}\n", "LCH010", "one root", None),
        ("launch:\n- let: {name: a, value: b, c: d}\n", "LCH010", "Unexpected key(s)", 2),
        ("launch:\n- group: {scoped: true}\n", "LCH010", "to have children entities", 2),
        ("launch: 1\n", "LCH010", "to be a list", None),
        ("launch: 2024-13-40\n", "LCH023", "month must be in", 1),
        ("launch:\n- arg:\n    name: 2024-13-40\n", "LCH023", "has the form of a date", 3),
        ("launch: !!python/object/apply:os.getcwd []\n", "LCH023", "could not determine", 1),
    ],
)
def test_what_is_wrong_with_yaml(
    robot: InstallSpace, text: str, code: str, message: str, line: int | None
) -> None:
    plan = markup(robot, text, "yaml")
    assert message in only_message(plan, code)
    (diagnostic,) = plan.diagnostics
    assert diagnostic.file is not None
    assert (diagnostic.file.name, diagnostic.line) == ("m.launch.yaml", line)


@pytest.mark.parametrize(
    ("text", "suffix", "hint"),
    [
        ("<launch>\n<node pkg='a'", "xml", "Add `>`, or close the quotes."),
        ("launch: [", "yaml", "indentation, colons, quotes, brackets."),
        ("a: 1\nb: 2\n", "yaml", "Write `launch:` at the top"),
    ],
)
def test_the_hint_is_about_what_is_wrong(
    robot: InstallSpace, text: str, suffix: str, hint: str
) -> None:
    (found,) = markup(robot, text, suffix).diagnostics
    assert hint in (found.hint or "")


def test_a_description_read_as_yaml_is_warned_of(robot: InstallSpace) -> None:
    plan = markup(
        robot,
        '<launch><node pkg="my_robot" exec="driver"><param name="robot_description" '
        "value=\"$(command 'echo &lt;robot/&gt;')\"/></node></launch>",
    )
    assert plan.processes[0].parameters == {"robot_description": "<robot/>"}
    only_message(plan, "LCH016")
    assert plan.diagnostics[0].hint == 'Add type="str" to the <param>.'


def test_entities_that_multiply(robot: InstallSpace) -> None:
    entities = "".join(
        f'<!ENTITY e{n} "{f"&e{n - 1};" * 10 if n else "lol" * 1000}">' for n in range(12)
    )
    text = f"<!DOCTYPE launch [{entities}]><launch><log message='&e11;'/></launch>"
    plan = markup(robot, text)
    assert "not well-formed XML" in only_message(plan, "LCH023")


def test_only_what_is_met_is_imported(robot: InstallSpace) -> None:
    text = (
        "import sys\nfrom launch import LaunchDescription\n"
        "from launch.actions import ExecuteProcess\n"
        "def generate_launch_description():\n"
        "    return LaunchDescription([ExecuteProcess(cmd=[' '.join(sys.modules)])])\n"
    )
    share = robot.add("my_robot", {"launch/small.launch.py": text})
    (process,) = robot.evaluate(share / "launch" / "small.launch.py").processes
    assert process.command is not None
    loaded = set(process.command[0].split())
    assert not {"launch.frontend", "yaml"} & loaded
