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
from wsgen.simulation.live_runs import FOLDER_VARIABLE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from wsgen.ros.environment import RosEnvironment

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[2]
USER = Path(__file__).with_name("shim_user.py")
WAIT = 300.0  # s, on a busy machine
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
    shim = str(ROOT / "src" / "wsgen" / "ros" / "shim")
    found["PYTHONPATH"] = os.pathsep.join([found.get("PYTHONPATH", ""), shim])
    return found


@contextlib.contextmanager
def node(name: str, *arguments: str, environment: dict[str, str]) -> Iterator[None]:
    command = [sys.executable, "-m", f"wsgen.live.nodes.{name}", *arguments]
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
    at_end = tmp_path / "at_end"
    at_end.mkdir()
    text = "import atexit, os\natexit.register(os.write, 1, b'The interpreter is torn down.')\n"
    (at_end / "sitecustomize.py").write_text(text, encoding="utf-8")
    path = os.pathsep.join([str(at_end), environment.get("PYTHONPATH", "")])
    refused = tool("topic", "type", "/gone", environment={**environment, "PYTHONPATH": path})
    assert (refused.returncode, refused.stdout) == (1, "")
    assert "Unknown topic '/gone'" in refused.stderr
    assert f"No node is found in ROS_DOMAIN_ID {environment['ROS_DOMAIN_ID']}." in refused.stderr


def reported(
    *words: str,
    environment: dict[str, str],
    holds: Callable[[subprocess.CompletedProcess[str]], bool] = lambda run: run.returncode == 0,
) -> subprocess.CompletedProcess[str]:
    """What a tool says once it has found all; on a busy machine it may give up before."""
    end = time.monotonic() + WAIT
    while not holds(run := tool(*words, environment=environment)):
        assert time.monotonic() < end, f"{words}: {run.stdout}{run.stderr}"
    return run


def echoed(topic: str, environment: dict[str, str], *options: str) -> str:
    return reported("topic", "echo", topic, "--once", *options, environment=environment).stdout


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


def _lines(run: subprocess.CompletedProcess[str]) -> set[str]:
    return set(run.stdout.splitlines())


def check_topics(environment: dict[str, str]) -> None:
    both = {
        "/joint_states [sensor_msgs/msg/JointState]",
        "/tf_static [tf2_msgs/msg/TFMessage]",
    }
    reported("topic", "list", "-t", environment=environment, holds=lambda run: both <= _lines(run))
    type_of_tf = reported("topic", "type", "/tf", environment=environment)
    assert type_of_tf.stdout == "tf2_msgs/msg/TFMessage\n"
    info = "Type: std_msgs/msg/String\nPublisher count: 1\nSubscription count: 1\n"
    described = ("topic", "info", "/robot_description")
    reported(*described, environment=environment, holds=lambda run: run.stdout == info)
    description = yaml.safe_load(echoed("/robot_description", environment, "-f").split("---")[0])
    assert description["data"] == ROBOT
    states = yaml.safe_load(echoed("/joint_states", environment).split("---")[0])
    np.testing.assert_allclose(states["position"], [1.2, 0.7])
    meant = "Did you mean /joint_states?"
    missing = ("topic", "echo", "/joint_state")
    reported(
        *missing,
        environment=environment,
        holds=lambda run: run.returncode == 1 and meant in run.stderr,
    )
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
    assert "Did you mean `std_msgs/msg/String`?" in wrong.stderr
    twist = "geometry_msgs/msg/Twist"
    wrong = tool("topic", "pub", "/go", twist, "{linear: {q: 1}}", environment=environment)
    assert wrong.returncode == 1
    assert wrong.stderr == (
        f"Failed to populate field: `linear` of {twist} has no field `q`.\n"
        "Fields of geometry_msgs/Vector3: x, y, z.\n"
    )


KEEPS = """
import sys
import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node(sys.argv[1])
if sys.argv[1] == "listener":
    node.create_subscription(String, "kept", print, 1)
else:
    kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_publisher(String, "kept", kept).publish(String(data="said before"))
print("ready", flush=True)
sys.stdin.read()
"""


