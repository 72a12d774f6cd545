from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.live.needed_ros import (
    messages_of_devices,
    messages_of_packages,
    messages_of_plan,
    messages_of_robots_to_come,
)
from wsgen.model.devices import Devices, Element, MountedSensor
from wsgen.model.plan import LaunchPlan, Process
from wsgen.packages.workspace.layout import Workspace, find_packages

CONTROL = {"control_msgs", "controller_manager_msgs"}


def _plan(process: Process) -> LaunchPlan:
    return LaunchPlan(package="robot", launch_file=Path("a.launch.py"), processes=(process,))


@pytest.mark.parametrize(
    ("process", "needed"),
    [
        (Process(package="controller_manager", executable="spawner"), CONTROL),
        (
            Process(
                package=None,
                executable=None,
                command=("ros2", "control", "load_controller", "arm"),
            ),
            CONTROL,
        ),
        (
            Process(
                package="ros_gz_bridge",
                executable="parameter_bridge",
                arguments=("/a@ros_gz_interfaces/msg/Contacts[gz.msgs.Contacts",),
            ),
            {"ros_gz_interfaces"},
        ),
        (Process(package="robot", executable="drive.py"), set()),
    ],
)
def test_messages_of_processes(process: Process, needed: set[str]) -> None:
    assert messages_of_plan(_plan(process)) == needed


def test_messages_of_the_file_of_a_bridge(tmp_path: Path) -> None:
    file = tmp_path / "bridge.yaml"
    file.write_text("- {ros_topic_name: a, ros_type_name: 'vision_msgs/msg/Detection2D'}\n")
    for config, needed in ((str(file), {"vision_msgs"}), (str(tmp_path / "none.yaml"), set())):
        bridge = Process(
            package="ros_gz_bridge", executable="bridge_node", parameters={"config_file": config}
        )
        assert messages_of_plan(_plan(bridge)) == needed


def test_messages_of_what_robots_carry(tmp_path: Path) -> None:
    contact = MountedSensor(
        name="bumper", kind="contact", link="base", frame="base", element=Element(tag="sensor")
    )
    plugin = Element(tag="plugin", attributes={"filename": "libgz_ros2_control-system.so"})
    devices = (Devices(sensors=(contact,)), Devices(plugins=(plugin,)))
    assert messages_of_devices(devices, "classic") == {"gazebo_msgs", *CONTROL}
    assert messages_of_devices(devices[:1], "gz") == {"ros_gz_interfaces"}
    steered = Element(tag="plugin", children=(Element(tag="use_actuator_msg", text="true"),))
    assert messages_of_devices([Devices(plugins=(steered,))], "gz") == {"actuator_msgs"}
    file = tmp_path / "controllers.yaml"
    file.write_text("tricycle: {ros__parameters: {publish_ackermann_command: true}}\n")
    parameters = (Element(tag="parameters", text=str(file)), Element(tag="parameters", text="no"))
    control = Element(tag="plugin", children=parameters)
    assert messages_of_devices([Devices(plugins=(control,))], "gz") == {"ackermann_msgs"}
    assert not messages_of_devices([Devices()], "gz")


def test_messages_that_nobody_declares(tmp_path: Path) -> None:
    files = {
        "package.xml": "<package><name>demo</name><exec_depend>sensor_msgs</exec_depend></package>",
        "CMakeLists.txt": "project(demo)\nfind_package(ament_cmake REQUIRED)\n",
        "scripts/drive": "from ackermann_msgs.msg import AckermannDrive\n",
        "config/bridge.yaml": "- ros_type_name: ros_gz_interfaces/msg/Contacts\n",
        "src/node.cpp": "#include <control_msgs/msg/pid_state.hpp>\n",
    }
    for name, text in files.items():
        file = tmp_path / "src" / "demo" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    packages = find_packages(Workspace(root=tmp_path))
    assert messages_of_packages(packages) == {"sensor_msgs", "ackermann_msgs", "ros_gz_interfaces"}


def test_messages_of_robots_that_a_second_launch_spawns(tmp_path: Path) -> None:
    files = {
        "package.xml": "<package><name>demo</name></package>",
        "CMakeLists.txt": "project(demo)\nfind_package(ament_cmake REQUIRED)\n",
        "urdf/arm.urdf.xacro": '<plugin filename="libgazebo_ros2_control.so" name="control"/>',
        "models/bumper/model.sdf": "<sensor name='bumper' type='contact'>",
        "src/node.cpp": "// of use_actuator_msg",
    }
    for name, text in files.items():
        file = tmp_path / "src" / "demo" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    packages = find_packages(Workspace(root=tmp_path))
    assert messages_of_robots_to_come(packages, "classic") == {"gazebo_msgs", *CONTROL}
    assert messages_of_robots_to_come(packages, "gz") == {"ros_gz_interfaces", *CONTROL}
    (tmp_path / "src/demo/models/bumper/model.sdf").unlink()
    (tmp_path / "src/demo/urdf/arm.urdf.xacro").unlink()
    assert not messages_of_robots_to_come(packages, "gz")
