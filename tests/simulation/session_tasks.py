"""Engines of sessions that are tested: one that plays a script, and some that misbehave."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from simulation.fake_engine import FakeEngine
from wsgen.pipeline.tasks import simulation
from wsgen.simulation.engine import Contact, Loaded, Refused, State

if TYPE_CHECKING:
    from wsgen.isolation.channel import Endpoint
    from wsgen.simulation.scene import Scene, SpawnedRobot


def motion(seconds: float) -> State:
    """It rises by 1 m/s, and is lost after 9 s."""
    height = float("nan") if seconds > 9 else seconds
    return State((0.0, 0.0, height), (0.0, 0.0, 0.0, 1.0), 1.0, 0.0, 0.5)


class ScriptEngine(FakeEngine):
    """Prints a lot, and dies of what it is told."""

    def __init__(self, _world: object) -> None:
        super().__init__(
            motion,
            refuses=frozenset({"refused"}),
            positions=lambda seconds: {"left": 2 * seconds, "right": 0.0},
            touching={"e": [Contact("base", None, None, (1.0, 2.0, 0.0), 9.8)]},
        )

    def spawn(self, robot: SpawnedRobot) -> Loaded | Refused:
        if robot.entity == "deadly":
            os.write(1, b"a bad mesh\n")
            os.abort()
        return super().spawn(robot)

    def advance(self, steps: int) -> None:
        os.write(1, b'{"value": "noise"}\n')
        super().advance(steps)
        if self.steps > 5000 and ("e", "left") in self.pushes:
            os.abort()
        while ("e", "right") in self.pushes:
            pass


def serve(scene: Scene, remembered: float, endpoint: Endpoint) -> None:
    simulation.serve(scene, remembered, endpoint, ScriptEngine)
