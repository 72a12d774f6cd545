"""Sensors and controllers that are added: robot, bridge, world, parameters, spawner."""

from __future__ import annotations

import os
import shutil
from typing import TYPE_CHECKING

import pytest

from golden_support import golden_package
from porting.adding.added import added, opened, package
from wsgen.errors import NotFoundError, RequestError
from wsgen.pipeline.check import CheckRequest, check
from wsgen.porting.adding.addition import write_addition
from wsgen.porting.adding.controllers import ControllerOptions, add_controller
from wsgen.porting.adding.sensors import KINDS, SensorOptions, add_sensor

if TYPE_CHECKING:
    from pathlib import Path


def copied(folder: Path, case: str) -> Path:
    place = folder / "src/gazebo_test"
    shutil.copytree(golden_package(case), place)
    return place


def reported(place: Path, distro: str) -> list[tuple[str, str | None]]:
    outcome = check(CheckRequest(paths=[place], distro=distro), environment=os.environ)
    return sorted((one.code, one.element) for one in outcome.diagnostics)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("case", ["diff_drive-humble-classic", "diff_drive-jazzy-gz"])
def test_a_sensor(tmp_path: Path, case: str, kind: str) -> None:
    place = copied(tmp_path, case)
    distro = case.split("-")[1]
    before = reported(place, distro)
    link = "base_link"
    plan, lines = added(place, lambda one: add_sensor(one, "extra", SensorOptions(kind, link)))
    assert plan.pasted == ()
    assert plan.created == ()
    assert reported(place, distro) == before
    gazebo = lines["model/robot.gazebo"]
    assert gazebo[0] == f'<gazebo reference="{link}">'
    assert any('<sensor name="extra"' in line for line in gazebo)
    if case.endswith("gz"):
        topics = [line for line in lines["config/bridge.yaml"] if line.startswith("gz_topic_name")]
        assert topics[0].startswith("gz_topic_name: /extra")
        system = {"imu": "Imu", "gps": "NavSat", "contact": "Contact"}.get(kind)
        world = (place / "model/empty_world.world").read_text()
        assert system is None or f"gz::sim::systems::{system}" in world


def test_a_bridge_with_arguments(tmp_path: Path) -> None:
    place = copied(tmp_path, "diff_drive-jazzy-gz")
    (place / "config/bridge.yaml").unlink()
    (place / "launch/bridge.launch.py").write_text(
        "def generate_launch_description():\n    return [Node(arguments=[\n"
        '        "/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock"\n    ])]\n'
    )
    _, lines = added(
        place, lambda one: add_sensor(one, "extra", SensorOptions("camera", "base_link"))
    )
    assert lines["launch/bridge.launch.py"] == [
        '"/extra/image@sensor_msgs/msg/Image[gz.msgs.Image",',
        '"/extra/camera_info@sensor_msgs/msg/CameraInfo[gz.msgs.CameraInfo",',
    ]


@pytest.mark.parametrize("simulator", ["classic", "gz"])
def test_files_for_either_simulator(tmp_path: Path, simulator: str) -> None:
    """Each is included on a condition: what is added is in that of the simulator."""
    texts = {
        "classic": '<plugin name="a" filename="libgazebo_ros_imu_sensor.so"/>',
        "gz": '<plugin name="gz::sim::systems::Imu" filename="gz-sim-imu-system"/>',
    }
    namespace = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
    includes = "".join(
        f'  <xacro:if value="$(arg {one})">\n'
        f'    <xacro:include filename="{one}.xacro"/>\n  </xacro:if>\n'
        for one in texts
    )
    arguments = "".join(f'  <xacro:arg name="{one}" default="false"/>\n' for one in texts)
    files = {
        "CMakeLists.txt": "project(owl)\ninstall(DIRECTORY urdf DESTINATION share/owl)\n",
        "urdf/owl.xacro": f'<robot name="owl" {namespace}>\n{arguments}{includes}'
        '  <link name="base_link"/>\n</robot>\n',
        **{
            f"urdf/{one}.xacro": f"<robot>\n  <gazebo>\n    {text}\n  </gazebo>\n</robot>\n"
            for one, text in texts.items()
        },
    }
    place = package(tmp_path, "owl", files)
    options = SensorOptions("imu", "base_link")
    for _ in range(2):  # the second time nothing is added
        addition = opened(place, "humble", simulator)
        add_sensor(addition, "extra", options)
        plan = addition.finish()
        write_addition(plan)
    assert plan.files == ()
    having = [
        one.name for one in place.rglob("*.xacro") if '<sensor name="extra"' in one.read_text()
    ]
    assert having == [f"{simulator}.xacro"]


def test_a_link_that_is_not_there(tmp_path: Path) -> None:
    addition = opened(copied(tmp_path, "diff_drive-jazzy-gz"))
    with pytest.raises(RequestError, match="has no link bas_link") as refused:
        add_sensor(addition, "extra", SensorOptions("imu", "bas_link"))
    assert "Did you mean `base_link`?" in refused.value.hint


@pytest.mark.slow
@pytest.mark.parametrize("case", ["arm-humble-classic", "arm-jazzy-gz"])
def test_a_controller(tmp_path: Path, case: str) -> None:
    place = copied(tmp_path, case)
    distro = case.split("-")[1]
    before = reported(place, distro)
    plan, lines = added(
        place,
        lambda one: add_controller(one, "pusher", ControllerOptions("effort")),
        grows="launch/gazebo_model.launch.py",
    )
    assert plan.pasted == ()
    assert reported(place, distro) == before
    robot = [one for path in lines if path.startswith("model/") for one in lines[path]]
    assert {*robot} == {'<command_interface name="effort"/>'}
    assert lines["config/controllers.yaml"][:2] == [
        "pusher:",
        "type: effort_controllers/JointGroupEffortController",
    ]
    launch = lines["launch/gazebo_model.launch.py"]
    assert launch[0] == "spawn_pusher = Node("
    assert "on_exit=[spawn_controller, spawn_pusher]" in launch[-1]


def test_a_controller_needs_ros2_control(tmp_path: Path) -> None:
    addition = opened(copied(tmp_path, "simple-jazzy-gz"))
    with pytest.raises(NotFoundError, match="has no <ros2_control>"):
        add_controller(addition, "pusher", ControllerOptions("effort"))
