"""The child process of a simulation in PyBullet; importing it loads the engine."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.pipeline.tasks import simulation
from wsgen.simulation.bullet import BulletEngine

if TYPE_CHECKING:
    from wsgen.isolation.channel import Endpoint
    from wsgen.simulation.scene import Scene, SceneResult


def simulate(scene: Scene) -> SceneResult:
    """Simulate the scene in PyBullet."""
    return simulation.simulate(scene, BulletEngine)


def serve(scene: Scene, remembered: float, endpoint: Endpoint) -> None:
    """Do with the scene what commands say, in PyBullet."""
    simulation.serve(scene, remembered, endpoint, BulletEngine)
