"""Start a child process, and return its answer or how it died.

Scratch folders of processes that were killed are removed, too: a process holds the lock of each of
its folders; the system releases it when the process ends,
however it ends. A folder that nobody holds is nobody's any more.
"""

from __future__ import annotations

import contextlib
import importlib
import os
import pickle
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from wsgen.errors import NotReadableError
from wsgen.isolation import child, system
from wsgen.isolation.result import (
    DEFAULT_LIMITS,
    OUTPUT_LIMIT,
    Answered,
    Died,
    Limits,
    conclude,
    read_lateness,
    read_tail,
)
from wsgen.isolation.system import open_parent_death_pipe

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping


__all__ = ["Answered", "Died", "Limits", "run"]


BOOTSTRAP = str(Path(__file__).with_name("bootstrap.py"))
# Robots are written on Linux, where this is the encoding of files and streams anyway.
UTF_8 = ("-X", "utf8") if sys.platform == "win32" else ()
SECONDS_TO_END = 10.0  # wall-clock, for a guard after SIGTERM

# Numerical libraries start a thread for every core when they are imported. wsgen does not use these
# threads; without them, importing numpy takes half the CPU time.
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}


def run(
    task: str,
    *arguments: object,
    limits: Limits = DEFAULT_LIMITS,
    environment: Mapping[str, str] | None = None,
    folder: Path | None = None,
    on_start: Callable[[subprocess.Popen[bytes]], None] | None = None,
) -> Answered | Died:
    """Call `module:function` with the arguments in a fresh interpreter.

    The arguments are pickled, as they are ours. The answer is JSON, because data that foreign code
    has touched must not be unpickled. `environment` replaces the child's environment. The module
    search path stays that of wsgen, followed by PYTHONPATH of the environment, so that a sourced
    ROS of another Python cannot replace modules of wsgen. `folder` is the child's working
    directory. `on_start` is called with the child, which `end` ends.

    The child and its children end with the call and with this process, however it ends.
    """
    with make_scratch() as scratch, open_parent_death_pipe() as parent_death_pipe:
        child = start_interpreter(
            make_request(task, arguments, limits, scratch),
            parent_death_pipe=parent_death_pipe,
            environment=environment,
            folder=folder,
        )
        is_late = False
        try:
            if on_start is not None:
                on_start(child)
            child.wait(limits.wall_clock_seconds)
        except subprocess.TimeoutExpired:
            is_late = True
        finally:
            end(child)
        if is_late:
            return read_lateness(scratch, limits)
        return conclude(scratch, limits, returncode=child.returncode)


@contextlib.contextmanager
def make_scratch(*, in_memory: bool = False) -> Iterator[Path]:
    """Make a scratch folder, of a child or of a stage; it is removed at the end.

    With `in_memory` it is there, if the system has a place for that and nobody chose another one
    (TMPDIR): for many links, which a disk takes ten times as long to make.

    A signal that arrives while it is made or removed waits until that is done. The first folder of
    a process in a place removes those that killed processes left behind there.
    """
    before = _hold_signals()
    try:
        # A process that a killed guard or server left behind may still write into the folder.
        folder = tempfile.TemporaryDirectory(
            prefix=PREFIX,
            ignore_cleanup_errors=True,
            dir=system.memory_folder() if in_memory else None,
        )
        with held(folder.name):
            try:
                _release_signals(before)
                _remove_stale_once(str(Path(folder.name).parent))
                yield Path(folder.name)
            finally:
                before = _hold_signals()
                folder.cleanup()
    finally:
        _release_signals(before)


@contextlib.contextmanager
def make_part(scratch: Path) -> Iterator[Path]:
    """Make a folder in a scratch folder, which takes a fifth of the time, and remove it."""
    with tempfile.TemporaryDirectory(dir=scratch, ignore_cleanup_errors=True) as folder:
        yield Path(folder)


_cleaned: set[str] = set()  # the places where this process has removed what others left


def _remove_stale_once(place: str) -> None:
    if place not in _cleaned:
        _cleaned.add(place)
        remove_stale(place)


def _hold_signals() -> set[int]:
    """Let signals to this thread wait; returns those that waited before."""
    mask = getattr(signal, "pthread_sigmask", None)  # not on Windows
    return mask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}) if mask else set()


def _release_signals(before: set[int]) -> None:
    mask = getattr(signal, "pthread_sigmask", None)
    if mask:
        mask(signal.SIG_SETMASK, before)


def make_request(
    task: str, arguments: tuple[object, ...], limits: Limits, scratch: Path
) -> dict[str, Any]:
    """Make the request to a child, for either way to start it."""
    return {
        "task": task,
        "arguments": arguments,
        "memory": limits.memory,
        "output": OUTPUT_LIMIT,
        "cpu_seconds": limits.seconds,
        "path": search_path(),
        "scratch": str(scratch),
        "is_guarded": system.has_guards(),
    }


def search_path() -> list[str]:
    """Return where this process finds modules, so that a child finds the same ones."""
    return [entry for entry in sys.path if entry]


