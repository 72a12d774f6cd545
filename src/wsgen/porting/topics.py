"""The names of the topics of a plugin of Gazebo Classic, as its node of ROS has them.

A name may contain what xacro replaces; then the same name is made of it before and after that.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.gazebo.plugins import REMAPPINGS
from wsgen.porting.xml_edits import COMPUTED

if TYPE_CHECKING:
    from wsgen.porting.xml_edits import Node

_NAMESPACES = ("robotNamespace", "robot_namespace")  # of plugins of ROS 1


class Topics:
    """Names topics for one plugin, with its namespace, or that of its spawner, and remappings."""

    def __init__(self, plugin: Node, namespace: str = "") -> None:
        ros = plugin.find("ros")
        written = [namespace, plugin.value("ros/namespace"), *map(plugin.value, _NAMESPACES)]
        # What contains elements is no name.
        self._namespace = _namespace(next((one for one in written if one and "<" not in one), ""))
        self._node = plugin.get("name") or "gazebo"
        rules = [] if ros is None else [one.text for one in ros.children(*REMAPPINGS)]
        pairs = [rule.partition(":=") for rule in rules if ":=" in rule]
        self._rules = {self.expand(one.strip()): other.strip() for one, _, other in reversed(pairs)}

    def expand(self, name: str) -> str:
        """A name with the namespace of the node."""
        if name.startswith("/"):
            return name
        if name.startswith("~"):
            name = f"{self._node}/{name[1:].lstrip('/')}"
        if not self._namespace and name.startswith(COMPUTED):
            return name  # it may begin with a slash
        return f"{self._namespace}/{name}"

    def resolve(self, name: str) -> str:
        """A name after remappings."""
        full = self.expand(name)
        return self.expand(self._rules[full]) if full in self._rules else full


def _namespace(text: str) -> str:
    text = text.rstrip("/")
    return text if not text or text.startswith(("/", COMPUTED)) else f"/{text}"


def absolute(topic: str) -> str:
    """A name as Gazebo and ROS have it in the end."""
    return f"/{'/'.join(filter(None, topic.split('/')))}"


def folder(topic: str) -> str:
    """What a topic is in; Gazebo Sim has `camera_info` there."""
    return topic.rpartition("/")[0]
