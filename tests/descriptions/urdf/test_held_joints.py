"""Joints that Gazebo's plugin for ros2_control holds."""

from __future__ import annotations

import pytest

from wsgen.descriptions.urdf.reader import read_urdf

ROBOT = """<robot name="r">
<link name="a"/><link name="b"/><link name="c"/>
<joint name="arm" type="continuous"><parent link="a"/><child link="b"/></joint>
<joint name="wheel" type="continuous"><parent link="a"/><child link="c"/></joint>
<ros2_control name="s" type="system">
<joint name="arm"><command_interface name="position"/></joint>
<joint name="wheel"><command_interface name="velocity"/><state_interface name="position"/></joint>
</ros2_control>{}</robot>"""
PLUGIN = '<gazebo><plugin filename="{}" name="p"/></gazebo>'


@pytest.mark.parametrize(
    ("plugin", "held"),
    [
        ("", set()),
        (PLUGIN.format("libgazebo_ros_diff_drive.so"), set()),
        (PLUGIN.format("libgazebo_ros2_control.so"), {"arm"}),
        (PLUGIN.format("gz_ros2_control-system"), {"arm"}),
    ],
)
def test_positions_that_are_commanded_are_held(plugin: str, held: set[str]) -> None:
    robot, _ = read_urdf(ROBOT.format(plugin), file=None)
    assert robot is not None
    assert {joint.name for joint in robot.joints if joint.is_held} == held
