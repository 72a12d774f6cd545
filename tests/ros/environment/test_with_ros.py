"""The ROS of PyPI, for real: its start, messages that PyPI lacks, messages of a workspace."""

import subprocess
import sys
from pathlib import Path

import pytest

from ros_for_tests import plain_environment, ros_with, variables_for
from wsgen.building.run import build
from wsgen.events import Event, StepStarted
from wsgen.packages.workspace.layout import Workspace
from wsgen.ros.environment import RosEnvironment, open_ros, variables_of_nodes
from wsgen.ros.environment.wheels import site_packages

pytestmark = pytest.mark.slow
SECONDS = 400.0  # wall-clock, on a busy machine

# What nodes of other ROS 2 say about the type; see REP 2016.
HASH_OF_TF = "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"
LISTEN_TO_ITSELF = """
import time
import rclpy
from {package}.msg import {name}

rclpy.init()
node = rclpy.create_node("itself")
heard = []
node.create_subscription({name}, "said", heard.append, 10)
publisher = node.create_publisher({name}, "said", 10)
message = {message}
end = time.monotonic() + 300
while not heard and time.monotonic() < end:
    publisher.publish(message)
    rclpy.spin_once(node, timeout_sec=0.05)
print(heard[0] == message, node.get_publishers_info_by_topic("/said")[0].topic_type_hash)
"""

MEETS = """
import re
import select
import sys
import rclpy
from std_msgs.msg import String

rclpy.init()
node, met, is_told = rclpy.create_node(sys.argv[1]), set(), False
node.create_subscription(String, 'met', lambda message: met.add(message.data), 10)
publisher = node.create_publisher(String, 'met', 10)
while not select.select([sys.stdin], [], [], 0)[0]:  # others are still to meet this one
    publisher.publish(String(data=sys.argv[1]))
    rclpy.spin_once(node, timeout_sec=0.05)
    if len(met) == 3 and not is_told:
        is_told = True
        print(*sorted(met), flush=True)
# A port may have been deleted meanwhile: a word more behind its name.
used = set(re.findall(r'/dev/shm/(fastdds_\\w+)', open('/proc/self/maps').read()))
print(sum('port' not in one for one in used))
"""