def start_interpreter(
    request: dict[str, Any],
    *,
    parent_death_pipe: int,
    descriptors: tuple[int, ...] = (),
    environment: Mapping[str, str] | None = None,
    folder: Path | None = None,
) -> subprocess.Popen[bytes]:
    """Start the interpreter of a child, which reads its request from the scratch folder.

    Raises:
        NotReadableError: The folder or the memory for it is missing.
    """
    scratch = write_request(request)
    with (scratch / "output").open("wb") as stream:
        try:
            return subprocess.Popen(
                [sys.executable, "-I", *UTF_8, BOOTSTRAP, scratch / "request"],
                stdin=parent_death_pipe,
                stdout=stream,
                stderr=subprocess.STDOUT,
                cwd=folder,
                env=complete(environment),
                pass_fds=descriptors,
                # So that its own children can be ended with it. Windows has no sessions: Ctrl-C
                # ends the child, too, for which this process would wait deaf to it.
                start_new_session=True,
            )
        except OSError as error:
            raise not_started(error) from error


def write_request(request: dict[str, Any]) -> Path:
    """Write the request of a child into its scratch folder; return the folder."""
    scratch = Path(request["scratch"])
    scratch.joinpath("request").write_bytes(pickle.dumps(request))
    return scratch


def complete(environment: Mapping[str, str] | None) -> dict[str, str]:
    """Complete the environment of a child; None is that of this process."""
    return {**(os.environ if environment is None else environment), **ONE_THREAD}


def not_started(error: OSError) -> NotReadableError:
    """Make the error for a child that the system refuses to start."""
    return NotReadableError(
        f"A child process could not be started: {error.strerror}.",
        hint="Check that the working folder exists and that memory is free.",
    )


class Process(Protocol):
    """A child: a `subprocess.Popen`, or a `forked.ForkedProcess`."""

    pid: int
    returncode: Any  # None while it runs, or nobody has asked

    def poll(self) -> int | None:
        """Its exit code, None while it runs."""

    def wait(self, timeout: float | None = None) -> int:
        """Wait for its end; `subprocess.TimeoutExpired` after so many seconds."""

    def kill(self) -> None:
        """Send SIGKILL, unless it has ended."""


def end(child: Process) -> None:
    """End the child and every process it started; nothing outlives the call."""
    if system.has_guards():
        _end_with_guard(child)
    elif os.name == "posix" or child.poll() is None:
        system.end_tree(child.pid)
    child.wait()


def _end_with_guard(guard: Process) -> None:
    """Make the guard end its child; a guard that has ended has done so."""
    from wsgen.isolation.guard import end_guard  # noqa: PLC0415  only on Linux

    if guard.poll() is None:
        end_guard(guard.pid)
        with contextlib.suppress(subprocess.TimeoutExpired):
            guard.wait(SECONDS_TO_END)
        guard.kill()


class Run(Protocol):
    """`wsgen.isolation.parent.run`, or the method of that name of a fork server."""

    def __call__(
        self,
        task: str,
        *arguments: object,
        limits: Limits = ...,
        environment: Mapping[str, str] | None = None,
        folder: Path | None = None,
    ) -> Answered | Died:
        """Call `module:function` with the arguments in a child process."""


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


try:
    import fcntl
except ImportError:  # on Windows
    fcntl = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Iterator


PREFIX = "wsgen-held-"  # of names; folders of other programs and versions have others
SECONDS_TO_HOLD = 60.0  # wall-clock, from when a folder is made until it is held
MOST_REMOVED = 50  # at a time


@contextmanager
def held(folder: str) -> Iterator[None]:
    """Hold the lock of a folder; where its file system has none, nobody takes the folder away."""
    descriptor = _lock(folder)
    try:
        yield
    finally:
        if descriptor is not None:
            os.close(descriptor)


def is_held(folder: str) -> bool:
    """Whether a process holds the lock of a folder, which has been held before."""
    descriptor = _lock(folder)
    if descriptor is not None:
        os.close(descriptor)
    return descriptor is None


def remove_stale(place: str) -> None:
    """Remove folders of this user that lie in a folder and that nobody holds."""
    if fcntl is None:
        return
    with suppress(OSError), os.scandir(place) as entries:
        stale = [entry.path for entry in entries if _may_be_stale(entry)]
        removed = 0
        for path in stale:
            descriptor = _lock(path)
            if descriptor is not None:
                shutil.rmtree(path, ignore_errors=True)
                os.close(descriptor)
                removed += 1
            if removed == MOST_REMOVED:
                break


def _may_be_stale(entry: os.DirEntry[str]) -> bool:
    if not entry.name.startswith(PREFIX):
        return False
    try:
        found = entry.stat(follow_symlinks=False)
    except OSError:
        return False
    return (
        entry.is_dir(follow_symlinks=False)
        and found.st_uid == os.getuid()
        and time.time() - found.st_mtime > SECONDS_TO_HOLD
    )


def _lock(folder: str) -> int | None:
    """A descriptor that holds the lock of a folder; None if another one does, or it has none."""
    if fcntl is None:
        return None
    descriptor = None
    try:
        descriptor = os.open(folder, os.O_RDONLY | os.O_NOFOLLOW | os.O_DIRECTORY)
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        if descriptor is not None:
            os.close(descriptor)
        return None
    return descriptor
