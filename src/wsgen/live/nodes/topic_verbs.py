"""`wsgen topic list`, `type`, `info`, `echo`, `hz` and `pub`, as ros2topic has them.

Texts and choices are those of ros2/ros2cli, ros2topic/verb.
"""

from __future__ import annotations

import math
import time
from copy import copy
from functools import partial
from typing import TYPE_CHECKING, Any

import rclpy
import yaml
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import (
    QoSDurabilityPolicy,
    QoSHistoryPolicy,
    QoSLivelinessPolicy,
    QoSPresetProfiles,
    QoSReliabilityPolicy,
    qos_profile_sensor_data,
)

from rosidl_runtime_py import message_to_csv, message_to_yaml, set_message_fields
from wsgen.live.nodes.graph import (
    Absent,
    Refusal,
    class_of_topic,
    full_name,
    instead,
    message_class,
    topics,
    type_name,
)
from wsgen.live.nodes.messages import Rates, WrongFieldError, fill, one_topic, table
from wsgen.live.nodes.unanswered import SECONDS

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.live.nodes.unanswered import Silence

POLL_SECONDS = 0.1
SECONDS_TO_ARRIVE = 10.0  # of the clock, for the last message, on a busy machine


def list_topics(
    node: Any, *, show_types: bool, count: bool, with_hidden: bool, verbose: bool
) -> None:
    """Print the topics."""
    found = topics(node, with_hidden=with_hidden)
    if count:
        print(len(found))
    elif verbose:
        print(_counted(found, node.count_publishers, "Published", "publisher"))
        print(_counted(found, node.count_subscribers, "Subscribed", "subscriber"))
    else:
        for name, types in found:
            print(f"{name} [{', '.join(types)}]" if show_types else name)


def show_type(node: Any, *, topic: str) -> None:
    """Print the type of a topic."""
    print(*_types(node, topic), sep="\n")


def show_info(node: Any, *, topic: str, verbose: bool) -> None:
    """Print the type of a topic, and who publishes and takes it."""
    types, name = _types(node, topic), full_name(node, topic)
    end = "\n\n" if verbose else "\n"
    print(f"Type: {types[0] if len(types) == 1 else types}", end=end)
    for title, number, endpoints in (
        ("Publisher", node.count_publishers(name), node.get_publishers_info_by_topic),
        ("Subscription", node.count_subscribers(name), node.get_subscriptions_info_by_topic),
    ):
        print(f"{title} count: {number}", end=end)
        for endpoint in endpoints(name) if verbose else ():
            print(endpoint, end=end)


def echo(
    node: Any,
    *,
    topic: str,
    message_type: str | None,
    qos: dict[str, Any],
    field: str | None,
    truncate_length: int | None,
    no_arr: bool,
    no_str: bool,
    flow_style: bool,
    csv: bool,
    raw: bool,
    once: bool,
    timeout: float | None,
    filter_expression: str | None,
    no_lost_messages: bool,
    silence: Silence,
) -> None:
    """Print messages as they come."""
    kind = class_of_topic(node, topic) if message_type is None else message_class(message_type)
    path = [part for part in (field or "").split(".") if part]
    if field is not None and not path:
        raise Refusal(f"Invalid field value '{field}'")
    is_wanted = _filter(filter_expression)
    shown: dict[str, Any] = {"truncate_length": truncate_length, "no_arr": no_arr, "no_str": no_str}
    is_done = has_come = False

    def show(message: Any) -> None:
        nonlocal is_done, has_come
        has_come = True
        part = _part(message, path)
        if is_done or not is_wanted(part):
            return
        is_done = once
        if not hasattr(part, "get_fields_and_field_types"):
            print(part, end="\n---\n", flush=True)
        elif csv:
            print(message_to_csv(part, **shown), flush=True)
        else:
            text = message_to_yaml(part, **shown, flow_style=flow_style)
            print(text, end="---\n", flush=True)

    callbacks = None if no_lost_messages else SubscriptionEventCallbacks(message_lost=_report_lost)
    subscribe = partial(
        node.create_subscription, kind, topic, show, raw=raw, event_callbacks=callbacks
    )
    subscription = _Subscription(node, topic, subscribe, qos)
    begun = time.monotonic()
    end = None if timeout is None else begun + timeout
    says_at = begun + SECONDS
    while rclpy.ok() and not is_done and (end is None or time.monotonic() < end):
        rclpy.spin_once(node, timeout_sec=POLL_SECONDS)
        if not has_come:
            subscription.match()
        if not has_come and time.monotonic() >= says_at:
            says_at = math.inf
            silence.say_nothing_comes(full_name(node, topic), type_name(kind))


