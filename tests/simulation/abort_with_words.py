"""Tasks that behave as engines do at their worst; run in a child process by test_run."""

from __future__ import annotations

import os
from typing import Any

from wsgen.isolation.child import announce


def simulate(scene: object) -> dict[str, Any]:
    announce("going down")
    os.write(1, b"pybullet build time: now\nfarewell\n")
    os.abort()


def complain(scene: object) -> dict[str, Any]:
    os.write(1, b"pybullet build time: now\nb3Warning: no\n")
    return {"robot_runs": [], "refused": {}, "picture_problem": None, "seconds": {"draw": 0.0}}
