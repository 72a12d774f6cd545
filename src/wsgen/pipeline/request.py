"""What the user asks `wsgen validate` for."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path


@dataclass(frozen=True, kw_only=True)
class ValidateRequest:
    """Packages and how they are tried."""

    packages: Sequence[str] = ()  # empty: every package of the workspace that can be launched
    launch_file: str | None = None  # a file name as `ros2 launch` takes it
    launch_arguments: Mapping[str, str] = field(default_factory=dict)
    seconds: float = 3.0  # of simulated time
    picture_folder: Path | None = None