def measure(
    node: Any,
    *,
    names: list[str],
    window: int,
    filter_expression: str | None,
    wall_time: bool,
    silence: Silence,
) -> None:
    """Print how often messages come, each second."""
    is_wanted = _filter(filter_expression)
    found = {name: Rates(window) for name in names}
    kinds: dict[str, str] = {}
    heard: set[str] = set()
    for name, rates in found.items():
        kind = _wait_for_class(node, name, silence)
        kinds[name] = type_name(kind)

        def take(message: Any, rates: Rates = rates, name: str = name) -> None:
            heard.add(name)
            if not is_wanted(message):
                return
            now = time.time() if wall_time else node.get_clock().now().nanoseconds * 1e-9
            if not rates.take(now):
                print("time has reset, resetting counters", flush=True)

        node.create_subscription(kind, name, take, qos_profile_sensor_data)
        if len(names) > 1:
            print(f"Subscribed to [{name}]", flush=True)
    shown = time.monotonic()
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=POLL_SECONDS)
        if time.monotonic() >= shown + 1.0:
            shown += 1.0
            _show_rates(found)
            for name in kinds.keys() - heard:
                silence.say_nothing_comes(full_name(node, name), kinds[name])
                heard.add(name)  # it is said once


def publish(
    node: Any,
    *,
    topic: str,
    message_type: str,
    values: str,
    rate: float,
    print_each: int,
    times: int,
    subscriptions: int,
    most_seconds: float | None,
    keep_alive: float,
    qos: dict[str, Any],
    silence: Silence,
) -> None:
    """Publish a message, once or again and again; `times` 0 stands for without end."""
    kind = message_class(message_type)
    name = full_name(node, topic)
    fields = _fields(values)
    message = kind()
    expand = partial(set_message_fields, expand_header_auto=True, expand_time_now=True)
    try:
        stamps = fill(message, fields, expand, message_type)
    except WrongFieldError as error:
        raise Refusal(f"Failed to populate field: {error}") from None
    publisher = node.create_publisher(kind, topic, _profile(qos, "default"))

    def notify() -> None:
        silence.say_nobody_takes(name, message_type)

    _wait_for_subscriptions(publisher, subscriptions, most_seconds, notify)
    print("publisher: beginning loop", flush=True)
    number, due = 0, time.monotonic()
    says_at = due + SECONDS
    while rclpy.ok():
        now = node.get_clock().now().to_msg()
        for stamp in stamps:
            stamp(now)
        number += 1
        if print_each and number % print_each == 0:
            print(f"publishing #{number}: {message!r}\n", flush=True)
        publisher.publish(message)
        if number == times:
            break
        due += 1.0 / rate
        while rclpy.ok() and (rest := due - time.monotonic()) > 0:
            rclpy.spin_once(node, timeout_sec=min(rest, POLL_SECONDS))
        if time.monotonic() >= says_at:
            says_at = math.inf
            if publisher.get_subscription_count() == 0:
                notify()
    _wait_for_acknowledgments(publisher)
    time.sleep(keep_alive)


