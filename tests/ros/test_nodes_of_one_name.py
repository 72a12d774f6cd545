"""Nodes of the simulator that share a name, as bridges often do."""

from __future__ import annotations

import subprocess
import sys

import pytest

from ros_for_tests import ros_with, variables_for

pytestmark = pytest.mark.slow

NODES = """
import time

from rcl_interfaces.msg import Log
from wsgen.live.nodes.simulator.ros import Ros

ros = Ros()
texts = []
ros.subscription(ros.node("listener"), Log, "/rosout", lambda log: texts.append(log.msg), 100)


def hears(node, text):
    "Whether what a node logs arrives on /rosout; what discovers it takes its time."
    end = time.monotonic() + 120
    while text not in texts and time.monotonic() < end:
        node.get_logger().info(text)
        for _ in range(10):
            ros.wait(0.01)
            ros.poll()
    print(text, "is heard" if text in texts else "is lost", flush=True)


nodes = [ros.node("ros_gz_bridge", namespace) for namespace in ("", "/", "/two")]
for number, node in enumerate(nodes):
    hears(node, f"node {number}")
ros.forget_node(nodes[1])
hears(nodes[0], "the first alone")
ros.forget_node(nodes[0])
ros.poll()
hears(ros.node("ros_gz_bridge"), "the next")
try:
    ros.node("odd", arguments=["-r", "no:=rule:="])
except Exception as error:
    print(type(error).__name__)
hears(ros.node("odd"), "after one that ROS refused")
hears(ros.node("plain", arguments=["-r", "__node:=other"]), "renamed")
hears(ros.node("plain"), "with the name that this one had")
"""


def test_nodes_of_one_name_are_heard_on_rosout() -> None:
    """Without a warning of rcl that /rosout has the name, and also those that are made again."""
    done = subprocess.run(
        [sys.executable, "-c", NODES],
        env=variables_for(ros_with()),
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.splitlines() == [
        "node 0 is heard",
        "node 1 is heard",
        "node 2 is heard",
        "the first alone is heard",
        "the next is heard",
        "BadNameError",
        "after one that ROS refused is heard",
        "renamed is heard",
        "with the name that this one had is heard",
    ]
    assert "already registered" not in done.stderr
