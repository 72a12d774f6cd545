"""A launch file that is started with the ROS of PyPI, from `wsgen new` to a node that drives."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from contextlib import suppress
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from chromium import needs_chromium, open_chromium
from live_launch import is_alive, wait_until
from own_network import network, ros_domain
from ros_for_tests import plain_environment, ros_with

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

pytestmark = pytest.mark.slow
SECONDS = 600.0  # wall-clock, on a busy machine
DRIVE = """#!/usr/bin/env python3
import sys
import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException

rclpy.init()
node = rclpy.create_node('driver')
node.declare_parameter('goal', 0.0)
goal = node.get_parameter('goal').value
publisher = node.create_publisher(Twist, 'cmd_vel', 10)
node.create_timer(0.1, lambda: publisher.publish(Twist(linear={}(x=0.4))))
places = []
node.create_subscription(Odometry, 'odom', lambda odom: places.append(odom.pose.pose.position.x), 9)
try:
    while not places or places[-1] < goal:
        rclpy.spin_once(node)
except (KeyboardInterrupt, ExternalShutdownException):
    sys.exit(0)
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

# Of the page: what it shows, the simulated time, and how to press a button.
TEXT = "document.body.textContent"
SIMULATED = f"Number(({TEXT}.match(/([0-9.]+) s simulated/) || [0, 0])[1])"
PRESS = (
    "[...document.querySelectorAll('button')].find(one => one.textContent.trim() === '{}').click()"
)

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


@pytest.mark.parametrize(
    "words",
    [
        ("list",),  # written at the end
        ("pub", "/x", "std_msgs/msg/String", "{data: a}", "--once", "-w", "0"),  # and at once
    ],
)
def test_a_topic_command_whose_output_finds_a_full_disk(
    workspace: Path, tmp_path: Path, words: Sequence[str]
) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "wsgen", "topic", *words, "--spin-time", "0"],
            cwd=workspace,
            env=_environment(tmp_path),
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=SECONDS,
            check=False,
        )
    assert done.returncode == 4, done.stderr
    assert "Cannot write the output or a temporary file: No space left" in done.stderr
    assert "Traceback" not in done.stderr


@needs_chromium
def test_a_run_is_shown_in_the_browser(workspace: Path, tmp_path: Path) -> None:
    pytest.importorskip("viser")
    screen, topics = tmp_path / "screen", tmp_path / "topics.mcap"
    words = ("drive.launch.py", "--run", "--view", "--no-browser", "--record", str(topics))
    with (
        screen.open("wb") as stream,
        subprocess.Popen(
            _command(*words, "--for", "3000"),
            cwd=workspace,
            env=_environment(tmp_path),
            stdout=stream,
            stderr=subprocess.STDOUT,
        ) as run,
    ):
        try:
            wait_until(lambda: "Press Ctrl-C" in screen.read_text(), screen.read_text, SECONDS)
            (url,) = re.findall(r"^http://127\.0\.0\.1:\d+$", screen.read_text(), re.MULTILINE)
            with open_chromium() as browser:
                tab = browser.open(url, width=320, height=240, draws_seldom=True)
                tab.wait_for(f"{TEXT}.includes('× real time')", SECONDS)
                tab.wait_for(f"{TEXT}.includes('rover: ')", SECONDS)
                tab.evaluate(PRESS.format("Pause"))
                tab.wait_for(f"{TEXT}.includes('simulated, paused')", SECONDS)
                late = browser.open(url, width=320, height=240, draws_seldom=True)
                late.wait_for(f"{TEXT}.includes('simulated, paused')", SECONDS)
                times = [one.evaluate(SIMULATED) for one in (tab, late)]
                assert times[0] == times[1] > 0
                late.evaluate(PRESS.format("Run"))
                tab.wait_for(f"{SIMULATED} > {times[0]}", SECONDS)
                run.send_signal(signal.SIGINT)
                assert run.wait(SECONDS) == 0, screen.read_text()
                tab.wait_for(f"{TEXT}.includes('The run has ended after')", SECONDS)
        finally:
            run.terminate()  # does nothing when it has ended
    assert "Traceback" not in screen.read_text()
    assert topics.stat().st_size > 10_000
    refused = subprocess.run(
        _command("spawn.launch.py", "--run", "--view"),
        cwd=workspace,
        env=_environment(tmp_path),
        capture_output=True,
        text=True,
        timeout=SECONDS,
        check=False,
    )
    assert refused.returncode == 2
    assert "spawn.launch.py starts no simulator" in refused.stderr


@pytest.mark.parametrize("way", ["wsgen", "guard", "service", "node server", "SIGINT", "SIGTERM"])
def test_nothing_is_left_of_a_run_that_is_ended(workspace: Path, tmp_path: Path, way: str) -> None:
    """Neither a process, nor shared memory, nor a port, whoever is killed."""
    before = _shared_memory() | _ports()
    screen = tmp_path / "screen"
    # As a script has it in the background.
    ignoring = ["sh", "-c", "trap '' INT; exec \"$@\"", "sh"] if way == "SIGINT" else []
    with (
        screen.open("wb") as stream,
        subprocess.Popen(
            [*ignoring, *_command("gazebo_model.launch.py", "--run")],
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
        (guard,) = _children(run.pid)
        (service,) = _children(guard)
        (server,) = _parents(pids) - {service}
        assert _ports() > before & _ports()
        assert {port.partition(":")[0] for port in _ports() - before} == {"0100007F"}  # 127.0.0.1
        if way.startswith("SIG"):
            run.send_signal(getattr(signal, way))
        else:
            killed = {"wsgen": run.pid, "guard": guard, "service": service, "node server": server}
            os.kill(killed[way], signal.SIGKILL)
        wait_until(lambda: not _run_for(tmp_path), lambda: f"{_run_for(tmp_path)} run")
    wait_until(
        lambda: _shared_memory() | _ports() <= before,
        lambda: f"{(_shared_memory() | _ports()) - before} is left",
    )


def _parent(pid: int) -> int:
    stat = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8", errors="replace")
    return int(stat.rpartition(")")[2].split()[1])


def _parents(pids: Iterable[int]) -> set[int]:
    """Those of the processes that have not ended."""
    found = set()
    for pid in pids:
        with suppress(OSError):  # a spawner has just ended
            found.add(_parent(pid))
    return found


def _children(pid: int) -> list[int]:
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            found += [int(folder.name)] if _parent(int(folder.name)) == pid else []
    return found


def _run_for(folder: Path) -> list[int]:
    """The processes that have the folder among their variables."""
    found = []
    for environ in Path("/proc").glob("[0-9]*/environ"):
        with suppress(OSError):
            if str(folder).encode() in environ.read_bytes():
                found.append(int(environ.parent.name))
    return [pid for pid in found if is_alive(pid)]


def _ports() -> set[str]:
    """The UDP ports of this domain, with the address that they are bound to."""
    first = 7400 + 250 * int(ros_domain())
    ports = set()
    for kind in ("udp", "udp6"):
        with suppress(OSError):
            for line in (network().tables / kind).read_text(encoding="utf-8").splitlines()[1:]:
                host, _, port = line.split()[1].partition(":")
                if first <= int(port, 16) < first + 250:
                    ports.add(f"{host}:{int(port, 16)}")
    return ports


def _shared_memory() -> set[str]:
    """The segments of this domain, whose ports only its processes have."""
    first = 7400 + 250 * int(ros_domain())
    own = {f"fastdds_port{port}" for port in range(first, first + 250)}
    return {path.name for path in Path("/dev/shm").glob("fastdds_port*") if path.name in own}
