"""Gazebo's topics, and the bridges between them and ROS's."""

from __future__ import annotations

from typing import Any

import pytest

from live.nodes.fake_ros import FakeRos

pytestmark = pytest.mark.usefixtures("messages")
TWIST = "geometry_msgs/msg/Twist"


def topics() -> tuple[Any, FakeRos, list[str]]:
    from wsgen.live.nodes.simulator.topics import GzTopics  # noqa: PLC0415  with fakes of messages

    ros = FakeRos()
    warnings: list[str] = []
    return GzTopics(ros, warnings.append), ros, warnings  # type: ignore[arg-type]


def rule(*values: str) -> Any:
    from wsgen.live.nodes.simulator.topics import Rule  # noqa: PLC0415

    return Rule(*values)


def twist(x: float) -> Any:
    from geometry_msgs.msg import Twist  # noqa: PLC0415

    made = Twist()
    made.linear.x = x
    return made


@pytest.mark.parametrize("is_bridged_first", [True, False])
def test_what_plugins_publish_reaches_ros_by_a_rule(*, is_bridged_first: bool) -> None:
    gz, ros, warnings = topics()
    kind = type(twist(0.0))
    node = ros.node("bridge")
    rules = [rule("/out", "model/a/speed", TWIST, "gz.msgs.Twist", "to_ros")]
    bridge = gz.open(node, rules) if is_bridged_first else None
    publisher, other = gz.publisher(kind, "/model/a/speed"), gz.publisher(kind, "/model/b/speed")
    bridge = bridge or gz.open(node, rules)
    assert publisher.is_wanted
    assert not other.is_wanted
    publisher.publish(twist(1.0))
    other.publish(twist(2.0))
    assert [message.linear.x for message in ros.published("/out")] == [1.0]
    node.publishers["/out"].subscribers = 0
    assert not publisher.is_wanted
    node.publishers["/out"].subscribers = 1
    gz.close(bridge)
    assert not publisher.is_wanted
    assert not ros.nodes
    assert not warnings


def test_what_ros_publishes_reaches_plugins_by_a_rule() -> None:
    gz, ros, _ = topics()
    got: list[float] = []
    reader = gz.subscription(type(twist(0.0)), "cmd_vel", lambda one: got.append(one.linear.x))
    bridge = gz.open(ros.node("b"), [rule("/in", "/cmd_vel", TWIST, "gz.msgs.Twist", "to_gz")])
    assert not bridge.ways
    ros.send("/in", twist(3.0))
    gz.forget(reader)
    ros.send("/in", twist(4.0))
    assert got == [3.0]


def test_a_bridge_makes_of_a_message_the_one_that_its_rule_wants() -> None:
    from geometry_msgs.msg import TransformStamped, TwistStamped  # noqa: PLC0415
    from tf2_msgs.msg import TFMessage  # noqa: PLC0415

    gz, ros, warnings = topics()
    got: list[float] = []
    gz.subscription(type(twist(0.0)), "/cmd_vel", lambda one: got.append(one.linear.x))
    poses = gz.publisher(TFMessage, "/pose")
    gz.open(
        ros.node("b"),
        [
            rule("/in", "/cmd_vel", f"{TWIST}Stamped", "gz.msgs.Twist", "both"),
            rule("/poses", "/pose", "geometry_msgs/msg/PoseArray", "gz.msgs.Pose_V", "to_ros"),
        ],
    )
    ros.send("/in", TwistStamped(twist=twist(5.0)))
    assert got == [5.0]
    transform = TransformStamped()
    transform.header.frame_id, transform.transform.translation.y = "odom", 2.0
    poses.publish(TFMessage(transforms=[transform]))
    (array,) = ros.published("/poses")
    assert (array.header.frame_id, array.poses[0].position.y) == ("odom", 2.0)
    assert not warnings


def test_another_type_than_the_plugin_has_is_named() -> None:
    from std_msgs.msg import Bool  # noqa: PLC0415

    gz, ros, warnings = topics()
    gz.publisher(Bool, "/a")
    gz.open(ros.node("b"), [rule("/a", "/a", TWIST, "gz.msgs.Twist", "to_ros")])
    assert "cannot be bridged as geometry_msgs/msg/Twist" in warnings[0]


def test_topics_that_nobody_has_are_named() -> None:
    gz, ros, _ = topics()
    gz.publisher(type(twist(0.0)), "/model/rover/speed")
    rules = [
        rule("/a", "/model/rover/sped", TWIST, "gz.msgs.Twist", "to_ros"),
        rule("/b", "/model/rover/speed", TWIST, "gz.msgs.Twist", "to_ros"),
    ]
    bridge = gz.open(ros.node("b"), rules)
    (problem,) = gz.unconnected()
    assert "bridge of `/a`" in problem
    assert "Did you mean `/model/rover/speed`" in problem
    gz.close(bridge)
    assert not list(gz.unconnected())


@pytest.mark.parametrize(
    ("ros_type", "gz_type", "message"),
    [
        (TWIST, "gz.msgs.Twist", None),
        ("geometry_msgs/Twist", "ignition.msgs.Twist", None),
        ("std_msgs/msg/Bool", "gz.msgs.Twist", "Write geometry_msgs/msg/Twist or"),
        (TWIST, "gz.msgs.Twisted", "no message type gz.msgs.Twisted"),
        (TWIST, "Twist", "no message type Twist"),
        ("sensor_msgs/msg/Joy", "gz.msgs.Joy", "is not installed"),
    ],
)
def test_types_are_checked(ros_type: str, gz_type: str, message: str | None) -> None:
    from wsgen.live.nodes.simulator.topics import problem_of  # noqa: PLC0415

    problem = problem_of(rule("/a", "/a", ros_type, gz_type))
    assert (problem is None) == (message is None)
    assert message is None or message in str(problem)


def test_two_types_on_a_topic_are_named() -> None:
    from wsgen.live.nodes.simulator.topics import Endpoint, mixed_types  # noqa: PLC0415

    twist, stamped = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
    teleop, bridge = Endpoint("teleop", twist), Endpoint("ros_gz_bridge", stamped)
    (reported,) = mixed_types(
        "/cmd_vel", [teleop, teleop], [bridge, Endpoint("_recorder", stamped)]
    )
    assert reported.startswith(
        "Nothing that `teleop` publishes on /cmd_vel reaches `ros_gz_bridge`"
    )
    assert twist in reported
    assert stamped in reported
    assert not list(mixed_types("/cmd_vel", [teleop], [Endpoint("drive", twist)]))


@pytest.mark.parametrize(
    ("topic", "words"),
    [
        ("/world/arena/model/rover/joint_state", "Topics: /cmd_vel, /world/arena/clock."),
        ("/model/rover/cmd_vel", "Did you mean `/cmd_vel`?"),
    ],
)
def test_a_topic_of_the_same_world_is_not_meant(topic: str, words: str) -> None:
    gz, ros, _ = topics()
    for name in ("/world/arena/clock", "/cmd_vel"):
        gz.publisher(type(twist(0.0)), name)
    gz.open(ros.node("b"), [rule("/a", topic, TWIST, "gz.msgs.Twist", "to_ros")])
    (problem,) = gz.unconnected()
    assert problem.endswith(words)
