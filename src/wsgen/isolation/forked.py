"""Fork a child process from this one, which saves starting an interpreter for it.

What this process has imported, the child has too, and shares its memory. That is for tasks whose
modules are mostly imported here anyway; on Linux only, and while this process has one thread.
"""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
import time
import traceback
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from wsgen.isolation import child, parent
from wsgen.text.files import forget_remembered

if TYPE_CHECKING:
    from collections.abc import Mapping


ENDING = frozenset({signal.SIGINT, signal.SIGTERM, signal.SIGHUP})
FIRST_WAIT, LONGEST_WAIT = 0.0005, 0.05  # s, wall-clock, between two looks whether it has ended


class ForkedProcess:
    """A child that was forked, with what `parent.end` uses of `subprocess.Popen`."""

    def __init__(self, pid: int) -> None:
        self.pid = pid
        self.returncode: int | None = None  # negative for the signal that ended it

    def poll(self) -> int | None:
        """Its exit code; None while it runs."""
        if self.returncode is None:
            try:
                reaped, status = os.waitpid(self.pid, os.WNOHANG)
            except ChildProcessError:
                # Somebody else has asked for its exit code, which subprocess takes for 0, too.
                reaped, status = self.pid, 0
            if reaped:
                self.returncode = os.waitstatus_to_exitcode(status)
        return self.returncode

    def wait(self, timeout: float | None = None) -> int:
        """Wait for its end, at most so many seconds.

        Raises:
            subprocess.TimeoutExpired: It still runs.
        """
        until = None if timeout is None else time.monotonic() + timeout
        pause = FIRST_WAIT
        while (code := self.poll()) is None:
            if until is not None and time.monotonic() > until:
                raise subprocess.TimeoutExpired("forked child", timeout or 0.0)
            time.sleep(pause)
            pause = min(2 * pause, LONGEST_WAIT)
        return code

    def kill(self) -> None:
        """Send it SIGKILL."""
        if self.poll() is None:
            os.kill(self.pid, signal.SIGKILL)


def fork_child(
    request: dict[str, Any],
    *,
    parent_death_pipe: int,
    descriptors: tuple[int, ...] = (),
    environment: Mapping[str, str] | None = None,
    folder: Path | None = None,
) -> ForkedProcess:
    """Fork a child that performs the request, as `parent.start_interpreter` starts one.

    Raises:
        NotReadableError: The memory for it is missing.
    """
    variables = parent.complete(environment)
    # What this process does at these signals, the child must not do in its place.
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
    try:
        pid = os.fork()
        if pid == 0:
            request = {**request, "parent_death_pipe": parent_death_pipe}
            be_child(request, descriptors, variables, folder, before)
    except OSError as error:
        raise parent.not_started(error) from error
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
    return ForkedProcess(pid)


def be_child(
    request: dict[str, Any],
    descriptors: tuple[int, ...],
    environment: Mapping[str, str],
    folder: Path | None,
    signals: set[int],
) -> NoReturn:
    """Be as a new interpreter would be, then perform the request."""
    try:
        gc.freeze()  # otherwise the collector writes to every object, which copies its page
        os.setsid()
        for number in ENDING:
            if signal.getsignal(number) is not signal.SIG_IGN:
                signal.signal(number, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_SETMASK, signals)
        _open_streams(Path(request["scratch"], "output"))
        _leave_files({0, 1, 2, request["parent_death_pipe"], *descriptors})
        forget_remembered()
        child.set_environment(environment)
        if folder is not None:
            os.chdir(folder)
        child.set_search_path(request["path"])
        sys.path_importer_cache.clear()  # otherwise it does not see newer folders
        child.perform(request)
    except BaseException:  # noqa: BLE001  nothing may get to what called for the fork
        traceback.print_exc()
        sys.stderr.flush()
    finally:
        os._exit(1)


def _open_streams(output: Path) -> None:
    """Print to a file, and read nothing."""
    for number, file, flags in (
        (0, Path(os.devnull), os.O_RDONLY),
        (1, output, os.O_WRONLY | os.O_CREAT | os.O_TRUNC),
    ):
        opened = os.open(file, flags)
        os.dup2(opened, number)
        if opened != number:
            os.close(opened)
    os.dup2(1, 2)
    # What the old ones have not written yet is their process's to write.
    sys.stdin = open(0, encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.stdout = open(1, "w", encoding="utf-8", errors="replace", closefd=False)  # noqa: SIM115
    sys.stderr = open(2, "w", encoding="utf-8", errors="backslashreplace", closefd=False)  # noqa: SIM115


def _leave_files(kept: set[int]) -> None:
    """Close the files of the parent but keep their numbers, which its objects may close again."""
    nothing = os.open(os.devnull, os.O_RDONLY)
    for name in os.listdir("/proc/self/fd"):  # noqa: PTH208  quicker
        number = int(name)
        if number != nothing and number not in kept:
            with suppress(OSError):  # the limit of open files is below it by now
                os.dup2(nothing, number, inheritable=False)
