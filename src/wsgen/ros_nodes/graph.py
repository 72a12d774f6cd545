"""The nodes and topics that a node sees: wait for them, find one, say what is there instead."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import rclpy

from rosidl_runtime_py.utilities import get_message
from wsgen.suggestions import nearest

if TYPE_CHECKING:
    from collections.abc import Iterable

STEP_SECONDS = 0.05
PATIENCE_SECONDS = 3.0


class Refusal(Exception):  # noqa: N818  no error of the program
    """What was asked for is not there; the message is for the user."""


class MissingMessages(Refusal):
    """A package of messages is not there."""

    def __init__(self, text: str, package: str) -> None:
        super().__init__(text)
        self.package = package


def discover(
    node: Any, seconds: float, *, topic: str | None = None, node_name: str | None = None
) -> None:
    """Wait until other nodes have been found: none has come for so long.

    A topic or node that is asked for is waited for longer, because machines are busy when a launch
    file starts.
    """
    start = changed = time.monotonic()
    seen = None
    while rclpy.ok():
        now = time.monotonic()
        found = (_node_names(node), tuple(name for name, _ in topics(node)))
        if found != seen:
            changed, seen = now, found
        is_quiet = now >= changed + seconds
        is_there = _is_there(topic, found[1]) and _is_there(node_name, found[0])
        if (is_quiet and (is_there or not seconds)) or now >= start + PATIENCE_SECONDS + seconds:
            return
        rclpy.spin_once(node, timeout_sec=STEP_SECONDS)


def _is_there(name: str | None, names: tuple[str, ...]) -> bool:
    return name is None or f"/{name.removeprefix('/')}" in names


def _node_names(node: Any) -> tuple[str, ...]:
    found = node.get_node_names_and_namespaces()
    return tuple(sorted(f"{space.rstrip('/')}/{name}" for name, space in found))


def node_names(node: Any, *, with_hidden: bool) -> list[str]:
    """The full names of the nodes, sorted."""
    return [name for name in _node_names(node) if with_hidden or not is_hidden(name)]


def is_hidden(name: str) -> bool:
    """Whether a part of a name begins with an underscore."""
    return any(part.startswith("_") for part in name.split("/"))


def topics(node: Any, *, with_hidden: bool = True) -> list[tuple[str, list[str]]]:
    """The topics with their types, by name."""
    found = sorted(node.get_topic_names_and_types())
    return [(name, types) for name, types in found if with_hidden or not is_hidden(name)]


def full_name(node: Any, topic: str) -> str:
    """The whole name of a topic.

    Raises:
        Refusal: It cannot be a name.
    """
    try:
        return str(node.resolve_topic_name(topic))
    except (ValueError, rclpy.exceptions.NameValidationException) as error:
        raise Refusal(str(error)) from None


def message_class(name: str) -> Any:
    """The class of messages of a type.

    Raises:
        Refusal: There is none.
    """
    try:
        return get_message(name)
    except ModuleNotFoundError:
        package = name.partition("/")[0]
        raise MissingMessages(
            f"The message type '{name}' is invalid\nThe package `{package}` is not built here: "
            "build it with wsgen build, and start wsgen in its workspace.",
            package,
        ) from None
    except ValueError:
        hint = "Write it as PACKAGE/msg/NAME, for example geometry_msgs/msg/Twist."
    except AttributeError:
        hint = f"The package `{name.partition('/')[0]}` has no such message."
    raise Refusal(f"The message type '{name}' is invalid\n{hint}")


def class_of_topic(node: Any, topic: str) -> Any:
    """The class of the messages of a topic that somebody publishes or takes.

    Raises:
        Refusal: The topic is not there, or has several types.
    """
    name = full_name(node, topic)
    types = dict(topics(node)).get(name)
    if types is None:
        raise Refusal(
            f"WARNING: topic [{topic}] does not appear to be published yet\n"
            "Could not determine the type for the passed topic\n"
            + instead(name, [one for one, _ in topics(node, with_hidden=False)], "topic")
        )
    if len(types) > 1:
        raise Refusal(
            f"Cannot echo topic '{topic}', as it contains more than one type: [{', '.join(types)}]"
        )
    return message_class(types[0])


def instead(name: str, names: Iterable[str], kind: str) -> str:
    """What to do where a name is not there."""
    others = list(names)
    near = nearest(name, others)
    if near:
        return f"Did you mean {near}?"
    return (
        f"wsgen {kind} list shows what is there. Nodes are found if they have the same "
        "ROS_DOMAIN_ID and ROS_AUTOMATIC_DISCOVERY_RANGE; start a launch file with "
        "wsgen launch PACKAGE FILE --run."
    )
