"""What a live run simulates: written by who starts it, read by the simulator's process."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping  # noqa: TC003  the file is decoded by its type hints
from contextlib import contextmanager
from dataclasses import field
from pathlib import Path

from wsgen.model.devices import Devices  # noqa: TC001
from wsgen.simulation.scene import Scene  # noqa: TC001
from wsgen.values import dataclass

FOLDER_VARIABLE = "WSGEN_LIVE_FOLDER"  # names the folder of a live run, in all its processes
SCENE_FILE = "scene.json"  # in that folder: a `LiveScene`, as `isolation.codec` writes it
SOCKET = "simulator.sock"  # in that folder, where the simulator takes commands


@dataclass(frozen=True, kw_only=True)
class LiveScene:
    """A world and all robots that may be spawned into it.

    Of `scene`, what has to do with the end of a simulation means nothing here. Static models are in
    the world from the beginning; robots come when somebody spawns them by their entity.
    """

    scene: Scene
    simulator: str  # "classic" or "gz": whose plugins and topics these are
    world: str = "default"  # its name
    devices: Mapping[str, Devices] = field(default_factory=dict)  # by entity
    world_devices: Devices | None = None  # plugins of the world
    in_world: tuple[str, ...] = ()  # entities that are there from the beginning
    descriptions: Mapping[str, str] = field(default_factory=dict)  # by entity: its URDF, if it has
    is_paused: bool = False  # at the beginning
    rate: float | None = 1.0  # simulated seconds a second; None: as many as possible
    is_filmed: bool = False  # a film is left in the folder, see `wsgen.simulation.film`
    seconds: float | None = None  # simulated, until the simulator ends; None: when it is told


def socket_path(folder: Path) -> Path:
    """Where the simulator of a live run takes commands."""
    return Path(folder) / SOCKET


@contextmanager
def short_name(path: Path) -> Iterator[str]:
    """A name of a socket that the system takes: one of 107 bytes at most."""
    folder = os.open(path.parent, os.O_RDONLY | os.O_DIRECTORY)
    try:
        yield f"/proc/self/fd/{folder}/{path.name}"
    finally:
        os.close(folder)
