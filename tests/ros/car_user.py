"""A node that drives a car, closes its gripper and reads its sensors; prints what it saw as JSON.

It runs in an environment that has ROS.
"""

from __future__ import annotations

import json
import sys
import time
from functools import partial
from typing import TYPE_CHECKING, Any

import rclpy
from actuator_msgs.msg import Actuators
from control_msgs.action import GripperCommand
from geometry_msgs.msg import TwistStamped, WrenchStamped
from nav_msgs.msg import Odometry
from rclpy.action import ActionClient
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState

if TYPE_CHECKING:
    from collections.abc import Callable

WAIT = 120.0  # s, on a busy machine
CAR = "/car_controller"

rclpy.init()
node = rclpy.create_node("user")
last: dict[str, Any] = {}
seen: dict[str, Any] = {}
for kind, topic, name in (
    (JointState, "/joint_states", "states"),
    (Odometry, f"{CAR}/odometry", "odometry"),
    (WrenchStamped, "/wrench_broadcaster/wrench", "wrench"),
    (WrenchStamped, "/forcetorque", "sensor"),
):
    node.create_subscription(
        kind, topic, lambda message, name=name: last.update({name: message}), 10
    )
# As many drivers do: who takes it must not ask for more.
best_effort = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
drive = node.create_publisher(TwistStamped, f"{CAR}/reference", best_effort)
actuators = node.create_publisher(Actuators, "/actuators", 10)
gripper = ActionClient(node, GripperCommand, "/gripper_controller/gripper_cmd")


def until(is_true: Callable[[], Any], what: str, every: Callable[[], None] | None = None) -> Any:
    end = time.monotonic() + WAIT
    while time.monotonic() < end:
        if every is not None:
            every()
        rclpy.spin_once(node, timeout_sec=0.02)
        found = is_true()
        if found:
            return found
    sys.exit(f"waited in vain for {what}; seen: {seen}")


def position(joint: str) -> float:
    states = last["states"]
    return float(states.position[states.name.index(joint)])


def reach(value: float) -> list[Any]:
    """Ask the gripper for a position; gives status, whether it is there, and whether it stalled."""
    goal = GripperCommand.Goal()
    goal.command.position = value
    sent = gripper.send_goal_async(goal)
    until(sent.done, "an answer to a goal")
    result = sent.result().get_result_async()
    until(result.done, "the end of a goal")
    found = result.result()
    return [found.status, found.result.reached_goal, found.result.stalled]


def command() -> None:
    message = TwistStamped()
    message.twist.linear.x, message.twist.angular.z = 0.5, 0.25
    drive.publish(message)


until(lambda: len(last) == 4, "states, odometry and wrenches")
until(gripper.server_is_ready, "the action")


def drives() -> bool:
    """Whether it has come far, as fast as it is told: it stops where commands are late."""
    odometry = last["odometry"]
    speed, turn = odometry.twist.twist.linear.x, odometry.twist.twist.angular.z
    seen["speed"] = [speed, turn]
    is_steady = abs(speed - 0.5) < 0.02 and abs(turn - 0.25) < 0.01
    return is_steady and bool(odometry.pose.pose.position.x > 0.5)


until(drives, "half a meter", command)
odometry = last["odometry"]
seen["frames"] = [odometry.header.frame_id, odometry.child_frame_id]
seen["gripper"] = [reach(0.03), reach(0.2)]
seen["finger"] = position("finger")
until(
    lambda: abs(position("arm") - 0.3) < 0.02,
    "the arm",
    lambda: actuators.publish(Actuators(position=[0.0, 0.3])),
)
for name in ("wrench", "sensor"):
    del last[name]
    message = until(partial(last.get, name), "a wrench")
    force = message.wrench.force
    seen[name] = [message.header.frame_id, force.x, force.y, force.z]
sys.stdout.write(json.dumps(seen))
rclpy.shutdown()
