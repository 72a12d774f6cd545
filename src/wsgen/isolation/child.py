"""The work of a child process: set the limits, call the function, write the answer."""

from __future__ import annotations

import _thread
import importlib
import json
import math
import os
import signal
import sys
import time
import traceback
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.isolation.codec import encode
from wsgen.isolation.system import end_tree, end_with_parent_by_thread

try:
    import resource
except ImportError:  # on Windows
    resource = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from types import FrameType

SPARE_CPU_SECONDS = 5  # between the soft and the hard limit
SECONDS_BETWEEN_CHECKS = 0.05
RESIDENT_UNIT = 1 if sys.platform == "darwin" else 1024  # bytes, of `ru_maxrss`

_scratch: Path | None = None
_first_frame: FrameType | None = None
_answering = _thread.allocate_lock()  # who has it answers, and ends the process


def announce(step: str) -> None:
    """Name the next step, which is reported if the process dies in it."""
    if _scratch is not None:
        _scratch.joinpath("step").write_text(step, encoding="utf-8")


def scratch_folder() -> Path | None:
    """Return a folder that is removed when the process ends; None outside of a child."""
    return _scratch


def first_frame() -> FrameType | None:
    """Return the frame below which the task runs; None outside of a child.

    Above it are the first lines of the child or, in one that was forked, those of its parent.
    """
    return _first_frame


_known_environment: tuple[dict[Any, Any], dict[str, str]] = ({}, {})  # encoded, and as texts


def copy_environment() -> dict[str, str]:
    """Return the environment as a dictionary of its own.

    `dict(os.environ)` decodes each name and value, which is done again here only after a change.
    """
    global _known_environment  # noqa: PLW0603  there is one environment
    encoded = os.environ._data  # type: ignore[attr-defined]  # noqa: SLF001  what it decodes
    if encoded != _known_environment[0]:
        _known_environment = encoded.copy(), dict(os.environ)
    return _known_environment[1].copy()


def set_environment(variables: Mapping[str, str]) -> None:
    """Set the environment; writing only what differs is ten times as fast."""
    before = copy_environment()
    for name in before.keys() - variables.keys():
        del os.environ[name]
    for name, value in variables.items():
        if before.get(name) != value:
            os.environ[name] = value


def set_search_path(own: list[str]) -> None:
    """Search modules where wsgen does, then in PYTHONPATH."""
    overlay = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    sys.path[:] = own + [entry for entry in overlay if entry and entry not in own]


def import_modules(names: list[str]) -> None:
    """Import modules: a task, as one that is compiled for another machine may crash.

    Raises:
        ImportError: one cannot be imported.
    """
    for name in names:
        importlib.import_module(name)


def perform(request: dict[str, Any]) -> None:
    """Perform the task, write its answer into the scratch folder, and end the process."""
    # The process has one task; its functions announce from anywhere.
    global _first_frame, _scratch  # noqa: PLW0603
    _first_frame = sys._getframe()  # noqa: SLF001  as `inspect.currentframe`, which loads more
    _scratch = Path(request["scratch"])
    if request["is_guarded"]:
        from wsgen.isolation.guard import stand_guard  # noqa: PLC0415  only on Linux

        stand_guard(request["parent_death_pipe"], request["cpu_seconds"])
    else:
        end_with_parent_by_thread(request["parent_death_pipe"])
        watch(request, _end_at_limit)
    _limit(request["memory"], request["cpu_seconds"], request["output"])
    module, _, function = request["task"].partition(":")
    try:
        value = getattr(importlib.import_module(module), function)(*request["arguments"])
        text = encode({"value": value})
    except MemoryError:
        text = json.dumps({"cause": "memory"})
    except SystemExit:
        raise
    except BaseException as error:  # noqa: BLE001  foreign code may raise anything
        traceback.print_exc()
        reason = f"failed ({type(error).__name__}: {error})"
        text = json.dumps({"died": reason, "cause": "exception"})
    _answer(text)
    with suppress(OSError, ValueError):  # the foreign code may have closed them
        sys.stdout.flush()
        sys.stderr.flush()
    # Engines and interpreters of foreign code may crash or hang at their exit. The answer is
    # written, so the process ends at once.
    os._exit(0)


def _answer(text: str) -> None:
    """Write the answer, the only one of this process."""
    _answering.acquire()
    part = Path(_scratch or "", "answer.part")
    part.write_text(text, encoding="utf-8")
    part.replace(part.with_suffix(""))


def _limit(memory: int, cpu_seconds: float, output: int) -> None:
    """Limit address space, CPU time and output where the system supports it."""
    if resource is None:
        return
    # Python would raise an exception, which foreign code may ignore.
    signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
    whole_seconds = math.ceil(cpu_seconds)
    for kind, soft, hard in (
        (resource.RLIMIT_AS, memory, memory),
        (resource.RLIMIT_CPU, whole_seconds, whole_seconds + SPARE_CPU_SECONDS),
        (resource.RLIMIT_FSIZE, output, output),
        (resource.RLIMIT_CORE, 0, 0),
    ):
        # A hard limit may be lower already, and macOS refuses RLIMIT_AS.
        with suppress(ValueError, OSError):
            resource.setrlimit(kind, (soft, hard))


def _end_at_limit(cause: str) -> None:
    with suppress(OSError):  # a full disk
        _answer(json.dumps({"cause": cause}))
    end_tree(os.getpid())


def watch(request: dict[str, Any], end: Callable[[str], None]) -> None:
    """Start a thread that calls `end` with the cause when a child without a guard exceeds a limit.

    What the child starts counts when the child has waited for it. Code that holds the lock of the
    interpreter holds up the thread, too: it ends at the limit of CPU time of the system (macOS), or
    at that of wall-clock time.
    """

    def check() -> None:
        while (cause := _exceeded(request)) is None:
            time.sleep(SECONDS_BETWEEN_CHECKS)
        end(cause)

    _thread.start_new_thread(check, ())


def _exceeded(request: dict[str, Any]) -> str | None:
    """Return the cause of a `Died` if this process exceeds a limit."""
    if sum(os.times()[:4]) > request["cpu_seconds"]:
        return "cpu time"
    if Path(request["scratch"], "output").stat().st_size > request["output"]:
        return "output"
    if resource is not None:
        resident = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * RESIDENT_UNIT
        return "memory" if resident > request["memory"] else None
    return None
