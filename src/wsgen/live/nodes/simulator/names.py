"""Names that ROS takes, and the error where it takes one not."""

from __future__ import annotations

import re


class BadNameError(Exception):
    """ROS refuses a name, a namespace or an argument; the text says which and why."""


def node_name(text: str) -> str:
    """A name that ROS takes for a node: Gazebo Sim's plugins are called as their classes."""
    name = re.sub(r"[^A-Za-z0-9_]", "_", text)
    return f"_{name}" if name[:1].isdigit() else name or "gazebo"
