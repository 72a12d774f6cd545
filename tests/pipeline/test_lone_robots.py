"""A robot file alone in a folder: each planted mistake is named at its line, without a package."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from mesh_samples import binary_stl
from wsgen.diagnostics import Severity
from wsgen.pipeline.check import CheckRequest, check

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic

INERTIA = 'ixx="0.0042" ixy="0" ixz="0" iyy="0.0042" iyz="0" izz="0.0017"'
LIMIT = '<limit lower="-1.5" upper="1.5" effort="10" velocity="1"/>'
SHAPE = '<collision><geometry><box size="0.1 0.1 0.2"/></geometry></collision>'
MIMICS = "arm_joint"
ARM = f"""<robot name="arm">
  <link name="base_link">
    <visual><geometry><box size="0.2 0.2 0.2"/></geometry></visual>
    <collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision>
    <inertial>
      <mass value="4"/>
      <inertia ixx="0.027" ixy="0" ixz="0" iyy="0.027" iyz="0" izz="0.027"/>
    </inertial>
  </link>
  <joint name="arm_joint" type="revolute">
    <origin xyz="0 0 0.3" rpy="0 0 1.5708"/>
    <parent link="base_link"/>
    <child link="arm"/>
    <axis xyz="0 1 0"/>
    {LIMIT}
  </joint>
  <link name="arm">
    <visual><geometry><box size="0.1 0.1 0.2"/></geometry></visual>
    {SHAPE}
    <inertial>
      <mass value="1"/>
      <inertia {INERTIA}/>
    </inertial>
  </link>
  <joint name="tool_joint" type="fixed">
    <origin xyz="0 0 0.1"/>
    <parent link="arm"/>
    <child link="tool"/>
  </joint>
  <link name="tool"/>
  <gazebo reference="arm">
    <mu1>1.0</mu1>
  </gazebo>
  <gazebo reference="tool">
    <sensor name="scan" type="gpu_lidar">
      <update_rate>10</update_rate>
      <gz_frame_id>tool</gz_frame_id>
    </sensor>
  </gazebo>
  <ros2_control name="arm" type="system">
    <hardware>
      <plugin>gz_ros2_control/GazeboSimSystem</plugin>
    </hardware>
    <joint name="{MIMICS}">
      <command_interface name="position"/>
      <state_interface name="position"/>
    </joint>
  </ros2_control>
  <gazebo>
    <plugin filename="gz_ros2_control-system" name="gz_ros2_control::GazeboSimROS2ControlPlugin">
      <parameters>/controllers.yaml</parameters>
    </plugin>
    <plugin filename="gz-sim-joint-state-publisher-system"
            name="gz::sim::systems::JointStatePublisher"/>
  </gazebo>
