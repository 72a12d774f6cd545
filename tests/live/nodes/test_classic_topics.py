"""Plugins in sensors have in live runs of Classic the topics that the proof of a port takes."""

from __future__ import annotations

import pytest

from live.nodes.sensor_messages import install_sensor_messages
from live.nodes.test_sensors import SURROUNDINGS, mounted, simulated
from wsgen.gazebo.sensors import TOPICS_OF_CLASSIC
from wsgen.live.nodes.simulator.topics import name_of
from wsgen.porting.robot_topics import of_classic_sensor

RAYS = "<ray><range><max>9</max></range></ray>"
EYES = '<camera name="left"/><camera name="right"/>'
SENSORS = {
    "bumper": ("contact", "bumper", "<contact/>"),
    "camera": ("camera", "camera", "<camera/>"),
    "depth camera": ("depth", "camera", "<camera/>"),
    "depth camera of later SDF": ("depth_camera", "camera", "<camera/>"),
    "several cameras": ("multicamera", "camera", EYES),
    "gps": ("gps", "gps_sensor", ""),
    "imu": ("imu", "imu_sensor", ""),
    "ray": ("ray", "ray_sensor", RAYS),
    "gpu ray": ("gpu_ray", "ray_sensor", RAYS),
}
PLUGINS = {
    "plain": "",
    "in a namespace": "<ros><namespace>/bot</namespace></ros>",
    "of another name": "<camera_name>front</camera_name>"
    "<output_type>sensor_msgs/LaserScan</output_type>",
    "remapped by an argument": "<ros><argument>~/out:=found</argument></ros>",
    "remapped": "<ros><namespace>bot</namespace><remapping>~/out:=found</remapping>"
    "<remapping>s/image_raw:=/found</remapping><remapping>bumper_states:=found</remapping></ros>",
}


@pytest.fixture(autouse=True)
def _messages(monkeypatch: pytest.MonkeyPatch) -> None:
    install_sensor_messages(monkeypatch)


def test_the_table_is_tried_whole() -> None:
    assert {f"gazebo_ros_{name}" for _, name, _ in SENSORS.values()} == TOPICS_OF_CLASSIC.keys()


@pytest.mark.parametrize("written", PLUGINS.values(), ids=PLUGINS)
@pytest.mark.parametrize(("kind", "name", "inside"), SENSORS.values(), ids=SENSORS)
def test_topics_of_sensors(kind: str, name: str, inside: str, written: str) -> None:
    sensor = mounted(
        f'<sensor name="s" type="{kind}">{inside}'
        f'<plugin name="p" filename="libgazebo_ros_{name}.so">{written}</plugin></sensor>'
    )
    ((in_live_runs),) = [
        {
            (topic.replace("/~/", "/p/"), name_of(publisher.kind))
            for node in ros.nodes
            if node.name == "p"
            for topic, publisher in node.publishers.items()
        }
        for _, ros in simulated(sensor, surroundings=SURROUNDINGS)
    ]
    in_proof = {(one.name, one.type) for one in of_classic_sensor(sensor, sensor.plugins[0])}
    assert in_live_runs
    assert in_proof == in_live_runs
