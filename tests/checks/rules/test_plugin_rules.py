"""The rules over plugins and sensors of a robot, each with its facts and no files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from wsgen.checks.rules.plugins import PluginFacts, check_plugins, simulator_meant
from wsgen.diagnostics import Severity
from wsgen.gazebo.plugins import OF_CLASSIC, PLUGINS, simulator_of, stem
from wsgen.gazebo.systems import CONTROL, systems
from wsgen.model.robot import GazeboTag, Joint, JointType, Plugin, Sensor

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.diagnostics import Diagnostic

FILE = Path("rover.urdf")
JOINTS = tuple(
    Joint(name=name, type=kind, parent="base_link", child=child)
    for name, kind, child in (
        ("left_wheel_joint", JointType.CONTINUOUS, "left_wheel"),
        ("right_wheel_joint", JointType.CONTINUOUS, "right_wheel"),
        ("laser_joint", JointType.FIXED, "laser"),
    )
)
WHEELS = {"left_joint": ("left_wheel_joint",), "right_joint": ("right_wheel_joint",)}
LINKS = ("base_link", "left_wheel", "right_wheel", "laser")
DRIVE = "gz-sim-diff-drive-system"
CLASSIC_DRIVE = "libgazebo_ros_diff_drive.so"


def plugin(
    filename: str = DRIVE, values: Mapping[str, tuple[str, ...]] | None = None, name: str = ""
) -> Plugin:
    return Plugin(filename, WHEELS if values is None else values, name, 30)


def check(
    *plugins: Plugin,
    tags: tuple[GazeboTag, ...] = (),
    simulator: str | None = None,
    distro: str | None = None,
) -> list[Diagnostic]:
    whole = GazeboTag(reference=None, plugins=plugins)
    facts = PluginFacts(
        tags=(whole, *tags), joints=JOINTS, links=LINKS, simulator=simulator, distro=distro
    )
    return list(check_plugins(facts, FILE))


def laser(*sensors: Sensor, reference: str | None = "laser") -> GazeboTag:
    return GazeboTag(reference=reference, sensors=sensors)


def test_the_tables_agree() -> None:
    control = {"gazebo_ros2_control", *CONTROL}
    assert PLUGINS.keys() <= {*systems(), *OF_CLASSIC, *control}
    for name, one in PLUGINS.items():
        named = {topic.parameter for topic in one.topics.values()} - {""}
        assert {*one.joints, *one.links, *one.required, *named} <= {*one.parameters} or not (
            one.parameters
        ), name
    assert stem("libignition-gazebo-diff-drive-system.so") == "diff-drive"
    assert simulator_of("/opt/lib/libgazebo_ros_camera.so") == "classic"
    assert simulator_of("libmaker_plugin.so") is None


@pytest.mark.parametrize(
    "sound",
    [
        plugin(name="gz::sim::systems::DiffDrive"),
        plugin("ignition-gazebo-diff-drive-system", name="ignition::gazebo::systems::DiffDrive"),
        plugin("libgz-sim-diff-drive-system.so", name="gz::sim::systems::DiffDrive"),
        plugin(CLASSIC_DRIVE, name="anything"),
        plugin("gz-sim-yarp-forcetorque-system", {}, "gzyarp::ForceTorqueDriver"),
        plugin("libgazebo_ros_link_attacher.so", {}),
        plugin(
            "gz_ros2_control-system",
            {"parameters": ("/controllers.yaml",)},
            "gz_ros2_control::GazeboSimROS2ControlPlugin",
        ),
    ],
)
def test_sound_plugins_are_silent(sound: Plugin) -> None:
    assert not check(sound)


@pytest.mark.parametrize(
    ("wrong", "hint"),
    [
        (plugin("gz-sim-diff-drive"), 'filename="gz-sim-diff-drive-system"'),
        (plugin("ignition-gazebo-diffdrive-system"), '"ignition-gazebo-diff-drive-system"'),
        (plugin("libgazebo_ros_difdrive.so"), 'filename="libgazebo_ros_diff_drive.so"'),
        (plugin(name="gz::sim::systems::DiffDriv"), 'name="gz::sim::systems::DiffDrive"'),
        (plugin(name="diff_drive"), 'name="gz::sim::systems::DiffDrive"'),
        (
            plugin("gz_ros2_contol-system", {"parameters": ("/a",)}, "x"),
            'filename="gz_ros2_control-system"',
        ),
        (
            plugin("gz_ros2_control-system", {"parameters": ("/a",)}, "gz_ros2_control::Plugin"),
            'name="gz_ros2_control::GazeboSimROS2ControlPlugin"',
        ),
    ],
)
def test_misspelled_plugins(wrong: Plugin, hint: str) -> None:
    (found,) = check(wrong)
    assert (found.code, found.line) == ("ROB100", 30)
    assert hint in (found.hint or "")


def test_plugins_of_the_other_simulator() -> None:
    (found,) = check(plugin(CLASSIC_DRIVE), simulator="gz")
    assert (found.code, found.severity) == ("ROB101", Severity.ERROR)
    assert found.hint == "Use gz-sim-diff-drive-system for Gazebo Sim."
    (found,) = check(plugin(), simulator="classic")
    assert found.hint == "Use libgazebo_ros_diff_drive.so for Gazebo Classic."
    (found,) = check(plugin(CLASSIC_DRIVE), distro="jazzy")
    assert found.code == "ROB101"
    (found,) = check(plugin(CLASSIC_DRIVE), plugin(), simulator="gz")
    assert found.severity is Severity.INFO
    assert not check(plugin(CLASSIC_DRIVE), plugin())
    assert not check(plugin(CLASSIC_DRIVE), distro="humble")
    # Another plugin for the right simulator does not drive the robot.
    states = plugin("gz-sim-joint-state-publisher-system", {})
    (found,) = check(plugin(CLASSIC_DRIVE), states, simulator="gz")
    assert found.severity is Severity.ERROR
    control = plugin("libgz_ros2_control-system.so", {"parameters": ("/c.yaml",)})
    (found,) = check(plugin(CLASSIC_DRIVE), control, simulator="gz")
    assert found.severity is Severity.INFO


def test_plugins_of_sensors_of_the_other_simulator() -> None:
    driver = plugin("libgazebo_ros_imu_sensor.so", {})
    tag = laser(Sensor("s", "imu", {"gz_frame_id": ("laser",)}, (driver,), line=4))
    (found,) = check(tags=(tag,), simulator="gz")
    assert (found.code, found.severity, found.line) == ("ROB101", Severity.ERROR, 30)
    assert not check(tags=(tag,), simulator="classic")


def test_what_a_plugin_says_that_is_not_loaded_is_not_checked() -> None:
    (found,) = check(plugin(CLASSIC_DRIVE, {**WHEELS, "wheel_radius": ("0.1",)}), simulator="gz")
    assert found.code == "ROB101"


def test_a_plugin_of_the_other_simulator_may_be_called_anything() -> None:
    system = plugin("gz-sim-diff-drive-system", WHEELS, "my_drive")
    (found,) = check(system, simulator="classic")
    assert found.code == "ROB101"
    assert "ROB100" in {one.code for one in check(system, simulator="gz")}


def test_joints_that_a_plugin_does_not_find() -> None:
    for filename in (DRIVE, CLASSIC_DRIVE):
        (found,) = check(plugin(filename, {**WHEELS, "left_joint": ("wheel_left_joint",)}))
        assert (found.code, found.severity, found.line) == ("ROB102", Severity.ERROR, 30)
        assert "Did you mean" in (found.hint or "")


def test_a_fixed_joint_that_a_drive_turns_is_wrong_where_the_joint_is() -> None:
    drive = plugin(CLASSIC_DRIVE, {**WHEELS, "left_joint": ("laser_joint",)})
    states = plugin("libgazebo_ros_joint_state_publisher.so", {"joint_name": ("laser_joint",)})
    (found,) = check(drive, states)
    assert (found.code, found.element) == ("ROB102", "joint[@name='laser_joint']")
    assert 'type="continuous"' in (found.hint or "")
    (found,) = check(states)
    assert (found.line, found.hint) == (
        30,
        "Remove <joint_name>laser_joint</joint_name>, or give the joint a type that moves.",
    )


def test_a_drive_without_joint() -> None:
    (found,) = check(plugin(values={"left_joint": ("left_wheel_joint",)}))
    assert (found.code, found.hint) == ("ROB102", "Add <right_joint>JOINT</right_joint>.")
    assert not check(plugin(values={**WHEELS, "left_joint": ("${prefix}left::joint",)}))


@pytest.mark.parametrize(
    ("filename", "parameter", "hint"),
    [
        (DRIVE, "wheel_seperation", "Write <wheel_separation>."),
        (DRIVE, "wheel_diameter", "Write <wheel_radius> with half the value."),
        (CLASSIC_DRIVE, "wheel_radius", "Write <wheel_diameter> with twice the value."),
        (CLASSIC_DRIVE, "wheelSeparation", "Write <wheel_separation>."),
        (CLASSIC_DRIVE, "robotNamespace", "Write <ros><namespace>."),
    ],
)
def test_parameters_that_are_not_read(filename: str, parameter: str, hint: str) -> None:
    (found,) = check(plugin(filename, {**WHEELS, parameter: ("1",)}))
    assert (found.code, found.hint) == ("ROB103", hint)
    assert not check(plugin(filename, {**WHEELS, "other": ("1",)}))


def test_a_plugin_of_ros_1_is_one_diagnostic() -> None:
    old = {"leftJoint": ("left_wheel_joint",), "rightJoint": ("right_wheel_joint",)}
    (found,) = check(plugin(CLASSIC_DRIVE, old))
    assert found.code == "ROB103"


def test_sensors() -> None:
    (found,) = check(tags=(laser(Sensor("s", "imu", line=4), reference=None),))
    assert (found.code, found.line) == ("ROB104", 4)
    scan = Sensor("s", "ray", {"gz_frame_id": ("laser",)}, line=4)
    (found,) = check(tags=(laser(scan),), simulator="gz")
    assert found.code == "ROB105"
    assert not check(tags=(laser(scan),), simulator="gz", distro="rolling")
    assert not check(tags=(laser(scan),))
    elsewhere = Sensor("s", "gpu_lidar", {"gz_frame_id": ("lasr",)}, line=4)
    (found,) = check(tags=(laser(elsewhere),))
    assert (found.code, found.hint) == ("ROB106", "Did you mean `laser`?")
    of_plugin = Sensor("s", "camera", {}, (plugin("libx.so", {"frame_name": ("eye",)}),), 4)
    (found,) = check(tags=(laser(of_plugin),))
    assert found.code == "ROB106"
    unset = laser(Sensor("s", "gpu_lidar", line=4))
    (found,) = check(tags=(unset,), simulator="gz")
    assert (found.code, found.severity) == ("ROB107", Severity.INFO)
    assert not check(tags=(unset,))
    assert not check(tags=(unset,), simulator="classic")


def test_two_sensors_of_one_name() -> None:
    first, second = laser(Sensor("s", "imu")), laser(Sensor("s", "imu", line=9))
    (found,) = check(tags=(first, second))
    assert (found.code, found.severity, found.line) == ("ROB108", Severity.ERROR, 9)
    of_body = laser(Sensor("s", "imu", line=12), reference="base_link")  # laser is fixed to it
    (found,) = check(tags=(first, of_body))
    assert found.line == 12
    of_wheel = laser(Sensor("s", "imu"), reference="left_wheel")
    assert not check(tags=(first, of_wheel))


def test_the_simulator_is_that_of_all_plugins() -> None:
    gz, classic = plugin(), plugin("libgazebo_ros_camera.so", {}, "camera")
    inside = Sensor(name="laser", kind="ray", plugins=(classic,))
    assert simulator_meant([GazeboTag(reference=None, plugins=(gz,))]) == "gz"
    assert simulator_meant([laser(inside)]) == "classic"
    assert simulator_meant([GazeboTag(reference=None, plugins=(gz,)), laser(inside)]) is None
    assert simulator_meant([]) is None
