"""The odometry that plugins of Gazebo Classic publish, and the transforms beside it.

Source: ros-simulation/gazebo_ros_pkgs, gazebo_plugins/src/gazebo_ros_diff_drive.cpp,
gazebo_ros_ackermann_drive.cpp and gazebo_ros_planar_move.cpp (branch ros2).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

from wsgen.live.nodes.simulator.elements import number, text, topics_of
from wsgen.live.nodes.simulator.messages import planar_covariance

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.devices import Element


def classic_odometry(robot: RobotHandle, element: Element) -> Any:
    """A message with its frames and covariances."""
    message = Odometry(child_frame_id=text(element, "robot_base_frame", robot))
    message.header.frame_id = text(element, "odometry_frame", robot)
    x, y, yaw = (number(element, f"covariance_{name}") for name in ("x", "y", "yaw"))
    message.pose.covariance = message.twist.covariance = planar_covariance(x, y, yaw)
    return message


def classic_publishers(
    host: Host, robot: RobotHandle, element: Element, node: Any
) -> tuple[Any, Any]:
    """Those of odometry and transforms; None where the plugin is not to publish them."""
    topics = topics_of(host, robot, element)
    found = (("odometry", Odometry, 1), ("tf", TFMessage, 100))
    odometry, tf = (
        host.publisher(robot, kind, topics[use], node=node, depth=depth) if use in topics else None
        for use, kind, depth in found
    )
    return odometry, tf