def _wait_for_acknowledgments(publisher: Any) -> None:
    """Wait until those who take all messages have them.

    Who subscribes may know of this publisher later than it knows of them; what was sent before, it
    sends again, as long as it is there.
    """
    end = time.monotonic() + SECONDS_TO_ARRIVE
    while rclpy.ok() and time.monotonic() < end:
        if publisher.wait_for_all_acked(Duration(seconds=POLL_SECONDS)):
            return


def _counted(
    found: list[tuple[str, list[str]]], count: Callable[[str], int], title: str, word: str
) -> str:
    lines = [f"{title} topics:"]
    for name, types in found:
        number = count(name)
        if number:
            ending = "s" if number > 1 else ""
            lines.append(f" * {name} [{', '.join(types)}] {number} {word}{ending}")
    return "\n".join(lines) + "\n"


def _types(node: Any, topic: str) -> list[str]:
    name, found = full_name(node, topic), dict(topics(node))
    if name not in found:
        raise Absent(
            f"Unknown topic '{topic}'",
            instead(name, [one for one, _ in topics(node, with_hidden=False)], "topic"),
        )
    return found[name]


def _wait_for_class(node: Any, topic: str, silence: Silence) -> Any:
    try:
        return class_of_topic(node, topic)
    except Refusal:
        if full_name(node, topic) in dict(topics(node)):
            raise
    print(f"WARNING: topic [{topic}] does not appear to be published yet", flush=True)
    if silence.is_alone():
        silence.say(silence.nothing_runs())
    else:
        name = full_name(node, topic)
        silence.say(instead(name, [one for one, _ in topics(node, with_hidden=False)], "topic"))
    while full_name(node, topic) not in dict(topics(node)):
        rclpy.spin_once(node, timeout_sec=POLL_SECONDS)
    return class_of_topic(node, topic)


def _show_rates(found: dict[str, Rates]) -> None:
    rows = [(name, row) for name, rates in found.items() if (row := rates.row()) is not None]
    if rows and len(found) == 1:
        print(one_topic(rows[0][1]), flush=True)
    elif rows:
        print(table([(name, *row) for name, row in rows]), flush=True)


def _part(message: Any, path: list[str]) -> Any:
    for index, name in enumerate(path):
        try:
            message = getattr(message, name)
        except AttributeError as error:
            raise Refusal(f"Invalid field '{'.'.join(path[: index + 1])}': {error}") from None
    return message


def _filter(expression: str | None) -> Callable[[Any], Any]:
    """What an expression about `m` says of a message."""
    if expression is None:
        return lambda _message: True
    try:
        code = compile(expression, "--filter", "eval")
    except SyntaxError as error:
        raise Refusal(f"--filter is not a Python expression: {error.msg}") from None

    def is_wanted(m: Any) -> Any:
        try:
            return eval(code, {"m": m})  # noqa: S307  the user's own, about the user's messages
        except Exception as error:  # noqa: BLE001
            raise Refusal(f"--filter: {type(error).__name__}: {error}") from None

    return is_wanted


def _profile(qos: dict[str, Any], default: str) -> Any:
    """The QoS of a preset, and what options change of it."""
    profile = copy(QoSPresetProfiles.get_from_short_key(qos.get("profile") or default))
    for key, policies in (
        ("history", QoSHistoryPolicy),
        ("durability", QoSDurabilityPolicy),
        ("reliability", QoSReliabilityPolicy),
        ("liveliness", QoSLivelinessPolicy),
    ):
        if qos.get(key):
            setattr(profile, key, policies.get_from_short_key(qos[key]))
    if qos.get("lease_seconds") is not None:
        profile.liveliness_lease_duration = Duration(seconds=qos["lease_seconds"])
    if qos.get("depth") is not None:
        profile.depth = qos["depth"]
    elif profile.durability == QoSDurabilityPolicy.TRANSIENT_LOCAL and profile.depth == 0:
        profile.depth = 1
    return profile


