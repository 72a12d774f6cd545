"""Two sound robots, and one mistake after the other in them: each is named where it is written.

Of the arm, which is written in xacro, the places are those in the xacro files.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.descriptions.xacro.expansion import expand
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.isolation import parent
from wsgen.pipeline.prepare import PrepareContext, PreparedRobot, prepare_robot

if TYPE_CHECKING:
    from pathlib import Path

INERTIA = '<inertia ixx="0.00087" ixy="0" ixz="0" iyy="0.0016" iyz="0" izz="0.00087"/>'
ROVER = f"""<robot name="rover">
  <material name="gray"><color rgba="0.5 0.5 0.5 1"/></material>
  <link name="base_link">
    <visual>
      <origin xyz="0 0 0.1"/>
      <geometry><box size="0.4 0.3 0.1"/></geometry>
      <material name="gray"/>
    </visual>
    <collision>
      <origin xyz="0 0 0.1"/>
      <geometry><box size="0.4 0.3 0.1"/></geometry>
    </collision>
    <inertial>
      <origin xyz="0 0 0.1"/>
      <mass value="5"/>
      <inertia ixx="0.042" ixy="0" ixz="0" iyy="0.071" iyz="0" izz="0.104"/>
    </inertial>
  </link>
  <joint name="left_joint" type="continuous">
    <origin xyz="0 0.18 0.08"/>
    <parent link="base_link"/>
    <child link="left_wheel"/>
    <axis xyz="0 1 0"/>
  </joint>
  <link name="left_wheel">
    <visual>
      <origin rpy="1.5708 0 0"/>
      <geometry><cylinder radius="0.08" length="0.04"/></geometry>
    </visual>
    <collision>
      <origin rpy="1.5708 0 0"/>
      <geometry><cylinder radius="0.08" length="0.04"/></geometry>
    </collision>
    <inertial>
      <mass value="0.5"/>
      {INERTIA}
    </inertial>
  </link>
  <joint name="right_joint" type="continuous">
    <origin xyz="0 -0.18 0.08"/>
    <parent link="base_link"/>
    <child link="right_wheel"/>
    <axis xyz="0 1 0"/>
  </joint>
  <link name="right_wheel">
    <visual>
      <origin rpy="1.5708 0 0"/>
      <geometry><cylinder radius="0.08" length="0.04"/></geometry>
    </visual>
    <collision>
      <origin rpy="1.5708 0 0"/>
      <geometry><cylinder radius="0.08" length="0.04"/></geometry>
    </collision>
    <inertial>
      <mass value="0.5"/>
      {INERTIA}
    </inertial>
  </link>
  <joint name="laser_joint" type="fixed">
    <origin xyz="0.1 0 0.15"/>
    <parent link="base_link"/>
    <child link="laser"/>
  </joint>
  <link name="laser"/>
  <gazebo reference="left_wheel">
    <mu1>1.0</mu1>
  </gazebo>
  <gazebo reference="laser">
    <sensor name="scan" type="gpu_lidar">
      <always_on>true</always_on>
      <update_rate>10</update_rate>
      <gz_frame_id>laser</gz_frame_id>
    </sensor>
  </gazebo>
  <gazebo>
    <plugin filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive">
      <left_joint>left_joint</left_joint>
      <right_joint>right_joint</right_joint>
      <wheel_separation>0.36</wheel_separation>
      <wheel_radius>0.08</wheel_radius>
    </plugin>
  </gazebo>
</robot>
"""
ARM = """<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:include filename="segment.xacro"/>
  <xacro:property name="mass" value="1.0"/>
  <link name="world"/>
  <link name="base_link">
    <visual><geometry><box size="0.2 0.2 0.2"/></geometry></visual>
    <collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision>
    <inertial>
      <mass value="4"/>
      <inertia ixx="0.0267" ixy="0" ixz="0" iyy="0.0267" iyz="0" izz="0.0267"/>
    </inertial>
  </link>
  <joint name="world_joint" type="fixed">
    <parent link="world"/>
    <child link="base_link"/>
  </joint>
  <xacro:segment name="upper" parent="base_link" mass="${mass}"/>
  <xacro:segment name="lower" parent="upper_link" mass="${mass / 2}"/>
  <xacro:finger name="left"/>
  <xacro:finger name="right"/>
  <ros2_control name="arm" type="system">
    <hardware>
      <plugin>gz_ros2_control/GazeboSimSystem</plugin>
    </hardware>
    <joint name="upper_joint">
      <command_interface name="position"/>
      <state_interface name="position"/>
    </joint>
    <joint name="lower_joint">
      <command_interface name="position"/>
      <state_interface name="position"/>
    </joint>
    <joint name="left_finger_joint">
      <command_interface name="effort"/>
      <state_interface name="position"/>
    </joint>
    <joint name="right_finger_joint">
      <state_interface name="position"/>
    </joint>
  </ros2_control>
  <gazebo>
    <plugin filename="gz_ros2_control-system" name="gz_ros2_control::GazeboSimROS2ControlPlugin">
      <parameters>/controllers.yaml</parameters>
    </plugin>
  </gazebo>
