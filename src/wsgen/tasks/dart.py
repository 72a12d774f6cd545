"""The child process of a simulation in DART; importing it loads the engine."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.simulation.dart import DartEngine
from wsgen.tasks import simulation

if TYPE_CHECKING:
    from wsgen.simulation.scene import Scene, SceneResult


def simulate(scene: Scene) -> SceneResult:
    """Simulate the scene in DART."""
    return simulation.simulate(scene, DartEngine)
