"""The user's own Gazebo: which one is installed, what is asked of it, what it answers.

`gazebo_servers` starts it, in a child process. SI units.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Mapping  # noqa: TC003  the type hints of answers are read
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.model.target import CLASSIC, SIM
from wsgen.model.transform import IDENTITY, Pose
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable


SECONDS_TO_SAY = 60.0  # wall-clock, for a version
_VERSION = re.compile(r"(\d+\.\d+\.\d+)")


@dataclass(frozen=True, kw_only=True)
class Installed:
    """A Gazebo on the PATH."""

    kind: str  # "classic" or "gz"
    server: tuple[str, ...]  # the command of the server, without options
    tool: str  # the program that asks the server
    version: str  # "11.1.0"; empty where it does not say

    @property
    def name(self) -> str:
        """Its name for people."""
        name = "Gazebo Classic" if self.kind == CLASSIC else "Gazebo Sim"
        return f"{name} {self.version}".rstrip()


@dataclass(frozen=True, kw_only=True)
class ToSpawn:
    """A robot to be spawned, or a model that the world already has."""

    entity: str
    file: Path | None = None  # URDF or SDF, not lumped; None: it is in the world
    pose: Pose = IDENTITY  # in the world


@dataclass(frozen=True, kw_only=True)
class GazeboScene:
    """What a Gazebo is to simulate."""

    installed: Installed
    environment: Mapping[str, str]
    world: str  # a file, or the name of a world that Gazebo brings along
    robots: tuple[ToSpawn, ...]
    seconds: float  # simulated
    step: float  # s, of its physics
    window: float  # s: how it moves is seen over the last ones


@dataclass(frozen=True, kw_only=True)
class ModelState:
    """A model in the server."""

    pose: Pose  # in the world
    links: Mapping[str, Pose]  # likewise, by name
    mass: float  # kg
    movable_joints: int
    joint_positions: Mapping[str, float]  # rad or m; those that the server says


@dataclass(frozen=True, kw_only=True)
class GazeboRun:
    """How a model was before the last moments, and at the end."""

    before: ModelState
    end: ModelState


@dataclass(frozen=True, kw_only=True)
class GazeboResult:
    """What a Gazebo did."""

    runs: Mapping[str, GazeboRun]  # by entity
    refused: Mapping[str, str]  # likewise: what it printed about it
    printed: tuple[str, ...] = ()  # its warnings and errors
    problem: str | None = None  # what ended it early, without a subject: "crashed (SIGSEGV)"


def find_gazebo(environment: Mapping[str, str], kind: str | None = None) -> Installed | None:
    """The Gazebo on the PATH of an environment: that of a kind, else Classic before Sim."""
    found = (_classic(environment) if one == CLASSIC else _sim(environment) for one in _kinds(kind))
    return next(filter(None, found), None)


def _kinds(kind: str | None) -> Iterable[str]:
    return (CLASSIC, SIM) if kind is None else (kind,)


def _classic(environment: Mapping[str, str]) -> Installed | None:
    path = environment.get("PATH")
    server, tool = shutil.which("gzserver", path=path), shutil.which("gz", path=path)
    if server is None or tool is None:
        return None
    # Beside a Gazebo Sim, `gz` may be that one's: Classic's lies beside its server.
    beside = Path(server).with_name("gz")
    version = _VERSION.search(_say([server, "--version"], environment))
    return Installed(
        kind=CLASSIC,
        server=(server,),
        tool=str(beside) if beside.exists() else tool,
        version=version[1] if version else "",
    )


def _sim(environment: Mapping[str, str]) -> Installed | None:
    """`gz sim`, or `ign gazebo` of Fortress; Classic's `gz` knows neither."""
    for name, word in (("gz", "sim"), ("ign", "gazebo")):
        tool = shutil.which(name, path=environment.get("PATH"))
        if tool is None:
            continue
        said = _say([tool, word, "--versions"], environment).split()
        if said and _VERSION.fullmatch(said[0]):
            return Installed(kind=SIM, server=(tool, word), tool=tool, version=said[0])
    return None


def _say(command: list[str], environment: Mapping[str, str]) -> str:
    """What a command prints; empty where it does not run."""
    try:
        run = subprocess.run(
            command,
            env=dict(environment),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=SECONDS_TO_SAY,
            check=False,
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return os.fsdecode(run.stdout)
