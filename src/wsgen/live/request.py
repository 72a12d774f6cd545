"""What the process of the launch service is given."""

from __future__ import annotations

from collections.abc import Mapping  # noqa: TC003  the file is decoded by its type hints
from dataclasses import field
from pathlib import Path  # noqa: TC003

from wsgen.model.plan import LaunchRequest  # noqa: TC001
from wsgen.text.values import dataclass

NODES_FILE = "nodes.json"  # in the live folder
# What the parent says to the service, a byte each.
NODES, GO, INTERRUPT, TERMINATE = b"n", b"g", b"i", b"t"


@dataclass(frozen=True, kw_only=True)
class ServiceRequest:
    """A launch to be played, and where its processes find what they need."""

    launch: LaunchRequest
    folder: Path  # of the live run
    python: Path  # the interpreter of nodes
    is_sourced: bool = False  # the programs of a ROS that the user sourced run
    distro: str | None = None  # of the ROS that runs; nodes may see another one
    # Environment of the launch, and what processes have in addition: complete values.
    environment: Mapping[str, str] = field(default_factory=dict)
    variables: Mapping[str, str] = field(default_factory=dict)
    packages: tuple[str, ...] = ()  # of the workspace
    sources: Mapping[str, Path] = field(default_factory=dict)  # of them, by their share folders
    is_colored: bool = False
    is_strict: bool = False  # what cannot run here ends the launch
    until_exit: str | None = None  # the node or process whose end ends the launch
    # After which the launch ends: wall-clock, where no simulator is started, which ends by itself.
    seconds: float | None = None
    is_watched: bool = False  # what happens is written into the journal of the folder
    beside: str | None = None  # what another run simulates in the same domain: "PACKAGE FILE"
    joined: Path | None = None  # the folder of another live run, whose simulator is that of this
    awaits_simulator: bool = False  # the launch file starts one, sooner or later


@dataclass(frozen=True, kw_only=True)
class NodeServerRequest:
    """What the server is started with."""

    python: Path  # the interpreter of nodes
    environment: Mapping[str, str]  # of nodes
    # Complete values of LD_LIBRARY_PATH and PYTHONPATH: those of nodes, and folders of messages
    # that they may come to need.
    paths: Mapping[str, str]
    engine: str  # of the simulation, by the name of its option
