"""Has what is spawned, and what the launch file does not name, prepared for an engine.

The process that started the run does it: `wsgen.live.preparer`.
"""

from __future__ import annotations

import json
import socket
from typing import TYPE_CHECKING

from wsgen.isolation.codec import decode, encode
from wsgen.live.nodes.simulator.simulation import RefusedError
from wsgen.simulation.live_scene import PreparedEntity, preparer_path, short_name

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.simulation.live_scene import NewEntity

SECONDS = 120.0  # wall-clock, for large meshes on a busy machine


class Preparing:
    """Asks for entities; threads may do so at a time."""

    def __init__(self, folder: Path) -> None:
        self._path = preparer_path(folder)

    def __call__(self, new: NewEntity) -> PreparedEntity:
        """What an engine takes; it has a robot.

        Raises:
            RefusedError: The description has errors, or nobody answers.
        """
        made = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        made.settimeout(SECONDS)
        try:
            with made, made.makefile("rwb") as stream:
                with short_name(self._path) as name:
                    made.connect(name)
                stream.write(encode(new).encode() + b"\n")
                stream.flush()
                line = stream.readline()
        except OSError as error:
            raise _unanswered(new) from error
        if not line:
            raise _unanswered(new)
        prepared = decode(json.loads(line), PreparedEntity)
        if prepared.robot is None:
            raise RefusedError(prepared.problem, prepared.hint)
        return prepared


def _unanswered(new: NewEntity) -> RefusedError:
    return RefusedError(
        f"`{new.entity}` cannot be prepared: what started the run does not answer.",
        "Spawn it in a launch that `wsgen launch --run` plays.",
    )
