"""Where what a launch file starts is written, and which files its evaluation read."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

import pytest

from install_space import HEAD, InstallSpace
from wsgen.model.plan import LaunchPlan, Origin
from wsgen.reporting.json_report import render_plan

if TYPE_CHECKING:
    from pathlib import Path


pytestmark = pytest.mark.slow

PARAMETERS = """\
/**:
  ros__parameters:
    rate: 10
driver:
  ros__parameters:
    rate: 20
    wheel:
      radius:
        0.1
    names: [a,
            b]
"""


def plan_of(space: InstallSpace, file: Path, **arguments: str) -> LaunchPlan:
    return space.evaluate(file, arguments=arguments, with_origins=True)


def in_python(space: InstallSpace, body: str, **arguments: str) -> tuple[LaunchPlan, list[str]]:
    """The plan of a function's body, and the lines of the launch file."""
    text = f"{HEAD}\ndef generate_launch_description():\n{body}"
    share = space.add("my_robot", {"r.launch.py": text, "p.yaml": PARAMETERS})
    space.add_program("my_robot", "driver")
    return plan_of(space, share / "r.launch.py", **arguments), text.splitlines()


def lines(plan: LaunchPlan, file: str = "r.launch.py") -> dict[str, int | None]:
    """The lines of the parameters of the first process that are written in a file."""
    found = plan.processes[0].parameter_origins
    return {name: one.line for name, one in found.items() if one.file.name == file}


BODY = """\
    rates = {'slow': 1}
    return LaunchDescription([
        DeclareLaunchArgument('z', default_value='1'),
        DeclareLaunchArgument('y', default_value='2'),
        SetParameter('use_sim_time', True),
        SetRemap('scan', '/scan'),
        Node(
            package='my_robot',
            executable='driver',
            name='driver',
            arguments=[
                '-z', LaunchConfiguration('z'),
                '-q',
            ],
            parameters=[
                os.path.join(get_package_share_directory('my_robot'), 'p.yaml'),
                {
                    'plain': 1,
                    'from': LaunchConfiguration('z'),
                    'inner': {
                        'deep': 2,
                    },
                },
                rates,
            ],
            remappings=[
                ('a', 'b'),
                ('c', LaunchConfiguration('y')),
            ],
        ),
    ])
"""


def line_with(lines_of_file: list[str], text: str) -> int:
    (found,) = (number for number, line in enumerate(lines_of_file, 1) if text in line)
    return found


def test_of_a_python_file(space: InstallSpace) -> None:
    plan, text = in_python(space, BODY, z="7")
    node = plan.processes[0]
    assert lines(plan) == {
        "use_sim_time": line_with(text, "SetParameter("),
        "plain": line_with(text, "'plain'"),
        "from": line_with(text, "'from'"),
        "inner.deep": line_with(text, "'deep'"),
        "slow": line_with(text, "'slow'"),
    }
    # A section that is more special wins only because it is the last one; a value may be below its
    # key.
    assert lines(plan, "p.yaml") == {"rate": 6, "wheel.radius": 8, "names": 10}
    assert node.parameters["rate"] == 20
    z = line_with(text, "'-z'")
    assert [one and one.line for one in node.argument_origins] == [z, z, z + 1]
    assert [one and one.line for one in node.remapping_origins] == [
        line_with(text, "SetRemap("),
        line_with(text, "('a', 'b')"),
        line_with(text, "('c',"),
    ]


def test_who_sets_a_launch_argument(space: InstallSpace) -> None:
    child = f"""{HEAD}
def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument(name, default_value='0') for name in ('a', 'b', 'c', 'd')
    ])
"""
    parent = f"""{HEAD}
def generate_launch_description():
    return LaunchDescription([
        SetLaunchConfiguration('c', '1'),
        IncludeLaunchDescription(
            os.path.join(get_package_share_directory('my_robot'), 'child.launch.py'),
            launch_arguments={{'a': '1'}}.items(),
        ),
    ])
"""
    share = space.add("my_robot", {"child.launch.py": child, "parent.launch.py": parent})
    plan = plan_of(space, share / "parent.launch.py", b="2")
    include = line_with(parent.splitlines(), "IncludeLaunchDescription(")
    setting = line_with(parent.splitlines(), "SetLaunchConfiguration(")
    declared = Origin(
        file=share / "child.launch.py", line=line_with(child.splitlines(), "DeclareLaunch")
    )
    parents = share / "parent.launch.py"
    assert {one.name: (one.set_by, one.set_at) for one in plan.arguments} == {
        "a": ("include", Origin(file=parents, line=include)),
        "b": ("command line", None),
        "c": ("launch file", Origin(file=parents, line=setting)),
        "d": ("default", declared),
    }
    assert {one.origin for one in plan.arguments} == {declared}


XML = """\
<launch>
  <arg name="z"
       default="1"/>
  <set_parameter name="use_sim_time" value="true"/>
  <node pkg="my_robot" exec="driver" name="driver" args="-z $(var z)">
    <param name="plain" value="1"/>
    <param from="$(find-pkg-share my_robot)/p.yaml"/>
    <param name="inner">
      <param name="deep" value="$(var z)"/>
    </param>
    <remap from="a" to="b"/>
  </node>
</launch>
"""
YAML = """\
launch:
- arg:
    name: z
    default: '1'
- set_parameter:
    name: use_sim_time
    value: true
- node:
    pkg: my_robot
    exec: driver
    name: driver
    args: -z $(var z)
    param:
    - name: plain
      value: 1
    - from: $(find-pkg-share my_robot)/p.yaml
    - name: inner
      param:
      - name: deep
        value: $(var z)
    remap:
    - from: a
      to: b
"""


@pytest.mark.parametrize(
    ("name", "text", "places", "remapping"),
    [
        ("r.launch.xml", XML, {"use_sim_time": 4, "plain": 6, "inner.deep": 9}, 11),
        ("r.launch.yaml", YAML, {"use_sim_time": 5, "plain": 14, "inner.deep": 19}, 22),
    ],
)
def test_of_other_formats(
    space: InstallSpace, name: str, text: str, places: dict[str, int], remapping: int
) -> None:
    share = space.add("my_robot", {name: text, "p.yaml": PARAMETERS})
    space.add_program("my_robot", "driver")
    plan = plan_of(space, share / name)
    assert lines(plan, name) == places
    assert lines(plan, "p.yaml") == {"rate": 6, "wheel.radius": 8, "names": 10}
    assert plan.processes[0].remapping_origins == (Origin(file=share / name, line=remapping),)
    assert {one.set_by for one in plan.arguments} == {"default"}


def test_of_a_file_that_is_rewritten(space: InstallSpace) -> None:
    body = """\
    from nav2_common.launch import RewrittenYaml
    file = os.path.join(get_package_share_directory('my_robot'), 'p.yaml')
    return LaunchDescription([
        Node(
            package='my_robot',
            executable='driver',
            name='driver',
            parameters=[RewrittenYaml(source_file=file, param_rewrites={'rate': '30'})],
        ),
    ])
"""
    plan, _ = in_python(space, body)
    assert plan.processes[0].parameters["rate"] == "30"
    assert lines(plan, "p.yaml") == {"rate": 6, "wheel.radius": 8, "names": 10}
    assert [(one.path.name, one.use) for one in plan.files] == [
        ("p.yaml", "parameters"),
        ("r.launch.py", "launch file"),
    ]


def test_of_nodes_in_a_container(space: InstallSpace) -> None:
    body = """\
    from launch_ros.descriptions import ComposableNode
    return LaunchDescription([
        ComposableNodeContainer(
            name='c',
            namespace='',
            package='my_robot',
            executable='driver',
            composable_node_descriptions=[
                ComposableNode(
                    package='p',
                    plugin='P',
                    parameters=[{'x': 1}],
                    remappings=[('a', 'b')],
                ),
            ],
        ),
    ])
"""
    plan, text = in_python(space, body)
    node = plan.processes[1]
    assert node.parameter_origins["x"].line == line_with(text, "{'x': 1}")
    (remapping,) = node.remapping_origins
    assert remapping is not None
    assert remapping.line == line_with(text, "('a', 'b')")


def test_the_files_that_are_read(space: InstallSpace) -> None:
    share = space.add(
        "my_robot",
        {
            "r.xacro": '<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro">\n'
            '<xacro:include filename="part.xacro"/></robot>',
            "part.xacro": "<part/>",
            "notes.txt": "of the launch file",
            "bridge.yaml": "[]",
            "worlds/w.sdf": "<sdf/>",
            "helper.py": "SPEED = 1",
        },
    )
    body = f"""\
    import sys
    sys.path.insert(0, {str(share)!r})
    import helper
    share = get_package_share_directory('my_robot')
    open(os.path.join(share, 'notes.txt')).read()
    os.environ['GZ_SIM_RESOURCE_PATH'] = share
    return LaunchDescription([
        ExecuteProcess(cmd=['gz', 'sim', '-r w.sdf']),
        Node(
            package='my_robot',
            executable='driver',
            parameters=[{{
                'config_file': share + '/bridge.yaml',
                'robot_description': Command(['xacro ', share, '/r.xacro']),
            }}],
        ),
    ])
"""
    plan, _ = in_python(space, body)
    assert [(str(one.path.relative_to(share)), one.use) for one in plan.files] == [
        ("bridge.yaml", "given"),
        ("helper.py", "module"),
        ("notes.txt", "read"),
        ("part.xacro", "read"),
        ("r.launch.py", "launch file"),
        ("r.xacro", "read"),
        ("worlds/w.sdf", "given"),
    ]
    assert {one.path.name: one.sha256 for one in plan.files} == {
        one.path.name: hashlib.sha256(one.path.read_bytes()).hexdigest() for one in plan.files
    }


def test_two_evaluations_give_the_same_bytes(space: InstallSpace) -> None:
    first, _ = in_python(space, BODY)
    second = plan_of(space, first.launch_file)
    texts = {render_plan(one) for one in (first, second)}
    assert len(texts) == 1
    # Another content is another text.
    (first.launch_file.parent / "p.yaml").write_text(PARAMETERS + "# one more line\n")
    assert render_plan(plan_of(space, first.launch_file)) not in texts


def test_nothing_is_noted_unless_somebody_asks(space: InstallSpace) -> None:
    first, _ = in_python(space, BODY)
    plan = space.evaluate(first.launch_file)
    (node,) = plan.processes
    assert plan.files == ()
    assert (node.parameter_origins, node.argument_origins, node.remapping_origins) == ({}, (), ())
    assert node.parameters == first.processes[0].parameters
