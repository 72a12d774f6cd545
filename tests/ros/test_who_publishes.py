"""The simulator knows which of its topics another process publishes, and another /clock."""

from __future__ import annotations

import subprocess
import sys

import pytest

from ros_for_tests import ros_with, variables_for

pytestmark = pytest.mark.slow

NODES = """
import subprocess
import sys
import time

from std_msgs.msg import String
from wsgen.live.nodes.simulator.ros import Ros

OTHER = '''
import rclpy
from std_msgs.msg import String

rclpy.init()
made = rclpy.create_node("driver").create_publisher(String, "/driven", 1)
input()
'''
ros = Ros()
for name in ("driven", "bridged", "idle"):
    ros.subscription(ros.node("bridge", name), String, f"/{name}", lambda _: None, 1)
ros.publisher(ros.node("bridge", "bridged"), String, "/bridged", 1)
ros.note_publishers()
print(sorted(ros.of_others), flush=True)
other = subprocess.Popen([sys.executable, "-c", OTHER], stdin=subprocess.PIPE)
end = time.monotonic() + 120
while not ros.of_others and time.monotonic() < end:
    ros.wait(0.01)
    ros.note_publishers()
other.communicate(b"end\\n")
ros.note_publishers()
print(sorted(ros.of_others), ros.has_heard)
clock = ros.node("bridge", "clock"), ros.node("bridge", "other")
for node in clock:
    ros.publisher(node, String, "/clock", 1)
print(ros.has_other_clock(), flush=True)
another = subprocess.Popen(
    [sys.executable, "-c", OTHER.replace("/driven", "/clock").replace("driver", "bridge")],
    stdin=subprocess.PIPE,
)
end = time.monotonic() + 120
while not ros.has_other_clock() and time.monotonic() < end:
    ros.wait(0.01)
print(ros.has_other_clock(), flush=True)
another.communicate(b"end\\n")
ros.close()
"""


def test_topics_that_other_processes_publish() -> None:
    """Not those that a bridge of both directions reads and publishes."""
    done = subprocess.run(
        [sys.executable, "-c", NODES],
        env=variables_for(ros_with()),
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.splitlines() == ["[]", "['/driven'] False", "False", "True"]
