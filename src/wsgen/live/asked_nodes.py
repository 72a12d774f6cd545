"""What a launch file asks of nodes that run: transitions of lifecycle nodes, nodes for containers.

What is said and when is that of launch_ros: `actions/lifecycle_node.py` and
`actions/load_composable_nodes.py`. A process that has rclpy asks: the node of the launch service,
started when it is needed.
"""

from __future__ import annotations

import json
import logging
import os
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from wsgen.text.values import dataclass

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Callable, Mapping, Sequence

    from wsgen.live.forked_nodes import ForkedNode
    from wsgen.model.plan import Process


# By their numbers in lifecycle_msgs/msg/Transition.
TRANSITIONS = (
    *("TRANSITION_CREATE", "TRANSITION_CONFIGURE", "TRANSITION_CLEANUP", "TRANSITION_ACTIVATE"),
    *("TRANSITION_DEACTIVATE", "TRANSITION_UNCONFIGURED_SHUTDOWN"),
    *("TRANSITION_INACTIVE_SHUTDOWN", "TRANSITION_ACTIVE_SHUTDOWN", "TRANSITION_DESTROY"),
)
LIFECYCLE = "launch_ros.actions.lifecycle_node"  # the logger
MANAGER = ("nav2_lifecycle_manager", "lifecycle_manager")


@dataclass(frozen=True, kw_only=True)
class Request:
    """What is asked of a node, and not answered yet."""

    node: str  # its full name
    what: str  # for users
    logger: str
    transition: int | None = None


class AskedNodes:
    """Asks nodes, and lets what they answer happen in the launch.

    Args:
        begin: Starts the process that asks; OSError where it cannot.
        post: Lets an event happen.
        leave_out: Names what cannot be done, and why.
    """

    def __init__(
        self,
        begin: Callable[[], LaunchNode],
        post: Callable[[Any], None],
        leave_out: Callable[[str, str], None],
    ) -> None:
        self.node: LaunchNode | None = None
        self._begin = begin
        self._post = post
        self._leave_out = leave_out
        self._followed: dict[str, list[Any]] = {}  # actions, by node
        self._not_started: set[int] = set()  # actions whose programs are left out
        self._requests: dict[int, Request] = {}
        self._count = 0

    def follow(self, action: Any) -> None:
        """Let the transitions of a lifecycle node be events of the launch."""
        if id(action) in self._not_started:
            return
        name = action.node_name
        actions = self._followed.setdefault(name, [])
        if action not in actions:
            actions.append(action)
        self._send("follow", node=name)

    def change_state(self, action: Any, transition: int) -> None:
        """Ask a lifecycle node for a transition."""
        name = action.node_name
        label = TRANSITIONS[transition] if 0 <= transition < len(TRANSITIONS) else str(transition)
        if id(action) in self._not_started:
            why = "its program does not run; what waits for its states does not happen"
            self._leave_out(f"{label} for the lifecycle node {name}", why)
            return
        number = self._remember(node=name, what=label, logger=LIFECYCLE, transition=transition)
        self._send("change", id=number, node=name, transition=transition)

    def load(self, process: Process, extra_arguments: Mapping[str, Any]) -> None:
        """Ask a container to load a node."""
        container = "/" + (process.container or "").lstrip("/")
        plugin = process.executable or ""
        number = self._remember(
            node=container, what=plugin, logger="launch_ros.actions.load_composable_nodes"
        )
        self._send(
            "load",
            id=number,
            container=container,
            package=process.package,
            plugin=plugin,
            name=process.name or "",
            namespace=process.namespace,
            remappings=[f"{source}:={target}" for source, target in process.remappings],
            parameters=dict(process.parameters),
            extra_arguments=dict(extra_arguments),
        )

    def note_not_started(self, action: Any) -> None:
        """The program of an action is left out."""
        self._not_started.add(id(action))

    def note_ended(self, node: str | None) -> None:
        """A node has ended: what it was asked for does not happen."""
        found = [number for number, one in self._requests.items() if one.node == node]
        for number in found:
            one = self._requests.pop(number)
            logging.getLogger(one.logger).error("%s", f"{node} has ended before {one.what}")
        if found:
            self._send("drop", node=node)

    def give_up(self) -> None:
        """The launch ends: nobody waits any more."""
        for one in self._requests.values():
            text = f"Abandoning wait for {one.what} of {one.node}, due to shutdown."
            logging.getLogger(one.logger).warning("%s", text)
            self._send("drop", node=one.node)
        self._requests.clear()

    def take(self) -> bool:
        """Take what has happened; False: the process that asks has ended."""
        reported = self.node.take() if self.node is not None else None
        if reported is None:
            self._lose()
            return False
        for one in reported:
            getattr(self, f"_take_{one['is']}")(one)
        return True

    def close(self) -> None:
        """End the process that asks."""
        if self.node is not None:
            self.node.close()
            self.node = None

    def _remember(self, **values: Any) -> int:
        self._count += 1
        self._requests[self._count] = Request(**values)
        return self._count

    def _send(self, do: str, **values: object) -> None:
        if self.node is None:
            try:
                self.node = self._begin()
            except OSError as error:
                self._lose(f"cannot be started: {error.strerror or error}")
                return
            # One that has ended does not hear any more what it followed.
            for name in self._followed:
                if (do, values.get("node")) != ("follow", name):
                    self.node.send("follow", node=name)
        self.node.send(do, **values)

    def _lose(self, why: str = "has ended") -> None:
        """Say of all requests that they are not done, since the process that asks is not there."""
        if not self._requests:
            text = f"the process that asks nodes {why}; the next request starts another one"
            if self._followed:
                names = ", ".join(self._followed)
                text += f". Until then, the launch does not hear of transitions of {names}"
            logging.getLogger(LIFECYCLE).error("%s", text)
        for one in self._requests.values():
            text = f"{one.what} of {one.node} is not done: the process that asks nodes {why}"
            logging.getLogger(one.logger).error("%s", text)
        self._requests.clear()
        self.close()

    def _take_transition(self, reported: Mapping[str, Any]) -> None:
        from launch_ros._events import StateTransition  # noqa: PLC0415  the shim's

        for action in self._followed.get(reported["node"], ()):
            self._post(
                StateTransition(
                    action=action,
                    transition=reported["transition"],
                    start_state=reported["start"],
                    goal_state=reported["goal"],
                    timestamp=reported["timestamp"],
                )
            )

    def _take_changed(self, reported: Mapping[str, Any]) -> None:
        one = self._requests.pop(reported["id"], None)
        if one is not None and not reported["success"]:
            why = f": {reported['error']}" if reported["error"] else ""
            logging.getLogger(one.logger).error(
                "%s", f"Failed to make transition '{one.what}' for LifecycleNode '{one.node}'{why}"
            )

    def _take_loaded(self, reported: Mapping[str, Any]) -> None:
        one = self._requests.pop(reported["id"], None)
        if one is None:
            return
        logger = logging.getLogger(one.logger)
        if reported["success"]:
            logger.info("%s", f"Loaded node '{reported['name']}' in container '{one.node}'")
        else:
            logger.error(
                "%s",
                f"Failed to load node of type '{one.what}' in container '{one.node}': "
                f"{reported['error']}",
            )

    def _take_unheard(self, reported: Mapping[str, Any]) -> None:
        text = f"the transitions of {reported['node']} are not heard: {reported['error']}"
        logging.getLogger(LIFECYCLE).error("%s", text)

    def _take_missing(self, reported: Mapping[str, Any]) -> None:
        one = self._requests.get(reported["id"])
        if one is None:
            return
        others = reported["others"]
        there = f"; services of its type: {', '.join(others)}" if others else ""
        what = "lifecycle node" if one.transition is not None else "container"
        logging.getLogger(one.logger).warning(
            "%s",
            f"{one.what} waits for the service {reported['service']}, which does not appear: check "
            f"that {one.node} is a {what} and has this name{there}",
        )


