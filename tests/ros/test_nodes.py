"""Our nodes and Python packages where ROS is, and `wsgen topic` and `wsgen node` on them."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation

from ros_for_tests import variables_for

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.ros_environment import RosEnvironment

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[2]
USER = Path(__file__).with_name("shim_user.py")
WAIT = 120.0  # s, on a busy machine
ROBOT = """\
<robot name="crane">
  <link name="base_link"/><link name="arm"/><link name="hook"/><link name="lamp"/>
  <joint name="turn" type="revolute">
    <parent link="base_link"/><child link="arm"/><origin xyz="0 0 2" rpy="0 0.5 0"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/>
  </joint>
  <joint name="lift" type="prismatic">
    <parent link="arm"/><child link="hook"/><origin xyz="1 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
    <mimic joint="turn" multiplier="0.5" offset="0.1"/>
  </joint>
  <joint name="mount" type="fixed">
    <parent link="base_link"/><child link="lamp"/><origin xyz="0.3 0 0"/>
  </joint>
</robot>
"""


@pytest.fixture
def environment(ros: RosEnvironment) -> dict[str, str]:
    """The variables of nodes."""
    found = variables_for(ros)
    shim = str(ROOT / "src" / "wsgen" / "ros_shim")
    found["PYTHONPATH"] = os.pathsep.join([found.get("PYTHONPATH", ""), shim])
    return found


@contextlib.contextmanager
def node(name: str, *arguments: str, environment: dict[str, str]) -> Iterator[None]:
    command = [sys.executable, "-m", f"wsgen.ros_nodes.{name}", *arguments]
    with subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True) as process:
        try:
            yield
            assert process.poll() is None, process.stderr and process.stderr.read()
            process.send_signal(signal.SIGINT)
            assert process.wait(WAIT) == 0
        finally:
            process.kill()


@contextlib.contextmanager
def crane(environment: dict[str, str], folder: Path) -> Iterator[None]:
    file = folder / "crane.urdf"
    file.write_text(ROBOT)
    with (
        node("robot_state_publisher", str(file), environment=environment),
        node(
            "joint_state_publisher",
            *("--ros-args", "-p", "rate:=20", "-p", "zeros.turn:=1.2"),
            environment=environment,
        ),
        node(
            "static_transform_publisher",
            *("--x", "5", "--frame-id", "map", "--child-frame-id", "base_link"),
            environment=environment,
        ),
    ):
        yield


def tool(*arguments: str, environment: dict[str, str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "wsgen", *arguments],
        env=environment,
        capture_output=True,
        text=True,
        timeout=WAIT,
        check=False,
    )


def test_frames_and_what_shows_them(environment: dict[str, str], tmp_path: Path) -> None:
    with crane(environment, tmp_path):
        check_frames(environment)
        check_topics(environment)
        check_nodes(environment)
    refused = tool("topic", "type", "/gone", environment=environment)
    assert refused.returncode == 1
    assert "Unknown topic '/gone'" in refused.stderr


def echoed(topic: str, environment: dict[str, str], *options: str) -> str:
    end = time.monotonic() + WAIT
    while time.monotonic() < end:
        run = tool("topic", "echo", topic, "--once", *options, environment=environment)
        if run.returncode == 0:
            return run.stdout
    raise AssertionError(run.stderr)


def check_frames(environment: dict[str, str]) -> None:
    moving = yaml.safe_load(echoed("/tf", environment).split("---")[0])["transforms"]
    places = {one["child_frame_id"]: one for one in moving}
    assert set(places) == {"arm", "hook"}
    arm, hook = places["arm"]["transform"], places["hook"]["transform"]
    turned = Rotation.from_euler("y", 0.5) * Rotation.from_euler("z", 1.2)
    assert list(arm["translation"].values()) == [0, 0, 2]
    quaternion = Rotation.from_quat([arm["rotation"][axis] for axis in "xyzw"])
    assert (turned.inv() * quaternion).magnitude() < 1e-9
    assert list(hook["translation"].values()) == pytest.approx([1, 0, 0.5 * 1.2 + 0.1])
    text = echoed("/tf_static", environment, "--field", "transforms")
    assert "frame_id='base_link'" in text or "frame_id='map'" in text


def check_topics(environment: dict[str, str]) -> None:
    shown = tool("topic", "list", "-t", "--spin-time", "3", environment=environment)
    assert "/joint_states [sensor_msgs/msg/JointState]" in shown.stdout.splitlines()
    assert "/tf_static [tf2_msgs/msg/TFMessage]" in shown.stdout.splitlines()
    assert (
        tool("topic", "type", "/tf", environment=environment).stdout == "tf2_msgs/msg/TFMessage\n"
    )
    info = tool(
        "topic", "info", "/robot_description", "--spin-time", "3", environment=environment
    ).stdout
    assert info == "Type: std_msgs/msg/String\nPublisher count: 1\nSubscription count: 1\n"
    described = yaml.safe_load(echoed("/robot_description", environment, "-f").split("---")[0])
    assert described["data"] == ROBOT
    states = yaml.safe_load(echoed("/joint_states", environment).split("---")[0])
    np.testing.assert_allclose(states["position"], [1.2, 0.7])
    missing = tool("topic", "echo", "/joint_state", environment=environment)
    assert missing.returncode == 1
    assert "Did you mean /joint_states?" in missing.stderr
    published = tool(
        *("topic", "pub", "-1", "-w", "0", "/go", "std_msgs/msg/String", "{data: on}"),
        environment=environment,
    )
    assert published.stdout == (
        "publisher: beginning loop\npublishing #1: std_msgs.msg.String(data='True')\n\n"
    )
    wrong = tool("topic", "pub", "/go", "std_msgs/msg/Sting", environment=environment)
    assert wrong.returncode == 1
    assert "The message type 'std_msgs/msg/Sting' is invalid" in wrong.stderr


def check_nodes(environment: dict[str, str]) -> None:
    shown = tool("node", "list", "--spin-time", "3", environment=environment).stdout.splitlines()
    assert shown[:2] == ["/joint_state_publisher", "/robot_state_publisher"]
    assert shown[2].startswith("/static_transform_publisher_")
    info = tool("node", "info", "/robot_state_publisher", environment=environment).stdout
    assert info.startswith("/robot_state_publisher\n  Subscribers:\n    /joint_states: sensor_msgs")
    assert "  Action Clients:\n" in info


def test_what_public_nodes_import(environment: dict[str, str]) -> None:
    run = subprocess.run(
        [sys.executable, USER],
        env=environment,
        capture_output=True,
        text=True,
        timeout=WAIT,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout == "all is well\n"


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ("", "robot_description parameter must not be empty"),
        ("robot_description:=<robot/>", "Unable to initialize urdf::model from robot description"),
        ("publish_frequency:=20", "robot_description parameter must not be empty"),
    ],
)
def test_a_node_that_cannot_start_says_why(
    parameters: str, message: str, environment: dict[str, str]
) -> None:
    arguments = ["--ros-args", "-p", parameters] if parameters else []
    run = subprocess.run(
        [sys.executable, "-m", "wsgen.ros_nodes.robot_state_publisher", *arguments],
        env=environment,
        capture_output=True,
        text=True,
        timeout=WAIT,
        check=False,
    )
    assert run.returncode == 1
    assert message in run.stderr
    assert "Traceback" not in run.stderr
