"""A session whose engine is not loaded; run in a child process by test_session."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsgen.isolation.channel import Endpoint
    from wsgen.simulation.scene import Scene


def serve(scene: Scene, remembered: float, endpoint: Endpoint) -> None:
    raise ImportError("libGL.so.1: cannot open shared object file: No such file or directory")
