"""A bridge to the topics of Gazebo Sim, for tests without ROS."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from live.nodes.fake_ros import FakeRos


def bridged(ros: FakeRos, simulation: Any, *rules: tuple[str, str, str, str]) -> None:
    """Bridge topics: that of ROS, that of Gazebo, and the two types."""
    from wsgen.live.nodes.simulator.topics import Rule  # noqa: PLC0415  with fakes of messages

    made = [Rule(topic, gz, kind, f"gz.msgs.{of_gz}") for topic, gz, kind, of_gz in rules]
    simulation.host.gz.open(ros.node("bridge"), made)
