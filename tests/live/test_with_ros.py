"""A launch file that is started with the ROS of PyPI, from `wsgen new` to a node that drives."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from live_launch import is_alive, wait_until
from ros_for_tests import plain_environment, ros_domain, ros_with

if TYPE_CHECKING:
    from collections.abc import Sequence

pytestmark = pytest.mark.slow
SECONDS = 300.0  # wall-clock, on a busy machine
DRIVE = """#!/usr/bin/env python3
import sys
import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry

rclpy.init()
node = rclpy.create_node('driver')
node.declare_parameter('goal', 0.0)
goal = node.get_parameter('goal').value
publisher = node.create_publisher(Twist, 'cmd_vel', 10)
node.create_timer(0.1, lambda: publisher.publish(Twist(linear={}(x=0.4))))
places = []
node.create_subscription(Odometry, 'odom', lambda odom: places.append(odom.pose.pose.position.x), 9)
while not places or places[-1] < goal:
    rclpy.spin_once(node)
node.get_logger().info(f'at {places[-1] > 0.3}, {node.get_name()}')
sys.exit(0 if goal else 7)
""".replace("{}", "__import__('geometry_msgs.msg', fromlist=['Vector3']).Vector3")
LAUNCH = """
import os
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node, RosTimer, SetUseSimTime
from launch.actions import LogInfo

def generate_launch_description():
    here = os.path.dirname(__file__)
    return LaunchDescription([
        SetUseSimTime(True),
        IncludeLaunchDescription(os.path.join(here, 'gazebo_model.launch.py')),
        Node(executable=os.path.join(here, 'drive.py'), name='pilot', output='screen',
             parameters=[{'goal': 0.5}]),
        RosTimer(period=1.0, actions=[LogInfo(msg='a second later')]),
    ])
"""


# The simulator is that of another terminal, which is not there.
SPAWN = """
from launch import LaunchDescription
from launch.actions import LogInfo
from launch_ros.actions import Node, RosTimer

def generate_launch_description():
    spawner = Node(package='gazebo_ros', executable='spawn_entity.py',
                   arguments=['-entity', 'rover', '-topic', 'robot_description'])
    return LaunchDescription([spawner, RosTimer(period=1.0, actions=[LogInfo(msg='later')])])
"""


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    ros_with()
    root = tmp_path_factory.mktemp("live")
    made = subprocess.run(
        [sys.executable, "-m", "wsgen", "new", "rover", "--template", "diff_drive", "-q"],
        cwd=root,
        env=plain_environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert made.returncode == 0, made.stderr
    (launch,) = root.rglob("launch")
    (launch / "drive.py").write_text(DRIVE)
    (launch / "drive.py").chmod(0o755)
    (launch / "drive.launch.py").write_text(LAUNCH)
    (launch / "spawn.launch.py").write_text(SPAWN)
    return launch.parents[2]


def _command(*words: str) -> Sequence[str]:
    return [sys.executable, "-m", "wsgen", "launch", "rover", *words]


def _environment(tmp_path: Path) -> dict[str, str]:
    own = {"ROS_DOMAIN_ID": ros_domain(), "ROS_LOG_DIR": str(tmp_path)}
    return {**plain_environment(), **own}


def test_a_node_of_the_user_drives_the_robot(workspace: Path, tmp_path: Path) -> None:
    words = ("drive.launch.py", "--run", "--rate", "max", "--until-exit", "pilot")
    done = subprocess.run(
        _command(*words),
        cwd=workspace,
        env=_environment(tmp_path),
        capture_output=True,
        text=True,
        timeout=SECONDS,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "at True, pilot" in done.stdout
    assert "[INFO] [launch.user]: a second later" in done.stdout
    assert "gzclient is left out" in done.stdout
    assert "Successfully spawned entity [rover]" in done.stdout
    assert "Traceback" not in done.stdout + done.stderr


def test_a_run_without_a_simulator_ends_after_its_seconds(workspace: Path, tmp_path: Path) -> None:
    done = subprocess.run(
        _command("spawn.launch.py", "--run", "--for", "4"),
        cwd=workspace,
        env=_environment(tmp_path),
        capture_output=True,
        text=True,
        timeout=SECONDS,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "[INFO] [launch.user]: later" in done.stdout
    assert "failed to terminate" not in done.stdout  # the spawner, which waits
    assert "failed" not in done.stderr
    refused = subprocess.run(
        _command("spawn.launch.py", "--run", "--until-exit", "spawn_entity"),
        cwd=workspace,
        env=_environment(tmp_path),
        capture_output=True,
        text=True,
        timeout=SECONDS,
        check=False,
    )
    assert refused.returncode == 2
    assert "Did you mean `spawn_entity.py`?" in refused.stderr


def test_nothing_is_left_of_a_run_that_is_killed(workspace: Path, tmp_path: Path) -> None:
    before = _shared_memory()
    screen = tmp_path / "screen"
    with (
        screen.open("wb") as stream,
        subprocess.Popen(
            _command("gazebo_model.launch.py", "--run"),
            cwd=workspace,
            env=_environment(tmp_path),
            stdout=stream,
            stderr=subprocess.STDOUT,
        ) as run,
    ):
        wait_until(lambda: "Successfully spawned" in screen.read_text(), screen.read_text, SECONDS)
        words = screen.read_text().replace("[", " ").replace("]", " ").split()
        pids = [int(word) for last, word in pairwise(words) if last == "pid"]
        assert len(set(pids)) >= 3
        os.kill(run.pid, signal.SIGKILL)
    wait_until(lambda: not any(map(is_alive, pids)), lambda: f"some of {pids} live")
    wait_until(lambda: _shared_memory() <= before, lambda: f"{_shared_memory() - before} is left")


def _shared_memory() -> set[str]:
    """The segments of this domain, whose ports only its processes have."""
    first = 7400 + 250 * int(ros_domain())
    own = {f"fastdds_port{port}" for port in range(first, first + 250)}
    return {path.name for path in Path("/dev/shm").glob("fastdds_port*") if path.name in own}
