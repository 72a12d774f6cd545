"""What `wsgen topic` and `wsgen node` say where they would be silent."""

from __future__ import annotations

import time
from types import SimpleNamespace
from typing import TYPE_CHECKING

from wsgen.isolation.parent import held
from wsgen.live.nodes.unanswered import Run, Silence

if TYPE_CHECKING:
    from pathlib import Path

    import pytest

TWIST, STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"


class Node:
    """A node that sees others, and a topic or two."""

    def __init__(self, *others: tuple[str, str], publishers: dict[str, str] | None = None) -> None:
        self._nodes = [("_ros2cli_1", "/"), ("_ros2cli_2", "/"), *others]
        self._topics = publishers or {}

    def get_fully_qualified_name(self) -> str:
        return "/_ros2cli_1"

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        return self._nodes

    def get_topic_names_and_types(self) -> list[tuple[str, list[str]]]:
        own = [("/rosout", ["rcl_interfaces/msg/Log"])]
        return own + [(name, [kind]) for name, kind in self._topics.items()]

    def get_publishers_info_by_topic(self, topic: str) -> list[SimpleNamespace]:
        return [SimpleNamespace(topic_type=self._topics[topic])] if topic in self._topics else []

    def count_publishers(self, topic: str) -> int:
        return len(self.get_publishers_info_by_topic(topic))

    get_subscriptions_info_by_topic = get_publishers_info_by_topic
    count_subscribers = count_publishers


def silence(node: Node, *runs: Run) -> Silence:
    return Silence(node, domain="5", runs=runs, command="wsgen topic list")


def test_nobody_is_there() -> None:
    found = silence(Node())
    assert found.is_alone()  # other tools are no nodes of a robot
    assert found.nothing_runs() == (
        "No node is found in ROS_DOMAIN_ID 5.\n"
        "Start a launch file in another terminal: wsgen launch PACKAGE FILE --run"
    )
    assert not silence(Node(("driver", "/left"))).is_alone()


def test_a_run_is_in_another_domain() -> None:
    runs = [Run(str(number), f"rover run_{number}.launch.py") for number in range(6, 11)]
    text = silence(Node(), *runs).nothing_runs()
    assert text.splitlines()[1] == (
        "`rover run_6.launch.py` runs in ROS_DOMAIN_ID 6. To see it: "
        "ROS_DOMAIN_ID=6 wsgen topic list"
    )
    assert text.splitlines()[4:] == ["2 more live runs have other domains."]
    here = silence(Node(), Run("5", "rover run.launch.py")).nothing_runs()
    assert "`rover run.launch.py` runs in this domain" in here
    assert "ROS_AUTOMATIC_DISCOVERY_RANGE" in here


