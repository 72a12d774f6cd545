"""The process that publishes and subscribes for tests."""

from __future__ import annotations

import subprocess
import sys

import pytest

from ros_for_tests import ros_with, variables_for
from wsgen.ros.environment import variables_of_nodes

pytestmark = pytest.mark.slow

REPEATING = """
import json
import os
import socket
import threading
import time

import rclpy
from std_msgs.msg import Empty
from wsgen.live.nodes.messenger import Messenger

ours, theirs = socket.socketpair()
rclpy.init(args=[])
listener = rclpy.create_node("listener")
for topic in ("/a", "/b", "/c"):
    listener.create_subscription(Empty, topic, lambda _: None, 10)
threading.Thread(target=Messenger(theirs).run, daemon=True).start()
answers = ours.makefile("rb")
for number, (topic, rate) in enumerate((("/a", 1.0), ("/b", 1.0), ("/a", None), ("/c", 1.0))):
    request = {"id": number, "do": "publish", "topic": topic, "type": "std_msgs/msg/Empty"}
    request |= {"values": {}, "rate": rate, "now": 0.0, "seconds": 120.0}
    ours.sendall(json.dumps(request).encode() + b"\\n")
    assert json.loads(answers.readline())["subscribers"] == 1
names, end = [], time.monotonic() + 60
while len(names) != 2 and time.monotonic() < end:  # what discovers them takes its time
    found = listener.get_publishers_info_by_topic("/rosout")
    names = [one.node_name for one in found if "timer" in one.node_name]
    time.sleep(0.05)
print(*names, flush=True)
os._exit(0)
"""


def test_each_topic_that_is_published_again_and_again_has_a_node_of_its_own_name() -> None:
    """Otherwise rcl warns that /rosout has it already, in what a test shows of its run."""
    ros = ros_with()
    variables = variables_for(ros)
    done = subprocess.run(
        [sys.executable, "-c", REPEATING],
        env={**variables, **variables_of_nodes(ros, variables)},
        capture_output=True,
        text=True,
        check=True,
    )
    names = done.stdout.split()
    assert len(names) == len(set(names)) == 2
    assert "already registered" not in done.stderr
