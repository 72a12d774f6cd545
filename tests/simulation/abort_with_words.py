"""Tasks that behave as engines do at their worst; run in a child process by test_run."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from wsgen.isolation.child import announce

if TYPE_CHECKING:
    from wsgen.simulation.scene import SceneResult


def simulate(scene: object) -> SceneResult:
    announce("going down")
    os.write(1, b"pybullet build time: now\nfarewell\n")
    os.abort()
