"""Names and QoS that ROS takes, and the error where it takes a name not.

The QoS is that which the <ros><qos> of a plugin of Gazebo Classic gives to its topics.
Source: ros-simulation/gazebo_ros_pkgs, branch ros2, gazebo_ros/src/qos.cpp.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wsgen.model.devices import Element


class BadNameError(Exception):
    """ROS refuses a name, a namespace or an argument; the text says which and why."""


def node_name(text: str) -> str:
    """A name that ROS takes for a node: Gazebo Sim's plugins are called as their classes."""
    name = re.sub(r"[^A-Za-z0-9_]", "_", text)
    return f"_{name}" if name[:1].isdigit() else name or "gazebo"


def written_qos(ros: Element | None, topic: str, depth: int, end: str = "publisher") -> Any:
    """The QoS of a topic: reliable, of that depth, or what <ros> says of its `end` in the plugin.

    `end` is "publisher" or "subscription", `topic` the name before remappings.
    """
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy  # noqa: PLC0415  nodes

    reliability, durability = "reliable", "volatile"
    for one in () if ros is None else ros.find_all("qos/topic"):
        if one.attributes.get("name", "") == topic:
            reliability = one.get(f"{end}/reliability", reliability)
            durability = one.get(f"{end}/durability", durability)
            written = one.get(f"{end}/history/depth") or one.get(f"{end}/depth")
            history = one.find(f"{end}/history")
            if not written and history is not None:
                written = history.attributes.get("depth", "")
            depth = int(written) if written.isdigit() else depth
    return QoSProfile(
        depth=depth,
        reliability=ReliabilityPolicy.BEST_EFFORT
        if reliability == "best_effort"
        else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL
        if durability == "transient_local"
        else DurabilityPolicy.VOLATILE,
    )
