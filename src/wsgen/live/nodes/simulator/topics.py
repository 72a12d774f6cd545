"""Topics of plugins: ROS's at once for those of Gazebo Classic, through a bridge for Gazebo Sim's.

A topic of Gazebo Sim is a name in this process. What plugins publish on it goes to those rules of
bridges that name it, and what arrives from ROS by a rule goes to the plugins that read it. Plugins
speak ROS's messages on the topics of Gazebo, each the first one of its kind
(`gazebo/bridged_types.py`), and a bridge makes the one that its rule wants of it.

The QoS is that which the <ros><qos> of a plugin of Gazebo Classic gives to its topics.
Source: ros-simulation/gazebo_ros_pkgs, branch ros2, gazebo_ros/src/qos.cpp.
"""

from __future__ import annotations

import importlib
import itertools
import math
import time
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from wsgen.gazebo.bridged_types import PAIRS, short_gz_type, short_ros_type
from wsgen.text.suggestions import did_you_mean, nearest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from wsgen.live.nodes.simulator.ros import Ros
    from wsgen.model.devices import Element


COUNT_EVERY = 0.02  # s of wall-clock time
DEPTH = 10  # of the queues of a bridge
_ALIKE = 0.85  # as difflib counts: long names have their beginning in common


class Endpoint(NamedTuple):
    """A node at a topic of ROS."""

    node: str
    type: str  # sensor_msgs/msg/LaserScan


def mixed_types(
    topic: str, senders: Iterable[Endpoint], readers: Iterable[Endpoint]
) -> Iterator[str]:
    """Which messages do not arrive, because they are not of the type that is read."""
    for sender, reader in itertools.product(sorted(set(senders)), sorted(set(readers))):
        is_hidden = "_" in {sender.node[:1], reader.node[:1]}
        if sender.type != reader.type and not is_hidden:
            yield (
                f"Nothing that `{sender.node}` publishes on {topic} reaches `{reader.node}`: it "
                f"sends {sender.type}, and {reader.type} is read. Publish that type, or change the "
                "one that is read: ros_type_name of a bridge, use_stamped_vel of a controller."
            )


class Publisher(Protocol):
    """What a plugin publishes with."""

    @property
    def is_wanted(self) -> bool:
        """Whether somebody gets what is published now."""

    def publish(self, message: Any) -> None:
        """Send a message to all who want it; nothing happens where nobody does."""


class RosPublisher:
    """On a topic of ROS."""

    def __init__(self, publisher: Any, *, keeps: bool) -> None:
        """`keeps` is whether those who come later get the last messages, too."""
        self.ros = publisher
        self._keeps = keeps
        self._counted = -math.inf  # s, when the subscriptions were counted
        self._has_readers = False

    @property
    def is_wanted(self) -> bool:
        """Whether somebody has subscribed, or may yet for this message."""
        now = time.monotonic()
        if now > self._counted + COUNT_EVERY:  # it costs as much as a small message
            self._counted = now
            self._has_readers = self._keeps or self.ros.get_subscription_count() > 0
        return self._has_readers

    def publish(self, message: Any) -> None:
        """Send it."""
        if self.is_wanted:
            self.ros.publish(message)


class GzPublisher:
    """On a topic of Gazebo Sim."""

    def __init__(self, message_type: type) -> None:
        self.type = name_of(message_type)
        self.outputs: list[tuple[_Way, Callable[[Any], Any]]] = []

    @property
    def is_wanted(self) -> bool:
        """Whether somebody has subscribed on the other side of a bridge."""
        return any(way.publisher.is_wanted for way, _ in self.outputs)

    def publish(self, message: Any) -> None:
        """Send it over all bridges."""
        for way, convert in self.outputs:
            if way.publisher.is_wanted:
                way.publisher.publish(convert(message))


class Rule(NamedTuple):
    """What a bridge connects."""

    ros_topic: str
    gz_topic: str
    ros_type: str  # sensor_msgs/msg/LaserScan
    gz_type: str  # gz.msgs.LaserScan
    direction: str = "both"  # or "to_ros", "to_gz"


class _Way(NamedTuple):
    """From Gazebo to ROS, by one rule."""

    rule: Rule
    publisher: RosPublisher


class _Reader(NamedTuple):
    """A plugin that reads a topic."""

    type: str
    callback: Callable[[Any], None]


class Bridge(NamedTuple):
    """What is connected by one process of the user's launch file."""

    node: Any
    made: list[Any]  # publishers and subscriptions of ROS
    ways: list[_Way]
    rules: list[Rule]


