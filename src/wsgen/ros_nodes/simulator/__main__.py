"""`python -m wsgen.ros_nodes.simulator`: Gazebo's side of a live run."""

from __future__ import annotations

import contextlib
import ctypes
import importlib
import json
import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.errors import EXIT_BUG
from wsgen.isolation.codec import decode
from wsgen.ros_nodes.bridge import split
from wsgen.ros_nodes.signals import ignore_ends, raise_when_ended
from wsgen.ros_nodes.simulator.commands import CommandServer
from wsgen.ros_nodes.simulator.filming import Filming
from wsgen.ros_nodes.simulator.host import Due
from wsgen.ros_nodes.simulator.names import BadNameError
from wsgen.ros_nodes.simulator.pace import Pace
from wsgen.ros_nodes.simulator.ros import Ros
from wsgen.ros_nodes.simulator.services import offer_services
from wsgen.ros_nodes.simulator.simulation import LiveSimulation
from wsgen.simulation.live_scene import FOLDER_VARIABLE, SCENE_FILE, LiveScene

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.model.world import World
    from wsgen.simulation.engine import Engine

# What starts it says: with the flag for a pause; without Gazebo Sim's to run.
PAUSED, WAITS = "--paused", "--waits-for-play"
TELL_OF_WAITING = (
    "Without -r, Gazebo Sim waits for the play button of its window. wsgen has none and runs at "
    "once; add -r to gz_args, and Gazebo Sim does so, too."
)
SLICE = 0.01  # s, simulated, between two looks at what has arrived
IDLE = 0.02  # s, that a paused simulator waits for what arrives
TRACEBACK = "WSGEN_TRACEBACK"  # a variable; set, bugs have tracebacks
ENGINES = {
    "bullet": "wsgen.simulation.bullet:BulletEngine",
    "dart": "wsgen.simulation.dart:DartEngine",
    "mujoco": "wsgen.simulation.mujoco:MujocoEngine",
}


def main() -> int:
    """Simulate until somebody ends it; gives the exit code."""
    folder = os.environ.get(FOLDER_VARIABLE)
    if not folder:
        sys.stderr.write(
            f"The simulator has no live run: {FOLDER_VARIABLE} is not set.\n"
            "Start it with `wsgen launch PACKAGE FILE --run`.\n"
        )
        return 2
    raise_when_ended()
    try:
        simulate(Path(folder), sys.argv[1:])
    except KeyboardInterrupt:
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
    text = (folder / SCENE_FILE).read_text(encoding="utf-8")
    scene = decode(json.loads(text), LiveScene)
    if PAUSED in arguments:
        scene = replace(scene, is_paused=True)
    engine = make_engine(scene.scene.engine, scene.scene.world)
    ros = Ros(split(arguments).of_ros)
    simulation = LiveSimulation(scene, engine, ros, lambda _: None)
    if scene.is_filmed:
        simulation.add(Due(plugin=Filming(simulation.host, folder), robot=None, name="film"))
    if WAITS in arguments:
        simulation.host.warn(TELL_OF_WAITING)
    server = CommandServer(folder, simulation)
    try:
        run(simulation, server, ros)
    finally:
        ignore_ends()
        server.close()
        simulation.close()
        ros.close()


def make_engine(name: str, world: World) -> Engine:
    """The world in an engine."""
    module, _, attribute = ENGINES[name].partition(":")
    with _quiet():  # PyBullet tells when it was built
        made: Any = getattr(importlib.import_module(module), attribute)
    engine: Engine = made(world)
    return engine


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


def run(simulation: LiveSimulation, server: CommandServer, ros: Ros) -> None:
    """Let time pass, as fast as the scene says."""
    pace = Pace(simulation.scene.rate)
    control = simulation.control
    offer_services(simulation)
    last = simulation.scene.seconds
    begun, is_told = simulation.now, False
    while last is None or simulation.now < last:
        if server.answer():  # it takes its time to load a robot
            pace.begin(simulation.now)
        ros.poll()
        if not control.passes:
            ros.wait(IDLE)
            pace.begin(simulation.now)
            continue
        if simulation.now < begun:  # it was reset
            pace.begin(simulation.now)
        begun = simulation.now
        simulation.advance(control.next(simulation.now, SLICE))
        rate = pace.rate_reached(simulation.now)
        if rate is not None and not is_told:
            is_told = True
            simulation.host.warn(
                f"This machine simulates {rate:.2g} s a second, slower than --rate {pace.rate:g}."
            )
        while (left := pace.early(simulation.now)) > 0:
            ros.wait(left)


if __name__ == "__main__":
    sys.exit(main())
