"""The node of a launch service, which has no rclpy: asks other nodes for what a launch file wants.

`python -m wsgen.live.nodes.launch_node`. Requests come by the standard input, and what happens goes
to the standard output, a JSON object a line. The program ends with its input.

A request says what to `do`: `follow` the transitions of a `node`; `change` its state by a
`transition`; `load` a node into a `container`; `drop` the requests to a node that has ended. What
`is` reported: a `transition`; that a state is `changed` or a node is `loaded`, with the `id` of the
request, or why not; that a service is `missing` which has not appeared.

Topic and services are those of rcl_lifecycle and rclcpp_components; the node is called as that of
launch_ros.
"""

from __future__ import annotations

import json
import os
import queue
import sys
import threading
import time
from contextlib import suppress
from dataclasses import field
from typing import TYPE_CHECKING, Any

import rclpy
from lifecycle_msgs.msg import TransitionEvent
from lifecycle_msgs.srv import ChangeState, GetState
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor

from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable

SPIN_SECONDS = 0.05  # of the clock, between two looks at what is waited for
IDLE_SECONDS = 1.0  # the same where nothing is
SECONDS_TO_APPEAR = 10.0  # after which a service is reported as missing
SECONDS_TO_ANSWER = 10.0  # a request that changes nothing
SECONDS_WITHOUT = 2.0  # for the service of such a request to appear, once the other one is there
QUEUE_SIZE = 10  # of transitions, as in launch_ros


class Probe:
    """Asks a node for something that changes nothing, until it answers.

    Its answer shows that the node knows the client, and so all that was announced before the
    client: a node that does not know yet who listens loses its transitions, and its answers. That
    DDS has found the node here says nothing of the other direction.
    """

    def __init__(self, node: Any, kind: Any, service: str) -> None:
        self._node = node
        self._kind = kind
        self._client = node.create_client(kind, service)
        self._since: float | None = None  # when both services were there
        self._futures: list[Any] = []

    def is_over(self, ready_since: float, now: float) -> bool:
        """Whether the node has answered, or nothing more is to be expected."""
        if any(future.done() for future in self._futures):
            return True
        if not self._client.service_is_ready():
            return now - (self._since or ready_since) > SECONDS_WITHOUT
        self._since = self._since or now
        # An answer to a client that the node does not know yet is lost: ask again, less and less.
        if now - self._since >= 2 ** len(self._futures) - 1:
            self._futures.append(self._client.call_async(self._kind.Request()))
        return now - self._since > SECONDS_TO_ANSWER

    def close(self) -> None:
        """Ask no more."""
        self._node.destroy_client(self._client)


@dataclass(kw_only=True)
class Waiting:
    """A request that is not answered yet."""

    request: dict[str, Any]
    node: str
    client: Any
    message: Any
    answer: Callable[[Any], object]
    probe: Probe | None  # until the request is made
    future: Any = None
    since: float = field(default_factory=time.monotonic)
    ready_since: float | None = None
    is_missed: bool = False

    def drop_probe(self) -> None:
        """Ask only for what is wanted."""
        if self.probe is not None:
            self.probe.close()
            self.probe = None


