"""Topics of nodes that nothing reads or publishes, with the facts of what is started."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.checks.rules.bridges import FROM_GZ, TO_GZ, Bridge
from wsgen.checks.rules.node_topics import (
    Graph,
    UsedTopic,
    graph_of,
    remapped,
    unheard_commands,
    unpublished_topics,
)
from wsgen.model.plan import Include, LaunchPlan, Process
from wsgen.text import yamlfile
from wsgen.text.xmltree import Element, parse

FILE = Path("walk.py")
LAUNCH = Path("robot.launch.py")
YAML = Path("/controllers.yaml")
TWIST, STAMPED = "geometry_msgs/Twist", "geometry_msgs/TwistStamped"
SCAN = "sensor_msgs/LaserScan"
PLAN = LaunchPlan(
    package="bot",
    launch_file=LAUNCH,
    processes=(Process(package="ros_gz_sim", executable="create"),),
)
SCANNED = Bridge("/scan", "/scan", "sensor_msgs/msg/LaserScan", "gz.msgs.LaserScan", FROM_GZ)
DRIVEN = Bridge("/drive", "/cmd_vel", "geometry_msgs/msg/Twist", "gz.msgs.Twist", TO_GZ)

OF_ARM = Bridge("/arm/cmd_vel", "/arm", "geometry_msgs/msg/Twist", "gz.msgs.Twist", TO_GZ)


def controlled(
    plugin: str = "", parameters: str = "", plan: LaunchPlan = PLAN, around: str = "{}"
) -> Graph:
    """A robot with a diff_drive_controller."""
    text = (
        f"<robot><plugin filename='gz_ros2_control-system'><parameters>{YAML}</parameters>{plugin}"
        "</plugin></robot>"
    )
    sections = (
        "controller_manager: {ros__parameters: {drive: "
        "{type: diff_drive_controller/DiffDriveController}}},\n"
        f"drive: {{ros__parameters: {{{parameters}}}}}"
    )
    content = yamlfile.parse(around.replace("{}", f"{{{sections}}}"))
    assert isinstance(content, yamlfile.Value)
    return graph_of(plan, (), (root_of(text),), {YAML: content}, ())


def root_of(text: str) -> Element:
    root = parse(text)
    assert isinstance(root, Element)
    return root


def bridged(*bridges: Bridge, plan: LaunchPlan = PLAN) -> Graph:
    return graph_of(plan, bridges, (), {}, (("bot", "walk.py"),))


def sent(topic: str | None, type_: str = STAMPED) -> UsedTopic:
    return UsedTopic(topic, type_, is_published=True, written="t", file=FILE, line=3)


def read(topic: str | None, type_: str = SCAN) -> UsedTopic:
    return UsedTopic(topic, type_, is_published=False, written="t", file=FILE, line=3)


def remapping(old: str, kind: str = "remapping") -> str:
    return f"<ros><{kind}>{old}:=/cmd_vel</{kind}></ros>"


@pytest.mark.parametrize(
    ("graph", "used", "hint"),
    [
        (
            controlled(),
            sent("/cmd_vel"),
            "Did you mean `/drive/cmd_vel`? If not, remap one of them.",
        ),
        (controlled(), sent("/drive/cmd_vel"), None),
        (controlled(remapping("/drive/cmd_vel")), sent("/cmd_vel"), None),
        (controlled(remapping("~/cmd_vel")), sent("/cmd_vel"), None),
        (controlled(remapping("~/cmd_vel", "argument")), sent("/cmd_vel"), None),
        (controlled(), sent("/drive/cmd_vel", TWIST), f"Publish {STAMPED} instead."),
        (
            controlled(around="/**: {}"),
            sent("/drive/cmd_vel", TWIST),
            f"Publish {STAMPED} instead.",
        ),
        (controlled("", "use_stamped_vel: false"), sent("/drive/cmd_vel_unstamped", TWIST), None),
        (bridged(DRIVEN), sent("/cmd_vell", TWIST), "Did you mean `/cmd_vel`? If not, remap one"),
        (bridged(DRIVEN), sent("/cmdvel", TWIST), "Did you mean `/cmd_vel`?"),
        (bridged(DRIVEN), sent("/cmd_vel", TWIST), None),
        (bridged(DRIVEN), sent("/cmd_vel", STAMPED), f"Publish {TWIST} instead."),
        (bridged(DRIVEN), sent("/arm/target", TWIST), None),
        (
            bridged(DRIVEN),
            sent("/velocity_command", TWIST),
            "Did you mean `/cmd_vel`? If not, remap",
        ),
        (bridged(DRIVEN), sent("/velocity_command", STAMPED), None),
        (bridged(DRIVEN), sent("/measured_velocity", TWIST), None),
        (bridged(DRIVEN, OF_ARM), sent("/velocity_command", TWIST), None),
        (bridged(DRIVEN), sent("/cmd_vell", "std_msgs/String"), None),
    ],
)
def test_commands(graph: Graph, used: UsedTopic, hint: str | None) -> None:
    found = [*unheard_commands([graph], [used])]
    assert [one.code for one in found] == (["LCH097"] if hint else [])
    assert all((one.hint or "").startswith(hint or "") for one in found)


def test_remappings_by_a_spawner() -> None:
    spawner = Process(
        package="controller_manager",
        executable="spawner",
        arguments=("drive", "--controller-ros-args", "-r /drive/cmd_vel:=/cmd_vel"),
    )
    plan = LaunchPlan(package="bot", launch_file=LAUNCH, processes=(spawner,))
    assert not [*unheard_commands([controlled(plan=plan)], [sent("/cmd_vel")])]


def test_a_plugin_of_gazebo_classic() -> None:
    text = (
        "<robot><plugin name='d' filename='libgazebo_ros_diff_drive.so'><ros>"
        "<namespace>/bot</namespace></ros></plugin></robot>"
    )
    graph = graph_of(PLAN, (), (root_of(text),), {}, ())
    assert [one.topic for one in graph.endpoints] == ["/bot/cmd_vel"]
    (found,) = unheard_commands([graph], [sent("/cmd_vel", TWIST)])
    assert found.hint == "Did you mean `/bot/cmd_vel`? If not, remap one of them."


@pytest.mark.parametrize(
    "plan",
    [
        LaunchPlan(
            package="bot",
            launch_file=LAUNCH,
            processes=(Process(package="twist_mux", executable="twist_mux"),),
        ),
        LaunchPlan(
            package="bot",
            launch_file=LAUNCH,
            includes=(Include(package="nav2_bringup", file=LAUNCH, evaluated=False),),
        ),
    ],
)
def test_others_may_read_and_publish(plan: LaunchPlan) -> None:
    graphs = [bridged(DRIVEN, SCANNED), bridged(plan=plan)]
    assert not [*unheard_commands(graphs, [sent("/cmd_vell", TWIST)])]
    assert not [*unpublished_topics(graphs, [read("/scna")])]


def test_other_nodes_and_computed_topics() -> None:
    graph, wrong = bridged(DRIVEN), sent("/cmd_vell", TWIST)
    assert [*unheard_commands([graph], [wrong])]
    assert not [*unheard_commands([graph], [wrong, read("/cmd_vell", TWIST)])]
    assert not [*unheard_commands([graph], [wrong, read(None, TWIST)])]
    assert not [*unheard_commands([], [wrong])]
    # Of two nodes, one may be for a robot of another name.
    other = sent("/bot/cmd_vel", TWIST)
    assert [*unheard_commands([graph], [other])]
    assert not [*unheard_commands([graph], [other, sent("/cmd_vel", TWIST)])]
    command = sent("/velocity_command", TWIST)
    assert [*unheard_commands([graph], [command])]
    assert not [*unheard_commands([graph], [command, sent("/cmd_vel", TWIST)])]


@pytest.mark.parametrize(
    ("topic", "meant"),
    [
        ("/scna", "/scan"),
        ("/scn", "/scan"),
        ("/scan", None),
        ("/scan2", None),
        ("/front/scan", None),
        ("/points", None),
    ],
)
def test_topics_that_nothing_publishes(topic: str, meant: str | None) -> None:
    found = [*unpublished_topics([bridged(SCANNED)], [read(topic)])]
    assert [one.hint for one in found] == ([f"Did you mean `{meant}`?"] if meant else [])
    assert not [*unpublished_topics([bridged(SCANNED)], [read(topic), sent(topic, SCAN)])]
    assert not [*unpublished_topics([bridged(SCANNED)], [read(topic, "std_msgs/String")])]


def test_names_of_topics() -> None:
    node = Process(
        package="bot",
        executable="walk.py",
        namespace="/a",
        remappings=(("cmd_vel", "drive"), ("/b/scan", "/scan"), ("odom", "~/odom")),
    )
    assert remapped("cmd_vel", None) == "/cmd_vel"
    assert remapped("cmd_vel", node) == "/a/drive"
    assert remapped("/b/scan", node) == "/scan"
    assert remapped("scan", node) == "/a/scan"
    assert remapped("odom", node) is None
    assert remapped("~/cmd_vel", node) is None
