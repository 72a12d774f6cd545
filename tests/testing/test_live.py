"""The fixture `live`: launch files with nodes, in tests, with the ROS of PyPI."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from live_launch import is_alive, wait_until
from ros_for_tests import plain_environment, ros_with

if TYPE_CHECKING:
    from collections.abc import Sequence

pytestmark = pytest.mark.slow
SECONDS = 400.0  # wall-clock, on a busy machine
PAGE = Path(__file__).parents[2] / "docs" / "testing.md"
EXAMPLE = re.compile(r"^```py\n(.*?)^```$", re.MULTILINE | re.DOTALL)

# What a stranger writes: a package in Python with a node of its own, and a test of it.
DRIVER = """
import sys
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_srvs.srv import Trigger

class Driver(Node):
    def __init__(self):
        super().__init__('driver')
        self.speed = 0.3
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_timer(0.1, self.drive)
        self.create_service(Trigger, 'stop', self.stop)
        self.create_service(Trigger, 'crash', self.crash)

    def drive(self):
        velocity = Twist()
        velocity.linear.x = self.speed
        self.publisher.publish(velocity)

    def stop(self, request, response):
        self.speed = 0.0
        response.success = True
        return response

    def crash(self, request, response):
        raise ZeroDivisionError('no ground')

def main():
    rclpy.init()
    rclpy.spin(Driver())
"""
LAUNCH = """
import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch_ros.actions import Node

def generate_launch_description():
    robot = os.path.join(get_package_share_directory('roamer'), 'launch', 'robot.launch.py')
    return LaunchDescription([
        IncludeLaunchDescription(robot),
        Node(package='stranger', executable='driver', parameters=[{'use_sim_time': True}]),
    ])
"""
SETUP = """
from setuptools import setup
setup(
    name='stranger', version='0.0.1', packages=['stranger'],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/stranger']),
        ('share/stranger', ['package.xml']),
        ('share/stranger/launch', ['launch/bringup.launch.py']),
    ],
    entry_points={'console_scripts': ['driver = stranger.driver:main']},
)
"""
MANIFEST = """<?xml version="1.0"?>
<package format="3">
  <name>stranger</name><version>0.0.1</version><description>A driver.</description>
  <maintainer email="a@b.cd">A</maintainer><license>MIT</license>
  <exec_depend>rclpy</exec_depend><exec_depend>geometry_msgs</exec_depend>
  <exec_depend>std_srvs</exec_depend><exec_depend>roamer</exec_depend>
  <export><build_type>ament_python</build_type></export>
</package>
"""
TESTS = """
import os
import pytest
from wsgen.testing import needs_ros

pytestmark = needs_ros

def test_drives_and_stops(live):
    with live("stranger", "bringup.launch.py") as ros:
        robot = ros.robot
        assert ros.wait_until(lambda: robot.pose.x > 0.3, seconds=20) is True
        assert ros.call("/stop", "std_srvs/srv/Trigger").success
        with pytest.raises(Exception, match="No node offers the service /stopp") as caught:
            ros.call("/stopp", "std_srvs/srv/Trigger", seconds=0.5)
        assert caught.value.hint.startswith("Did you mean `/stop`? Services of this type: ")
        with pytest.raises(Exception, match="has the type std_srvs/srv/Trigger, and not"):
            ros.call("/stop", "std_srvs/srv/Empty", seconds=0.5)
        ros.run_for(1.0)
        there = robot.pose.x
        ros.run_for(1.0)
        assert abs(robot.pose.x - there) < 0.02
        odometry = ros.message("/odom")
        assert abs(odometry.pose.pose.position.x - robot.pose.x) < 0.1
        assert robot.positions["left_wheel_joint"] > 1.0
        print("domain", os.environ.get("ROS_DOMAIN_ID"))

def test_crashes(live):
    with live("stranger", "bringup.launch.py") as ros:
        ros.call("/crash", "std_srvs/srv/Trigger")

def test_never(live):
    with live("stranger", "bringup.launch.py") as ros:
        ros.wait_until(lambda: ros.robots["roamer"].pose.x > 9, seconds=1)

def test_hangs(live):
    with live("stranger", "bringup.launch.py") as ros:
        open(os.environ["UP"], "w").close()
        ros.run_for(10_000)
