"""Sensors have in live runs the topics that the checks of bridges say they have."""

from __future__ import annotations

from dataclasses import replace

import pytest

from live.nodes.sensor_messages import install_sensor_messages
from live.nodes.test_sensors import ROVER, SURROUNDINGS, mounted, simulated
from wsgen.checks.rules import node_topics
from wsgen.descriptions.sdf.source import read_document
from wsgen.gazebo.bridged_types import PAIRS
from wsgen.gazebo.sensors import SENSORS as KNOWN_SENSORS
from wsgen.live.nodes.simulator.sensors import SENSORS
from wsgen.model.robot import Joint, JointType

WHEELED = replace(
    ROVER,
    links=(*ROVER.links, replace(ROVER.links[0], name="wheel")),
    joints=(Joint(name="axle", type=JointType.CONTINUOUS, parent="base", child="wheel"),),
)
TOPICS = {
    "": "",
    "absolute": "<topic>/own/name</topic>",
    "relative": "<topic>own</topic>",
    "of contacts": "<contact><topic>touched</topic></contact>",
    "of a camera": "<camera><camera_info_topic>about</camera_info_topic></camera>",
}


@pytest.fixture(autouse=True)
def _messages(monkeypatch: pytest.MonkeyPatch) -> None:
    install_sensor_messages(monkeypatch)


def in_live_runs(text: str) -> tuple[set[tuple[str, str]], list[str]]:
    """Topics of Gazebo with their types, and warnings."""

    sensor = replace(mounted(text), frame="axle" if "force_torque" in text else "base")
    ((found, warnings),) = [
        (
            {
                (topic, next(kind for kind, types in PAIRS.items() if types[0] == publisher.type))
                for topic, publishers in simulation.host.gz._publishers.items()
                for publisher in publishers
            },
            ros.warnings,
        )
        for simulation, ros in simulated(
            sensor, simulator="gz", robot=WHEELED, surroundings=SURROUNDINGS
        )
    ]
    return found, warnings


def in_checks(text: str, place: str = "link name='base'") -> set[tuple[str, str]]:
    root, _ = read_document(
        f"<sdf><model name='rover'><{place}>{text}</{place.partition(' ')[0]}></model></sdf>"
    )
    assert root is not None
    return {(one.name, one.type) for one in node_topics.topics_of(root, "rover", "field")}


@pytest.mark.parametrize("topic", TOPICS.values(), ids=TOPICS)
@pytest.mark.parametrize("kind", sorted({*KNOWN_SENSORS, *SENSORS}))
def test_topics_of_sensors(kind: str, topic: str) -> None:
    needed = (
        "<lidar><range><max>9</max></range></lidar>" if "ray" in kind or "lidar" in kind else ""
    )
    needed = "<contact/>" if kind == "contact" and "<contact>" not in topic else needed
    text = f'<sensor name="s" type="{kind}">{topic}{needed}</sensor>'
    place = "joint name='axle'" if kind == "force_torque" else "link name='base'"
    found, warnings = in_live_runs(text)
    assert found or warnings
    assert found == in_checks(text, place)


def test_gazebo_sim_has_no_multicamera() -> None:
    found, (warning,) = in_live_runs('<sensor name="s" type="multicamera"/>')
    assert not found
    assert "Write a sensor for each camera" in warning
