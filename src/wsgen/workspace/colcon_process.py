"""Run colcon in a process of its own, and hand on its events while it works.

Why not in this process, which would save 40 ms of 490: colcon is written to run once. It caches
the manifests and extensions it has read and where CMake is in module globals, changes the logging
and, when interrupted, the handling of SIGINT, and it takes the environment and the current folder
from the process, which other threads of ours may be using. As a process, with the group of
processes it starts, it can also be ended as a whole.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from wsgen.errors import NotReadableError
from wsgen.isolation.lifeline import open_lifeline

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

CHILD = str(Path(__file__).with_name("colcon_child.py"))
SECONDS_TO_STOP = 10.0  # wall-clock, for compilers to clean up


@dataclass(frozen=True, kw_only=True)
class Finished:
    """How the process ended."""

    returncode: int  # negative: the number of the signal that ended it
    output: str  # what colcon itself had to say


def run_colcon(
    arguments: Sequence[str],
    *,
    folder: Path,
    environment: Mapping[str, str],
    on_event: Callable[[dict[str, Any]], None],
) -> Finished:
    """Run `colcon` with the arguments in the folder, calling back for each event of the build.

    The events are those of `colcon_events`. An interruption (Ctrl-C, or whatever a handler of
    signals raises) ends colcon and all that it started, then goes on as the exception that it is.
    The end of this process ends them, too.
    """
    with tempfile.TemporaryFile() as output, open_lifeline() as lifeline:
        request = {
            "path": [entry for entry in sys.path if entry],
            "arguments": arguments,
            "lifeline": lifeline,
        }
        try:
            child = subprocess.Popen(
                [sys.executable, "-I", CHILD],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=output,
                cwd=folder,
                env=dict(environment),
                pass_fds=(lifeline,),
                start_new_session=True,  # the group of processes to end
            )
        except OSError as error:
            raise NotReadableError(
                f"colcon could not be started in {folder}: {error.strerror}.",
                hint="Check that you may enter the folder and that memory is free.",
            ) from error
        with child:  # outermost: at its exit it waits, so the child has to have been ended
            try:
                _send(child.stdin, json.dumps(request))
                for line in child.stdout or ():
                    on_event(json.loads(line))
            except KeyboardInterrupt:
                _end(child, signal.SIGINT)
                raise
            except BaseException:
                _end(child, signal.SIGTERM)
                raise
        return Finished(returncode=child.returncode, output=_read(output))


def _send(stream: IO[bytes] | None, request: str) -> None:
    if stream is not None:
        with suppress(BrokenPipeError), stream:  # it died at once; its exit code tells
            stream.write(request.encode())


def _end(child: subprocess.Popen[bytes], first: signal.Signals) -> None:
    """Signal the group as a terminal or supervisor would, and end by force what does not stop."""
    for number, patience in ((first, SECONDS_TO_STOP), (signal.SIGKILL, None)):
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(child.pid, number)
        with suppress(subprocess.TimeoutExpired):
            child.wait(patience)


def _read(output: IO[bytes]) -> str:
    output.seek(0)
    return output.read().decode("utf-8", "replace").strip()