</robot>
"""
SEGMENT = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="segment" params="name parent mass">
    <joint name="${name}_joint" type="revolute">
      <origin xyz="0 0 0.2"/>
      <parent link="${parent}"/>
      <child link="${name}_link"/>
      <axis xyz="0 1 0"/>
      <limit lower="-1.57" upper="1.57" effort="20" velocity="2"/>
    </joint>
    <link name="${name}_link">
      <visual><geometry><box size="0.1 0.1 0.2"/></geometry></visual>
      <collision><geometry><box size="0.1 0.1 0.2"/></geometry></collision>
      <inertial>
        <mass value="${mass}"/>
        <inertia ixx="0.004" ixy="0" ixz="0" iyy="0.004" iyz="0" izz="0.002"/>
      </inertial>
    </link>
  </xacro:macro>
  <xacro:macro name="finger" params="name">
    <joint name="${name}_finger_joint" type="prismatic">
      <origin xyz="0 0 0.2"/>
      <parent link="lower_link"/>
      <child link="${name}_finger"/>
      <axis xyz="0 1 0"/>
      <limit lower="0" upper="0.04" effort="5" velocity="0.5"/>
      <xacro:if value="${name == 'right'}">
        <mimic joint="left_finger_joint"/>
      </xacro:if>
    </joint>
    <link name="${name}_finger">
      <visual><geometry><box size="0.02 0.01 0.05"/></geometry></visual>
      <collision><geometry><box size="0.02 0.01 0.05"/></geometry></collision>
      <inertial>
        <mass value="0.05"/>
        <inertia ixx="1.1e-5" ixy="0" ixz="0" iyy="1.2e-5" iyz="0" izz="2.1e-6"/>
      </inertial>
    </link>
  </xacro:macro>
</robot>
"""
SERIOUS = (Severity.ERROR, Severity.WARNING)


def prepare(text: str | bytes, file: Path) -> tuple[PreparedRobot | None, tuple[Diagnostic, ...]]:
    context = PrepareContext(share_of=lambda _: None, folder=file.parent, run=parent.run)
    return prepare_robot(text, file=file, context=context, simulator="gz", distro="jazzy")


def diagnose(text: str | bytes, file: Path) -> list[Diagnostic]:
    _, found = prepare(text, file)
    return [one for one in found if one.severity in SERIOUS]


def swap(text: str, old: str, new: str) -> str:
    assert old in text
    return text.replace(old, new, 1)


def check_rover(text: str, folder: Path) -> list[Diagnostic]:
    file = folder / "rover.urdf"
    file.write_text(text)
    return diagnose(text.encode(), file)


def check_arm(main: str, segment: str, folder: Path) -> list[Diagnostic]:
    file = folder / "arm.xacro"
    file.write_text(main)
    (folder / "segment.xacro").write_text(segment)
    result = expand(file, {})
    assert result.code == 0, result.stderr
    return diagnose(result.stdout, file)


def test_the_sound_robots_are_silent(tmp_path: Path) -> None:
    assert not check_rover(ROVER, tmp_path)
    assert not check_arm(ARM, SEGMENT, tmp_path)


