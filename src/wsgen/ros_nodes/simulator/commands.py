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

from wsgen.ros_nodes.simulator.simulation import RefusedError
from wsgen.ros_nodes.simulator.topics import Rule
from wsgen.ros_nodes.simulator_client import short_name
from wsgen.simulation.live_scene import socket_path

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from wsgen.ros_nodes.simulator.simulation import LiveSimulation
    from wsgen.ros_nodes.simulator.topics import Bridge

DIRECTIONS = ("both", "to_ros", "to_gz", "service")


class _Connection:
    """A client, and what ends with it."""

    def __init__(self) -> None:
        self.bridges: list[Bridge] = []


class CommandServer:
    """Listens, and answers when it is told to."""

    def __init__(self, folder: Path, simulation: LiveSimulation) -> None:
        """Listen from now on."""
        self._simulation = simulation
        self._waiting: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._path = socket_path(folder)
        with contextlib.suppress(FileNotFoundError):
            self._path.unlink()
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        with short_name(self._path) as name:
            self._socket.bind(name)
        self._socket.listen()
        threading.Thread(target=self._accept, daemon=True).start()

    def answer(self) -> None:
        """Do what was asked for."""
        with contextlib.suppress(queue.Empty):
            while True:
                self._waiting.get_nowait()()

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
            return {"ok": True, **self._command(request, connection)}
        except RefusedError as error:
            return {"error": error.message, "hint": error.hint}
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            return {
                "error": f"The simulator does not understand the request: {error!r}",
                "hint": "Send one JSON object a line, with a command as `do`.",
            }

    def _command(self, request: dict[str, Any], connection: _Connection) -> dict[str, Any]:
        simulation, host = self._simulation, self._simulation.host
        command = request["do"]
        if command == "spawn":
            simulation.spawn(str(request["entity"]))
            return {}
        if command == "delete":
            simulation.delete(str(request["entity"]))
            return {}
        if command in {"pause", "unpause"}:
            simulation.control.is_paused = command == "pause"
            return {}
        if command == "bridge":
            rules = [_rule(one) for one in request["rules"]]
            node = host.ros.node(
                str(request.get("node", "ros_gz_bridge")),
                str(request.get("namespace", "")),
                [str(one) for one in request.get("arguments", ())],
            )
            connection.bridges.append(host.gz.open(node, rules))
            return {}
        if command == "state":
            return {
                "seconds": simulation.now,
                "world": host.world,
                "simulator": host.simulator,
                "entities": list(host.robots),
                "poses": {
                    entity: [*robot.state().xyz, *robot.state().xyzw]
                    for entity, robot in host.robots.items()
                },
                "gz_topics": sorted(host.gz.names),
            }
        raise RefusedError(
            f"The simulator has no command `{command}`.",
            "Commands: spawn, delete, bridge, pause, unpause, state.",
        )


def _rule(given: dict[str, str]) -> Rule:
    rule = Rule(**given)
    if rule.direction not in DIRECTIONS:
        raise ValueError(f"the direction is {rule.direction!r}")
    return rule
