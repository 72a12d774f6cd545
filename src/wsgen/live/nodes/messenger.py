"""The process that publishes, subscribes and calls services for a test, which has no rclpy.

It takes one argument, the number of a socket. By it come requests, a JSON object a line: what to
do, its values, and an `id` that the answer has, too. An answer may come later than that to the next
request. When the socket is closed, the process ends.
"""

from __future__ import annotations

import contextlib
import itertools
import json
import math
import os
import queue
import socket
import sys
import threading
import time
from functools import partial
from typing import TYPE_CHECKING, Any

import rclpy
from rclpy.executors import SingleThreadedExecutor

from rosidl_runtime_py import message_to_ordereddict, set_message_fields
from rosidl_runtime_py.utilities import get_service
from wsgen.live.nodes.graph import (
    Refusal,
    class_of_topic,
    message_class,
    no_such,
    node_names,
    topics,
)
from wsgen.live.nodes.messages import WrongFieldError, fill
from wsgen.live.nodes.simulator.ros import Ros
from wsgen.live.nodes.topic_verbs import matching_profile
from wsgen.live.nodes.unanswered import absent_service
from wsgen.text.suggestions import ask_for_nearest

if TYPE_CHECKING:
    from collections.abc import Callable

    Answer = dict[str, Any]
    Request = dict[str, Any]

SPIN_SECONDS = 0.05  # of the clock, between two looks at what waits


class Subscribed:
    """A topic whose messages are taken."""

    def __init__(self) -> None:
        self.subscription: Any = None
        self.count = 0
        self.last: Any = None

    def take(self, message: Any) -> None:
        """Keep the last message."""
        self.count += 1
        self.last = message


