"""Tasks that behave as engines do at their worst; run in a child process by test_run."""

from __future__ import annotations

import os

from wsgen.isolation.child import announce
from wsgen.simulation.scene import SceneResult


def simulate(scene: object) -> SceneResult:
    announce("going down")
    os.write(1, b"pybullet build time: now\nfarewell\n")
    os.abort()


def warn(scene: object) -> SceneResult:
    os.write(1, b"pybullet build time: now\nb3Warning: no\n")
    return SceneResult(robot_runs=(), refused={}, seconds={"draw": 0.0})
