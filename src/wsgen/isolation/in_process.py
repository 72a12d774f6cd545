"""Run a task in this process, which already is a child, as `parent.run` does in a new one."""

from __future__ import annotations

import importlib
import os
import sys
import traceback
from contextlib import suppress
from typing import TYPE_CHECKING

from wsgen.isolation import child
from wsgen.isolation.result import DEFAULT_LIMITS, Answered, Died, Limits, read_tail

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path


def run_here(
    task: str,
    *arguments: object,
    limits: Limits = DEFAULT_LIMITS,  # noqa: ARG001  those of this process hold
    environment: Mapping[str, str] | None = None,  # noqa: ARG001  likewise
    folder: Path | None = None,  # noqa: ARG001  likewise
) -> Answered | Died:
    """Call `module:function` with the arguments; the answer is what it returns, as it is.

    Its output is what has been printed since the call, in a child that `isolation` started. What
    kills the process kills the caller, and a lack of memory is raised: after it nothing in the
    process can be relied on.

    Raises:
        MemoryError: The task needs more memory than the process may have.
    """
    module, _, function = task.partition(":")
    _forget_output()
    try:
        value = getattr(importlib.import_module(module), function)(*arguments)
    except MemoryError:
        raise
    except Exception as error:  # noqa: BLE001  engines may raise anything
        traceback.print_exc()
        reason = f"failed ({type(error).__name__}: {error})"
        step = _read("step")
        return Died(reason=reason, step=step, output=_read_output(), cause="exception")
    return Answered(value=value, output=_read_output())


def _read(name: str) -> str:
    scratch = child.scratch_folder()
    return "" if scratch is None else read_tail(scratch / name)


def _read_output() -> str:
    _flush()
    return _read("output")


def _forget_output() -> None:
    """Empty the file that this process prints to: its size is limited, and it is one run's."""
    scratch = child.scratch_folder()
    if scratch is None:
        return
    _flush()
    with suppress(OSError):  # foreign code may have closed it
        if os.fstat(1).st_size and os.path.samestat(os.fstat(1), (scratch / "output").stat()):
            os.lseek(1, 0, os.SEEK_SET)
            os.ftruncate(1, 0)


def _flush() -> None:
    with suppress(OSError, ValueError):
        sys.stdout.flush()
        sys.stderr.flush()
