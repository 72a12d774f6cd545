"""Remembers where all links are while a trial goes on, and says whether a film can be made."""

from __future__ import annotations

import math
import os
from importlib.util import find_spec
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence
    from pathlib import Path

    from wsgen.model.pose import Pose
    from wsgen.simulation.exhibits import Poses

EVERY = 5  # hundredths of a second, what GIF counts time in: 20 frames a second
MOST_FRAMES = 600  # of a long trial there are fewer a second
ENCODER = "av"  # PyAV, which brings FFmpeg with it; wheels for every Python that wsgen runs on


def why_no_film(file: Path) -> str | None:
    """What keeps a film from being written there, in a sentence with what to do; None if nothing.

    It is cheap; ask before a trial.
    """
    suffix = file.suffix.lower()
    if suffix not in {".gif", ".mp4"}:
        return f"a film is a .gif or an .mp4, and `{file.name}` is neither"
    if suffix == ".mp4" and find_spec(ENCODER) is None:
        return "an .mp4 needs PyAV: take a .gif, or pip install 'wsgen[video]'"
    if not file.parent.is_dir():
        return f"the folder {file.parent} does not exist"
    is_special = file.is_dir() or file.is_fifo()
    if is_special or not os.access(file if file.exists() else file.parent, os.W_OK):
        return f"{file} cannot be written to"
    return None


class Recorder:
    """An observer of a trial: keeps the poses of all links at a fixed rate.

    `link_poses` gives those of a robot, as an engine does; robots that are `immobile` are asked
    about once.
    """

    def __init__(
        self,
        link_poses: Callable[[str], Mapping[str, Pose]],
        seconds: float,
        *,
        immobile: Collection[str] = (),
    ) -> None:
        self.rate = 100 / max(EVERY, math.ceil(100 * seconds / MOST_FRAMES))  # frames a second
        self.frames: list[Poses] = []
        self.ends: list[int] = []  # frames after which the robots are put elsewhere
        self._link_poses = link_poses
        self._immobile = immobile

    def mark(self) -> None:
        """Say that the robots are put elsewhere now."""
        if self.frames:
            self.ends.append(len(self.frames) - 1)

    def __call__(self, seconds: float, entities: Sequence[str]) -> None:
        """Look, if it is time for the next frame."""
        if seconds * self.rate < len(self.frames) - 1e-6:
            return
        before = self.frames[-1] if self.frames else {}
        self.frames.append(
            {
                entity: before[entity]
                if entity in before and entity in self._immobile
                else self._link_poses(entity)
                for entity in entities
            }
        )
