"""What the user asks `wsgen validate` for."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path


FILE_SUFFIXES = (".urdf", ".xacro", ".sdf", ".world")  # what can be validated without a package


@dataclass(frozen=True, kw_only=True)
class ValidateRequest:
    """Packages and files, and how they are validated."""

    packages: Sequence[str] = ()
    files: Sequence[Path] = ()  # neither: every package of the workspace that can be launched
    launch_file: str | None = None  # a file name as `ros2 launch` takes it
    launch_arguments: Mapping[str, str] = field(default_factory=dict)
    seconds: float = 3.0  # of simulated time
    engines: Sequence[str] = ("bullet",)  # the first one's figures are reported
    jobs: int = 1  # number of packages or files to process in parallel
    picture_folder: Path | None = None
    video: Path | None = None  # a .gif or .mp4 of the simulation of one launch file

    @property
    def is_drawn(self) -> bool:
        """Whether it matters what things look like."""
        return self.picture_folder is not None or self.video is not None
