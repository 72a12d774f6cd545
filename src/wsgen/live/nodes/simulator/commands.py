"""The simulator's socket: what spawners and bridges of the launch file ask for.

A request is a JSON object on a line, and so is its answer: `{"ok": true, …}`, or `{"error": …,
"hint": …}`. Connections are read in threads; what they ask for is done between two steps.
"""

from __future__ import annotations

import contextlib
import json
import queue
import socket
import sys
import threading
import time
from typing import TYPE_CHECKING, Any

from wsgen.isolation.codec import decode, encode
from wsgen.live.nodes.simulator.services import SERVICE, GzServices
from wsgen.live.nodes.simulator.simulation import RefusedError
from wsgen.live.nodes.simulator.timing import TINY
from wsgen.live.nodes.simulator.topics import BadNameError, Rule, problem_of
from wsgen.simulation.live_runs import NewEntity, PreparedEntity, short_name, socket_path

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from wsgen.live.nodes.simulator.simulation import LiveSimulation
    from wsgen.live.nodes.simulator.topics import Bridge

DIRECTIONS = ("both", "to_ros", "to_gz", SERVICE)
SLOW = frozenset({"spawn", "delete", "bridge"})  # commands that load robots and make topics
LONGEST_STEP = 10.0  # s, simulated

RENAME = (
    "Names in ROS have letters, digits and `_`. Give the topic another name in ROS: with "
    "ros_topic_name in a YAML file of the bridge (config_file)."
)


HEARTBEAT = 0.2  # s of the clock: who waits for simulated time hears of it as often


class _Advance:
    """Somebody who waits until time has passed."""

    def __init__(self, seconds: float, answers: queue.SimpleQueue[dict[str, Any]]) -> None:
        self.seconds = seconds  # simulated
        self.answers = answers
        self.late = time.monotonic() + HEARTBEAT


class _Connection:
    """A client, and what ends with it."""

    def __init__(self) -> None:
        self.bridges: list[Bridge] = []
        self.reported: dict[str, tuple[int, int]] = {}  # entity -> its poses that this client has


