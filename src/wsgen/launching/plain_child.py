"""Children that evaluate many plain launch files and xacro files, one after another.

Starting a process for a launch file takes longer than most evaluations. A plain one leaves nothing
behind in its process (`launch.plain`), so that the next one can be evaluated there. What is not
plain, what fails, and what the child dies of, is evaluated in a process of its own.
"""

from __future__ import annotations

import sys
import threading
from contextlib import AbstractContextManager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.isolation import parent
from wsgen.isolation.channel import Channel
from wsgen.isolation.result import DEFAULT_LIMITS, Answered, Died, Limits
from wsgen.launching.commands_of_child import EVALUATE, EXPAND
from wsgen.launching.evaluate import LIMITS, TASK
from wsgen.launching.plain import MOST_BYTES, is_plain
from wsgen.model.plan import LaunchRequest
from wsgen.text.files import read_regular

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import TracebackType

    from wsgen.isolation.parent import Run


SERVE = "wsgen.pipeline.tasks.launch:serve_plain_launches"
TASK_OF_XACRO = "wsgen.descriptions.xacro.expansion:expand_for_parent"
SECONDS = 5.0  # CPU time; what takes longer gets a process, and more time, of its own
# What somebody else imported here is not what a launch file is to meet in a child.
FOREIGN = frozenset(("ament_index_python", "launch", "launch_ros", "xacro"))
MOST_DEATHS = 3  # then each launch file gets a process of its own


class PlainLaunches(AbstractContextManager["PlainLaunches"]):
    """A context manager whose `run` does what the given one does, and plain launch files faster.

    Threads may share it: each has a child. `end` has calls that wait come back.
    """

    def __init__(self, run: Run, *, is_forked: bool = False) -> None:
        """Children are forked from this process where `is_forked`, and where that can be."""
        self._run = run
        self._is_forked = is_forked
        self._children: dict[int, Channel] = {}  # by the threads that use them
        self._lock = threading.Lock()
        self._deaths = 0
        self._has_ended = False

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.end()
        for child in self._children.values():
            child.close()

    def end(self) -> None:
        """End the children; afterwards none is started."""
        with self._lock:
            self._has_ended = True
            for child in self._children.values():
                child.end()

    def run(
        self,
        task: str,
        *arguments: object,
        limits: Limits = DEFAULT_LIMITS,
        environment: Mapping[str, str] | None = None,
        folder: Path | None = None,
    ) -> Answered | Died:
        """Call `module:function` with the arguments in a child; see `parent.run`."""
        outcome = None
        if task == TASK and folder is None:
            (request,) = arguments
            if isinstance(request, LaunchRequest) and _is_plain(request):
                outcome = self._call(EVALUATE, request, parent.complete(environment))
        elif task == TASK_OF_XACRO:
            place = str(Path.cwd() / (folder or ""))
            outcome = self._call(EXPAND, *arguments, parent.complete(environment), place)
        if outcome is not None:
            return outcome
        return self._run(task, *arguments, limits=limits, environment=environment, folder=folder)

    def _call(self, command: str, *arguments: object) -> Answered | None:
        """What the child of this thread answers; None where a process of its own is needed."""
        child = self._child()
        if child is None:
            return None
        outcome = child.call(command, *arguments, seconds=SECONDS)
        if isinstance(outcome, Answered):
            return None if outcome.value is None else outcome
        with self._lock:
            self._deaths += 1
            del self._children[threading.get_ident()]
        child.close()
        return None

    def _child(self) -> Channel | None:
        """The child of this thread."""
        with self._lock:
            if self._has_ended or self._deaths >= MOST_DEATHS:
                return None
            here = threading.get_ident()
            child = self._children.get(here)
            if child is None:
                is_forked = self._is_forked and sys.modules.keys().isdisjoint(FOREIGN)
                child = Channel(SERVE, memory=LIMITS.memory, is_forked=is_forked)
                self._children[here] = child
            return child


def _is_plain(request: LaunchRequest) -> bool:
    if request.answers or request.only_arguments or request.with_origins:
        return False
    if request.launch_file.suffix in {".xml", ".yaml", ".yml"}:
        return True
    with suppress(OSError):
        return is_plain(read_regular(request.launch_file, MOST_BYTES))
    return False
