"""The substitutions of nav2_common, where it is not installed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from install_space import InstallSpace

BEFORE = """
from nav2_common.launch import (
    HasNodeParams, LaunchConfigAsBool, ParseMultiRobotPose, ReplaceString, RewrittenYaml
)
C = LaunchConfiguration
FILE = os.path.join(get_package_share_directory('my_robot'), 'p.yaml')
"""
FILE = """\
amcl:
  ros__parameters:
    {alpha: 0.2, frame: odom, use_sim_time: false, scan: {topic: /scan}, list: [1, 2]}
other:
  ros__parameters: {frame: odom, use_sim_time: false}
"""


def node(parameters: str, namespace: str = "") -> str:
    return (
        f"Node(package='nav2_amcl', executable='amcl', name='amcl', namespace='{namespace}', "
        f"parameters=[{parameters}])"
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rewrites", "changed"),
    [
        ("{}", {}),
        ("''", {}),
        ("{'use_sim_time': C('sim')}", {"use_sim_time": True}),
        ("{'frame': 'map', 'nowhere': 'x'}", {"frame": "map"}),
        ("{'alpha': '1'}, convert_types=True", {"alpha": 1}),
        ("{'alpha': '1.5'}, convert_types=True", {"alpha": 1.5}),
        ("{'alpha': '1.5'}", {"alpha": "1.5"}),
        ("{'amcl.ros__parameters.scan.topic': 'laser'}", {"scan.topic": "laser"}),
        ("{'amcl.ros__parameters.list.1': '7'}, convert_types=True", {"list": [1, 7]}),
        ("{'amcl.ros__parameters.new.one': 'x'}", {"new.one": "x"}),
        ("{}, key_rewrites={'frame': 'odom_frame'}", {"frame": None, "odom_frame": "odom"}),
        (
            "{}, value_rewrites={'odom': 'map', '2': '3'}, convert_types=True",
            {"frame": "map", "list": [1, 3]},
        ),
    ],
)
def test_a_rewritten_parameter_file(
    space: InstallSpace, rewrites: str, changed: dict[str, object]
) -> None:
    space.add("my_robot", {"p.yaml": FILE})
    plan = space.play(
        "DeclareLaunchArgument('sim', default_value='True'), "
        + node(f"RewrittenYaml(source_file=FILE, param_rewrites={rewrites})"),
        before=BEFORE,
    )
    assert not plan.diagnostics
    assert not plan.unresolved
    before = {
        "alpha": 0.2,
        "frame": "odom",
        "use_sim_time": False,
        "scan.topic": "/scan",
        "list": [1, 2],
    }
    wanted = {name: value for name, value in {**before, **changed}.items() if value is not None}
    assert plan.processes[0].parameters == wanted


@pytest.mark.slow
def test_a_namespace_around_a_parameter_file(space: InstallSpace) -> None:
    space.add("my_robot", {"p.yaml": FILE})
    rewritten = "RewrittenYaml(FILE, {}, root_key='robot1')"
    plan = space.play(node(rewritten, "robot1") + ", " + node(rewritten), before=BEFORE)
    assert plan.processes[0].namespace == "/robot1"
    assert plan.processes[0].parameters["alpha"] == 0.2
    assert plan.processes[1].parameters == {}


@pytest.mark.slow
def test_replaced_texts(space: InstallSpace) -> None:
    space.add("my_robot", {"p.yaml": FILE})
    replaced = "ReplaceString(FILE, {{'odom': C('frame')}}, condition={})"
    plan = space.play(
        "DeclareLaunchArgument('frame', default_value='map'), "
        + node(replaced.format("None"))
        + ", "
        + node(replaced.format("IfCondition('false')")),
        before=BEFORE,
    )
    assert [one.parameters["frame"] for one in plan.processes] == ["map", "odom"]


@pytest.mark.slow
def test_conditions_and_poses(space: InstallSpace) -> None:
    space.add("my_robot", {"p.yaml": FILE})
    poses = "ParseMultiRobotPose(C('robots')).perform(context).values()"
    plan = space.play(
        "DeclareLaunchArgument('on', default_value='yes'), "
        "ExecuteProcess(cmd=[HasNodeParams(FILE, 'amcl'), HasNodeParams(FILE, 'x'), "
        "LaunchConfigAsBool('on'), *ParseMultiRobotPose('robots').value()]), "
        "OpaqueFunction(function=lambda context: [ExecuteProcess(cmd=[str(pose['x']), "
        f"str(pose['yaw'])]) for pose in {poses}])",
        before=BEFORE,
        arguments={"robots": "a={x: 1.5, y: 1}; b={yaw: 2.0}"},
    )
    assert [one.command for one in plan.processes] == [
        ("True", "False", "True", "a", "b"),
        ("1.5", "0.0"),
        ("0.0", "2.0"),
    ]


@pytest.mark.slow
def test_files_that_are_not_here(space: InstallSpace) -> None:
    share = "FindPackageShare('nav2_bringup')"
    plan = space.play(
        node(f"RewrittenYaml([{share}, '/params/nav2_params.yaml'], {{}}), {{'a': 1}}"),
        before=BEFORE,
    )
    assert plan.processes[0].parameters == {"a": 1}
    assert not [one for one in plan.diagnostics if one.severity.name == "ERROR"]
    plan = space.play(node("RewrittenYaml('/nowhere.yaml', {})"), before=BEFORE)
    assert "/nowhere.yaml" in plan.diagnostics[0].message
