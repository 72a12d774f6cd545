"""What the process of the launch service is given."""

from __future__ import annotations

from collections.abc import Mapping  # noqa: TC003  the file is decoded by its type hints
from dataclasses import field
from pathlib import Path  # noqa: TC003

from wsgen.model.plan import LaunchRequest  # noqa: TC001
from wsgen.values import dataclass

REQUEST_FILE = "service.json"  # in the live folder
# What the parent tells the service, a byte each.
GO, INTERRUPT, TERMINATE = b"g", b"i", b"t"


@dataclass(frozen=True, kw_only=True)
class ServiceRequest:
    """A launch to be played, and where its processes find what they need."""

    launch: LaunchRequest
    folder: Path  # of the live run
    python: Path  # the interpreter of nodes
    is_sourced: bool = False  # the programs of a ROS that the user sourced run
    # Environment of the launch, and what processes have in addition: complete values.
    environment: Mapping[str, str] = field(default_factory=dict)
    variables: Mapping[str, str] = field(default_factory=dict)
    is_colored: bool = False
    is_strict: bool = False  # what cannot run here ends the launch
    until_exit: str | None = None  # the node or process whose end ends the launch
    # After which the launch ends: wall-clock, where no simulator is started, which ends by itself.
    seconds: float | None = None
    awaits_simulator: bool = False  # the launch file starts one, sooner or later
