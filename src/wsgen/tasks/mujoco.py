"""The child process of a simulation in MuJoCo; importing it loads the engine."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.simulation.mujoco import MujocoEngine
from wsgen.tasks import simulation

if TYPE_CHECKING:
    from wsgen.simulation.scene import Scene, SceneResult


def simulate(scene: Scene) -> SceneResult:
    """Simulate the scene in MuJoCo."""
    return simulation.simulate(scene, MujocoEngine)
