"""Records where all links are during a simulation, and says whether a video can be written."""

from __future__ import annotations

import math
import os
from dataclasses import field
from importlib.util import find_spec
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence
    from pathlib import Path

    from wsgen.model.transform import Pose
    from wsgen.rendering.render_items import Poses


EVERY = 5  # hundredths of a second, what GIF counts time in: 20 frames a second
MOST_FRAMES = 600  # of a long simulation there are fewer a second
ENCODER = "av"  # PyAV, which brings FFmpeg with it; wheels for every Python that wsgen runs on


def require_encoder(file: Path) -> None:
    """Check that what a video of that name needs is installed.

    Raises:
        NotFoundError: PyAV is not.
    """
    if _lacks_encoder(file):
        raise NotFoundError(
            "PyAV, which writes .mp4, is not installed.",
            hint="Install it: pip install 'wsgen[video]'; or record a .gif.",
        )


def _lacks_encoder(file: Path) -> bool:
    return file.suffix.lower() == ".mp4" and find_spec(ENCODER) is None


def why_no_video(file: Path) -> str | None:
    """What keeps a video from being written there, in a sentence with what to do; None if nothing.

    It is cheap; ask before a simulation.
    """
    if file.suffix.lower() not in {".gif", ".mp4"}:
        return f"`{file.name}` is neither a .gif nor an .mp4 file"
    if _lacks_encoder(file):
        return "an .mp4 file needs PyAV: name a .gif file, or pip install 'wsgen[video]'"
    if not file.parent.is_dir():
        return f"the folder {file.parent} does not exist"
    is_special = file.is_dir() or file.is_fifo()
    if is_special or not os.access(file if file.exists() else file.parent, os.W_OK):
        return f"{file} is not writable"
    return None


@dataclass(frozen=True)
class Clip:
    """A part of a video, without a cut."""

    name: str = ""  # of the behavior that it shows; empty for what every robot does: stand
    frames: list[Poses] = field(default_factory=list)


class Recorder:
    """An observer of a simulation: keeps the poses of all links at a fixed rate.

    `link_poses` gives those of a robot, as an engine does; robots that are `immobile` are asked
    about once. `seconds` is how long the video is about to be, in simulated time.
    """

    def __init__(
        self,
        link_poses: Callable[[str], Mapping[str, Pose]],
        seconds: float,
        *,
        immobile: Collection[str] = (),
    ) -> None:
        self.rate = 100 / max(EVERY, math.ceil(100 * seconds / MOST_FRAMES))  # frames a second
        self.clips = [Clip()]
        self._began = 0.0  # the last clip, s
        self._link_poses = link_poses
        self._immobile = immobile

    def begin(self, name: str, seconds: float) -> None:
        """A behavior begins now: what is seen from here on is a clip of its own."""
        self.clips.append(Clip(name))
        self._began = seconds

    @property
    def shown(self) -> list[Clip]:
        """What the video is of: the behaviors, or the standing where there are none."""
        return [clip for clip in self.clips[1:] if clip.frames] or self.clips[:1]

    def __call__(self, seconds: float, entities: Sequence[str]) -> None:
        """Look, if it is time for the next frame."""
        frames = self.clips[-1].frames
        if (seconds - self._began) * self.rate < len(frames) - 1e-6:
            return
        before = frames[-1] if frames else {}
        frames.append(
            {
                entity: before[entity]
                if entity in before and entity in self._immobile
                else self._link_poses(entity)
                for entity in entities
            }
        )
