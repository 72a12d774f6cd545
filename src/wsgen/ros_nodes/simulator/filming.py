"""Keeps where everything is while a live run goes on, for a video of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.ros_nodes.simulator.host import Plugin
from wsgen.simulation.film import FILM_FILE, RATE, FilmWriter

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.ros_nodes.simulator.host import Host


class Filming(Plugin):
    """Writes a frame every tenth of a simulated second, from when the first robot is there."""

    period = 1 / RATE

    def __init__(self, host: Host, folder: Path) -> None:
        self._host = host
        self._stream = (folder / FILM_FILE).open("w", encoding="utf-8")
        self._writer = FilmWriter(self._stream)
        self._seen: set[str] = set()

    def update(self) -> None:
        """Write the frame of now."""
        robots = self._host.robots
        if all(robot.spawned.is_static_model for robot in robots.values()):
            return
        corners = {
            entity: [
                *self._host.engine.corners(entity),
                *(pose.xyz for pose in robot.link_poses().values()),
            ]
            for entity, robot in robots.items()
            if entity not in self._seen
        }
        self._seen |= robots.keys()
        self._writer.add({entity: robot.link_poses() for entity, robot in robots.items()}, corners)

    def close(self) -> None:
        """End the film."""
        self._stream.close()
