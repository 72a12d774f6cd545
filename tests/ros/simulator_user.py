"""A node that uses the simulator as nodes of users do; prints what it saw as JSON.

It runs in an environment that has ROS.
"""

from __future__ import annotations

import json
import math
import sys
from typing import TYPE_CHECKING, Any

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.qos import qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_srvs.srv import Empty
from tf2_msgs.msg import TFMessage

if TYPE_CHECKING:
    from collections.abc import Callable

rclpy.init()
node = rclpy.create_node("user")
last: dict[str, Any] = {}
counts: dict[str, int] = {}


def listen(kind: type, topic: str, qos: Any = 10) -> None:
    def take(message: Any) -> None:
        last[topic] = message
        counts[topic] = counts.get(topic, 0) + 1

    node.create_subscription(kind, topic, take, qos)


listen(Clock, "/clock", qos_profile_sensor_data)
listen(Odometry, "/odom")
listen(Odometry, "/truth")
listen(JointState, "/joint_states")
listen(TFMessage, "/tf")
commands = node.create_publisher(Twist, "/cmd_vel", 10)


def now() -> float:
    clock = last["/clock"].clock
    return float(clock.sec + clock.nanosec / 1e9)


def until(condition: Callable[[], bool]) -> None:
    while not condition():
        rclpy.spin_once(node, timeout_sec=1.0)


def drive(speed: float) -> None:
    message = Twist()
    message.linear.x = speed
    commands.publish(message)


def x_of(topic: str) -> float:
    return float(last[topic].pose.pose.position.x)


def stamp_of(topic: str) -> float:
    stamp = last[topic].header.stamp
    return float(stamp.sec + stamp.nanosec / 1e9)


def call(name: str) -> None:
    client = node.create_client(Empty, name)
    until(client.service_is_ready)
    answer = client.call_async(Empty.Request())
    until(answer.done)


until(lambda: "/clock" in last and "/odom" in last and "/truth" in last)
until(lambda: commands.get_subscription_count() > 0)
seen: dict[str, Any] = {"frames": [last["/odom"].header.frame_id, last["/odom"].child_frame_id]}
before = {topic: x_of(topic) for topic in ("/odom", "/truth")}
drive(0.5)
until(lambda: x_of("/truth") > before["/truth"] + 0.05)
drive(math.nan)
begun, way = stamp_of("/truth"), x_of("/truth")
until(lambda: stamp_of("/truth") >= begun + 4.0)
seen["speed"] = (x_of("/truth") - way) / (stamp_of("/truth") - begun)
assert now() > 4.0  # so long, half of it of the clock, is it known that time begins anew
drive(0.0)
until(lambda: all(abs(last[topic].twist.twist.linear.x) < 1e-3 for topic in before))
seen["moved"] = {topic: x_of(topic) - start for topic, start in before.items()}
seen["joints"] = list(last["/joint_states"].name)
transform = last["/tf"].transforms[0]
seen["tf"] = [transform.header.frame_id, transform.child_frame_id]

call("/pause_physics")
for _ in range(1000):  # what was sent before the pause arrives
    before_wait = dict(counts)
    rclpy.spin_once(node, timeout_sec=1.0)
    if counts == before_wait:
        break
seen["is_paused"] = counts == before_wait
paused, count = now(), counts["/odom"]
call("/unpause_physics")
until(lambda: counts["/odom"] > count + 5)
call("/reset_simulation")
until(lambda: now() < paused)
until(lambda: abs(x_of("/truth")) < 0.01)
seen["reset"] = True
json.dump(seen, sys.stdout)
