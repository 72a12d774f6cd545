"""`robot_state_publisher` for machines where ROS's own is not installed.

Parameters, topics, QoS and messages are those of robot_state_publisher 3.4
(ros/robot_state_publisher, src/robot_state_publisher.cpp), and `use_tf_static` of Foxy's.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geometry_msgs.msg import TransformStamped
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from rclpy.time import Time
from rclpy.utilities import remove_ros_args
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from wsgen.live.nodes.joint_frames import RefusedDescriptionError, read_joint_frames
from wsgen.live.nodes.spinning import FatalError, leave_clock, run

if TYPE_CHECKING:
    from collections.abc import Iterable

    from wsgen.live.nodes.joint_frames import JointFrame, JointFrames, Quaternion
    from wsgen.model.transform import Vector

NAME = "robot_state_publisher"
MOST_HERTZ = 1000.0
BACKWARDS = 500_000_000  # ns
SAY_SECONDS = 2.0  # wall-clock, between two warnings of one kind
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class RobotStatePublisher(Node):
    """Sends the frames of a robot: fixed ones once, those of moving joints as they come."""

    def __init__(self, arguments: list[str]) -> None:
        super().__init__(NAME)
        self._joints: JointFrames | None = None
        self._messages: dict[str, Any] = {}  # by joint; filled again for each time
        self._last_sent: dict[str, int] = {}  # ns, by joint
        self._last_callback = 0  # ns
        text = self._description(arguments)
        self.declare_parameter("publish_frequency", 20.0)
        self.declare_parameter("frame_prefix", "")
        self.declare_parameter("ignore_timestamp", False)
        self.declare_parameter("use_tf_static", True)
        if not 0.0 <= self._frequency <= MOST_HERTZ:
            raise FatalError("publish_frequency must be between 0 and 1000")
        self._transforms = self.create_publisher(TFMessage, "/tf", 100)
        self._static_transforms = self.create_publisher(TFMessage, "/tf_static", LATCHED)
        if self.get_parameter("use_robot_description_topic").value:
            self.create_subscription(String, "robot_description", self._take_message, LATCHED)
        else:
            self._descriptions = self.create_publisher(String, "robot_description", LATCHED)
            self._start_with(text)
        self.create_subscription(
            JointState, "joint_states", self._take_states, qos_profile_sensor_data
        )
        if not self.get_parameter("use_tf_static").value and self._frequency:
            self.create_timer(1.0 / self._frequency, self._send_fixed)
        else:
            leave_clock(self)
        self.add_on_set_parameters_callback(self._check_parameters)
        self.add_post_set_parameters_callback(self._use_parameters)

    @property
    def _frequency(self) -> float:
        return float(self.get_parameter("publish_frequency").value)

    def _description(self, arguments: list[str]) -> str:
        """The parameter, or the file that is named in its place."""
        self.declare_parameter("use_robot_description_topic", False)
        text = str(self.declare_parameter("robot_description", "").value)
        if text or self.get_parameter("use_robot_description_topic").value:
            return text
        if len(arguments) < 2:  # noqa: PLR2004  the first one is the program
            raise FatalError("robot_description parameter must not be empty")
        self.get_logger().warning(
            "No robot_description parameter, but command-line argument available.  Assuming "
            "argument is name of URDF file.  This backwards compatibility fallback will be "
            "removed in the future."
        )
        try:
            return Path(arguments[1]).read_text("utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise FatalError(f"Failed to open URDF file: {arguments[1]}: {error}") from None

    def _start_with(self, text: str) -> None:
        try:
            self._use(text)
        except RefusedDescriptionError as error:
            raise FatalError(
                f"Unable to initialize urdf::model from robot description\n{error}"
            ) from None

    def _use(self, text: str) -> None:
        """Send the frames of this robot from now on."""
        robot, self._joints = read_joint_frames(text)
        prefix = self.get_parameter("frame_prefix").value
        self._messages = {
            name: _message(joint, prefix) for name, joint in self._joints.moving.items()
        }
        self._last_sent.clear()
        if not self.get_parameter("use_robot_description_topic").value:
            self._descriptions.publish(String(data=text))
        self.get_logger().info("Robot initialized")
        self.get_logger().debug(f"{robot.name}: {len(self._messages)} moving joints")
        self._send_fixed()

    def _take_message(self, message: Any) -> None:
        """A description that another node publishes."""
        try:
            self._use(message.data)
        except RefusedDescriptionError as error:
            self.get_logger().warning(f"Failed to parse new URDF: {error}")

    def _send_fixed(self) -> None:
        if self._joints is None:
            return
        prefix = self.get_parameter("frame_prefix").value
        stamp = self.get_clock().now().to_msg()
        transforms = []
        for joint in self._joints.fixed:
            message = _message(joint, prefix)
            _place(message.transform, *joint.at(0.0))
            message.header.stamp = stamp
            transforms.append(message)
        is_static = self.get_parameter("use_tf_static").value
        publisher = self._static_transforms if is_static else self._transforms
        publisher.publish(TFMessage(transforms=transforms))

    def _take_states(self, state: Any) -> None:
        """Send where moving joints are, unless they were sent a moment ago."""
        names, joints = list(state.name), self._joints
        if joints is None or not self._is_usable(state, names):
            return
        stamp = Time.from_msg(state.header.stamp).nanoseconds
        now = self._now(stamp)
        if now < self._last_callback:
            # With two simulators in a domain that is each message, and the original says it each
            # time: nothing else can be read then.
            self.get_logger().warning(
                "Moved backwards in time, re-publishing joint transforms!",
                throttle_duration_sec=SAY_SECONDS,
            )
            self._last_sent.clear()
        self._last_callback = now
        last = min((self._last_sent.get(name, 0) for name in names), default=now)
        frequency = self._frequency
        # Whole milliseconds, as in the original.
        interval = int(1000.0 / frequency) * 1_000_000 if frequency else 0
        is_due = stamp >= min(last, now) + interval
        if not is_due and not self.get_parameter("ignore_timestamp").value:
            return
        self._send_moving(joints.positions(names, state.position), state.header.stamp)
        for name in names:
            self._last_sent[name] = stamp

    def _now(self, stamp: int) -> int:
        """The time, ns; of a simulation that of the last joint state.

        Several sources send joint states in no order, so that time goes back only where a stamp is
        far behind.
        """
        if not self.get_parameter("use_sim_time").value:
            return int(self.get_clock().now().nanoseconds)
        is_behind = self._last_callback - BACKWARDS < stamp < self._last_callback
        return self._last_callback if is_behind else stamp

    def _is_usable(self, state: Any, names: list[str]) -> bool:
        if len(names) == len(state.position):
            return True
        if len(state.position):
            self.get_logger().error("Robot state publisher ignored an invalid JointState message")
        else:
            self.get_logger().warning(
                f'Robot state publisher ignored a JointState message about joint(s) "{names[0]}"'
                "(,...) whose position member was empty."
            )
        return False

    def _send_moving(self, positions: dict[str, float], stamp: Any) -> None:
        assert self._joints is not None  # noqa: S101  checked by the caller
        transforms = []
        for name, position in positions.items():
            message = self._messages.get(name)
            if message is not None:
                message.header.stamp = stamp
                _place(message.transform, *self._joints.moving[name].at(position))
                transforms.append(message)
        self._transforms.publish(TFMessage(transforms=transforms))

    def _check_parameters(self, parameters: Iterable[Any]) -> Any:
        for parameter in parameters:
            reason = self._refusal(parameter)
            if reason:
                return SetParametersResult(successful=False, reason=reason)
        return SetParametersResult(successful=True)

    def _refusal(self, parameter: Any) -> str:
        """Why a parameter cannot have that value; empty where it can."""
        if parameter.name == "publish_frequency" and not 0.0 <= parameter.value <= MOST_HERTZ:
            return "publish_frequency must be between 0.0 and 1000.0"
        if parameter.name == "robot_description":
            if not parameter.value:
                return "Empty URDF is not allowed"
            try:
                read_joint_frames(parameter.value)
            except RefusedDescriptionError as error:
                text = f"Unable to initialize urdf::model from robot description\n{error}"
                self.get_logger().warning(text)
                return text
        return ""

    def _use_parameters(self, parameters: Iterable[Any]) -> None:
        for parameter in parameters:
            if parameter.name == "robot_description":
                self._use(parameter.value)


def _message(joint: JointFrame, prefix: str) -> Any:
    message = TransformStamped()
    message.header.frame_id = prefix + joint.parent
    message.child_frame_id = prefix + joint.child
    return message


def _place(transform: Any, xyz: Vector, xyzw: Quaternion) -> None:
    place, turn = transform.translation, transform.rotation
    place.x, place.y, place.z = xyz
    turn.x, turn.y, turn.z, turn.w = xyzw


def main() -> int:
    """Run until a signal ends it."""
    return run(NAME, lambda: RobotStatePublisher(remove_ros_args(sys.argv)))


if __name__ == "__main__":
    raise SystemExit(main())