def managed_by(process: Process) -> str:
    """What to say of a lifecycle manager of Nav2 that does not run; nothing of other programs."""
    names = process.parameters.get("node_names")
    if (process.package, process.executable) != MANAGER or not isinstance(names, (list, tuple)):
        return ""
    return f"; nothing configures and activates {', '.join(map(str, names))}" if names else ""


LAUNCH_NODE = "wsgen.live.nodes.launch_node"  # says what is asked for, and how
STDERR = 2
LARGEST = 1 << 16  # bytes that are read at once


class LaunchNode:
    """The process.

    Args:
        begin: Starts it; is given descriptors for its output and its errors.

    Raises:
        OSError: It cannot be started.
    """

    def __init__(
        self, begin: Callable[[Sequence[int]], subprocess.Popen[bytes] | ForkedNode]
    ) -> None:
        self.descriptor, theirs = os.pipe()
        try:
            self._process = begin((theirs, STDERR))
        except OSError:
            os.close(self.descriptor)
            raise
        finally:
            os.close(theirs)
        self._rest = b""

    def send(self, do: str, **values: object) -> None:
        """Ask for something."""
        line = json.dumps({"do": do, **values}).encode() + b"\n"
        assert self._process.stdin is not None  # noqa: S101  it is started with one
        with suppress(OSError):  # it has ended, which `take` says
            self._process.stdin.write(line)
            self._process.stdin.flush()

    def take(self) -> list[dict[str, Any]] | None:
        """What has happened; None when the process has ended."""
        data = os.read(self.descriptor, LARGEST)
        if not data:
            return None
        *lines, self._rest = (self._rest + data).split(b"\n")
        return [json.loads(line) for line in lines]

    def close(self) -> None:
        """Have it end."""
        with suppress(OSError):
            if self._process.stdin is not None:
                self._process.stdin.close()
        os.close(self.descriptor)
        self._process.poll()
