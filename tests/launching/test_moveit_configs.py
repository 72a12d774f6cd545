"""The robots of MoveIt packages, where moveit_configs_utils and what it uses are not installed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from install_space import only_message

if TYPE_CHECKING:
    from install_space import InstallSpace

ROBOT = """\
<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="size" default="1"/><link name="of_$(arg size)"/>
</robot>
"""
ASSISTANT = """\
moveit_setup_assistant_config:
  urdf: {package: my_robot, relative_path: urdf/r.xacro, xacro_args: "size:=2"}
  srdf: {relative_path: config/groups.srdf}
"""
BEFORE = """
from moveit_configs_utils import MoveItConfigsBuilder
config = {}
"""
PUBLISHER = "Node(package='robot_state_publisher', executable='robot_state_publisher', {})"


@pytest.fixture
def moveit(space: InstallSpace) -> InstallSpace:
    space.add("my_robot", {"urdf/r.xacro": ROBOT})
    space.add(
        "my_moveit_config",
        {
            ".setup_assistant": ASSISTANT,
            "config/groups.srdf": '<robot name="r"/>',
            "config/other.xacro": ROBOT.replace("of_", "other_"),
        },
    )
    return space


@pytest.mark.slow
@pytest.mark.parametrize(
    ("builder", "link"),
    [
        ("('my')", "of_2"),
        ("('x', package_name='my_moveit_config')", "of_2"),
        ("('my').robot_description(mappings={'size': '3'}).planning_pipelines(['a'])", "of_3"),
        (
            "('my').robot_description(mappings={'size': LaunchConfiguration('n', default='4')})",
            "of_4",
        ),
        (
            "('my').moveit_cpp('no').robot_description('config/other.xacro', {'size': '5'})",
            "other_5",
        ),
    ],
)
def test_the_robot_of_a_package(moveit: InstallSpace, builder: str, link: str) -> None:
    whole = "Node(package='moveit_ros_move_group', executable='move_group', parameters=[{}])"
    plan = moveit.play(
        f"{PUBLISHER.format('parameters=[config.robot_description]')}, "
        f"{whole.format('config.to_dict()')}",
        before=BEFORE.format(f"MoveItConfigsBuilder{builder}.to_moveit_configs()"),
    )
    assert not plan.diagnostics
    publisher, planner = plan.processes
    assert f'<link name="{link}"' in publisher.parameters["robot_description"]
    assert publisher.description_file is not None
    assert publisher.description_file.suffix == ".xacro"
    assert '<robot name="r"/>' in planner.parameters["robot_description_semantic"]
    assert planner.parameters["planning_pipelines"].startswith("$(moveit_configs_utils")
    assert "moveit_configs_utils" in {one.what for one in plan.unresolved}


@pytest.mark.slow
def test_mistakes_in_its_files(moveit: InstallSpace) -> None:
    config = BEFORE.format("MoveItConfigsBuilder('my').to_moveit_configs()")
    moveit.add("my_robot", {"urdf/r.xacro": ROBOT.replace("$(arg size)", "${no}")})
    plan = moveit.play("", before=config)
    assert "'no' is not defined" in only_message(plan, "LCH008")
    assert plan.diagnostics[0].file is not None
    assert plan.diagnostics[0].file.name == "r.xacro"
    moveit.add("my_robot", {"urdf/r.xacro": ROBOT})
    (moveit.prefix / "share" / "my_moveit_config" / "config" / "groups.srdf").unlink()
    assert "groups.srdf" in only_message(moveit.play("", before=config), "LCH005")


@pytest.mark.slow
def test_a_robot_of_a_package_that_is_not_here(moveit: InstallSpace) -> None:
    elsewhere = ASSISTANT.replace("my_robot", "moveit_resources_panda_description")
    moveit.add("my_moveit_config", {".setup_assistant": elsewhere})
    plan = moveit.play(
        PUBLISHER.format("parameters=[config.robot_description]"),
        before=BEFORE.format("MoveItConfigsBuilder('my').to_moveit_configs()"),
    )
    assert not plan.diagnostics
    assert plan.processes[0].parameters["robot_description"].startswith("$(xacro ")


@pytest.mark.slow
def test_a_builder_of_parameters(moveit: InstallSpace) -> None:
    moveit.add("my_robot", {"config/p.yaml": "a: 1\nb: {c: x}\n", "notes.txt": "text"})
    plan = moveit.play(
        PUBLISHER.format("parameters=[builder.to_dict()]"),
        before="""
        from launch_param_builder import ParameterBuilder
        from launch_param_builder.utils import ParameterBuilderFileNotFoundError
        builder = (
            ParameterBuilder('my_robot')
            .yaml('config/p.yaml')
            .yaml(file_path='config/p.yaml', parameter_namespace='n')
            .file_parameter('notes', 'notes.txt')
            .xacro_parameter('robot_description', 'urdf/r.xacro', mappings={'size': '7'})
            .parameter('rate', 2.5)
        )
        for error in (KeyError, ParameterBuilderFileNotFoundError):
            try:
                builder.yaml('no.yaml')
            except error:
                pass
        """,
    )
    assert not plan.diagnostics
    parameters = dict(plan.processes[0].parameters)
    assert '<link name="of_7"' in parameters.pop("robot_description")
    nested = {"n.a": 1, "n.b.c": "x"}
    assert parameters == {"a": 1, "b.c": "x", **nested, "notes": "text", "rate": 2.5}