def run(script: str, variables: dict[str, str]) -> str:
    done = subprocess.run(
        [sys.executable, "-c", script],
        env=variables,
        capture_output=True,
        text=True,
        timeout=SECONDS,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return done.stdout


def test_messages_that_pypi_lacks_are_those_of_other_machines(ros: RosEnvironment) -> None:
    script = LISTEN_TO_ITSELF.format(
        package="tf2_msgs",
        name="TFMessage",
        message="TFMessage(transforms=[TransformStamped(child_frame_id='grün')])",
    )
    script = f"from geometry_msgs.msg import TransformStamped{script}"
    assert run(script, variables_for(ros)).split() == ["True", HASH_OF_TF]


def test_the_interpreter_is_not_executed_again(ros: RosEnvironment) -> None:
    assert ros.python == Path(sys.executable)
    packages = site_packages(ros.prefixes[-1])
    assert (packages / "rclpy").is_dir()
    assert not [*packages.glob("*.pth")]
    assert not (packages / "ros_wheels_bootstrapper").exists()
    # CMake refuses folders that do not exist.
    cmake = [file.read_text(encoding="utf-8") for file in ros.prefixes[-1].rglob("*.cmake")]
    assert cmake
    assert not any("/opt/python" in text for text in cmake)


def test_what_is_there_is_not_made_again(ros: RosEnvironment) -> None:
    events: list[Event] = []
    again = open_ros(plain_environment(), listener=events.append)
    assert events == []
    assert again == ros


def write(root: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)


MANIFEST = """\
<?xml version="1.0"?>
<package format="3">
  <name>{name}</name>
  <version>0.1.0</version>
  <description>Messages</description>
  <maintainer email="somebody@example.com">Somebody</maintainer>
  <license>Apache-2.0</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <buildtool_depend>rosidl_default_generators</buildtool_depend>
  <depend>{depends}</depend>
  <exec_depend>rosidl_default_runtime</exec_depend>
  <member_of_group>rosidl_interface_packages</member_of_group>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
CMAKE = """\
cmake_minimum_required(VERSION 3.20)
project({name})
find_package(ament_cmake REQUIRED)
find_package(rosidl_default_generators REQUIRED)
find_package({depends} REQUIRED)
rosidl_generate_interfaces(${{PROJECT_NAME}}
  {files}
  DEPENDENCIES {depends}
)
ament_export_dependencies(rosidl_default_runtime)
ament_package()
"""


def workspace_with_messages(root: Path) -> Workspace:
    first = {"name": "door_msgs", "depends": "geometry_msgs"}
    second = {"name": "house_msgs", "depends": "door_msgs"}
    write(
        root / "src",
        {
            "door_msgs/package.xml": MANIFEST.format(**first),
            "door_msgs/CMakeLists.txt": CMAKE.format(
                **first, files='"msg/Door.msg" "srv/Open.srv"'
            ),
            "door_msgs/msg/Door.msg": "# a door\ngeometry_msgs/Point hinge\nstring<=20 name\n"
            "uint8 OAK=3\nfloat64[2] size\n",
            "door_msgs/srv/Open.srv": "bool wide\n---\nbool done\n",
            "house_msgs/package.xml": MANIFEST.format(**second),
            "house_msgs/CMakeLists.txt": CMAKE.format(**second, files='"msg/House.msg"'),
            "house_msgs/msg/House.msg": "door_msgs/Door[] doors\n",
        },
    )
    return Workspace(root=root)


def test_nodes_send_messages_of_the_workspace(ros: RosEnvironment, tmp_path: Path) -> None:
    workspace = workspace_with_messages(tmp_path)
    result = build(workspace, environment=plain_environment())
    assert result.succeeded
    assert result.diagnostics == ()
    setup = f". {workspace.install}/setup.sh && exec {sys.executable} -c"
    script = LISTEN_TO_ITSELF.format(
        package="house_msgs",
        name="House",
        message="House(doors=[Door(name='front', size=[2.0, 0.9])])",
    )
    script = (
        f"from door_msgs.msg import Door\nfrom door_msgs.srv import Open{script}\nprint(Door.OAK)"
    )
    done = subprocess.run(
        ["sh", "-c", f'{setup} "$0"', script],
        env=variables_for(ros),
        capture_output=True,
        text=True,
        timeout=SECONDS,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    heard, type_hash, oak = done.stdout.split()
    assert (heard, oak) == ("True", "3")
    assert type_hash.startswith("RIHS01_")
    # What is wrong is told with file and line, and by the name of the package.
    message = tmp_path / "src" / "door_msgs" / "msg" / "Door.msg"
    message.write_text("nav_msgs/Path way\n")
    result = build(workspace, packages=["door_msgs"], environment=plain_environment())
    assert not result.succeeded
    (found,) = result.diagnostics
    assert "nav_msgs is used, but it is not among DEPENDENCIES" in found.message
    assert (found.file, found.line) == (message, 1)


def test_messages_that_need_a_released_package_nobody_has_are_left_out(tmp_path: Path) -> None:
    used = {"name": "way_msgs", "depends": "geographic_msgs"}
    unused = {"name": "wind_msgs", "depends": "geographic_msgs"}
    write(
        tmp_path / "src",
        {
            "way_msgs/package.xml": MANIFEST.format(**used),
            "way_msgs/CMakeLists.txt": CMAKE.format(**used, files='"msg/Way.msg"'),
            "way_msgs/msg/Way.msg": "geographic_msgs/GeoPoint[] stops\n",
            "wind_msgs/package.xml": MANIFEST.format(**unused),
            "wind_msgs/CMakeLists.txt": CMAKE.format(**unused, files='"msg/Wind.msg"'),
            "wind_msgs/msg/Wind.msg": "float64 speed  # beside geographic_msgs/GeoPoint\n",
        },
    )
    result = build(Workspace(root=tmp_path), environment=plain_environment())
    assert result.succeeded
    (found,) = result.diagnostics
    assert (found.code, found.element) == ("BLD032", "way_msgs")
    assert "without messages" in found.message
    assert "geographic_msgs" in found.message
    assert (tmp_path / "install/wind_msgs/lib").is_dir()


def test_without_the_extra_messages_are_left_out_and_pip_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wsgen.ros.environment.environment.find_spec", lambda _: None)
    environment = {**plain_environment(), "XDG_CACHE_HOME": str(tmp_path / "cache")}
    result = build(workspace_with_messages(tmp_path / "ws"), environment=environment)
    assert result.succeeded
    found = {str(one.element): one for one in result.diagnostics if one.code == "BLD032"}
    assert "messages" in found["door_msgs"].message
    assert "pip install 'wsgen[ros]'" in str(found["door_msgs"].hint)


def test_only_workspaces_with_messages_bring_ros(tmp_path: Path) -> None:
    write(
        tmp_path / "src" / "plain",
        {
            "package.xml": MANIFEST.format(name="plain", depends="std_msgs"),
            "CMakeLists.txt": "cmake_minimum_required(VERSION 3.20)\n"
            "project(plain LANGUAGES NONE)\nfind_package(ament_cmake REQUIRED)\nament_package()\n",
        },
    )
    events: list[Event] = []
    environment = {**plain_environment(), "XDG_CACHE_HOME": str(tmp_path / "cache")}
    result = build(Workspace(root=tmp_path), environment=environment, listener=events.append)
    assert result.succeeded
    assert not [one for one in events if isinstance(one, StepStarted) and one.step[0] == "ros"]
    assert not (tmp_path / "cache" / "wsgen" / "ros").exists()


def test_further_messages_are_built_when_they_are_asked_for() -> None:
    ros = ros_with("ackermann_msgs")
    assert [prefix.name.partition("-")[0] for prefix in ros.prefixes[:-1]] == [
        "ackermann_msgs",
        "tf2_msgs",
    ]
    script = LISTEN_TO_ITSELF.format(
        package="ackermann_msgs",
        name="AckermannDriveStamped",
        message="AckermannDriveStamped()",
    )
    assert run(script, variables_for(ros)).startswith("True RIHS01_")


def test_nodes_print_nothing_and_meet_without_shared_memory(
    ros: RosEnvironment, monkeypatch: pytest.MonkeyPatch
) -> None:
    with_memory = variables_for(ros, variables_of_nodes(ros, ros.variables))
    monkeypatch.setattr("wsgen.ros.environment.environment.LEAST_FREE", 1 << 60)
    without = variables_for(ros, variables_of_nodes(ros, ros.variables))
    started = [
        subprocess.Popen(
            [str(ros.python), "-c", MEETS, name],
            env=variables,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        for name, variables in (("a", without), ("b", without), ("c", with_memory))
    ]
    try:
        met = [one.stdout.readline() for one in started if one.stdout is not None]
        output = [one.communicate(timeout=SECONDS)[0] for one in started]
    finally:
        for one in started:
            one.kill()
    assert met == ["a b c\n"] * 3
    assert output == ["0\n", "0\n", "2\n"]
