"""Prepares what processes of a live run spawn and the launch file does not name.

The simulator sends the text of a description by a socket in the folder of the run, and gets what an
engine takes: read, checked, lumped, its meshes converted, as that of robots of the launch file.
This process does it, because it knows the packages and has the pipeline loaded.

A connection has one request, a `NewEntity` on a line, and one answer, a `PreparedEntity`, both as
`isolation.codec` writes them.
"""

from __future__ import annotations

import contextlib
import json
import socket
import threading
from typing import TYPE_CHECKING

from wsgen.diagnostics import Severity
from wsgen.errors import WsgenError
from wsgen.isolation.codec import decode, encode
from wsgen.model.world import Spawn
from wsgen.pipeline.run_robots import spawned_robots
from wsgen.simulation.live_scene import NewEntity, PreparedEntity, preparer_path, short_name

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.pipeline.package_validation import Validation


SECONDS_TO_END = 2.0  # wall-clock, for what is being prepared when the run ends


class Preparer:
    """Prepares entities for the simulator of a run."""

    def __init__(
        self,
        subject: Validation,
        folder: Path,
        show: Callable[[Iterable[Diagnostic]], None],
        note: Callable[[Spawn], None] = lambda _spawn: None,
    ) -> None:
        """Prepare as `subject` has prepared the robots of the launch file.

        Args:
            subject: What has read the launch file.
            folder: For files that engines read; there until the run is over.
            show: Is given what is reported, each once, where anything is.
            note: Is given each entity that is asked for.
        """
        self._subject = subject
        self._folder = folder
        self._show = show
        self._note = note
        self._shown: set[Diagnostic] = set()
        self._count = 0

    def prepare(self, new: NewEntity) -> PreparedEntity:
        """Make of a description what an engine takes."""
        self._count += 1
        folder = self._folder / f"later{self._count}"
        folder.mkdir()
        spawn = Spawn(
            entity=new.entity,
            description=new.text,
            description_file=new.file,
            model_uri=new.model_uri,
            pose_in_world=new.pose_in_world,
        )
        self._note(spawn)
        prepared, found = self._subject.prepare_later(spawn, folder)
        reported = (one for one in found if one.severity is not Severity.INFO)
        fresh = [one for one in reported if one not in self._shown]
        self._shown.update(fresh)
        if fresh:
            self._show(fresh)
        if prepared is None or not prepared.can_run:
            errors = (one for one in found if one.severity is Severity.ERROR)
            error = next(errors, next(iter(found), None))
            if error is None:
                return PreparedEntity(
                    problem="The description has no robot.",
                    hint="Give the text of a URDF with <robot>, or of an SDF with <model>.",
                )
            return PreparedEntity(problem=error.message, hint=error.hint or "")
        (robot,) = spawned_robots((prepared,))
        return PreparedEntity(
            robot=robot, devices=prepared.devices, description=prepared.description
        )


@contextlib.contextmanager
def serve(folder: Path, prepare: Callable[[NewEntity], PreparedEntity]) -> Iterator[None]:
    """Answer requests in a thread, one after the other, until the context ends.

    Args:
        folder: Of the live run.
        prepare: What answers them.
    """
    listening = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    with short_name(preparer_path(folder)) as name:
        listening.bind(name)
    listening.listen()
    thread = threading.Thread(target=_accept, args=(listening, prepare), daemon=True)
    thread.start()
    try:
        yield
    finally:
        with contextlib.suppress(OSError):
            listening.shutdown(socket.SHUT_RDWR)  # the thread waits for a connection
        thread.join(SECONDS_TO_END)
        listening.close()


def _accept(listening: socket.socket, prepare: Callable[[NewEntity], PreparedEntity]) -> None:
    while True:
        try:
            client, _ = listening.accept()
        except OSError:  # the run is over
            return
        with contextlib.suppress(OSError), client, client.makefile("rwb") as stream:
            line = stream.readline()
            if line:
                stream.write(encode(_answer(line, prepare)).encode() + b"\n")


def _answer(line: bytes, prepare: Callable[[NewEntity], PreparedEntity]) -> PreparedEntity:
    """What is prepared; an error is a problem of that entity, not of the run."""
    try:
        return prepare(decode(json.loads(line), NewEntity))
    except WsgenError as error:
        return PreparedEntity(problem=error.message, hint=error.hint)
    except Exception as error:  # noqa: BLE001  the simulator waits for an answer
        return PreparedEntity(
            problem=f"The description cannot be read: {type(error).__name__}: {error}.",
            hint="Report it with the description: it is a bug in wsgen.",
        )
