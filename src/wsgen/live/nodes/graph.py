"""The nodes and topics that a node sees: wait for them, find one, say what is there instead."""

from __future__ import annotations

import importlib
import os
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import rclpy

from rosidl_runtime_py.utilities import get_message
from wsgen.live.nodes.unanswered import SECONDS
from wsgen.ros.environment.interfaces import buildable
from wsgen.text.suggestions import did_you_mean, misspelled_as, nearest

if TYPE_CHECKING:
    from collections.abc import Iterable

    from wsgen.live.nodes.unanswered import Silence

STEP_SECONDS = 0.05
PATIENCE_SECONDS = 3.0
PREFIXES = "AMENT_PREFIX_PATH"


class Refusal(Exception):  # noqa: N818  no error of the program
    """What was asked for is not there; the message is for the user."""


class Absent(Refusal):
    """A topic or node is not there; the hint is for where others are."""

    def __init__(self, text: str, hint: str) -> None:
        super().__init__(f"{text}\n{hint}")
        self.text = text


class MissingMessages(Refusal):
    """A package of messages is not there."""

    def __init__(self, text: str, package: str) -> None:
        super().__init__(text)
        self.package = package


def discover(
    node: Any,
    seconds: float,
    *,
    topic: str | None = None,
    node_name: str | None = None,
    silence: Silence,
) -> None:
    """Wait until other nodes have been found: none has come for so long.

    A topic or node that is asked for is waited for longer, because machines are busy when a launch
    file starts; so are its publishers and subscriptions, which are found one by one, and the nodes
    of a run that has just been started. `silence` says what is waited for, if that takes long.
    """
    what = f"the topic {topic}" if topic else f"the node {node_name}" if node_name else None
    start = changed = time.monotonic()
    seen = None
    while rclpy.ok():
        now = time.monotonic()
        found = (_node_names(node), tuple(name for name, _ in topics(node)))
        of_it = (found, _endpoints(node, topic, node_name))
        if of_it != seen:
            changed, seen = now, of_it
        is_quiet = now >= changed + seconds
        is_there = _is_there(topic, found[1]) and _is_there(node_name, found[0])
        is_over = now >= start + PATIENCE_SECONDS + seconds
        expects = bool(seconds) and silence.expects_nodes()
        if not expects and (is_over or (is_quiet and (is_there or not seconds))):
            return
        if seconds and now >= start + SECONDS:
            silence.waits(None if is_there else what)
        rclpy.spin_once(node, timeout_sec=STEP_SECONDS)


def _endpoints(node: Any, topic: str | None, node_name: str | None) -> tuple[int, ...]:
    """How many publishers, subscriptions and services a topic, or a node, is known to have."""
    if topic is not None and (name := _from_root(topic)) in dict(topics(node)):
        return node.count_publishers(name), node.count_subscribers(name)
    if node_name is not None and (name := _from_root(node_name)) in _node_names(node):
        space, _, last = name.rpartition("/")
        with suppress(RuntimeError):  # it has just ended
            return (
                len(node.get_publisher_names_and_types_by_node(last, space or "/")),
                len(node.get_subscriber_names_and_types_by_node(last, space or "/")),
                len(node.get_service_names_and_types_by_node(last, space or "/")),
            )
    return ()


def _from_root(name: str) -> str:
    return f"/{name.removeprefix('/')}"


def _is_there(name: str | None, names: tuple[str, ...]) -> bool:
    return name is None or _from_root(name) in names


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
    except BAD_NAMES as error:
        raise Refusal(_without_place(error)) from None


def make_node(name: str, **options: Any) -> Any:
    """Make the node that asks.

    Raises:
        Refusal: It cannot have the name.
    """
    try:
        return rclpy.create_node(name, **options)
    except BAD_NAMES as error:
        raise Refusal(_without_place(error)) from None


# What rclpy raises at names that none can be; the error of its C library is a RuntimeError.
BAD_NAMES = (ValueError, RuntimeError, rclpy.exceptions.NameValidationException)


def _without_place(error: Exception) -> str:
    """What an error says, without the place in the source of the C library."""
    return str(error).partition(", at /")[0]


def message_class(name: str) -> Any:
    """The class of messages of a type.

    Raises:
        Refusal: There is none.
    """
    try:
        return get_message(name)
    except ModuleNotFoundError:
        hint = _absent_package(name)
        package = name.partition("/")[0]
        raise MissingMessages(f"The message type '{name}' is invalid\n{hint}", package) from None
    except ValueError:
        hint = "Write it as PACKAGE/msg/NAME, for example geometry_msgs/msg/Twist."
    except AttributeError:
        hint = no_such(name, "msg", "message")
    raise Refusal(f"The message type '{name}' is invalid\n{hint}")


def _absent_package(name: str) -> str:
    """The hint where the package of a type is not there: which one may be meant."""
    package, *_, last = name.split("/")
    known = packages_of_interfaces()
    if package in known:  # what is between is wrong: `geometry_msgs/msgs/Twist`
        return did_you_mean(f"{package}/msg/{last}")
    build = "build it with wsgen build, and start wsgen in its workspace."
    meant = misspelled_as(package, known)
    if meant is None:
        return f"The package `{package}` is not built here: {build}"
    question = did_you_mean(f"{meant}/msg/{last}")
    return f"No package `{package}` is here. {question} If not, {build}"


def packages_of_interfaces() -> frozenset[str]:
    """The packages of messages, services and actions that are installed, or can be built."""
    index = "share/ament_index/resource_index/rosidl_interfaces"
    folders = (Path(one, index) for one in os.environ.get(PREFIXES, "").split(os.pathsep) if one)
    installed: set[str] = set()
    for folder in folders:
        with suppress(OSError):  # it is not there, or nobody may read it
            installed |= set(os.listdir(folder))  # noqa: PTH208  names are wanted
    return frozenset({*installed, *buildable()})


def no_such(name: str, kind: str, word: str) -> str:
    """The hint where a package has no interface of a name: which one may be meant.

    Args:
        name: `package/kind/Name`, or `package/Name`.
        kind: `msg` or `srv`.
        word: What interfaces of the kind are called.
    """
    package, *_, last = name.split("/")
    module = importlib.import_module(f"{package}.{kind}")
    known = (one for one in dir(module) if isinstance(getattr(module, one), type))
    near = nearest(last, known)
    meant = f" {did_you_mean(f'{package}/{kind}/{near}')}" if near else ""
    return f"The package `{package}` has no such {word}.{meant}"


def type_name(kind: Any) -> str:
    """The name of a class of messages, as ROS writes it."""
    return f"{kind.__module__.partition('.')[0]}/msg/{kind.__name__}"


def class_of_topic(node: Any, topic: str) -> Any:
    """The class of the messages of a topic that somebody publishes or takes.

    Raises:
        Refusal: The topic is not there, or has several types.
    """
    name = full_name(node, topic)
    types = dict(topics(node)).get(name)
    if types is None:
        raise Absent(
            f"WARNING: topic [{topic}] does not appear to be published yet\n"
            "Could not determine the type for the passed topic",
            instead(name, [one for one, _ in topics(node, with_hidden=False)], "topic"),
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
        "ROS_DOMAIN_ID and ROS_AUTOMATIC_DISCOVERY_RANGE."
    )