def test_what_a_publisher_has_kept_that_is_found_late_is_shown(
    environment: dict[str, str],
) -> None:
    """The topic is there before: somebody has subscribed to it."""

    def start(*words: str) -> subprocess.Popen[str]:
        pipe = subprocess.PIPE
        return stack.enter_context(
            subprocess.Popen(
                [sys.executable, *words],
                env=environment,
                stdin=pipe,
                stdout=pipe,
                stderr=pipe,
                text=True,
            )
        )

    with contextlib.ExitStack() as stack:
        nodes = [start("-c", KEEPS, name) for name in ("listener", "keeper")]
        for node in nodes:
            stack.callback(node.kill)
            assert node.stdout is not None
            assert node.stdout.readline() == "ready\n"
        nodes[1].send_signal(signal.SIGSTOP)  # nobody finds it
        shown = start("-m", "wsgen", "topic", "echo", "/kept", "--once")
        stack.callback(shown.kill)
        assert shown.stderr is not None
        # The name of the listener may be found later than its subscription.
        silent = ("No node publishes on /kept", "No node is found")
        while not (line := shown.stderr.readline()).startswith(silent):
            assert line
        nodes[1].send_signal(signal.SIGCONT)
        assert shown.communicate(timeout=WAIT)[0] == "data: said before\n---\n"


def check_nodes(environment: dict[str, str]) -> None:
    def names_all(run: subprocess.CompletedProcess[str]) -> bool:
        shown = run.stdout.splitlines()
        return (
            shown[:2] == ["/joint_state_publisher", "/robot_state_publisher"]
            and len(shown) == 3
            and shown[2].startswith("/static_transform_publisher_")
        )

    reported("node", "list", environment=environment, holds=names_all)
    begin = "/robot_state_publisher\n  Subscribers:\n    /joint_states: sensor_msgs"
    info = reported(
        *("node", "info", "/robot_state_publisher"),
        environment=environment,
        holds=lambda run: run.stdout.startswith(begin),
    )
    assert "  Action Clients:\n" in info.stdout


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
        [sys.executable, "-m", "wsgen.live.nodes.robot_state_publisher", *arguments],
        env=environment,
        capture_output=True,
        text=True,
        timeout=WAIT,
        check=False,
    )
    assert run.returncode == 1
    assert message in run.stderr
    assert "Traceback" not in run.stderr


JUMPS = """
import time
import rclpy
from rclpy.time import Time
from sensor_msgs.msg import JointState

rclpy.init()
node = rclpy.create_node("two_clocks")
publisher = node.create_publisher(JointState, "joint_states", 10)
while publisher.get_subscription_count() == 0:
    time.sleep(0.02)
for second in (9, 5) * 20:
    stamp = Time(seconds=second).to_msg()
    message = JointState(name=["turn"], position=[0.0])
    message.header.stamp = stamp
    publisher.publish(message)
    time.sleep(0.02)
"""


def test_two_clocks_do_not_drown_everything_else(
    environment: dict[str, str], tmp_path: Path
) -> None:
    file = tmp_path / "crane.urdf"
    file.write_text(ROBOT)
    command = [sys.executable, "-m", "wsgen.live.nodes.robot_state_publisher", str(file)]
    command += ["--ros-args", "-p", "use_sim_time:=true"]
    with subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True) as process:
        began = time.monotonic()
        subprocess.run([sys.executable, "-c", JUMPS], env=environment, check=True, timeout=WAIT)
        took = time.monotonic() - began
        process.terminate()
        _, printed = process.communicate(timeout=WAIT)
    assert 1 <= printed.count("Moved backwards in time") <= 2 + took / 2.0


def test_a_spawner_refuses_a_topic_that_ros_has_not(
    environment: dict[str, str], tmp_path: Path
) -> None:
    words = ["--as", "spawn_entity.py", "-topic", "robot description", "-entity", "rover"]
    run = subprocess.run(
        [sys.executable, "-m", "wsgen.live.nodes.create", *words],
        env={**environment, FOLDER_VARIABLE: str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=WAIT,
        check=False,
    )
    assert run.returncode == 1
    assert "Invalid topic name" in run.stderr
    assert "Correct the name in the launch file." in run.stderr
    assert "Traceback" not in run.stderr
