"""Images larger than the queues of Fast DDS, from what has the variables of the simulator."""

from __future__ import annotations

import subprocess
import sys

import pytest

from ros_for_tests import ros_with, variables_for
from wsgen.ros.environment import variables_of_nodes
from wsgen.ros.environment.environment import variables_of_simulator

pytestmark = pytest.mark.slow
COUNT = 20
SECONDS = 300.0  # wall-clock, on a busy machine
# Who has sent one waits until it has arrived, or has not for long: a busy machine may keep a reader
# from reading. The first one may be lost, to a reader that has not found the other side yet.
SEND = f"""
import array, time
import rclpy
from sensor_msgs.msg import {{kind}}
from std_msgs.msg import Int32

rclpy.init()
node = rclpy.create_node("simulator")
publisher, arrived = node.create_publisher({{kind}}, "large", 5), []
node.create_subscription(Int32, "arrived", lambda one: arrived.append(one.data), {COUNT})
data = array.array("B", bytes({{size}}))
while not publisher.get_subscription_count():
    rclpy.spin_once(node, timeout_sec=0.05)
end = time.monotonic() + 60
while not arrived and time.monotonic() < end:
    publisher.publish({{kind}}(height=0, data=data))
    rclpy.spin_once(node, timeout_sec=1.0)
for number in range(1, {COUNT}):
    publisher.publish({{kind}}(height=number, data=data))
    late = time.monotonic() + (10 if arrived else 0)
    while number not in arrived and time.monotonic() < late:
        rclpy.spin_once(node, timeout_sec=0.1)
print(len(set(arrived)))
"""
READ = f"""
import rclpy
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import {{kind}}
from std_msgs.msg import Int32

rclpy.init()
node = rclpy.create_node("reader")
publisher = node.create_publisher(Int32, "arrived", {COUNT})
qos = QoSProfile(depth={COUNT}, reliability=ReliabilityPolicy.{{reliability}})
tell = lambda one: publisher.publish(Int32(data=one.height))
node.create_subscription({{kind}}, "large", tell, qos)
rclpy.spin(node)
"""


@pytest.mark.parametrize(
    ("kind", "size", "reliability"),
    [
        ("Image", 800 * 800 * 3, "BEST_EFFORT"),
        ("Image", 1920 * 1080 * 3, "RELIABLE"),
        ("PointCloud2", 640 * 480 * 32, "BEST_EFFORT"),
    ],
)
def test_large_messages_of_the_simulator_arrive(kind: str, size: int, reliability: str) -> None:
    ros = ros_with()
    variables = variables_for(ros, variables_of_nodes(ros, {}))
    words = {"kind": kind, "size": size, "reliability": reliability}
    own = {**variables, **variables_of_simulator(variables)}
    assert own != variables
    read, send = ([sys.executable, "-c", one.format(**words)] for one in (READ, SEND))
    with subprocess.Popen(read, env=variables) as reader:
        try:
            done = subprocess.run(
                send, env=own, timeout=SECONDS, stdout=subprocess.PIPE, check=True
            )
        finally:
            reader.kill()
    assert int(done.stdout) >= COUNT - 1
