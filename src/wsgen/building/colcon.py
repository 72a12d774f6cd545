"""Run colcon in a child process, and turn its events into those of wsgen.

Running it in this process would save 40 ms of 490, but colcon is written to run once. It caches
manifests, extensions and the path of CMake in module globals, changes the logging and, when
interrupted, the handling of SIGINT, and uses the environment and the current folder of the process,
which other threads may need. A child can also be ended together with the processes that it starts.
"""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from dataclasses import field
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from wsgen.building.last_build import INTERRUPTED
from wsgen.errors import NotReadableError
from wsgen.events import OutputLine, StepEnded, StepProgressed, StepStarted, post
from wsgen.isolation.parent_death import open_parent_death_pipe
from wsgen.isolation.system import end_tree
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from wsgen.events import Listener


CHILD = str(Path(__file__).with_name("colcon_child.py"))
SECONDS_TO_STOP = 10.0  # wall-clock, for compilers to clean up


@dataclass(frozen=True, kw_only=True)
class Finished:
    """How colcon ended."""

    returncode: int  # negative: the number of the signal that ended it
    output: str  # what colcon itself printed


def run_colcon(
    arguments: Sequence[str],
    *,
    folder: Path,
    environment: Mapping[str, str],
    on_event: Callable[[dict[str, Any]], None],
) -> Finished:
    """Run `colcon` with the arguments in the folder, calling back for each event of the build.

    The events are those of `colcon_events`. An interruption (Ctrl-C, or an exception of a signal
    handler) ends colcon and all processes that it started, and is raised again. The end of this
    process ends them, too.
    """
    with tempfile.TemporaryFile() as output, open_parent_death_pipe() as parent_death_pipe:
        path = json.dumps([entry for entry in sys.path if entry])
        try:
            child = subprocess.Popen(
                [sys.executable, "-I", CHILD, path, *arguments],
                stdin=parent_death_pipe,
                stdout=subprocess.PIPE,
                stderr=output,
                cwd=folder,
                env=dict(environment),
                start_new_session=True,  # the group of processes to end
            )
        except OSError as error:
            raise NotReadableError(
                f"colcon could not be started in {folder}: {error.strerror}.",
                hint="Check that you may enter the folder, and that memory is free.",
            ) from error
        with child:  # outermost: its exit waits for the child, which must have ended
            try:
                for line in child.stdout or ():
                    on_event(json.loads(line))
            except KeyboardInterrupt:
                _end(child, signal.SIGINT)
                raise
            except BaseException:
                _end(child, signal.SIGTERM)
                raise
        return Finished(returncode=child.returncode, output=_read(output))


def _end(child: subprocess.Popen[bytes], first: signal.Signals) -> None:
    """Signal the group as a terminal or supervisor would, and kill what does not stop."""
    for number, patience in ((first, SECONDS_TO_STOP), (None, None)):
        end_tree(child.pid, number)
        with suppress(subprocess.TimeoutExpired):
            child.wait(patience)


def _read(output: IO[bytes]) -> str:
    output.seek(0)
    return output.read().decode("utf-8", "replace").strip()


STEP = ("build",)


@dataclass(frozen=True, kw_only=True)
class PackageResult:
    """The outcome of one package."""

    name: str
    outcome: str  # "built", "failed", "interrupted" (because another one failed) or "skipped"
    seconds: float  # wall-clock
    error_output: tuple[str, ...] = ()  # the lines of its programs on standard error, or of errors
    log_folder: Path | None = None  # None if logging is off
    left_out: tuple[str, ...] = ()  # targets and more that could not be compiled without ROS
    needs: tuple[str, ...] = ()  # names of the missing packages that these need


@dataclass
class Progress:
    """Receives the events of `colcon_events`, posts ours, and collects results."""

    listener: Listener | None
    results: list[PackageResult] = field(default_factory=list)
    log_folder: Path | None = None
    colcon_output: list[str] = field(default_factory=list)  # lines on standard error
    _started: dict[str, float] = field(default_factory=dict)  # time.monotonic()
    _error_output: dict[str, list[str]] = field(default_factory=dict)
    _failing: set[str] = field(default_factory=set)

    def __call__(self, event: dict[str, Any]) -> None:
        """Post the event, and keep what the result needs."""
        if event["event"] == "log":
            self.log_folder = None if event["path"] is None else Path(event["path"])
            return
        name: str = event["package"]
        step = (*STEP, name)
        if event["event"] == "started":
            self._started[name] = time.monotonic()
            post(self.listener, StepStarted(step=step))
        elif event["event"] == "progress":
            post(self.listener, StepProgressed(step=step, detail=event["detail"]))
        elif event["event"] == "line":
            is_error = event["is_error_stream"]
            # From here on ninja writes what a failed program wrote to either stream.
            if event["text"].startswith("FAILED: "):
                self._failing.add(name)
            if is_error or name in self._failing:
                self._error_output.setdefault(name, []).append(event["text"])
            post(self.listener, OutputLine(step=step, text=event["text"], is_error_stream=is_error))
        elif event["event"] == "skipped":
            self.results.append(PackageResult(name=name, outcome="skipped", seconds=0.0))
        elif event["event"] == "ended":
            self._end(name, event["result"])

    def _end(self, name: str, returncode: int | str) -> None:
        outcome = {0: "built", INTERRUPTED: "interrupted"}.get(returncode, "failed")
        seconds = time.monotonic() - self._started[name]
        self.results.append(
            PackageResult(
                name=name,
                outcome=outcome,
                seconds=seconds,
                error_output=tuple(self._error_output.get(name, ())),
                log_folder=self.log_folder,
            )
        )
        post(
            self.listener,
            StepEnded(
                step=(*STEP, name),
                succeeded=outcome == "built",
                seconds=seconds,
                detail="" if outcome == "built" else outcome,
            ),
        )
