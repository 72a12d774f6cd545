"""`python -m wsgen.ros_nodes.simulator`: Gazebo's side of a live run."""

from __future__ import annotations

import importlib
import json
import os
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.isolation.codec import decode
from wsgen.ros_nodes.simulator.commands import CommandServer
from wsgen.ros_nodes.simulator.filming import Filming
from wsgen.ros_nodes.simulator.host import Due
from wsgen.ros_nodes.simulator.pace import Pace
from wsgen.ros_nodes.simulator.ros import Ros
from wsgen.ros_nodes.simulator.services import offer_services
from wsgen.ros_nodes.simulator.simulation import LiveSimulation
from wsgen.simulation.live_scene import FOLDER_VARIABLE, SCENE_FILE, LiveScene

if TYPE_CHECKING:
    from wsgen.model.world import World
    from wsgen.simulation.engine import Engine

SLICE = 0.01  # s, simulated, between two looks at what has arrived
IDLE = 0.02  # s, that a paused simulator waits for what arrives
ENGINES = {
    "bullet": "wsgen.simulation.bullet:BulletEngine",
    "dart": "wsgen.simulation.dart:DartEngine",
    "mujoco": "wsgen.simulation.mujoco:MujocoEngine",
}


class Ended(Exception):  # noqa: N818  it is no error
    """A signal asked for the end."""


def main() -> int:
    """Simulate until somebody ends it; gives the exit code."""
    folder = os.environ.get(FOLDER_VARIABLE)
    if not folder:
        sys.stderr.write(
            f"The simulator has no live run: {FOLDER_VARIABLE} is not set.\n"
            "Start it with `wsgen launch PACKAGE FILE --run`.\n"
        )
        return 2
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _end)
    try:
        simulate(Path(folder), sys.argv[1:])
    except Ended:
        return 0
    return 0


def _end(_number: int, _frame: object) -> None:
    raise Ended


def simulate(folder: Path, arguments: list[str]) -> None:
    """Simulate the scene of a live folder."""
    text = (folder / SCENE_FILE).read_text(encoding="utf-8")
    scene = decode(json.loads(text), LiveScene)
    engine = make_engine(scene.scene.engine, scene.scene.world)
    ros = Ros(arguments)
    simulation = LiveSimulation(scene, engine, ros, lambda _: None)
    if scene.is_filmed:
        simulation.add(Due(plugin=Filming(simulation.host, folder), robot=None, name="film"))
    server = CommandServer(folder, simulation)
    try:
        run(simulation, server, ros)
    finally:
        server.close()
        simulation.close()
        ros.close()


def make_engine(name: str, world: World) -> Engine:
    """The world in an engine."""
    module, _, attribute = ENGINES[name].partition(":")
    made: Any = getattr(importlib.import_module(module), attribute)
    engine: Engine = made(world)
    return engine


def run(simulation: LiveSimulation, server: CommandServer, ros: Ros) -> None:
    """Let time pass, as fast as the scene says."""
    pace = Pace(simulation.scene.rate)
    control = simulation.control
    offer_services(simulation)
    last = simulation.scene.seconds
    begun = simulation.now
    while last is None or simulation.now < last:
        server.answer()
        ros.poll()
        if not control.passes:
            ros.wait(IDLE)
            pace.begin(simulation.now)
            continue
        if simulation.now < begun:  # it was reset
            pace.begin(simulation.now)
        begun = simulation.now
        simulation.advance(control.next(simulation.now, SLICE))
        while (left := pace.early(simulation.now)) > 0:
            ros.wait(left)
            if left > IDLE:
                server.answer()


if __name__ == "__main__":
    sys.exit(main())