def test_the_nodes_of_a_run_that_has_just_been_started_are_yet_to_come(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    begun = time.time()
    monkeypatch.setattr(time, "time", lambda: begun + 3)
    old, new = Run("5", "rover run.launch.py"), Run("5", "rover next.launch.py", begun=begun)
    starting = silence(Node(), old, new)
    assert starting.expects_nodes()
    assert starting.nothing_runs().splitlines()[1] == (
        "`rover next.launch.py` has just been started, and its nodes are not there yet: start this "
        "command again in a few seconds."
    )
    assert silence(Node(), new, old).nothing_runs() == starting.nothing_runs()
    assert not silence(Node(("driver", "/")), new).expects_nodes()
    for other in (
        old,
        new._replace(domain="6"),
        new._replace(drawn="x.gif"),
        new._replace(begun=begun - 60),
        new._replace(begun=begun + 3600),  # the clock was set back since
    ):
        assert not silence(Node(), other).expects_nodes()
        assert "just been started" not in silence(Node(), other).nothing_runs()


def test_a_run_that_has_ended_is_none_to_look_for() -> None:
    ended = Run("5", "rover run.launch.py", "x.gif")
    assert silence(Node(), ended).nothing_runs().splitlines() == [
        "No node is found in ROS_DOMAIN_ID 5.",
        "`rover run.launch.py` has ended; x.gif is still being drawn of it.",
        "Start a launch file in another terminal: wsgen launch PACKAGE FILE --run",
    ]
    assert "rover" not in silence(Node(), ended._replace(domain="6")).nothing_runs()
    both = silence(Node(), ended, Run("6", "rover next.launch.py")).nothing_runs().splitlines()
    assert [line.split("`")[1] for line in both[1:]] == [
        "rover run.launch.py",
        "rover next.launch.py",
    ]


def test_a_run_may_end_after_it_was_found(tmp_path: Path) -> None:
    live = tmp_path / "held" / "live"
    live.mkdir(parents=True)
    file = live / "ended"
    begun = time.time()
    run = Run("5", "rover run.launch.py", begun=begun, ended=str(file))
    says = [
        "No node is found in ROS_DOMAIN_ID 5.",
        "`rover run.launch.py` has ended.",
        "Start a launch file in another terminal: wsgen launch PACKAGE FILE --run",
    ]
    with held(str(live.parent)):
        assert silence(Node(), run).expects_nodes()
        assert "has ended" not in silence(Node(), run).nothing_runs()
        file.touch()
        assert not silence(Node(), run).expects_nodes()
        assert silence(Node(), run).nothing_runs().splitlines() == says
        file.unlink()
    # Nobody holds it: it was killed.
    assert silence(Node(), run).nothing_runs().splitlines() == says
    live.rmdir()
    assert silence(Node(), run).nothing_runs().splitlines() == says
    assert "rover" not in silence(Node(), run._replace(domain="6")).nothing_runs()


def test_who_waits_says_for_what_once(capsys: pytest.CaptureFixture[str]) -> None:
    alone = silence(Node())
    for _ in range(3):
        alone.waits(None)
        alone.waits("the topic /scan")
    silence(Node(("driver", "/"))).waits("the topic /scan")
    silence(Node(("driver", "/"))).waits(None)  # nodes have been found
    shown = capsys.readouterr()
    assert shown.out == ""
    assert (
        shown.err == "Waiting for nodes in ROS_DOMAIN_ID 5 ...\nWaiting for the topic /scan ...\n"
    )


def test_nothing_comes(capsys: pytest.CaptureFixture[str]) -> None:
    def said(node: Node, topic: str, kind: str = TWIST) -> str:
        silence(node).say_nothing_comes(topic, kind)
        return capsys.readouterr().err

    node = Node(("driver", "/"), publishers={"/cmd_vel": TWIST})
    assert said(Node(), "/cmd_vel").startswith("No node is found")
    assert said(node, "/cmd_vell").startswith(
        "No node publishes on /cmd_vell. Did you mean `/cmd_vel`? Waiting"
    )
    assert "Topics with publishers: /cmd_vel." in said(node, "/scan")
    assert f"/cmd_vel has {TWIST}, and not {STAMPED}" in said(node, "/cmd_vel", STAMPED)
    assert "its publishers are there" in said(node, "/cmd_vel")


def test_nobody_takes_what_is_published(capsys: pytest.CaptureFixture[str]) -> None:
    def said(node: Node, topic: str, kind: str = TWIST) -> str:
        silence(node).say_nobody_takes(topic, kind)
        return capsys.readouterr().err

    node = Node(("driver", "/"), publishers={"/cmd_vel": STAMPED})
    assert said(Node(), "/cmd_vel").startswith("No node is found")
    assert "No node subscribes to /cmd_vell. Did you mean `/cmd_vel`?" in said(node, "/cmd_vell")
    assert said(node, "/cmd_vel").startswith(
        f"Those who subscribe to /cmd_vel want {STAMPED}, and not {TWIST}."
    )
    assert "QoS" in said(node, "/cmd_vel", STAMPED)
