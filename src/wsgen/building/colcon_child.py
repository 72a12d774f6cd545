"""The process that colcon runs in: a script with the module search path and colcon's arguments.

Standard input is the parent-death pipe. Standard output carries the events to wsgen, as JSON lines;
the output of colcon itself goes to standard error.

colcon takes event handlers from the entry points of installed distributions. The one that writes
the events is only useful in this process. It is not installed as an entry point, which every plain
`colcon` would load, but offered by a distribution that exists only in this process.
"""

from __future__ import annotations

import gc
import json
import os
import signal
import sys
from importlib.metadata import Distribution, DistributionFinder
from typing import TYPE_CHECKING, Any

from colcon_core.command import main
from colcon_core.event.job import JobEnded, JobProgress, JobSkipped, JobStarted
from colcon_core.event.output import StderrLine, StdoutLine
from colcon_core.event_handler import EventHandlerExtensionPoint
from colcon_core.executor import Job
from colcon_core.location import get_log_path
from colcon_core.plugin_system import satisfies_version

from wsgen.building.toolchain import ignore_python_environments, set_package_environments
from wsgen.isolation.system import end_tree, end_with_parent, take_parent_death_pipe

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping


sys.path[:] = json.loads(sys.argv[1])
events = os.fdopen(os.dup(1), "w", encoding="utf-8")
os.dup2(2, 1)


class EventWriter(EventHandlerExtensionPoint):  # type: ignore[misc]  # colcon is not typed
    """Writes each event to show as one JSON object on a line."""

    def __init__(self) -> None:
        super().__init__()
        satisfies_version(EventHandlerExtensionPoint.EXTENSION_POINT_VERSION, "^1.0")
        self._is_log_known = False

    def __call__(self, event: tuple[Any, ...]) -> None:
        """Write the event; `event[0]` says what happened, `event[1]` is the job."""
        data = event[0]
        if isinstance(data, JobStarted):
            self._write_log_path()
            self._write({"event": "started", "package": data.identifier})
        elif isinstance(data, JobProgress):
            self._write({"event": "progress", "package": data.identifier, "detail": data.progress})
        elif isinstance(data, (StdoutLine, StderrLine)):
            self._write(
                {
                    "event": "line",
                    "package": str(event[1]),
                    "text": _decode(data.line).rstrip(),
                    "is_error_stream": isinstance(data, StderrLine),
                }
            )
        elif isinstance(data, JobEnded):
            self._write({"event": "ended", "package": data.identifier, "result": data.rc})
        elif isinstance(data, JobSkipped):
            self._write({"event": "skipped", "package": data.identifier})

    def _write_log_path(self) -> None:
        if not self._is_log_known:
            self._is_log_known = True
            path = get_log_path()
            self._write({"event": "log", "path": None if path is None else str(path.absolute())})

    def _write(self, event: Mapping[str, object]) -> None:
        try:
            events.write(json.dumps(event) + "\n")
            events.flush()
        except BrokenPipeError:
            # wsgen has ended, perhaps killed, so the build must end, too.
            end_tree(os.getpid(), signal.SIGINT)


def _decode(line: bytes | str) -> str:
    return line.decode("utf-8", "replace") if isinstance(line, bytes) else line


class _Offer(Distribution):
    """A distribution of one entry point."""

    def read_text(self, filename: str) -> str | None:
        return {
            "METADATA": "Metadata-Version: 2.1\nName: wsgen-events\nVersion: 1\n",
            "entry_points.txt": "[colcon_core.event_handler]\n"
            f"wsgen = {__name__}:{EventWriter.__name__}\n",
        }.get(filename)

    def locate_file(self, path: Any) -> Any:
        raise FileNotFoundError(path)  # it has no files


class _Finder(DistributionFinder):
    """Finds this distribution, and no module."""

    def find_spec(self, *_arguments: object) -> None:
        return None

    def find_distributions(
        self, context: DistributionFinder.Context | None = None
    ) -> Iterator[Distribution]:
        if context is None or context.name in {None, "wsgen-events"}:
            yield _Offer()


# Not SIGKILL: make and compilers remove unfinished files.
end_with_parent(take_parent_death_pipe(), signal.SIGTERM)

# The process is short, and importing colcon creates enough objects to keep the collector busy.
gc.disable()

set_package_environments(os.environ)
ignore_python_environments()
run_job = Job.__call__


async def run_to_its_end(job: Job) -> int:
    """Let a package fail whose task raises: colcon would give up all others, too."""
    try:
        await run_job(job)
    except Exception:  # noqa: BLE001  the job has reported it
        return 1
    return int(job.returncode)


Job.__call__ = run_to_its_end
sys.meta_path.append(_Finder())
sys.argv[:2] = ["colcon"]  # the name in its messages
sys.exit(main(argv=sys.argv[1:]))
