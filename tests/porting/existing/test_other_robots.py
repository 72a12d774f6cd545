"""What belongs to other robots of a package of ROS 1 is left out, and said."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.model.target import choose_target
from wsgen.porting.existing.launch_port import Source
from wsgen.porting.existing.other_robots import find_other_robots

if TYPE_CHECKING:
    from pathlib import Path

ROBOT = '<robot name="r" xmlns:xacro="x">{}</robot>'
FIND = "$(find arms)"


def load(robot: str) -> str:
    return f'<launch><param name="robot_description" command="xacro {FIND}/urdf/{robot}"/></launch>'


FILES = {
    "urdf/small.urdf.xacro": ROBOT.format('<xacro:include filename="parts/joints.xacro"/>'),
    "urdf/small.urdf": ROBOT.format(""),  # what it became
    "urdf/parts/joints.xacro": ROBOT.format(""),
    "urdf/large.xacro": ROBOT.format(f'<xacro:include filename="{FIND}/urdf/large.trans"/>'),
    "urdf/large.trans": ROBOT.format(""),
    "urdf/table.urdf": ROBOT.format(""),
    "launch/load_small.launch": load("small.urdf.xacro"),
    "launch/load_large.launch": load("large.xacro"),
    "launch/view_large.launch": '<launch><include file="$(find arms)/launch/load_large.launch"/>'
    "</launch>",
    "launch/made.launch": load("small.urdf"),
    "launch/any.launch": load("$(arg size).urdf.xacro"),
    "launch/scene.launch": f'<launch><include file="{FIND}/launch/load_small.launch"/>'
    f'<node pkg="gazebo_ros" type="spawn_model" args="-file {FIND}/urdf/table.urdf"/></launch>',
    "launch/gazebo.launch": "<launch/>",
    "launch/commented.launch": f"<launch><!-- {FIND}/urdf/large.xacro --></launch>",
}


def source_of(folder: Path, robot: str) -> Source:
    for name, text in FILES.items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    return Source(folder, "arms", "my_arm", choose_target("jazzy"), robot=robot)


def test_files_of_other_robots(tmp_path: Path) -> None:
    found = find_other_robots(source_of(tmp_path, "urdf/small.urdf.xacro"), FILES)
    assert found.paths == {
        "launch/load_large.launch",
        "launch/view_large.launch",
        "urdf/large.trans",
        "urdf/large.xacro",
    }
    assert [(one.file.name, one.what) for one in found.notes] == [
        ("load_large.launch", "The launch file is for another robot, urdf/large.xacro."),
        ("view_large.launch", "The launch file is for another robot, urdf/large.xacro."),
        (
            "small.urdf.xacro",
            "Other descriptions are not of this robot: urdf/large.trans, urdf/large.xacro.",
        ),
    ]
    assert "wsgen new NAME --from" in found.notes[0].advice


def test_without_a_robot_nothing_is_of_others(tmp_path: Path) -> None:
    assert find_other_robots(source_of(tmp_path, ""), FILES).paths == set()