class GzTopics:
    """All topics of Gazebo Sim."""

    def __init__(self, ros: Ros, warn: Callable[[str], None]) -> None:
        self._ros = ros
        self._warn = warn
        self._publishers: dict[str, list[GzPublisher]] = {}
        self._readers: dict[str, list[_Reader]] = {}
        self._ways: list[_Way] = []
        self._rules: list[Rule] = []

    def publisher(self, message_type: type, topic: str) -> GzPublisher:
        """Publish on a topic."""
        made = GzPublisher(message_type)
        self._publishers.setdefault(gz_name(topic), []).append(made)
        for way in self._ways:
            if gz_name(way.rule.gz_topic) == gz_name(topic):
                self._connect(way, made)
        return made

    def subscription(
        self, message_type: type, topic: str, callback: Callable[[Any], None]
    ) -> _Reader:
        """Read a topic."""
        reader = _Reader(name_of(message_type), callback)
        self._readers.setdefault(gz_name(topic), []).append(reader)
        return reader

    def forget(self, made: object) -> None:
        """End a publisher or a subscription."""
        for publishers in self._publishers.values():
            publishers[:] = [one for one in publishers if one is not made]
        for readers in self._readers.values():
            readers[:] = [one for one in readers if one is not made]

    @property
    def names(self) -> set[str]:
        """The topics that somebody has here."""
        return {
            topic for table in (self._publishers, self._readers) for topic in table if table[topic]
        }

    def unconnected(self) -> Iterator[str]:
        """What is wrong with rules whose topics of Gazebo nobody here has."""
        for rule in self._rules:
            topic = gz_name(rule.gz_topic)
            if self._publishers.get(topic) or self._readers.get(topic):
                continue
            near = self._near(topic)
            yield (
                f"bridge of `{rule.ros_topic}`: nothing in the simulation publishes or reads "
                f"Gazebo's topic `{topic}`. "
                + (did_you_mean(near) if near else f"Topics: {', '.join(sorted(self.names))}.")
            )

    def _near(self, topic: str) -> str | None:
        """The topic that may be meant: what is alike in it is more than the world and the model."""
        word = topic.rpartition("/")[2]
        same = [name for name in self.names if name.rpartition("/")[2] == word]
        return same[0] if len(same) == 1 else nearest(topic, sorted(self.names), cutoff=_ALIKE)

    def open(self, node: Any, rules: list[Rule]) -> Bridge:
        """Connect topics; `node` is that of the bridge, and the rules have no problem."""
        bridge = Bridge(node, [], [], [])
        for rule in rules:
            self.connect(bridge, rule)
        return bridge

    def connect(self, bridge: Bridge, rule: Rule) -> None:
        """Follow one more rule. Raises BadNameError: ROS refuses the name of its topic."""
        kind = message_class(rule.ros_type)
        if rule.direction != "to_gz":
            assert kind is not None  # noqa: S101  `problem_of` looked
            made = self._ros.publisher(bridge.node, kind, rule.ros_topic, DEPTH)
            way = _Way(rule, RosPublisher(made, keeps=False))
            bridge.made.append(made)
            bridge.ways.append(way)
            self._ways.append(way)
            for publisher in self._publishers.get(gz_name(rule.gz_topic), ()):
                self._connect(way, publisher)
        if rule.direction != "to_ros":
            source, topic = short_ros_type(rule.ros_type), gz_name(rule.gz_topic)

            def deliver(message: Any) -> None:
                for reader in tuple(self._readers.get(topic, ())):
                    convert = conversion(source, reader.type)
                    if convert is None:
                        self._warn(_mismatch(rule, reader.type))
                    else:
                        reader.callback(convert(message))

            assert kind is not None  # noqa: S101  `problem_of` looked
            bridge.made.append(
                self._ros.subscription(bridge.node, kind, rule.ros_topic, deliver, DEPTH)
            )
        self._rules.append(rule)
        bridge.rules.append(rule)

    def _connect(self, way: _Way, publisher: GzPublisher) -> None:
        convert = conversion(publisher.type, short_ros_type(way.rule.ros_type))
        if convert is None:
            self._warn(_mismatch(way.rule, publisher.type))
        else:
            publisher.outputs.append((way, convert))

    def close(self, bridge: Bridge) -> None:
        """End a bridge."""
        ended = {id(way) for way in bridge.ways}
        self._ways = [way for way in self._ways if id(way) not in ended]
        for publishers in self._publishers.values():
            for publisher in publishers:
                publisher.outputs = [one for one in publisher.outputs if id(one[0]) not in ended]
        ended = {id(rule) for rule in bridge.rules}
        self._rules = [rule for rule in self._rules if id(rule) not in ended]
        self._ros.forget_node(bridge.node)


