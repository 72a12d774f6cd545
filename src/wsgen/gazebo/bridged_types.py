"""The types of messages that ros_gz_bridge converts to each other, from Humble on.

Source: gazebosim/ros_gz, ros_gz_bridge/ros_gz_bridge/mappings.py and the conversions in
ros_gz_bridge/src/convert.
"""

from __future__ import annotations

from wsgen.text.tables import read_table

# Gazebo's type, without `gz.msgs.` -> ROS's types; the first one is what plugins speak here.
PAIRS = read_table(__file__, "bridged-types.txt")
PREFIXES = ("gz.msgs.", "ignition.msgs.")


def short_ros_type(name: str) -> str:
    """`sensor_msgs/LaserScan` of a name with or without `/msg/`."""
    return name.replace("/msg/", "/")


def short_gz_type(name: str) -> str | None:
    """`LaserScan` of `gz.msgs.LaserScan` or the older name; None of any other name."""
    prefix = next((one for one in PREFIXES if name.startswith(one)), None)
    return None if prefix is None else name[len(prefix) :]