class _Subscription:
    """A subscription with the QoS that the user chooses, or that publishers offer.

    These may be found after the topic, to which somebody else has subscribed. What they keep for
    those who come later is sent to one who asks for it alone.
    """

    def __init__(
        self, node: Any, topic: str, subscribe: Callable[..., Any], qos: dict[str, Any]
    ) -> None:
        self._node, self._topic, self._subscribe = node, topic, subscribe
        self._is_chosen = bool(qos)
        self._profile = _profile(qos, "sensor_data") if qos else matching_profile(node, topic)
        self._made = subscribe(qos_profile=self._profile)

    def match(self) -> None:
        """Subscribe anew where publishers that have been found since then offer something else."""
        if self._is_chosen or self._profile == _offered_profile(self._node, self._topic)[0]:
            return
        self._node.destroy_subscription(self._made)
        self._profile = matching_profile(self._node, self._topic)
        self._made = self._subscribe(qos_profile=self._profile)


def matching_profile(node: Any, topic: str) -> Any:
    """A QoS that takes what all publishers of a topic offer; says what not all of them do."""
    profile, mixed = _offered_profile(node, topic)
    for wanted, fallback in mixed:
        print(
            f"Some, but not all, publishers are offering {wanted}. Falling back to {fallback} as "
            "it will connect to all publishers",
            flush=True,
        )
    return profile


def _offered_profile(node: Any, topic: str) -> tuple[Any, list[tuple[str, str]]]:
    """The QoS, and the policies that some offer alone, with those in their place."""
    profile = copy(QoSPresetProfiles.get_from_short_key("sensor_data"))
    mixed = []
    offered = [one.qos_profile for one in node.get_publishers_info_by_topic(full_name(node, topic))]
    for name, policies, wanted, fallback in (
        ("reliability", QoSReliabilityPolicy, "RELIABLE", "BEST_EFFORT"),
        ("durability", QoSDurabilityPolicy, "TRANSIENT_LOCAL", "VOLATILE"),
    ):
        number = sum(getattr(one, name) == getattr(policies, wanted) for one in offered)
        if offered and number == len(offered):
            setattr(profile, name, getattr(policies, wanted))
        elif offered:
            if number:
                kind = policies.__name__
                mixed.append((f"{kind}.{wanted}", f"{kind}.{fallback}"))
            setattr(profile, name, getattr(policies, fallback))
    return profile, mixed


def _report_lost(status: Any) -> None:
    print(
        f"A message was lost!!!\n\ttotal count change:{status.total_count_change}"
        f"\n\ttotal count: {status.total_count}",
        end="---\n",
        flush=True,
    )


def _fields(values: str) -> dict[str, Any]:
    try:
        fields = yaml.safe_load(values)
    except yaml.YAMLError as error:
        raise Refusal(
            f"The values are not YAML: {error}\n"
            "Write them as '{linear: {x: 0.5}}', with a blank after each colon."
        ) from None
    if not isinstance(fields, dict):
        raise Refusal(
            "The passed value needs to be a dictionary in YAML format\n"
            "Write it as '{linear: {x: 0.5}}', with a blank after each colon."
        )
    return fields


def _wait_for_subscriptions(
    publisher: Any, wanted: int, most_seconds: float | None, notify: Callable[[], None]
) -> None:
    start = shown = time.monotonic()
    while rclpy.ok() and (found := publisher.get_subscription_count()) < wanted:
        if time.monotonic() >= shown:
            print(f"Waiting for at least {wanted} matching subscription(s)...", flush=True)
            shown += 1.0
        if time.monotonic() >= start + SECONDS:
            notify()
        if most_seconds is not None and time.monotonic() - start >= most_seconds:
            raise Refusal(
                f"Timed out waiting for subscribers: Expected {wanted} subcribers but only got "
                f"{found} subscribers"
            )
        time.sleep(POLL_SECONDS)