def gz_name(topic: str) -> str:
    """The whole name of a topic of Gazebo Sim."""
    return "/" + topic.strip("/")


def problem_of(rule: Rule) -> str | None:
    """Why a rule cannot be followed, and what to do; None where it can."""
    gz_type = short_gz_type(rule.gz_type)
    if gz_type is None or gz_type not in PAIRS:
        return (
            f"Gazebo has no message type {rule.gz_type} that can be bridged. Write one like "
            "gz.msgs.LaserScan."
        )
    types = PAIRS[gz_type]
    if short_ros_type(rule.ros_type) not in types:
        known = " or ".join(one.replace("/", "/msg/") for one in types)
        return f"{rule.gz_type} cannot be bridged to {rule.ros_type}. Write {known}."
    if message_class(rule.ros_type) is None:
        return f"The ROS package of {rule.ros_type} is not installed. Build it in the workspace."
    return None


def _mismatch(rule: Rule, kind: str) -> str:
    return (
        f"bridge of `{rule.ros_topic}`: on Gazebo's topic `{rule.gz_topic}` are messages like "
        f"{kind.replace('/', '/msg/')}, which cannot be bridged as {rule.ros_type}."
    )


def name_of(message_type: type) -> str:
    """`sensor_msgs/LaserScan` of a class of messages."""
    return f"{message_type.__module__.partition('.')[0]}/{message_type.__name__}"


def message_class(name: str) -> type | None:
    """The class of a message type; None where its package is not installed."""
    package, _, message = short_ros_type(name).partition("/")
    try:
        found: type | None = getattr(importlib.import_module(f"{package}.msg"), message, None)
    except ImportError:
        return None
    return found


def conversion(source: str, target: str) -> Callable[[Any], Any] | None:
    """What makes a message of one type of another one; None where they have nothing in common."""
    if source == target:
        return _same
    return _CONVERSIONS.get((source, target))


def _same(message: Any) -> Any:
    return message


def _stamped(name: str, field: str) -> Callable[[Any], Any]:
    """What makes a message with a header of one without, which becomes this field."""

    def stamp(message: Any) -> Any:
        made = _new(name)
        setattr(made, field, message)
        return made

    return stamp


def _pose_array(message: Any) -> Any:
    made = _new("geometry_msgs/PoseArray")
    for transform in message.transforms:
        made.header = transform.header
        made.poses.append(_pose(transform))
    return made


def _pose(stamped: Any) -> Any:
    pose = _new("geometry_msgs/Pose")
    position, translation = pose.position, stamped.transform.translation
    position.x, position.y, position.z = translation.x, translation.y, translation.z
    pose.orientation = stamped.transform.rotation
    return pose


def _stamped_pose(stamped: Any) -> Any:
    made = _new("geometry_msgs/PoseStamped")
    made.header, made.pose = stamped.header, _pose(stamped)
    return made


def _new(name: str) -> Any:
    made = message_class(name)
    assert made is not None  # noqa: S101  geometry_msgs are always there
    return made()


_CONVERSIONS: dict[tuple[str, str], Callable[[Any], Any]] = {
    ("geometry_msgs/TwistStamped", "geometry_msgs/Twist"): attrgetter("twist"),
    ("geometry_msgs/Twist", "geometry_msgs/TwistStamped"): _stamped(
        "geometry_msgs/TwistStamped", "twist"
    ),
    ("tf2_msgs/TFMessage", "geometry_msgs/PoseArray"): _pose_array,
    ("geometry_msgs/TransformStamped", "geometry_msgs/PoseStamped"): _stamped_pose,
    ("geometry_msgs/TransformStamped", "geometry_msgs/Pose"): _pose,
    ("geometry_msgs/TransformStamped", "geometry_msgs/Transform"): attrgetter("transform"),
    ("geometry_msgs/WrenchStamped", "geometry_msgs/Wrench"): attrgetter("wrench"),
    ("geometry_msgs/Wrench", "geometry_msgs/WrenchStamped"): _stamped(
        "geometry_msgs/WrenchStamped", "wrench"
    ),
}


class BadNameError(Exception):
    """ROS refuses a name, a namespace or an argument; the text says which and why."""


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
