"""`python -m wsgen.live.nodes.simulator`: Gazebo's side of a live run."""

from __future__ import annotations

import contextlib
import ctypes
import importlib
import json
import os
import socket
import sys
import time
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.errors import EXIT_BUG
from wsgen.isolation.codec import decode, encode
from wsgen.live.nodes.bridge import split
from wsgen.live.nodes.signals import ignore_ends, raise_when_ended
from wsgen.live.nodes.simulator.commands import CommandServer
from wsgen.live.nodes.simulator.host import Due
from wsgen.live.nodes.simulator.pose_logger import PoseLogger
from wsgen.live.nodes.simulator.ros import Ros
from wsgen.live.nodes.simulator.services import offer_services
from wsgen.live.nodes.simulator.simulation import LiveSimulation, RefusedError
from wsgen.live.nodes.simulator.timing import Pace
from wsgen.live.nodes.simulator.topics import BadNameError
from wsgen.model.engines import ENGINES
from wsgen.simulation.live_runs import (
    FOLDER_VARIABLE,
    SCENE_FILE,
    UNHEARD_FILE,
    LiveScene,
    PreparedEntity,
    preparer_path,
    short_name,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.model.world import World
    from wsgen.simulation.engine import Engine
    from wsgen.simulation.live_runs import NewEntity


SECONDS = 120.0  # wall-clock, for large meshes on a busy machine


class Preparing:
    """Asks for entities; threads may do so at a time."""

    def __init__(self, folder: Path) -> None:
        self._path = preparer_path(folder)

    def __call__(self, new: NewEntity) -> PreparedEntity:
        """What an engine takes; it has a robot.

        Raises:
            RefusedError: The description has errors, or nobody answers.
        """
        made = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        made.settimeout(SECONDS)
        try:
            with made, made.makefile("rwb") as stream:
                with short_name(self._path) as name:
                    made.connect(name)
                stream.write(encode(new).encode() + b"\n")
                stream.flush()
                line = stream.readline()
        except OSError as error:
            raise _unanswered(new) from error
        if not line:
            raise _unanswered(new)
        prepared = decode(json.loads(line), PreparedEntity)
        if prepared.robot is None:
            raise RefusedError(prepared.problem, prepared.hint)
        return prepared


def _unanswered(new: NewEntity) -> RefusedError:
    return RefusedError(
        f"`{new.entity}` cannot be prepared: what started the run does not answer.",
        "Spawn it in a launch that `wsgen launch --run` plays.",
    )


# What starts it says: with the flag for a pause; without Gazebo Sim's to run.
PAUSED, WAITS = "--paused", "--waits-for-play"
TELL_OF_WAITING = (
    "Without -r, Gazebo Sim waits for the play button of its window. wsgen has none and runs at "
    "once; add -r to gz_args, and Gazebo Sim does so, too."
)
SLICE = 0.01  # s, simulated, between two looks at what has arrived
AWAITED = 30.0  # s, of the wall clock, that the time of robots to come is not faster than that
LOOK_EVERY = 2.0  # s, of the wall clock, between two looks at the types of topics
DOMAINS = 102  # whose ports Linux gives to nobody else
LOOK_AT_TOPICS = 0.1  # s, likewise, while a recorder is yet to find them
IDLE = 0.02  # s, that a paused simulator waits for what arrives
NEXT_STEP = 0.002  # s, that one waits for a command to go on, before it looks at messages
TRACEBACK = "WSGEN_TRACEBACK"  # a variable; set, bugs have tracebacks


def main() -> int:
    """Simulate until somebody ends it; gives the exit code."""
    folder = os.environ.get(FOLDER_VARIABLE)
    if not folder:
        sys.stderr.write(
            f"The simulator has no live run: {FOLDER_VARIABLE} is not set.\n"
            "Start it with `wsgen launch PACKAGE FILE --run`.\n"
        )
        return 2
    try:
        raise_when_ended()
        simulate(Path(folder), sys.argv[1:])
    except KeyboardInterrupt:
        ignore_ends()
        return 0
    except BadNameError as error:
        sys.stderr.write(
            f"The simulator cannot begin: {error}\n"
            "Correct the name, remappings and parameters of its node in the launch file.\n"
        )
        return 1
    except Exception as error:
        if os.environ.get(TRACEBACK):
            raise
        sys.stderr.write(
            f"The simulator cannot go on: {type(error).__name__}: {error}\n"
            f"This is a bug in wsgen. Set {TRACEBACK}=1, run the command again and report the "
            "output.\n"
        )
        return EXIT_BUG
    return 0


def simulate(folder: Path, arguments: list[str]) -> None:
    """Simulate the scene of a live folder."""
    ends = contextlib.ExitStack()
    try:
        text = (folder / SCENE_FILE).read_text(encoding="utf-8")
        scene = decode(json.loads(text), LiveScene)
        if PAUSED in arguments:
            scene = replace(scene, is_paused=True)
        engine = make_engine(scene.scene.engine, scene.scene.world)
        ros = Ros(split(arguments).of_ros)
        ends.callback(ros.close)
        simulation = LiveSimulation(scene, engine, ros, lambda _: None)
        ends.callback(simulation.close)
        ends.callback(note_unheard, folder, ros)  # first: other nodes end at the same time
        simulation.prepare = Preparing(folder)
        if scene.logs_poses:
            logger = PoseLogger(simulation.host, folder)
            simulation.add(Due(plugin=logger, robot=None, name="pose log"))
        if WAITS in arguments:
            simulation.host.warn(TELL_OF_WAITING)
        server = CommandServer(folder, simulation)
        ends.callback(server.close)
        run(simulation, server, ros)
    finally:
        ignore_ends()  # before anything that takes time: a signal comes again
        ends.close()


def note_unheard(folder: Path, ros: Ros) -> None:
    """Leave the topics that could have driven a robot, where nobody has sent anything.

    Those are none of them where a node was about to do so when the run was ended.
    """
    if not ros.has_heard:
        ros.note_publishers()
        unheard = {topic: kind for topic, kind in ros.read.items() if topic not in ros.of_others}
        with contextlib.suppress(OSError):  # a hint depends on it, no more
            (folder / UNHEARD_FILE).write_text(json.dumps(unheard), encoding="utf-8")


def make_engine(name: str, world: World) -> Engine:
    """The world in an engine."""
    engine: Engine = load_engine(name)(world)
    return engine


def load_engine(name: str) -> Any:
    """The class of an engine, by the name of its option."""
    module, _, attribute = ENGINES[name].engine.partition(":")
    with _quiet():  # PyBullet prints when it was built
        return getattr(importlib.import_module(module), attribute)


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Let nothing be printed, not by libraries of C either."""
    kept = [(number, os.dup(number)) for number in (1, 2)]
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for number, _ in kept:
            os.dup2(nowhere, number)
        yield
    finally:
        ctypes.CDLL(None).fflush(None)  # what C has kept to print it later
        for number, copy in kept:
            os.dup2(copy, number)
            os.close(copy)
        os.close(nowhere)


class Arrival:
    """Keeps time as slow as real time until the robots of the launch file are there.

    Otherwise the seconds of `--for` could be over before their spawners have begun, or before the
    recorder has found their topics. Who steps the simulation waits for them.
    """

    def __init__(self, simulation: LiveSimulation, pace: Pace, ros: Ros) -> None:
        self._simulation, self._pace, self._ros = simulation, pace, ros
        self._next = 0.0  # wall-clock, of the next look at topics
        self._wanted = pace.rate
        self._end = time.monotonic() + AWAITED
        self._is_over = simulation.scene.is_stepped
        if not self._is_over:
            pace.rate = min(pace.rate or 1.0, 1.0)

    def look(self) -> None:
        """Take the wanted rate when they are there, or have not come for long."""
        now = time.monotonic()
        if self._is_over or (self._simulation.awaited and now < self._end):
            return
        if self._simulation.scene.is_recorded and now < self._end:
            if now < self._next:
                return
            self._next = now + LOOK_AT_TOPICS
            if self._ros.has_unheard_topics():
                return
        self._is_over, self._pace.rate = True, self._wanted
        self._pace.begin(self._simulation.now)


def two_simulators() -> str:
    """What to say where another process publishes /clock, too."""
    domain = os.environ.get("ROS_DOMAIN_ID", "")
    number = int(domain) if domain.isdecimal() else 0
    return (
        f"Another process publishes /clock in ROS_DOMAIN_ID {number}, too: nodes get the time and "
        "the messages of two simulators. End the other one, or start one of them with "
        f"ROS_DOMAIN_ID={(number + 1) % DOMAINS}."
    )


class TypesOfTopics:
    """Names messages that do not arrive because another type is read, and other simulators."""

    def __init__(self, simulation: LiveSimulation, ros: Ros) -> None:
        self._simulation, self._ros = simulation, ros
        self._next = time.monotonic() + LOOK_EVERY

    def look(self) -> None:
        """Look now and then: it costs as much as a small message."""
        if time.monotonic() >= self._next:
            self._next = time.monotonic() + LOOK_EVERY
            for problem in self._ros.mixed_types():
                self._simulation.host.warn(problem)
            if self._ros.has_other_clock():
                self._simulation.host.warn(two_simulators())
            if not self._ros.has_heard:  # who publishes may be gone at the end
                self._ros.note_publishers()


def run(simulation: LiveSimulation, server: CommandServer, ros: Ros) -> None:
    """Let time pass, as fast as the scene says."""
    rate = simulation.scene.rate
    pace = Pace(rate)
    arrival = Arrival(simulation, pace, ros)
    control = simulation.control
    offer_services(simulation)
    # What asks has its answer as soon in slow motion.
    slice_seconds = SLICE * min(1.0, rate or 1.0)
    last = simulation.scene.seconds
    begun, is_notified = simulation.now, False
    is_stepped = simulation.scene.is_stepped
    rest = partial(server.wait, NEXT_STEP) if is_stepped else partial(ros.wait, IDLE)
    types = TypesOfTopics(simulation, ros)
    while last is None or simulation.now < last:
        loads = simulation.loads
        took_time = server.answer()
        ros.poll()
        arrival.look()
        if took_time or simulation.loads != loads:  # it takes its time to load a robot
            pace.begin(simulation.now)
        types.look()
        if not control.passes(simulation.now):
            rest()
            pace.begin(simulation.now)
            continue
        if simulation.now < begun:  # it was reset
            pace.begin(simulation.now)
        begun = simulation.now
        simulation.advance(control.next(simulation.now, slice_seconds))
        reached = pace.rate_reached(simulation.now)
        if reached is not None and not is_notified:
            is_notified = True
            simulation.host.warn(
                f"This machine simulates {reached:.2g} s a second, slower than --rate "
                f"{pace.rate:g}."
            )
        while (left := pace.early(simulation.now)) > 0:
            ros.wait(left)


if __name__ == "__main__":
    sys.exit(main())