@pytest.mark.parametrize(
    ("old", "new", "code", "line"),
    [
        ('<robot name="rover">', "<robot>", "ROB004", 1),
        ("</collision>\n    <inertial>", "<inertial>", "ROB001", 9),
        ('<parent link="base_link"/>', '<parent link="base"/>', "ROB013", 19),
        ('type="continuous"', 'type="hinge"', "ROB015", 19),
        ('name="right_joint"', 'name="left_joint"', "ROB008", 39),
        ('<link name="right_wheel">', '<link name="left_wheel">', "ROB007", 45),
        ('<child link="laser"/>', '<child link="left_wheel"/>', "ROB011", 59),
        ('xyz="0 1 0"', 'xyz="0 0 0"', "ROB018", 23),
        ('xyz="0 1 0"', 'xyz="0 2 0"', "ROB019", 23),
        ('xyz="0 0.18 0.08"', 'xyz="0 0,18 0.08"', "ROB016", 20),
        ('xyz="0 0.18 0.08"', 'xyz="0 0.18"', "ROB016", 20),
        ('<mass value="0.5"/>', '<mass value="0"/>', "ROB040", 25),
        ('<mass value="0.5"/>', '<mass value="-0.5"/>', "ROB022", 35),
        ('iyy="0.0016"', 'iyy="1.6"', "ROB037", 25),
        (INERTIA, INERTIA.replace("0.00", "90.00"), "ROB050", 25),
        ('<mass value="0.5"/>', '<mass value="500"/>', "ROB118", 25),
        ('<cylinder radius="0.08"', '<cylinder radius="0"', "ROB028", 28),
        ("<visual>", "<visaul>", "ROB001", 8),
        ('<material name="gray"/>', '<material name="grey"/>', "ROB025", 7),
        ('rgba="0.5 0.5 0.5 1"', 'rgba="127 127 127 1"', "ROB027", 2),
        ('reference="left_wheel"', 'reference="lef_wheel"', "ROB030", 65),
        ("<mu1>1.0</mu1>", "<mu1>high</mu1>", "ROB031", 66),
        ("<mu1>1.0</mu1>", "<mu1>0</mu1>", "ROB122", 65),
        ('type="gpu_lidar"', 'type="gpu_lidr"', "ROB097", 69),
        ('type="gpu_lidar"', 'type="ray"', "ROB105", 69),
        ("<update_rate>10<", "<update_rate>ten<", "ROB099", 71),
        ("<gz_frame_id>laser<", "<gz_frame_id>laser_frame<", "ROB106", 69),
        ('<gazebo reference="laser">', "<gazebo>", "ROB104", 69),
        ("gz-sim-diff-drive-system", "gz-sim-difdrive-system", "ROB100", 76),
        ("gz-sim-diff-drive-system", "libgazebo_ros_diff_drive.so", "ROB101", 76),
        ("<left_joint>left_joint<", "<left_joint>left_wheel_joint<", "ROB102", 76),
        ("wheel_separation", "wheel_seperation", "ROB103", 76),
        ("wheel_radius>0.08</wheel_radius", "wheel_diameter>1</wheel_diameter", "ROB103", 76),
    ],
)
def test_a_mistake_in_the_rover(tmp_path: Path, old: str, new: str, code: str, line: int) -> None:
    text = swap(ROVER, old, new)
    if f"</{old.strip('<>')}>" in ROVER and old.startswith("wheel_s"):
        text = text.replace(f"</{old}>", f"</{new}>")
    found = check_rover(text, tmp_path)
    assert (code, line) in {(one.code, one.line) for one in found}
    assert all(one.hint for one in found)


@pytest.mark.parametrize(
    ("old", "new", "code", "line"),
    [
        ('<joint name="upper_joint">', '<joint name="uper_joint">', "ROB087", 25),
        ('<joint name="upper_joint">', '<joint name="world_joint">', "ROB088", 25),
        (
            '<joint name="right_finger_joint">',
            '<joint name="right_finger_joint"><command_interface name="position"/>',
            "ROB089",
            37,
        ),
        ('type="system"', 'type="sytem"', "ROB090", 21),
        ('name="position"', 'name="positon"', "ROB091", 25),
        ("GazeboSimSystem", "GazeboSystem", "ROB092", 23),
        ("gz_ros2_control/GazeboSimSystem", "gazebo_ros2_control/GazeboSystem", "ROB093", 23),
        ("gz_ros2_control/GazeboSimSystem", "mock_components/GenericSystem", "ROB093", 23),
        ("gz_ros2_control-system", "libmaker.so", "ROB094", 21),
        ('name="gz_ros2_control::GazeboSimROS2ControlPlugin"', "", "ROB098", 42),
        (
            "</robot>",
            '<transmission name="t"><joint name="j"/></transmission></robot>',
            "ROB095",
            46,
        ),
        ("<xacro:property", "<property", "ROB071", None),
        ('<link name="world"/>', '<property name="a" value="1"/><link name="world"/>', "ROB115", 4),
    ],
)
def test_a_mistake_in_the_arm(
    tmp_path: Path, old: str, new: str, code: str, line: int | None
) -> None:
    if line is None:
        file = tmp_path / "arm.xacro"
        file.write_text(swap(ARM, old, new))
        (tmp_path / "segment.xacro").write_text(SEGMENT)
        assert expand(file, {}).code != 0
        return
    found = check_arm(swap(ARM, old, new), SEGMENT, tmp_path)
    places = {(one.code, one.file, one.line) for one in found}
    assert (code, tmp_path / "arm.xacro", line) in places


