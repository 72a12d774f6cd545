"""What a live run leaves for a video: its robots, and where all links were, frame by frame.

A line of JSON a frame, written as the simulated time passes: what is there when the simulator is
killed can be drawn. Drawing comes afterwards, because the end of a launch does not wait for it.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, TextIO

from wsgen.isolation.codec import decode, encode
from wsgen.model.transform import Pose
from wsgen.simulation.scene import SpawnedRobot
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.model.transform import Vector

    Poses = dict[str, Mapping[str, Pose]]  # in the world, by entity and link


POSE_LOG_FILE = "poses.jsonl"  # in the folder of a live run
NO_ROBOT = "the run ended before a robot was spawned"  # why it has no poses
RATE = 10.0  # frames a simulated second
DIGITS = 5  # of m and rad


@dataclass(frozen=True)
class PoseLog:
    """The frames of a live run.

    `corners` are points (m, in the world) of boxes around what can touch, by entity, where it was
    when it was first seen. `robots` are all that were seen. A name that two different robots had
    one after the other is that of the first one here; the second one has another.
    """

    frames: list[Poses]
    corners: dict[str, list[Vector]]
    robots: tuple[SpawnedRobot, ...]


class PoseLogWriter:
    """Writes frames; what has not moved since the last frame is not written again."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._last: dict[str, dict[str, list[float]]] = {}

    def add(
        self,
        poses: Mapping[str, Mapping[str, Pose]],
        corners: Mapping[str, Sequence[Vector]],
        robots: Sequence[SpawnedRobot],
    ) -> None:
        """Write a frame; `corners` and `robots` are of what is seen for the first time."""
        now = {
            entity: {
                link: [round(number, DIGITS) for number in (*pose.xyz, *pose.rpy)]
                for link, pose in links.items()
            }
            for entity, links in poses.items()
        }
        line: dict[str, Any] = {
            "moved": {
                entity: links for entity, links in now.items() if links != self._last.get(entity)
            }
        }
        if gone := [entity for entity in self._last if entity not in now]:
            line["gone"] = gone
        if corners:
            line["corners"] = {entity: list(points) for entity, points in corners.items()}
        if robots:
            line["robots"] = json.loads(encode(robots))
        self._last = now
        self._stream.write(json.dumps(line, separators=(",", ":")) + "\n")
        self._stream.flush()


def read_pose_log(file: Path) -> PoseLog:
    """The frames of a pose log; half a line at its end is none.

    Raises:
        OSError: The file cannot be read.
    """
    frames: list[Poses] = []
    corners: dict[str, list[Vector]] = {}
    robots: list[SpawnedRobot] = []
    for line in _lines(file):
        poses = dict(frames[-1]) if frames else {}
        for entity, links in line["moved"].items():
            poses[entity] = {
                link: Pose(xyz=(x, y, z), rpy=(roll, pitch, yaw))
                for link, (x, y, z, roll, pitch, yaw) in links.items()
            }
        for entity in line.get("gone", ()):
            poses.pop(entity, None)
        for entity, points in line.get("corners", {}).items():
            corners[entity] = [(x, y, z) for x, y, z in points]
        robots += [decode(one, SpawnedRobot) for one in line.get("robots", ())]
        frames.append(poses)
    return PoseLog(frames, corners, tuple(robots))


def _lines(file: Path) -> Iterator[dict[str, Any]]:
    with file.open(encoding="utf-8") as stream:
        for line in stream:
            if line.endswith("\n"):
                yield json.loads(line)
