"""The topics of Gazebo Sim that the plugins and sensors of robots and worlds have."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from wsgen.gazebo.plugins import PLUGINS, GazeboPlugin, simulator_of, stem
from wsgen.gazebo.sensors import SENSORS
from wsgen.model.target import SIM
from wsgen.text.xmltree import child_text, children

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.text.xmltree import Element


class GazeboTopic(NamedTuple):
    """A topic, and what has it."""

    name: str  # absolute
    type: str  # of gz.msgs
    is_published: bool  # by Gazebo; if not, it reads the topic
    owner: str  # "the sensor `lidar`"


def topics_of(root: Element, model: str | None, world: str | None) -> Iterator[GazeboTopic]:
    """The topics of the plugins and sensors of a robot or a model.

    Default names are given only where what they are made of is known.

    Args:
        root: A `<robot>`, or a `<model>`.
        model: What it is called in the world.
        world: The name of the world.
    """
    names = {"model": model, "world": world}
    for plugin in root.iter("plugin"):
        yield from _of_plugin(plugin, names)
    for sensor in root.iter("sensor"):
        yield from _of_sensor(sensor, names)


def _of_plugin(plugin: Element, names: dict[str, str | None]) -> Iterator[GazeboTopic]:
    filename = plugin.get("filename") or ""
    if simulator_of(filename) != SIM:
        return
    known = PLUGINS.get(stem(filename), GazeboPlugin())
    for _, topic, name in known.topic_names(lambda tag: child_text(plugin, tag), names):
        if name is not None:
            yield GazeboTopic(name, topic.type, not topic.is_read, f"the plugin `{filename}`")


def _of_sensor(sensor: Element, names: dict[str, str | None]) -> Iterator[GazeboTopic]:
    kind = sensor.get("type") or ""
    of_sensor = SENSORS.get(kind)
    if of_sensor is None:
        return
    name = sensor.get("name")
    owner = f"the sensor `{name}`"
    written = _in_child(sensor, kind, "topic") if kind == "contact" else None
    written = written or child_text(sensor, "topic")
    if written:
        base = _absolute(written)
    else:
        place = _place_of(sensor)
        default = f"/world/{{world}}/model/{{model}}/{place}/sensor/{name}{of_sensor.default}"
        filled = _filled(default, names) if place and name else None
        if filled is None:
            return
        base = filled
    for suffix, type_name in of_sensor.topics:
        yield GazeboTopic(f"{base}{suffix}", type_name, is_published=True, owner=owner)
    if of_sensor.has_info:
        info = _in_child(sensor, "camera", "camera_info_topic")
        beside = f"{base.rpartition('/')[0]}/camera_info"
        yield GazeboTopic(
            _absolute(info) if info else beside, "CameraInfo", is_published=True, owner=owner
        )


def _in_child(sensor: Element, tag: str, name: str) -> str | None:
    """The text of an element in the first child of that tag that has it."""
    return next((text for one in children(sensor, tag) if (text := child_text(one, name))), None)


def _place_of(sensor: Element) -> str | None:
    """The link or joint that has a sensor; None in the `<gazebo>` of a URDF.

    Gazebo may have lumped the link that it refers to into another one.
    """
    for place in sensor.iterancestors():
        if place.tag in ("link", "joint") and place.get("name"):
            return f"{place.tag}/{place.get('name')}"
        if place.tag == "gazebo":
            return None
    return None


def _absolute(topic: str) -> str:
    return topic if topic.startswith("/") else f"/{topic}"


def _filled(default: str, names: dict[str, str | None]) -> str | None:
    used = {key: name for key, name in names.items() if f"{{{key}}}" in default}
    if None in used.values():
        return None
    for key, name in used.items():
        default = default.replace(f"{{{key}}}", name or "")
    return default
