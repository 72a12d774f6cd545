"""The child process of a simulation in DART; importing it loads the engine."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.pipeline.tasks import simulation
from wsgen.simulation.dart import DartEngine

if TYPE_CHECKING:
    from wsgen.isolation.channel import Endpoint
    from wsgen.simulation.scene import Scene, SceneResult


def simulate(scene: Scene) -> SceneResult:
    """Simulate the scene in DART."""
    return simulation.simulate(scene, DartEngine)


def serve(scene: Scene, remembered: float, endpoint: Endpoint) -> None:
    """Do with the scene what commands say, in DART."""
    simulation.serve(scene, remembered, endpoint, DartEngine)
