"""`joint_state_publisher` for machines where ROS's own is not installed.

Parameters, topics and messages are those of joint_state_publisher 2 (ros/joint_state_publisher).
It also stands for joint_state_publisher_gui, whose sliders nobody could move without a screen.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.utilities import remove_ros_args
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from wsgen.live.nodes.joint_frames import (
    DependenceError,
    PublishedJoints,
    Settings,
    numbers,
    read_dependences,
)
from wsgen.live.nodes.spinning import FatalError, run

NAME = "joint_state_publisher"
DEFAULTS: dict[str, Any] = {
    "publish_default_efforts": False,
    "publish_default_positions": True,
    "publish_default_velocities": False,
    "rate": 10,
    "source_list": [""],  # the type of an empty list would not be known
    "use_mimic_tags": True,
    "use_smallest_joint_limits": True,
    "delta": 0.0,
}


class JointStatePublisher(Node):
    """Publishes a state for each joint of the robot, again and again."""

    def __init__(self, file: Path | None) -> None:
        # `zeros` and `dependent_joints` are named after joints: nobody can declare them.
        super().__init__(NAME, automatically_declare_parameters_from_overrides=True)
        for name, default in DEFAULTS.items():
            if not self.has_parameter(name):
                self.declare_parameter(name, default)
        rate = self.get_parameter("rate").value
        if not isinstance(rate, int | float) or rate <= 0:
            raise FatalError(f"The parameter `rate` must be a number above 0, not {rate!r}.")
        try:
            self._joints = PublishedJoints(self._settings(), self.get_logger().warning)
        except DependenceError as error:
            raise FatalError(str(error)) from None
        if file is None:
            self._wait_for_description()
        else:
            self._configure(_read(file))
        self._delta = self.get_parameter("delta").value
        for topic in self.get_parameter("source_list").value:
            if topic:
                self.create_subscription(JointState, topic, self._take_states, 10)
        self._publisher = self.create_publisher(JointState, "joint_states", 10)
        self.create_timer(1.0 / rate, self._publish)

    def _settings(self) -> Settings:
        def value(name: str) -> bool:
            return bool(self.get_parameter(name).value)

        def prefixed(prefix: str) -> dict[str, object]:
            found = self.get_parameters_by_prefix(prefix)
            return {name: parameter.value for name, parameter in found.items()}

        return Settings(
            zeros=numbers(prefixed("zeros"), "zeros"),
            dependences=read_dependences(prefixed("dependent_joints")),
            use_mimic_tags=value("use_mimic_tags"),
            use_smallest_limits=value("use_smallest_joint_limits"),
            publish_positions=value("publish_default_positions"),
            publish_velocities=value("publish_default_velocities"),
            publish_efforts=value("publish_default_efforts"),
        )

    def _wait_for_description(self) -> None:
        self.get_logger().info(
            "Waiting for robot_description to be published on the robot_description topic..."
        )
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.create_subscription(
            String, "robot_description", lambda message: self._configure(message.data), latched
        )

    def _configure(self, text: str) -> None:
        try:
            self._joints.configure(text)
        except DependenceError as error:
            raise FatalError(str(error)) from None

    def _take_states(self, state: Any) -> None:
        self._joints.take(state.name, state.position, state.velocity, state.effort)

    def _publish(self) -> None:
        if self._delta > 0:
            self._joints.move(self._delta)
        states = self._joints.states()
        if not states.names:
            return
        message = JointState(
            name=states.names,
            position=states.positions,
            velocity=states.velocities,
            effort=states.efforts,
        )
        message.header.stamp = self.get_clock().now().to_msg()
        self._publisher.publish(message)


def _read(file: Path) -> str:
    try:
        return file.read_text("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise FatalError(f"Cannot read the URDF file {file}: {error}") from None


def main() -> int:
    """Run until a signal ends it."""
    parser = argparse.ArgumentParser(prog=NAME)
    parser.add_argument("urdf_file", nargs="?", type=Path, help="URDF file to use")
    file = parser.parse_args(remove_ros_args(sys.argv)[1:]).urdf_file
    return run(NAME, lambda: JointStatePublisher(file))


if __name__ == "__main__":
    raise SystemExit(main())