</robot>
"""
MESH = '<collision><geometry><mesh filename="{}"/></geometry></collision>'
SERIOUS = (Severity.ERROR, Severity.WARNING)


def diagnose(text: str, folder: Path) -> list[Diagnostic]:
    file = folder / "arm.urdf"
    file.write_text(text)
    outcome = check(CheckRequest(paths=[file]), environment={"PATH": os.environ["PATH"]})
    assert all(one.file == file and one.hint for one in outcome.diagnostics)
    return [one for one in outcome.diagnostics if one.severity in SERIOUS]


def test_the_sound_robot_is_silent(tmp_path: Path) -> None:
    assert not diagnose(ARM, tmp_path)


@pytest.mark.parametrize(
    ("old", "new", "code", "line"),
    [
        (LIMIT, LIMIT.replace("1.5", "90"), "ROB081", 15),
        (LIMIT, '<limit lower="0" upper="45" effort="10" velocity="1"/>', "ROB081", 15),
        (LIMIT, LIMIT.replace('effort="10"', 'effort="0.0"'), "ROB082", 15),
        (LIMIT, LIMIT.replace('velocity="1"', 'velocity="0"'), "ROB083", 15),
        (LIMIT, LIMIT.replace('effort="10" ', ""), "ROB016", 15),
        (LIMIT, LIMIT.replace("-1.5", "-1,5"), "ROB016", 15),
        (LIMIT, LIMIT.replace("-1.5", "-inf"), "ROB016", 15),
        (LIMIT, LIMIT.replace("-1.5", "-pi"), "ROB016", 15),
        (LIMIT, '<limit lower="1" upper="1" effort="10" velocity="1"/>', "ROB084", 15),
        (LIMIT, "", "ROB020", 10),
        (LIMIT, LIMIT + '<mimic joint="arm_joint"/>', "ROB036", 10),
        (LIMIT, LIMIT + '<mimic joint="tool_joint"/>', "ROB085", 15),
        ('rpy="0 0 1.5708"', 'rpy="0 0 90"', "ROB140", 11),
        ('<axis xyz="0 1 0"/>', '<axis xyz="0 0 0"/>', "ROB018", 14),
        ('<child link="tool"/>', '<child link="arm"/>', "ROB012", 25),
        ('<link name="tool"/>', '<link name="tool"/><link name="other"/>', "ROB009", 30),
        ('<link name="tool"/>', '<link name="tool"/><link name="tool"/>', "ROB007", 30),
        ('type="fixed"', 'type="Fixed"', "ROB015", 25),
        ('joint name="arm_joint"', 'joint name="arm"', "ROB034", 10),
        ('<mass value="1"/>', '<mass value="0"/>', "ROB040", 17),
        ('<mass value="1"/>', '<mass value="-1"/>', "ROB022", 21),
        ('<mass value="1"/>', '<mass value="1000"/>', "ROB049", 17),
        ('ixx="0.0042"', 'ixx="-0.0042"', "ROB037", 17),
        ('ixy="0" ixz="0" iyy="0.0042"', 'ixy="0.01" ixz="0" iyy="0.0042"', "ROB037", 17),
        ('izz="0.0017"', 'izz="0.017"', "ROB037", 17),
        (INERTIA, 'ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"', "ROB050", 17),
        (INERTIA, 'ixx="1e-9" ixy="0" ixz="0" iyy="1e-9" iyz="0" izz="1e-9"', "ROB050", 17),
        (SHAPE, MESH.format("missing.stl"), "ROB060", 17),
        (SHAPE, MESH.format("Cut.stl"), "ROB062", 17),
        (SHAPE, MESH.format("WHOLE.STL"), "ROB060", 17),
        (SHAPE, MESH.format("pointer.stl"), "ROB062", 17),
        (SHAPE, MESH.format('whole.stl" scale="0 0 0'), "ROB028", 19),
        (SHAPE, MESH.format('whole.stl" scale="1000 1000 1000'), "ROB066", 17),
        ("<mu1>1.0</mu1>", "<mu1>high</mu1>", "ROB031", 32),
        ("<mu1>1.0</mu1>", "<mu1>1,0</mu1>", "ROB031", 32),
        ("<mu1>1.0</mu1>", "<mu_1>1.0</mu_1>", "ROB038", 32),
        ("<mu1>1.0</mu1>", "<friction>1.0</friction>", "ROB033", 32),
        ('<gazebo reference="arm">', '<gazebo reference="amr">', "ROB030", 31),
        ('type="gpu_lidar"', 'type="laser"', "ROB097", 35),
        ('type="gpu_lidar"', 'type="ray"', "ROB105", 35),
        ("<gz_frame_id>tool<", "<gz_frame_id>tol<", "ROB106", 35),
        ("<update_rate>10<", "<update_rate>fast<", "ROB099", 36),
        ("GazeboSimSystem", "GazeboSystem", "ROB092", 42),
        ("gz_ros2_control/GazeboSimSystem", "gazebo_ros2_control/GazeboSystem", "ROB093", 42),
        (f'<joint name="{MIMICS}">', '<joint name="arm_jiont">', "ROB087", 44),
        (f'<joint name="{MIMICS}">', '<joint name="tool_joint">', "ROB088", 44),
        ('interface name="position"', 'interface name="positon"', "ROB091", 44),
        ("<parameters>/controllers.yaml</parameters>", "", "ROB102", 50),
        ("joint-state-publisher-system", "joint-state-publisher-sytem", "ROB100", 54),
        ("systems::JointStatePublisher", "systems::JointState", "ROB100", 54),
    ],
)
def test_a_mistake_is_named_at_its_line(
    tmp_path: Path, old: str, new: str, code: str, line: int
) -> None:
    assert old in ARM
    (tmp_path / "Cut.stl").write_bytes(binary_stl()[:-30])
    (tmp_path / "whole.stl").write_bytes(binary_stl())
    (tmp_path / "pointer.stl").write_bytes(b"version https://git-lfs.github.com/spec/v1\n")
    if old.startswith("<joint"):
        before, _, after = ARM.rpartition(old)
        text = before + new + after
    else:
        text = ARM.replace(old, new, 1)
    found = diagnose(text, tmp_path)
    assert (code, line) in {(one.code, one.line) for one in found}, found


@pytest.mark.parametrize(
    ("uri", "severity"), [("model://x500", "warning"), ("x500", "warning"), ("parts/x", "error")]
)
def test_a_part_may_be_in_a_folder_of_models(tmp_path: Path, uri: str, severity: str) -> None:
    (tmp_path / "model.sdf").write_text(
        f'<sdf version="1.9"><model name="m"><include><uri>{uri}</uri></include></model></sdf>'
    )
    outcome = check(CheckRequest(paths=(tmp_path / "model.sdf",)), environment={})
    found = [one for one in outcome.diagnostics if one.code == "WLD004"]
    assert [one.severity.value for one in found] == [severity]


@pytest.mark.parametrize(
    ("text", "severity"),
    [
        ("<robot>\n<!-- what is added -->\n</robot>\n", "info"),
        ('<?xml version="1.0"?>\n<robot/>', "info"),
        ('<robot xmlns:xacro="http://www.ros.org/wiki/xacro">\n</robot>', "info"),
        ('<robot><material name="a"/></robot>', "error"),
        ('<robot><!-- a --><material name="a"/><!-- b --></robot>', "error"),
        # A search that tries what each comment may end at would take days.
        (f"{'<!-- a license -->' * 60}<robot><material name='a'/></robot>", "error"),
    ],
)
def test_a_robot_may_be_empty_on_purpose(tmp_path: Path, text: str, severity: str) -> None:
    (tmp_path / "empty.urdf").write_text(text)
    outcome = check(CheckRequest(paths=(tmp_path / "empty.urdf",)), environment={})
    found = {one.code: one.severity.value for one in outcome.diagnostics}
    assert found == {"ROB004": severity, "ROB005": severity}


@pytest.mark.parametrize(("uri", "severity"), [("model://a/h.png", "warning"), ("h.png", "error")])
def test_a_heightmap_may_be_in_a_folder_of_models(tmp_path: Path, uri: str, severity: str) -> None:
    shape = f"<geometry><heightmap><uri>{uri}</uri><size>9 9 1</size></heightmap></geometry>"
    (tmp_path / "w.world").write_text(
        "<sdf version='1.6'><world name='w'><model name='m'><static>1</static><link name='l'>"
        f"<collision name='c'>{shape}</collision></link></model></world></sdf>"
    )
    outcome = check(CheckRequest(paths=(tmp_path / "w.world",)), environment={})
    found = [one for one in outcome.diagnostics if one.code == "WLD050"]
    assert [one.severity.value for one in found] == [severity]
