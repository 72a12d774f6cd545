"""Values in the elements of plugins, as `sdf::Element::Get` reads them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.descriptions.urdf.values import leading_float
from wsgen.gazebo.plugins import PLUGINS, TRUE, Default, GazeboPlugin, stem
from wsgen.live.nodes.simulator.host import CannotWorkError

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.devices import Element

FALSE = ("false", "0")


def facts_of(element: Element) -> GazeboPlugin:
    """What is known of a plugin, by its element."""
    return PLUGINS[stem(element.attributes["filename"])]


def default_of(element: Element, name: str) -> Default:
    """What a parameter of a plugin is that is not written."""
    return facts_of(element).parameters[name]


def topics_of(host: Host, robot: RobotHandle | None, element: Element) -> dict[str, str]:
    """The names of the topics that a plugin has, by what they are for.

    Raises:
        CannotWorkError: A truth value that decides on them is none, or what names one is empty.
    """
    facts = facts_of(element)
    for name in {name for topic in facts.topics.values() for name in topic.deciding}:
        boolean(element, name)
    names = {"model": robot.entity if robot is not None else None, "world": host.world}
    named = {}
    for use, topic, called in facts.topic_names(element.get, names):
        if called is None:
            raise CannotWorkError(f"a parameter in the name of its topic `{topic.name}` is empty.")
        named[use] = called
    return named


def text(element: Element, name: str, robot: RobotHandle) -> str:
    """The text of a parameter."""
    default = str(default_of(element, name))
    return element.get(name) or default.format(model=robot.entity, link=robot.robot.root)


def number(element: Element, path: str, default: float | None = None) -> float:
    """The number at a path; where it is not written, `default`, or that of the plugin.

    Raises:
        CannotWorkError: It is no number.
    """
    written = element.get(path)
    if written:
        return _number(written, path)
    known = default_of(element, path) if default is None else default
    if not isinstance(known, (int, float)):
        raise CannotWorkError(f"it has no <{path}>. Write a number.")
    return known


def numbers(element: Element, path: str) -> list[float]:
    """The numbers of all elements at a path.

    Raises:
        CannotWorkError: One of them is no number.
    """
    return [_number(found.text, path) for found in element.find_all(path)]


def vector(
    element: Element, path: str, default: tuple[float, ...] | None = None
) -> tuple[float, ...]:
    """Numbers with blanks between them, as many as `default` has, or the plugin's default.

    Raises:
        CannotWorkError: They are others.
    """
    if default is None:
        known = default_of(element, path)
        assert isinstance(known, tuple), path  # noqa: S101  a table of wsgen says so
        default = known
    written = element.get(path)
    if not written:
        return default
    found = tuple(_number(word, path) for word in written.split())
    if len(found) != len(default):
        raise CannotWorkError(
            f"its <{path}> is `{written[:60]}`. Write {len(default)} numbers with blanks between "
            "them."
        )
    return found


def boolean(element: Element, path: str, *, default: bool | None = None) -> bool:
    """The truth value at a path; where it is not written, `default`, or that of the plugin.

    Raises:
        CannotWorkError: It is none.
    """
    written = element.get(path).lower()
    if written in TRUE:
        return True
    if written and written not in FALSE:
        raise CannotWorkError(f"its <{path}> is `{written[:60]}`. Write true or false.")
    if written:
        return False
    return bool(default_of(element, path)) if default is None else default


def _number(written: str, path: str) -> float:
    value = leading_float(written)
    if value is None or not math.isfinite(value):
        raise CannotWorkError(f"its <{path}> is `{written[:60]}`. Write a number.")
    return value
