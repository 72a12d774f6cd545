"""An event handler inside colcon that writes its events as JSON lines for `wsgen build`.

colcon takes event handlers from the entry points of installed distributions. This handler is only
useful in the process that `wsgen build` starts. It is not installed as an entry point, which every
plain `colcon` would load, but offered by a distribution that exists only in that process.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from importlib.metadata import Distribution, DistributionFinder
from typing import TYPE_CHECKING, Any, TextIO

from colcon_core.event.job import JobEnded, JobProgress, JobSkipped, JobStarted
from colcon_core.event.output import StderrLine, StdoutLine
from colcon_core.event_handler import EventHandlerExtensionPoint
from colcon_core.location import get_log_path
from colcon_core.plugin_system import satisfies_version

from wsgen.isolation.system import end_tree

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping


_stream: TextIO = sys.stdout


def write_events_to(stream: TextIO) -> None:
    """Offer the handler to colcon, and let it write to the stream."""
    global _stream  # noqa: PLW0603  colcon creates the handler without arguments
    _stream = stream
    sys.meta_path.append(_Finder())


class EventWriter(EventHandlerExtensionPoint):  # type: ignore[misc]  # colcon is not typed
    """Writes each event to show as one JSON object on a line."""

    def __init__(self) -> None:
        super().__init__()
        satisfies_version(EventHandlerExtensionPoint.EXTENSION_POINT_VERSION, "^1.0")
        self._stream = _stream
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
            self._stream.write(json.dumps(event) + "\n")
            self._stream.flush()
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
