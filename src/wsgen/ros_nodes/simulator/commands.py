"""The simulator's socket: what spawners and bridges of the launch file ask for.

A request is a JSON object on a line, and so is its answer: `{"ok": true, …}`, or `{"error": …,
"hint": …}`. Connections are read in threads; what they ask for is done between two steps.
"""

from __future__ import annotations

import contextlib
import json
import queue
import socket
import threading
from typing import TYPE_CHECKING, Any

from wsgen.ros_nodes.simulator.names import BadNameError
from wsgen.ros_nodes.simulator.services import SERVICE, GzServices
from wsgen.ros_nodes.simulator.simulation import RefusedError
from wsgen.ros_nodes.simulator.topics import Rule, problem_of
from wsgen.simulation.live_scene import short_name, socket_path

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from wsgen.ros_nodes.simulator.simulation import LiveSimulation
    from wsgen.ros_nodes.simulator.topics import Bridge

DIRECTIONS = ("both", "to_ros", "to_gz", SERVICE)

RENAME = (
    "Names in ROS have letters, digits and `_`. Give the topic another name in ROS: with "
    "ros_topic_name in a YAML file of the bridge (config_file)."
)


class _Connection:
    """A client, and what ends with it."""

    def __init__(self) -> None:
        self.bridges: list[Bridge] = []


class CommandServer:
    """Listens, and answers when it is told to."""

    def __init__(self, folder: Path, simulation: LiveSimulation) -> None:
        """Listen from now on."""
        self._simulation = simulation
        self._services = GzServices(simulation)
        self._waiting: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._path = socket_path(folder)
        with contextlib.suppress(FileNotFoundError):
            self._path.unlink()
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        with short_name(self._path) as name:
            self._socket.bind(name)
        self._socket.listen()
        threading.Thread(target=self._accept, daemon=True).start()

    def answer(self) -> bool:
        """Do what was asked for; gives whether there was anything."""
        is_asked = not self._waiting.empty()
        with contextlib.suppress(queue.Empty):
            while True:
                self._waiting.get_nowait()()
        return is_asked

    def close(self) -> None:
        """Stop listening."""
        with contextlib.suppress(OSError):
            self._socket.close()
        with contextlib.suppress(FileNotFoundError):
            self._path.unlink()

    def _accept(self) -> None:
        with contextlib.suppress(OSError):  # the socket is closed
            while True:
                client, _ = self._socket.accept()
                threading.Thread(target=self._serve, args=(client,), daemon=True).start()

    def _serve(self, client: socket.socket) -> None:
        connection = _Connection()
        with contextlib.suppress(OSError), client, client.makefile("rwb") as stream:
            for line in stream:
                answers: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()

                def work(
                    line: bytes = line, answers: queue.SimpleQueue[dict[str, Any]] = answers
                ) -> None:
                    answers.put(self._do(line, connection))

                self._waiting.put(work)
                stream.write(json.dumps(answers.get()).encode() + b"\n")
                stream.flush()
        self._waiting.put(lambda: self._end(connection))

    def _end(self, connection: _Connection) -> None:
        for bridge in connection.bridges:
            self._simulation.host.gz.close(bridge)

    def _do(self, line: bytes, connection: _Connection) -> dict[str, Any]:
        try:
            request = json.loads(line)
        except ValueError:
            request = None
        if not isinstance(request, dict):
            return _error(
                "The simulator does not understand the request: it is no JSON object.",
                'Send one like {"do": "state"} a line.',
            )
        known = {
            "spawn": self._spawn,
            "delete": self._delete,
            "bridge": self._bridge,
            "pause": self._pause,
            "unpause": self._unpause,
            "state": self._state,
        }
        command = str(request.get("do"))
        if command not in known:
            return _error(
                f"The simulator has no command `{command}`.", f"Commands: {', '.join(known)}."
            )
        try:
            return {"ok": True, **known[command](request, connection)}
        except RefusedError as error:
            return _error(error.message, error.hint)

    def _spawn(self, request: dict[str, Any], _: _Connection) -> dict[str, Any]:
        self._simulation.spawn(str(request.get("entity", "")))
        return {}

    def _delete(self, request: dict[str, Any], _: _Connection) -> dict[str, Any]:
        self._simulation.delete(str(request.get("entity", "")))
        return {}

    def _pause(self, _: dict[str, Any], __: _Connection) -> dict[str, Any]:
        self._simulation.control.is_paused = True
        return {}

    def _unpause(self, _: dict[str, Any], __: _Connection) -> dict[str, Any]:
        self._simulation.control.is_paused = False
        return {}

    def _bridge(self, request: dict[str, Any], connection: _Connection) -> dict[str, Any]:
        """Connect topics; the answer has what is wrong with each rule, null where nothing is."""
        host = self._simulation.host
        rules = [_rule(given) for given in request.get("rules", ())]
        problems = [
            self._services.problem_of(rule) if rule.direction == SERVICE else problem_of(rule)
            for rule in rules
        ]
        try:
            node = host.ros.node(
                str(request.get("node", "ros_gz_bridge")),
                str(request.get("namespace", "")),
                [str(one) for one in request.get("arguments", ())],
            )
        except BadNameError as error:
            raise RefusedError(
                str(error), "Correct the name, remappings and parameters of the bridge's node."
            ) from error
        bridge = host.gz.open(node, [])
        connection.bridges.append(bridge)
        for index, rule in enumerate(rules):
            if problems[index] is not None:
                continue
            try:
                if rule.direction == SERVICE:
                    self._services.offer(rule, node)
                else:
                    host.gz.connect(bridge, rule)
            except BadNameError as error:
                problems[index] = f"{error} {RENAME}"
        return {"problems": problems}

    def _state(self, _: dict[str, Any], __: _Connection) -> dict[str, Any]:
        simulation, host = self._simulation, self._simulation.host
        return {
            "seconds": simulation.now,
            "world": host.world,
            "simulator": host.simulator,
            "is_paused": simulation.control.is_paused,
            "entities": list(host.robots),
            # m, and a unit quaternion x, y, z, w: the root links' frames in the world
            "poses": {
                entity: [*robot.state().xyz, *robot.state().xyzw]
                for entity, robot in host.robots.items()
            },
            "gz_topics": sorted(host.gz.names),
        }


def _error(message: str, hint: str) -> dict[str, Any]:
    return {"error": message, "hint": hint}


def _rule(given: Any) -> Rule:
    """The rule that a request has.

    Raises:
        RefusedError: It is none.
    """
    fields = ("ros_topic", "gz_topic", "ros_type", "gz_type", "direction")
    values = [given.get(name) for name in fields] if isinstance(given, dict) else [None]
    if not all(isinstance(value, str) for value in values) or values[-1] not in DIRECTIONS:
        raise RefusedError(
            f"The simulator does not understand the rule {json.dumps(given)}.",
            f"Give it {', '.join(fields)}; the last one is one of {', '.join(DIRECTIONS)}.",
        )
    return Rule(*values)
