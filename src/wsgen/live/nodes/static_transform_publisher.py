"""`static_transform_publisher` for machines where tf2_ros is not installed.

Arguments, parameters and messages are those of geometry2 (tf2_ros/src/
static_transform_broadcaster_program.cpp and _node.cpp).
"""

from __future__ import annotations

import secrets
import string
import sys
from typing import TYPE_CHECKING, Any

from geometry_msgs.msg import TransformStamped
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.utilities import remove_ros_args
from tf2_msgs.msg import TFMessage

from wsgen.live.nodes.spinning import FatalError, leave_clock, run
from wsgen.live.nodes.static_transform_arguments import (
    OLD_STYLE_WARNING,
    USAGE,
    ArgumentsError,
    parse_arguments,
)

if TYPE_CHECKING:
    from wsgen.live.nodes.static_transform_arguments import StaticTransform

NAME = "static_transform_publisher"


class StaticTransformPublisher(Node):
    """Publishes one transform on /tf_static, for those who come later as well."""

    def __init__(self, transform: StaticTransform) -> None:
        unique = "".join(secrets.choice(string.ascii_letters + string.digits) for _ in range(16))
        values = {
            **dict(
                zip(("translation.x", "translation.y", "translation.z"), transform.xyz, strict=True)
            ),
            **dict(
                zip(
                    ("rotation.x", "rotation.y", "rotation.z", "rotation.w"),
                    transform.xyzw,
                    strict=True,
                )
            ),
            "frame_id": transform.frame,
            "child_frame_id": transform.child,
        }
        super().__init__(
            f"{NAME}_{unique}",
            parameter_overrides=[Parameter(name, value=value) for name, value in values.items()],
        )
        read_only = ParameterDescriptor(read_only=True)
        for name, value in values.items():
            self.declare_parameter(name, value, read_only)
        if transform.frame == transform.child:
            raise FatalError(
                f"cannot publish static transform from '{transform.frame}' to '{transform.child}', "
                "exiting"
            )
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._publisher = self.create_publisher(TFMessage, "/tf_static", latched)
        self._publisher.publish(TFMessage(transforms=[self._message(transform)]))
        leave_clock(self)

    def _message(self, transform: StaticTransform) -> Any:
        message = TransformStamped()
        message.header.stamp = self.get_clock().now().to_msg()
        message.header.frame_id, message.child_frame_id = transform.frame, transform.child
        place, turn = message.transform.translation, message.transform.rotation
        place.x, place.y, place.z = transform.xyz
        turn.x, turn.y, turn.z, turn.w = transform.xyzw
        return message


def main() -> int:
    """Run until a signal ends it."""
    try:
        transform, is_old = parse_arguments(remove_ros_args(sys.argv)[1:])
    except ArgumentsError as error:
        get_logger(NAME).error(f"error parsing command line arguments: {error}")
        sys.stdout.write(USAGE)
        return 1
    if transform is None:
        sys.stdout.write(USAGE)
        return 0
    if is_old:
        get_logger(NAME).warning(OLD_STYLE_WARNING)

    def make() -> StaticTransformPublisher:
        node = StaticTransformPublisher(transform)
        place = ", ".join(f"'{number:f}'" for number in transform.xyz)
        turn = ", ".join(f"'{number:f}'" for number in transform.xyzw)
        node.get_logger().info(
            f"Spinning until stopped - publishing transform\ntranslation: ({place})\n"
            f"rotation: ({turn})\nfrom '{transform.frame}' to '{transform.child}'"
        )
        return node

    return run(NAME, make)


if __name__ == "__main__":
    raise SystemExit(main())