class LaunchNode:
    """Does what the launch service asks for."""

    def __init__(self, requests: int, answers: int) -> None:
        self._answers = answers
        self._requests: queue.SimpleQueue[dict[str, Any] | None] = queue.SimpleQueue()
        self._waiting: list[Waiting] = []
        self._followed: dict[str, Any] = {}  # subscriptions by node
        self._clients: dict[str, Any] = {}  # by service
        self._node = rclpy.create_node(
            f"launch_ros_{os.getppid()}", use_global_arguments=False, start_parameter_services=False
        )
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self._node)
        self._wake = self._node.create_guard_condition(_nothing)
        threading.Thread(target=self._read, args=(requests,), daemon=True).start()

    def run(self) -> None:
        """Serve until the input ends."""
        while rclpy.ok():
            self._executor.spin_once(timeout_sec=SPIN_SECONDS if self._waiting else IDLE_SECONDS)
            with suppress(queue.Empty):
                while True:
                    request = self._requests.get_nowait()
                    if request is None:
                        return
                    self._do(request)
            self._go_on()

    def _go_on(self) -> None:
        """Do what can be done of what is waited for; of a node, in the order of the requests."""
        waiting, self._waiting = self._waiting, []
        held: set[str] = set()  # nodes to which a request is still to be made
        for one in waiting:
            if one.node in held or not self._is_over(one):
                self._waiting.append(one)
                if one.future is None:
                    held.add(one.node)

    def _do(self, request: dict[str, Any]) -> None:
        """Do what is asked for; what cannot be done ends nothing but this request."""
        try:
            getattr(self, f"_{request['do']}")(request)
        except Exception as error:  # noqa: BLE001  rclpy's, which are of many kinds
            self._refuse(request, error)

    def _is_over(self, one: Waiting) -> bool:
        """Whether nothing more is to be done of a request."""
        try:
            return self._is_done(one)
        except Exception as error:  # noqa: BLE001  as above
            one.drop_probe()
            self._refuse(one.request, error)
            return True

    def _refuse(self, request: dict[str, Any], error: Exception) -> None:
        """Answer that a request cannot be done, and why."""
        why = " ".join(str(error).split()) or type(error).__name__
        if request["do"] == "change":
            self._notify("changed", id=request["id"], success=False, error=why)
        elif request["do"] == "load":
            self._notify("loaded", id=request["id"], success=False, name="", error=why)
        else:
            self._notify("unheard", node=request["node"], error=why)

    def _read(self, requests: int) -> None:
        with os.fdopen(requests, "rb") as stream:
            for line in stream:
                self._requests.put(json.loads(line))
                self._wake.trigger()
        self._requests.put(None)
        self._wake.trigger()

    def _notify(self, what: str, **values: object) -> None:
        line = json.dumps({"is": what, **values}).encode() + b"\n"
        while line:
            line = line[os.write(self._answers, line) :]

    # What can be asked for.

    def _follow(self, request: dict[str, Any]) -> None:
        node = request["node"]
        if node in self._followed:
            return

        def take(event: Any) -> None:
            self._notify(
                "transition",
                node=node,
                transition=event.transition.label,
                start=event.start_state.label,
                goal=event.goal_state.label,
                timestamp=event.timestamp,
            )

        self._followed[node] = self._node.create_subscription(
            TransitionEvent, _topic_of(node), take, QUEUE_SIZE
        )

    def _change(self, request: dict[str, Any]) -> None:
        message = ChangeState.Request()
        message.transition.id = request["transition"]
        number, node = request["id"], request["node"]
        self._waiting.append(
            Waiting(
                request=request,
                node=node,
                client=self._client(ChangeState, f"{node}/change_state"),
                probe=Probe(self._node, GetState, f"{node}/get_state"),
                message=message,
                answer=lambda answer: self._notify(
                    "changed", id=number, success=answer.success, error=""
                ),
            )
        )

    def _load(self, request: dict[str, Any]) -> None:
        # A ROS that has containers has it.
        from composition_interfaces.srv import ListNodes, LoadNode  # noqa: PLC0415

        message = LoadNode.Request()
        message.package_name, message.plugin_name = request["package"], request["plugin"]
        message.node_name, message.node_namespace = request["name"], request["namespace"]
        message.remap_rules = request["remappings"]
        message.parameters = _parameters(request["parameters"])
        message.extra_arguments = _parameters(request["extra_arguments"])
        number, node = request["id"], request["container"]
        self._waiting.append(
            Waiting(
                request=request,
                node=node,
                client=self._client(LoadNode, f"{node}/_container/load_node"),
                probe=Probe(self._node, ListNodes, f"{node}/_container/list_nodes"),
                message=message,
                answer=lambda answer: self._notify(
                    "loaded",
                    id=number,
                    success=answer.success,
                    name=answer.full_node_name,
                    error=answer.error_message,
                ),
            )
        )

    def _drop(self, request: dict[str, Any]) -> None:
        for one in self._waiting:
            if one.node == request["node"]:
                one.drop_probe()
        self._waiting = [one for one in self._waiting if one.node != request["node"]]

    # What is waited for.

    def _client(self, kind: Any, service: str) -> Any:
        """That of a service; its probe, which is made after it, is the last to be announced."""
        if service not in self._clients:
            self._clients[service] = self._node.create_client(kind, service)
        return self._clients[service]

    def _is_done(self, one: Waiting) -> bool:
        """Call the service when it is there; whether its answer has come."""
        if one.future is not None:
            if one.future.done():
                one.answer(one.future.result())
                return True
            return False
        now = time.monotonic()
        if one.client.service_is_ready():
            one.ready_since = one.ready_since or now
            if one.probe is None or one.probe.is_over(one.ready_since, now):
                one.drop_probe()
                one.future = one.client.call_async(one.message)
        elif not one.is_missed and now - one.since > SECONDS_TO_APPEAR:
            one.is_missed = True
            kind = f"{one.client.srv_type.__module__.split('.')[0]}/srv/"
            kind += one.client.srv_type.__name__
            others = sorted(
                name
                for name, kinds in self._node.get_service_names_and_types()
                if kind in kinds and name not in self._clients
            )
            self._notify(
                "missing", id=one.request["id"], service=one.client.srv_name, others=others
            )
        return False


def _topic_of(node: str) -> str:
    return f"{node}/transition_event"


def _parameters(values: dict[str, Any]) -> list[Any]:
    return [_parameter(name, value) for name, value in values.items()]


def _parameter(name: str, value: Any) -> Any:
    """The message of a parameter.

    Raises:
        ValueError: It has a value that no parameter can have.
    """
    try:
        made = rclpy.Parameter(name, value=value)
        if made.type_ != rclpy.Parameter.Type.NOT_SET:
            return made.to_parameter_msg()
    except Exception:  # noqa: BLE001, S110  what is out of range fails in the classes of messages
        pass
    raise ValueError(
        f"the parameter `{name}` has the value {json.dumps(value)}; write a bool, a number or a "
        "text, or a list with items of one of these types"
    )


def _nothing() -> None:
    """A guard condition's callback."""


def main() -> int:
    """Serve a launch service; returns the exit code."""
    requests, answers = os.dup(0), os.dup(1)
    os.dup2(2, 1)  # what is printed is no answer
    rclpy.init(args=[])
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        LaunchNode(requests, answers).run()
    rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
