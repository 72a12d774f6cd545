"""What the child process of a session (`wsgen.simulation.session`) does, with whatever engine."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.isolation import channel
from wsgen.isolation.child import announce
from wsgen.pipeline.tasks.simulation import unbuffer_output_of_c
from wsgen.simulation.running_scene import RunningScene

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from wsgen.isolation.channel import Endpoint
    from wsgen.model.world import World
    from wsgen.simulation.engine import Engine
    from wsgen.simulation.scene import NotDrawn, Picture, Scene, Video
    from wsgen.simulation.session_state import Opened


def serve(
    scene: Scene, remembered: float, endpoint: Endpoint, make_engine: Callable[[World], Engine]
) -> None:
    """Open the scene with the first command, and do what the others say."""
    unbuffer_output_of_c()
    _Server(scene, remembered, make_engine).serve(endpoint)


class _Server:
    """The commands of a session."""

    def __init__(
        self, scene: Scene, remembered: float, make_engine: Callable[[World], Engine]
    ) -> None:
        self._scene = scene
        self._remembered = remembered
        self._make_engine = make_engine
        self._commands: dict[str, Callable[..., object]] = {"open": self._open}

    def serve(self, endpoint: Endpoint) -> None:
        channel.serve(endpoint, self._commands)

    def _open(self) -> Opened:
        running = RunningScene(
            self._scene, self._make_engine, announce, remembered=self._remembered
        )
        self._commands |= {
            "reset": running.reset,
            "step": running.step,
            "watch": running.watch,
            "drive": running.drive,
            "hold": running.hold,
            "set_motors": running.set_motors,
            "release": running.release,
            "push": running.push,
            "measure": running.measure,
            "moved": running.moved,
            "contacts": running.contacts,
            "lowest_point": running.lowest_point,
            "picture": lambda file: self._picture(running, file),
            "record": lambda file: self._record(running, file),
        }
        return running.opened()

    @staticmethod
    def _picture(running: RunningScene, file: Path) -> Picture | NotDrawn:
        # Loading NumPy and Pillow would cost every session.
        from wsgen.rendering.drawing import draw_picture  # noqa: PLC0415

        return draw_picture(running, file)

    @staticmethod
    def _record(running: RunningScene, file: Path) -> Video | NotDrawn:
        from wsgen.rendering.drawing import draw_last_seconds  # noqa: PLC0415  as above

        return draw_last_seconds(running, file)