class CommandServer:
    """Listens, and answers when it is asked to."""

    def __init__(self, folder: Path, simulation: LiveSimulation) -> None:
        """Listen from now on."""
        self._simulation = simulation
        self._services = GzServices(simulation)
        self._waiting: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._took_time = False
        self._advance: _Advance | None = None
        self._lock = threading.Lock()
        self._claimed: set[str] = set()  # prepared robots that a request is about to spawn
        self._path = socket_path(folder)
        with contextlib.suppress(FileNotFoundError):
            self._path.unlink()
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        with short_name(self._path) as name:
            self._socket.bind(name)
        self._socket.listen()
        threading.Thread(target=self._accept, daemon=True).start()

    def answer(self) -> bool:
        """Do what was asked for; gives whether it took time that the simulation may lose.

        Questions do not: who asks often would let no lost time be made up for.
        """
        self._took_time = False
        with contextlib.suppress(queue.Empty):
            while True:
                self._waiting.get_nowait()()
        self._report_advance()
        return self._took_time

    def wait(self, seconds: float) -> None:
        """Wait for a command, so long at most, and do it."""
        with contextlib.suppress(queue.Empty):
            self._waiting.get(timeout=seconds)()

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

                request = self._understand(line)

                def work(
                    request: dict[str, Any] = request,
                    answers: queue.SimpleQueue[dict[str, Any]] = answers,
                ) -> None:
                    answer = self._do(request, connection, answers)
                    if answer is not None:
                        answers.put(answer)

                self._waiting.put(work)
                stream.write(json.dumps(answers.get()).encode() + b"\n")
                stream.flush()
        self._waiting.put(lambda: self._end(connection))

    def _end(self, connection: _Connection) -> None:
        for bridge in connection.bridges:
            self._simulation.host.gz.close(bridge)

    def _understand(self, line: bytes) -> dict[str, Any]:
        """A request, or an error; what the launch file does not name is prepared, meanwhile."""
        try:
            request = json.loads(line)
        except ValueError:
            request = None
        if not isinstance(request, dict):
            return _error(
                "The simulator does not understand the request: it is not a JSON object.",
                'Send one like {"do": "state"} a line.',
            )
        if "error" in request:
            return _error(str(request["error"]), "Requests have no such key.")
        if request.get("do") == "spawn" and "new" in request:
            try:
                new = decode(request["new"], NewEntity)
                if not self._claim(request, new):
                    request["prepared"] = self._simulation.prepare(new)
            except RefusedError as error:
                return _error(error.message, error.hint)
            except TypeError as error:
                return _error(
                    f"The simulator does not understand what is to be spawned: {error}",
                    "Send a NewEntity.",
                )
        return request

    def _claim(self, request: dict[str, Any], new: NewEntity) -> bool:
        """Whether a request is to spawn what has been prepared for its name; only one is.

        Raises:
            RefusedError: The name is taken.
        """
        entity = str(request.get("entity", ""))
        if not request.get("renames"):
            self._simulation.refuse_twice(entity)
            fits = self._simulation.awaits(entity)
        else:  # any description may come with that name
            fits = self._simulation.awaits(entity, new)
        with self._lock:
            if not fits or entity in self._claimed:
                return False
            self._claimed.add(entity)
        return True

    def _do(
        self,
        request: dict[str, Any],
        connection: _Connection,
        answers: queue.SimpleQueue[dict[str, Any]],
    ) -> dict[str, Any] | None:
        """The answer to a request; None where it comes later."""
        if "error" in request:
            return request
        known = {
            "spawn": self._spawn,
            "delete": self._delete,
            "bridge": self._bridge,
            "pause": self._pause,
            "unpause": self._unpause,
            "step": self._step,
            "reset": self._reset,
            "state": self._state,
            "poses": self._poses,
            "robot": self._robot,
        }
        command = str(request.get("do"))
        if command not in known and command != "advance":
            return _error(
                f"The simulator has no command `{command}`.",
                f"Commands: {', '.join((*known, 'advance'))}.",
            )
        self._took_time |= command in SLOW
        try:
            if command == "advance":
                self._begin_advance(request, answers)
                return None
            return {"ok": True, **known[command](request, connection)}
        except RefusedError as error:
            return _error(error.message, error.hint)

    def _begin_advance(
        self, request: dict[str, Any], answers: queue.SimpleQueue[dict[str, Any]]
    ) -> None:
        """Let time pass; the answer says how much did, when it has, or after a heartbeat."""
        seconds, control = _seconds(request), self._simulation.control
        if not self._simulation.scene.is_stepped or self._advance is not None or seconds is None:
            raise RefusedError(
                "The simulator does not take steps.",
                "Give `seconds`, one step at a time, to a simulator that is started for steps.",
            )
        control.limit = self._simulation.now + seconds
        self._advance = _Advance(seconds, answers)

    def _report_advance(self) -> None:
        """Answer who waits for time that has passed, or has waited for long."""
        advance, control = self._advance, self._simulation.control
        if advance is None:
            return
        left = max(0.0, control.limit - self._simulation.now)
        if left < TINY or time.monotonic() >= advance.late:
            self._advance = None
            control.limit = self._simulation.now
            answer = self._state({}, _Connection())
            advance.answers.put({"ok": True, **answer, "passed": advance.seconds - left})

    def _spawn(self, request: dict[str, Any], _: _Connection) -> dict[str, Any]:
        namespace, renames = str(request.get("namespace", "")), bool(request.get("renames"))
        prepared = request.get("prepared")
        if isinstance(prepared, PreparedEntity):
            entity = self._simulation.spawn_prepared(prepared, namespace, renames=renames)
        else:
            entity = str(request.get("entity", ""))
            try:
                self._simulation.spawn(entity, namespace)
            finally:
                if "new" in request:
                    self._claimed.discard(entity)
        return {"entity": entity}

    def _delete(self, request: dict[str, Any], _: _Connection) -> dict[str, Any]:
        self._simulation.delete(str(request.get("entity", "")))
        return {}

    def _pause(self, _: dict[str, Any], __: _Connection) -> dict[str, Any]:
        self._simulation.control.is_paused = True
        return {}

    def _unpause(self, _: dict[str, Any], __: _Connection) -> dict[str, Any]:
        self._simulation.control.is_paused = False
        return {}

    def _step(self, request: dict[str, Any], _: _Connection) -> dict[str, Any]:
        """Let so much time pass, and no more."""
        seconds = _seconds(request)
        if seconds is None or not 0 < seconds <= LONGEST_STEP:
            raise RefusedError(
                f"The simulator cannot step by {json.dumps(request.get('seconds'))} s.",
                f"Give a number of seconds above 0, and {LONGEST_STEP:g} at most.",
            )
        control = self._simulation.control
        control.is_paused, control.seconds = True, seconds
        return {}

    def _reset(self, _: dict[str, Any], __: _Connection) -> dict[str, Any]:
        self._simulation.reset(with_time=True)
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
            # rad or m, of robots that are no static models
            "joints": {
                entity: dict(robot.joint_positions())
                for entity, robot in host.robots.items()
                if not robot.robot.is_static
            },
            "gz_topics": sorted(host.gz.names),
        }

    def _poses(self, _: dict[str, Any], connection: _Connection) -> dict[str, Any]:
        """Where all links are: of what stands still only what this client does not know yet."""
        simulation, robots = self._simulation, self._simulation.host.robots
        # The same one twice is one robot; one that comes again with its old name has another one.
        numbers = {entity: robot.number for entity, robot in robots.items()}
        now = {entity: (robot.number, robot.times_placed) for entity, robot in robots.items()}
        moved = {
            entity: robot
            for entity, robot in robots.items()
            if not robot.robot.is_static or connection.reported.get(entity) != now[entity]
        }
        connection.reported = now
        prepared = {id(robot) for robot in simulation.scene.scene.robots}
        return {
            "seconds": simulation.now,
            "is_paused": simulation.control.is_paused,
            "robots": numbers,
            # What is not as the scene of the run has it: `robot` says it.
            "others": [
                entity for entity, robot in robots.items() if id(robot.spawned) not in prepared
            ],
            # m, and rad about x, y and z: the links' frames in the world
            "links": {
                entity: {link: [*pose.xyz, *pose.rpy] for link, pose in robot.link_poses().items()}
                for entity, robot in moved.items()
            },
        }

    def _robot(self, request: dict[str, Any], _: _Connection) -> dict[str, Any]:
        """A robot as it was put into the world: a `SpawnedRobot`."""
        entity = str(request.get("entity", ""))
        robot = self._simulation.host.robots.get(entity)
        if robot is None:
            raise RefusedError(
                f"No entity `{entity}` is in the world.",
                f"Entities: {', '.join(self._simulation.host.robots) or 'none'}.",
            )
        return {"robot": encode(robot.spawned)}


def _error(message: str, hint: str) -> dict[str, Any]:
    return {"error": message, "hint": hint}


def _seconds(request: Mapping[str, Any]) -> float | None:
    """The `seconds` of a request, finite and not negative; None where it has none."""
    seconds = request.get("seconds")
    if isinstance(seconds, bool) or not isinstance(seconds, int | float):
        return None
    return float(seconds) if 0 <= seconds <= sys.float_info.max else None


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
