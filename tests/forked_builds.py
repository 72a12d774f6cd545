"""`wsgen build` in tests, forked from a process that has imported what colcon imports, too.

It forks colcon from itself: from a server, colcon would not become its child.
"""

from __future__ import annotations

import atexit
import os
import signal
import subprocess
import sys
import traceback
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, NoReturn

import forks
from building import forked_colcon
from wsgen.building import colcon
from wsgen.isolation import system
from wsgen.isolation.forked import ENDING, ForkedProcess

if TYPE_CHECKING:
    from collections.abc import Sequence


OWN = frozenset({"wsgen", "forks", "build"})  # what that interpreter imports itself, or never


class ColconOfThisProcess(forked_colcon.ForkedColcon):
    """What `wsgen.building.colcon` uses of `subprocess.Popen`."""

    @staticmethod
    def _fork(order: dict[str, Any], files: list[int]) -> ForkedProcess:
        sys.stdout.flush()  # otherwise both processes write what is not written yet
        sys.stderr.flush()
        before = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
        try:
            pid = os.fork()
            if pid == 0:
                _be_colcon(order, files, before)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        return ForkedProcess(pid)


def start(command: Sequence[str], **options: Any) -> object:
    """Start colcon, as a fork where that can be."""
    kind = ColconOfThisProcess if system.can_fork() else subprocess.Popen
    return kind(command, **options)


def _be_colcon(order: dict[str, Any], files: list[int], signals: set[int]) -> NoReturn:
    """Be as the interpreter that wsgen would start, without what wsgen has imported of itself."""
    code: object = 1
    try:
        for number in ENDING:
            signal.signal(number, signal.SIG_DFL)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.pthread_sigmask(signal.SIG_SETMASK, signals)
        atexit._clear()
        for name in [one for one in sys.modules if one.partition(".")[0] in OWN]:
            del sys.modules[name]
        forked_colcon.become(order, files)
    except SystemExit as end:
        code = 0 if end.code is None else end.code
    except BaseException:  # noqa: BLE001  nothing may get to what called for the fork
        traceback.print_exc()
    finally:
        forks.end_process(code)


if __name__ == "__main__":
    forked_colcon.import_libraries()
    starting = SimpleNamespace(
        Popen=start, PIPE=subprocess.PIPE, TimeoutExpired=subprocess.TimeoutExpired
    )
    vars(colcon)["subprocess"] = starting
    forks.main()