@pytest.mark.parametrize(
    ("old", "new", "code", "line", "calls"),
    [
        ('lower="-1.57" upper="1.57"', 'lower="-90" upper="90"', "ROB081", 8, (17, 18)),
        ('effort="20"', 'effort="0"', "ROB082", 8, (17, 18)),
        ('velocity="2"', 'velocity="0"', "ROB083", 8, (17, 18)),
        ('lower="-1.57" upper="1.57" ', "", "ROB084", 8, (17, 18)),
        ('lower="-1.57" upper="1.57"', 'lower="1.57" upper="-1.57"', "ROB023", 8, (17, 18)),
        ('<mimic joint="left_finger_joint"/>', '<mimic joint="finger"/>', "ROB035", 27, (20,)),
        ('xyz="0 0 0.2"', 'xyz="0 0 0,2"', "ROB016", 4, (17, 18)),
        ('<mass value="0.05"/>', '<mass value="0.0"/>', "ROB040", 30, (19, 20)),
        ('<child link="${name}_link"/>', '<child link="link"/>', "ROB013", 3, (17, 18)),
    ],
)
def test_a_mistake_in_a_macro(  # noqa: PLR0917  the facts of a case
    tmp_path: Path, old: str, new: str, code: str, line: int, calls: tuple[int, ...]
) -> None:
    """It is named where the macro is written, once for each of the calls."""
    found = [one for one in check_arm(ARM, swap(SEGMENT, old, new), tmp_path) if one.code == code]
    assert [(one.file, one.line) for one in found] == [(tmp_path / "segment.xacro", line)] * len(
        calls
    )
    ends = {one.message.rpartition(" is called in ")[2] for one in found}
    assert ends == {f"line {call} of arm.xacro." for call in calls}


CONTROLLED = """<ros2_control name="rover" type="system">
    <hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
    <joint name="left_joint"><command_interface name="velocity"/></joint>
  </ros2_control>
</robot>"""


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ("gz-sim-diff-drive-system", "gz-sim-difdrive-system", "ROB100"),
        ("systems::DiffDrive", "systems::DifDrive", "ROB100"),
        ("gz-sim-diff-drive-system", "libgazebo_ros_diff_drive.so", "ROB101"),
        ("<left_joint>left_joint<", "<left_joint>left_wheel_joint<", "ROB102"),
        ("</robot>", CONTROLLED.replace("left_joint", "lef_joint"), "ROB087"),
        ("</robot>", CONTROLLED.replace("GazeboSimSystem", "GazeboSystem"), "ROB092"),
    ],
)
def test_gazebo_loads_the_robot_without_a_plugin(
    tmp_path: Path, old: str, new: str, code: str
) -> None:
    """The mistake is an error, and the robot is simulated all the same."""
    prepared, found = prepare(swap(ROVER, old, new), tmp_path / "rover.urdf")
    assert {one.code for one in found if one.severity is Severity.ERROR} == {code}
    assert prepared is not None
    assert prepared.can_run


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ('<mass value="0.5"/>', '<mass value="0"/>', "ROB040"),
        ("<collision>", "<collision><geometry><cone/></geometry></collision><collision>", "ROB024"),
    ],
)
def test_gazebo_classic_simulates_what_is_left(
    tmp_path: Path, old: str, new: str, code: str
) -> None:
    file = tmp_path / "rover.urdf"
    context = PrepareContext(share_of=lambda _: None, folder=tmp_path, run=parent.run)
    for simulator in ("classic", "gz"):
        prepared, found = prepare_robot(
            swap(ROVER, old, new), file=file, context=context, simulator=simulator
        )
        assert code in {one.code for one in found if one.severity is Severity.ERROR}
        assert prepared is not None
        assert prepared.can_run == (simulator == "classic")


def test_gazebo_refuses_a_robot_with_a_plugin_without_a_name(tmp_path: Path) -> None:
    text = swap(ROVER, ' name="gz::sim::systems::DiffDrive"', "")
    prepared, found = prepare(text, tmp_path / "rover.urdf")
    assert {one.code for one in found if one.severity is Severity.ERROR} == {"ROB098"}
    assert prepared is not None
    assert not prepared.can_run
