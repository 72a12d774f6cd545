"""The child process of a simulation in PyBullet; with its modules, it loads the engine."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from wsgen.simulation.bullet import BulletEngine
from wsgen.tasks import simulation

if TYPE_CHECKING:
    from wsgen.simulation.scene import Scene


def simulate(scene: Scene) -> dict[str, Any]:
    """Play the scene in PyBullet."""
    return simulation.simulate(scene, BulletEngine)
