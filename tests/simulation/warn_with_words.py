"""A task that warns as engines do; run in a child process by test_run."""

from __future__ import annotations

import os

from wsgen.simulation.scene import SceneResult


def simulate(scene: object) -> SceneResult:
    os.write(1, b"pybullet build time: now\nb3Warning: no\n")
    return SceneResult(robot_runs=(), refused={}, seconds={"draw": 0.0})
