"""A node that moves an arm by its controllers, as nodes of users do; prints what it saw as JSON.

It runs in an environment that has ROS.
"""

from __future__ import annotations

import json
import sys
import time
from typing import TYPE_CHECKING, Any

import rclpy
from builtin_interfaces.msg import Duration
from control_msgs.action import FollowJointTrajectory
from control_msgs.msg import JointTolerance, JointTrajectoryControllerState
from controller_manager_msgs.srv import ListControllers, ListHardwareInterfaces, SwitchController
from rcl_interfaces.srv import GetParameters
from rclpy.action import ActionClient
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

if TYPE_CHECKING:
    from collections.abc import Callable

WAIT = 120.0  # s, on a busy machine
LONG = 600.0  # s, simulated, of what is to end before
JOINTS = ["joint_1", "joint_2"]
ARM = "/arm_controller"

rclpy.init()
node = rclpy.create_node("user")
last: dict[str, Any] = {}
node.create_subscription(
    JointState, "/joint_states", lambda message: last.update(states=message), 10
)
node.create_subscription(
    JointTrajectoryControllerState,
    f"{ARM}/controller_state",
    lambda message: last.update(controller=message),
    10,
)
by_topic = node.create_publisher(JointTrajectory, f"{ARM}/joint_trajectory", 10)
by_force = node.create_publisher(Float64MultiArray, "/forward_controller/commands", 10)
client = ActionClient(node, FollowJointTrajectory, f"{ARM}/follow_joint_trajectory")


def until(is_true: Callable[[], Any], what: str) -> Any:
    end = time.monotonic() + WAIT
    while time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.02)
        found = is_true()
        if found:
            return found
    sys.exit(f"waited in vain for {what}")


def ask(kind: Any, name: str, request: Any) -> Any:
    service = node.create_client(kind, name)
    until(service.service_is_ready, name)
    future = service.call_async(request)
    until(future.done, f"the answer of {name}")
    return future.result()


def positions() -> list[float]:
    """Those of the joints, once they rest."""
    last.pop("states", None)

    def resting() -> bool:
        message = last.get("states")
        return message is not None and max(map(abs, message.velocity)) < 1e-3

    until(resting, "joints at rest")
    return [last["states"].position[last["states"].name.index(name)] for name in JOINTS]


def point(seconds: float, *where: float) -> JointTrajectoryPoint:
    whole = int(seconds)
    after = Duration(sec=whole, nanosec=int((seconds - whole) * 1e9))
    return JointTrajectoryPoint(
        positions=list(where), velocities=[0.0] * len(where), time_from_start=after
    )


def goal(*points: JointTrajectoryPoint, **more: Any) -> Any:
    made = FollowJointTrajectory.Goal(**more)
    made.trajectory.joint_names = JOINTS[::-1]
    made.trajectory.points = list(points)
    return made


def send(what: Any, feedback: list[Any] | None = None) -> Any:
    def take(message: Any) -> None:
        if feedback is not None:
            feedback.append(message.feedback)

    future = client.send_goal_async(what, feedback_callback=take)
    until(future.done, "the answer to a goal")
    return future.result()


def result_of(handle: Any) -> list[Any]:
    future = handle.get_result_async()
    until(future.done, "the end of a goal")
    return [future.result().status, future.result().result.error_code]


until(lambda: "states" in last, "joint states")
until(client.server_is_ready, "the action")
listed = ask(ListControllers, "/controller_manager/list_controllers", ListControllers.Request())
hardware = ask(
    ListHardwareInterfaces,
    "/controller_manager/list_hardware_interfaces",
    ListHardwareInterfaces.Request(),
)
parameters = ask(
    GetParameters, f"{ARM}/get_parameters", GetParameters.Request(names=["joints", "cmd_timeout"])
)
seen: dict[str, Any] = {
    "names": list(last["states"].name),
    "controllers": {one.name: one.state for one in listed.controller},
    "claimed": [one.name for one in hardware.command_interfaces if one.is_claimed],
    "joints": list(parameters.values[0].string_array_value),
}
feedback: list[Any] = []
seen["reached"] = result_of(send(goal(point(1.0, 0.1, 0.2), point(2.0, -0.4, 0.5)), feedback))
until(lambda: len(feedback) > 5, "feedback")
seen["after_goal"] = positions()
strict = [JointTolerance(name=name, position=0.02) for name in JOINTS]
seen["off_path"] = result_of(send(goal(point(0.05, 1.5, 1.5), path_tolerance=strict)))
first = send(goal(point(LONG, 0.0, 0.0)))
second = send(goal(point(LONG, 0.1, 0.1)))
seen["preempted"] = result_of(first)
canceled = second.cancel_goal_async()
until(canceled.done, "the answer to a cancelation")
seen["canceled"] = result_of(second)
wrong = goal(point(1.0, 0.0, 0.0))
wrong.trajectory.joint_names = ["joint_1", "elbow"]
seen["refused"] = not send(wrong).accepted
until(lambda: by_topic.get_subscription_count() > 0, "the arm controller")
by_topic.publish(JointTrajectory(joint_names=JOINTS, points=[point(1.0, 0.3, -0.3)]))
until(
    lambda: last.get("controller") and abs(last["controller"].reference.positions[0] - 0.3) < 1e-6,
    "the end of a trajectory",
)
seen["after_topic"] = positions()
request = SwitchController.Request(
    activate_controllers=["forward_controller"], strictness=SwitchController.Request.STRICT
)
seen["switched"] = [ask(SwitchController, "/controller_manager/switch_controller", request).ok]
request.deactivate_controllers = ["arm_controller"]
seen["switched"].append(ask(SwitchController, "/controller_manager/switch_controller", request).ok)
until(lambda: by_force.get_subscription_count() > 0, "the forward controller")
by_force.publish(Float64MultiArray(data=[0.25, 0.15]))
until(lambda: abs(positions()[0] - 0.25) < 0.005, "the position that was commanded")
seen["after_command"] = positions()
sys.stdout.write(json.dumps(seen))
rclpy.shutdown()