"""
BEHAVIOR = """
[[behavior]]
name = "wanders"
run = true
seconds = 4.0
travels = 0.5
"""


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace with the wanderer's package, and one of a stranger with a driver; built."""
    ros_with()
    root = tmp_path_factory.mktemp("live")
    wsgen = [sys.executable, "-m", "wsgen"]
    new = [*wsgen, "new", "roamer", "--template", "wanderer", "--distro", "jazzy", "-q"]
    _run(new, root)
    root /= "ws_gazebo"
    launch = root / "src" / "roamer" / "launch"
    text = (launch / "gazebo_model.launch.py").read_text()
    without_node = text.replace("        wanderer,\n", "")
    assert without_node != text
    (launch / "robot.launch.py").write_text(without_node)
    stranger = root / "src" / "stranger"
    files = {
        "stranger/__init__.py": "",
        "stranger/driver.py": DRIVER,
        "launch/bringup.launch.py": LAUNCH,
        "resource/stranger": "",
        "setup.py": SETUP,
        "setup.cfg": "[develop]\nscript_dir=$base/lib/stranger\n"
        "[install]\ninstall_scripts=$base/lib/stranger\n",
        "package.xml": MANIFEST,
        "test/test_bringup.py": TESTS,
    }
    for name, content in files.items():
        (stranger / name).parent.mkdir(parents=True, exist_ok=True)
        (stranger / name).write_text(content, encoding="utf-8")
    _run([*wsgen, "build", "-q"], root)
    return root


def _run(
    command: Sequence[str], folder: Path, *, code: int = 0
) -> subprocess.CompletedProcess[str]:
    done = subprocess.run(
        list(command),
        cwd=folder,
        env={**plain_environment(), "COLUMNS": "200"},
        capture_output=True,
        text=True,
        timeout=SECONDS,
        check=False,
    )
    assert done.returncode == code, done.stdout + done.stderr
    return done


def _pytest(folder: Path, *words: str | Path, code: int = 0) -> str:
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "--color=no", "-q"]
    return _run([*command, *map(str, words)], folder, code=code).stdout


def test_a_strangers_package_in_parallel(workspace: Path) -> None:
    file = workspace / "src" / "stranger" / "test" / "test_bringup.py"
    words = ("-n", "2", "-k", "not hangs")
    out = _pytest(workspace, *words, file, code=1)
    assert "2 failed, 1 passed" in out, out
    assert re.search(r"SessionDiedError: The process driver-\d has failed \(exit code 1\)", out)
    assert "ZeroDivisionError: no ground" in out
    assert "The condition does not hold within 1 simulated seconds" in out


def test_the_examples_pass(workspace: Path) -> None:
    (example,) = EXAMPLE.findall(PAGE.read_text(encoding="utf-8"))
    file = workspace / "src" / "roamer" / "test" / "test_example.py"
    file.write_text(example, encoding="utf-8")
    assert "2 passed" in _pytest(workspace, file)


def test_nothing_is_left_when_pytest_is_killed(workspace: Path, tmp_path: Path) -> None:
    up = tmp_path / "up"
    file = workspace / "src" / "stranger" / "test" / "test_bringup.py"
    run = subprocess.Popen(
        [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-q", "-k", "hangs", str(file)],
        cwd=workspace,
        env={**plain_environment(), "UP": str(up), "TMPDIR": str(tmp_path)},
        stdout=subprocess.DEVNULL,
    )
    try:
        wait_until(up.exists, lambda: "it has not started", SECONDS)
        mark = f"ROS_LOG_DIR={tmp_path}".encode()
        started = [pid for pid in _pids() if mark in _environ(pid)]
        assert len(started) > 5
    finally:
        run.send_signal(signal.SIGKILL)
        run.wait()
    wait_until(
        lambda: not any(map(is_alive, started)), lambda: f"left: {list(filter(is_alive, started))}"
    )


def _pids() -> list[int]:
    return [int(one.name) for one in Path("/proc").iterdir() if one.name.isdecimal()]


def _environ(pid: int) -> bytes:
    try:
        return Path(f"/proc/{pid}/environ").read_bytes()
    except OSError:
        return b""


def test_validate_runs_the_launch_file(workspace: Path) -> None:
    settings = workspace / "src" / "roamer" / "wsgen.toml"
    before = settings.read_text(encoding="utf-8")
    try:
        settings.write_text(before + BEHAVIOR, encoding="utf-8")
        words = ("validate", "roamer", "--launch", "gazebo_model.launch.py")
        done = _run([sys.executable, "-m", "wsgen", *words], workspace)
        assert re.search(r"ok +wanders: .* traveled \d", done.stdout)
        # Without its node, the robot does not move.
        words = ("validate", "roamer", "--launch", "robot.launch.py")
        done = _run([sys.executable, "-m", "wsgen", *words], workspace, code=1)
        assert "error[SPN101] way-too-short: `wanders`: in 4 s the robot travels 0" in done.stdout
    finally:
        settings.write_text(before, encoding="utf-8")