class Messenger:
    """Does what a test asks for."""

    def __init__(self, connection: socket.socket) -> None:
        self._connection = connection
        self._requests: queue.SimpleQueue[Request] = queue.SimpleQueue()
        self._waiting: list[Callable[[], Answer | None]] = []  # that give their answers later
        self._subscribed: dict[str, Subscribed] = {}
        self._publishers: dict[tuple[str, str], Any] = {}
        self._timers: dict[str, tuple[Any, Any]] = {}  # with their nodes, by topic
        self._timers_made = itertools.count()
        self._clients: dict[tuple[str, str], Any] = {}
        self._executor = SingleThreadedExecutor()
        self._node = self._make_node("")
        self._wake = self._node.create_guard_condition(_nothing)

    def run(self) -> None:
        """Answer until the socket is closed."""
        threading.Thread(target=self._read, daemon=True).start()
        while rclpy.ok():
            self._executor.spin_once(timeout_sec=SPIN_SECONDS)
            with contextlib.suppress(queue.Empty):
                while True:
                    self._begin(self._requests.get_nowait())
            self._waiting = [one for one in self._waiting if not self._answered(one)]

    def _make_node(self, purpose: str, *, use_sim_time: bool = False) -> Any:
        node = rclpy.create_node(
            f"_wsgen_test{purpose}_{os.getpid()}",
            start_parameter_services=False,
            parameter_overrides=[rclpy.Parameter("use_sim_time", value=use_sim_time)],
        )
        self._executor.add_node(node)
        return node

    def _read(self) -> None:
        with contextlib.suppress(OSError), self._connection.makefile("rb") as stream:
            for line in stream:
                self._requests.put(json.loads(line))
                self._wake.trigger()
        os._exit(0)  # nobody is there any more

    def _begin(self, request: Request) -> None:
        seconds = float(request.get("seconds", 0.0))
        end = time.monotonic() + (seconds if math.isfinite(seconds) else 0.0)
        verb = getattr(self, f"_{request['do']}")
        state: dict[str, Any] = {}  # of a verb that is asked again until it answers

        def ask() -> Answer | None:
            try:
                answer: Answer | None = verb(request, state, is_late=time.monotonic() >= end)
            except (Refusal, WrongFieldError) as refusal:
                message, _, hint = str(refusal).partition("\n")
                answer = {"error": message, "hint": hint}
            except Exception as error:  # noqa: BLE001  of messages, which check their values
                answer = {"error": f"{type(error).__name__}: {error}", "hint": ""}
            return None if answer is None else {"id": request["id"], **answer}

        self._waiting.append(ask)

    def _answered(self, ask: Callable[[], Answer | None]) -> bool:
        answer = ask()
        if answer is None:
            return False
        with contextlib.suppress(OSError):
            self._connection.sendall(json.dumps(answer, default=_plain).encode() + b"\n")
        return True

    # What can be asked for: each gives its answer, or None to be asked again.

    def _nodes(self, _request: Request, _state: dict[str, Any], *, is_late: bool) -> Answer:
        del is_late
        return {"nodes": node_names(self._node, with_hidden=True)}

    def _subscribe(
        self, request: Request, _state: dict[str, Any], *, is_late: bool
    ) -> Answer | None:
        """Take the messages of a topic from now on, as soon as somebody publishes on it."""
        topic = request["topic"]
        one = self._subscribed.setdefault(topic, Subscribed())
        if self._node.count_publishers(topic) == 0:
            known = [name for name, _ in topics(self._node, with_hidden=False)]
            return {"is_there": False, "hint": ask_for_nearest(topic, known)} if is_late else None
        if one.subscription is None:
            kind = class_of_topic(self._node, topic)
            profile = matching_profile(self._node, topic)
            one.subscription = self._node.create_subscription(kind, topic, one.take, profile)
        # No simulated time passes meanwhile: what is published in it would be lost.
        if one.subscription.get_publisher_count() == 0 and not is_late:
            return None
        return {"is_there": True}

    def _message(self, request: Request, _state: dict[str, Any], *, is_late: bool) -> Answer | None:
        """Give the last message of a topic, if one has come."""
        one = self._subscribed[request["topic"]]
        if one.count == 0 and not is_late:
            return None
        last = None if one.last is None else message_to_ordereddict(one.last)
        return {"count": one.count, "message": last}

    def _publish(self, request: Request, _state: dict[str, Any], *, is_late: bool) -> Answer | None:
        """Publish a message when somebody takes it; with a rate, again and again."""
        topic, kind = request["topic"], message_class(request["type"])
        message = kind()
        expand = partial(set_message_fields, expand_header_auto=True, expand_time_now=True)
        stamps = fill(message, request["values"], expand, request["type"])
        publisher = self._publishers.get((topic, request["type"]))
        if publisher is None:
            self._forget(self._publishers, topic, self._node.destroy_publisher)
            publisher = self._node.create_publisher(kind, topic, 10)
            self._publishers[topic, request["type"]] = publisher
        if publisher.get_subscription_count() == 0:
            return self._nobody(request) if is_late else None
        self._end_timer(topic)
        for stamp in stamps:
            stamp(Ros.time(request["now"]))
        publisher.publish(message)
        if request["rate"] is not None:
            self._repeat(topic, publisher, message, stamps, 1.0 / request["rate"])
        return {"subscribers": publisher.get_subscription_count()}

    def _nobody(self, request: Request) -> Answer:
        found = self._node.get_subscriptions_info_by_topic(request["topic"])
        others = sorted({one.topic_type for one in found} - {request["type"]})
        known = [
            name
            for name, _ in topics(self._node, with_hidden=False)
            if self._node.count_subscribers(name)
        ]
        hint = (
            f"Write the type that its subscriptions have: {', '.join(others)}."
            if others
            else f"{ask_for_nearest(request['topic'], known)}Use a topic with subscriptions: "
            f"{', '.join(known) or 'none has any'}."
        )
        return {"error": f"No node takes {request['type']} from {request['topic']}.", "hint": hint}

    def _repeat(self, topic: str, publisher: Any, message: Any, stamps: Any, period: float) -> None:
        """Publish a message again and again, in simulated time."""
        node = self._make_node(f"_{next(self._timers_made)}_timer", use_sim_time=True)

        def publish() -> None:
            now = node.get_clock().now().to_msg()
            for stamp in stamps:
                stamp(now)
            publisher.publish(message)

        self._timers[topic] = (node, node.create_timer(period, publish))

    def _end_timer(self, topic: str) -> None:
        node, timer = self._timers.pop(topic, (None, None))
        if node is not None:
            timer.cancel()
            self._executor.remove_node(node)
            node.destroy_node()

    def _call(self, request: Request, state: dict[str, Any], *, is_late: bool) -> Answer | None:
        """Call a service, and give its answer."""
        name, type_name = request["service"], request["type"]
        if "future" in state:
            future = state["future"]
            if future.done():
                return {"response": message_to_ordereddict(future.result())}
            if not is_late:
                return None
            text = f"The service {name} has not answered."
            return {"error": text, "hint": "Look at what its node prints."}
        client = self._clients.get((name, type_name))
        if client is None:
            self._forget(self._clients, name, self._node.destroy_client)
            client = self._node.create_client(_service_class(type_name), name)
            self._clients[name, type_name] = client
        if client.service_is_ready():
            message = client.srv_type.Request()
            fill(message, request["values"], set_message_fields, type_name)
            state["future"] = client.call_async(message)
            return None
        if not is_late:
            return None
        message, hint = absent_service(name, type_name, self._offered())
        return {"error": message, "hint": hint}

    def _forget(
        self, made: dict[tuple[str, str], Any], name: str, destroy: Callable[[Any], object]
    ) -> None:
        """Destroy what has a name and another type: a process has one type for a name."""
        for key in [key for key in made if key[0] == name]:
            if made is self._publishers:
                self._end_timer(name)
            destroy(made.pop(key))

    def _offered(self) -> dict[str, list[str]]:
        """The services that nodes offer, with their types; a client of one makes a name, too."""
        found: dict[str, list[str]] = {}
        for node, namespace in self._node.get_node_names_and_namespaces():
            with contextlib.suppress(RuntimeError):  # it has just ended
                of_node = self._node.get_service_names_and_types_by_node(node, namespace)
                found.update((name, list(types)) for name, types in of_node)
        return found


def _service_class(name: str) -> Any:
    try:
        return get_service(name)
    except AttributeError:
        hint = no_such(name, "srv", "service")
    except (ModuleNotFoundError, ValueError):
        hint = "Write it as PACKAGE/srv/NAME, for example std_srvs/srv/Empty."
    raise Refusal(f"The service type '{name}' is unknown.\n{hint}")


def _plain(value: Any) -> Any:
    """What JSON has in the place of a value that it has not."""
    if isinstance(value, (bytes, bytearray)):
        return list(value)
    return value.tolist() if hasattr(value, "tolist") else str(value)


def _nothing() -> None:
    """A guard condition's callback."""


def main(arguments: list[str]) -> int:
    """Serve a test; returns the exit code."""
    connection = socket.socket(fileno=int(arguments[1]))
    rclpy.init(args=[])
    try:
        Messenger(connection).run()
    except KeyboardInterrupt:
        return 0
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv))
