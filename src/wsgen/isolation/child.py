"""What happens in the child process: set the limits, call the function, leave the answer."""

from __future__ import annotations

import importlib
import json
import os
import signal
import sys
import traceback
from contextlib import suppress
from pathlib import Path
from typing import Any

from wsgen.isolation.lifeline import hold

if sys.platform != "win32":
    import resource

OUTPUT_LIMIT = 64 * 2**20  # bytes; a child that prints for ever must not fill the disk

_scratch: Path | None = None


def announce(step: str) -> None:
    """Say what comes now; it is what is reported if the process dies in it."""
    if _scratch is not None:
        _scratch.joinpath("step").write_text(step, encoding="utf-8")


def scratch_folder() -> Path | None:
    """A folder that goes when the process ends, however it ends; None outside of a child."""
    return _scratch


def perform(request: dict[str, Any]) -> None:
    """Do the task and end the process; the answer lies in the scratch folder."""
    global _scratch  # noqa: PLW0603  the process has one task; its functions announce from anywhere
    _scratch = Path(request["scratch"])
    hold(request["lifeline"], signal.SIGKILL)
    _limit(request["memory"], request["cpu_seconds"])
    module, _, function = request["task"].partition(":")
    try:
        answer = {
            "value": getattr(importlib.import_module(module), function)(*request["arguments"])
        }
        text = json.dumps(answer)
    except MemoryError:
        text = json.dumps({"died": "needed more memory than it may have"})
    except Exception as error:  # noqa: BLE001  foreign code may raise anything
        traceback.print_exc()
        text = json.dumps({"died": f"failed ({type(error).__name__}: {error})"})
    answer_file = _scratch / "answer"
    answer_file.with_suffix(".part").write_text(text, encoding="utf-8")
    answer_file.with_suffix(".part").replace(answer_file)
    with suppress(OSError, ValueError):  # the foreign code may have closed them
        sys.stdout.flush()
        sys.stderr.flush()
    # Engines and interpreters of foreign code may crash or wait while they are torn down; the
    # answer is there, so nothing is lost by leaving at once.
    os._exit(0)


def _limit(memory: int, cpu_seconds: int) -> None:
    """Limit address space, CPU time and output where the system knows how."""
    if sys.platform == "win32":
        return
    for kind, amount in (
        (resource.RLIMIT_AS, memory),
        (resource.RLIMIT_CPU, cpu_seconds),
        (resource.RLIMIT_FSIZE, OUTPUT_LIMIT),
        (resource.RLIMIT_CORE, 0),
    ):
        # A hard limit may be lower already, and macOS refuses RLIMIT_AS.
        with suppress(ValueError, OSError):
            resource.setrlimit(kind, (amount, amount))
