"""What a live run simulates: written by who starts it, read by the simulator's process."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping  # noqa: TC003  the file is decoded by its type hints
from contextlib import contextmanager
from dataclasses import field
from pathlib import Path

from wsgen.model.devices import Devices  # noqa: TC001
from wsgen.model.transform import IDENTITY, Pose
from wsgen.simulation.scene import Scene, SpawnedRobot  # noqa: TC001
from wsgen.text.values import dataclass

FOLDER_VARIABLE = "WSGEN_LIVE_FOLDER"  # names the folder of a live run, in all its processes
SCENE_FILE = "scene.json"  # in that folder: a `LiveScene`, as `isolation.codec` writes it
# In that folder, where no message of ROS has come to the simulator until its end: a JSON
# object of the topics that it has read and no other node publishes, and the types of their
# messages.
UNHEARD_FILE = "unheard.json"
SOCKET = "simulator.sock"  # in that folder, where the simulator takes commands
PREPARER = "preparer.sock"  # likewise, where descriptions become what it can simulate


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
    # The classes of the systems of Gazebo Sim that the world has without its robots; None: all.
    systems: tuple[str, ...] | None = None
    in_world: tuple[str, ...] = ()  # entities that are there from the beginning
    descriptions: Mapping[str, str] = field(default_factory=dict)  # by entity: its URDF, if it has
    is_paused: bool = False  # at the beginning
    rate: float | None = 1.0  # simulated seconds a second; None: as many as possible
    is_recorded: bool = False  # a recorder subscribes to all topics, as soon as it has found them
    logs_poses: bool = False  # a pose log is left in the folder, see `wsgen.simulation.pose_log`
    is_stepped: bool = False  # time passes only while somebody has it pass, by the socket
    seconds: float | None = None  # simulated, until the simulator ends; None: on command


@dataclass(frozen=True, kw_only=True)
class NewEntity:
    """What a process spawns that the launch file does not name."""

    entity: str = ""  # its name in the simulator; empty: that of its description
    text: str = ""  # URDF or SDF; empty: the model of `model_uri`
    file: Path | None = None  # that the text was read from
    model_uri: str | None = None  # the address of a model that Gazebo looks up
    pose_in_world: Pose = IDENTITY


@dataclass(frozen=True, kw_only=True)
class PreparedEntity:
    """A new entity, ready for an engine; without a robot, `problem` and `hint` say why."""

    robot: SpawnedRobot | None = None
    devices: Devices | None = None
    description: str | None = None  # its URDF, if it has one
    problem: str = ""
    hint: str = ""


def socket_path(folder: Path) -> Path:
    """Where the simulator of a live run takes commands."""
    return Path(folder) / SOCKET


def preparer_path(folder: Path) -> Path:
    """Where a live run has new entities prepared."""
    return Path(folder) / PREPARER


@contextmanager
def short_name(path: Path) -> Iterator[str]:
    """A name of a socket that the system takes: one of 107 bytes at most."""
    folder = os.open(path.parent, os.O_RDONLY | os.O_DIRECTORY)
    try:
        yield f"/proc/self/fd/{folder}/{path.name}"
    finally:
        os.close(folder)
