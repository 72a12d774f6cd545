"""Start a child process, and return its answer or how it died."""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from wsgen.errors import NotReadableError
from wsgen.isolation.parent_death import open_parent_death_pipe
from wsgen.isolation.result import (
    DEFAULT_LIMITS,
    OUTPUT_LIMIT,
    Answered,
    Died,
    Limits,
    conclude,
    read_lateness,
)

if TYPE_CHECKING:
    from collections.abc import Mapping


__all__ = ["Answered", "Died", "Limits", "run"]

BOOTSTRAP = str(Path(__file__).with_name("bootstrap.py"))
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
) -> Answered | Died:
    """Call `module:function` with the arguments in a fresh interpreter.

    The arguments are pickled, as they are ours. The answer is JSON, because data that foreign code
    has touched must not be unpickled. `environment` replaces the child's environment. The module
    search path stays that of wsgen, followed by PYTHONPATH of the environment, so that a sourced
    ROS of another Python cannot replace modules of wsgen. `folder` is the child's working
    directory.

    The child and its children end with the call and with this process, however it ends.
    """
    with (
        # A process that a killed guard left behind may still write into the folder.
        tempfile.TemporaryDirectory(prefix="wsgen-", ignore_cleanup_errors=True) as name,
        open_parent_death_pipe() as parent_death_pipe,
    ):
        scratch = Path(name)
        request = make_request(task, arguments, limits, scratch, parent_death_pipe)
        child = start_interpreter(
            output=scratch / "output",
            descriptors=(parent_death_pipe,),
            environment=environment,
            folder=folder,
        )
        is_late = False
        try:
            # If the child dies before it has read the request, its exit code shows it.
            with contextlib.suppress(BrokenPipeError):
                child.communicate(pickle.dumps(request), timeout=limits.wall_clock_seconds)
        except subprocess.TimeoutExpired:
            is_late = True
        finally:
            _end(child)
        if is_late:
            return read_lateness(scratch, limits)
        return conclude(scratch, limits, returncode=child.returncode)


def make_request(
    task: str, arguments: tuple[object, ...], limits: Limits, scratch: Path, parent_death_pipe: int
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
        "parent_death_pipe": parent_death_pipe,
    }


def search_path() -> list[str]:
    """Return where this process finds modules, so that a child finds the same ones."""
    return [entry for entry in sys.path if entry]


def start_interpreter(
    *,
    output: Path,
    descriptors: tuple[int, ...],
    environment: Mapping[str, str] | None = None,
    folder: Path | None = None,
) -> subprocess.Popen[bytes]:
    """Start the interpreter of a child, which expects its pickled request on standard input.

    Raises:
        NotReadableError: The folder or the memory for it is missing.
    """
    with output.open("wb") as stream:
        try:
            return subprocess.Popen(
                [sys.executable, "-I", BOOTSTRAP],
                stdin=subprocess.PIPE,
                stdout=stream,
                stderr=subprocess.STDOUT,
                cwd=folder,
                env=complete(environment),
                pass_fds=descriptors,
                start_new_session=True,  # so that its own children can be ended with it
            )
        except OSError as error:
            raise not_started(error) from error


def complete(environment: Mapping[str, str] | None) -> dict[str, str]:
    """Complete the environment of a child; None is that of this process."""
    return {**(os.environ if environment is None else environment), **ONE_THREAD}


def not_started(error: OSError) -> NotReadableError:
    """Make the error for a child that the system refuses to start."""
    return NotReadableError(
        f"A child process could not be started: {error.strerror}.",
        hint="Check that the working folder exists and that memory is free.",
    )


def _end(child: subprocess.Popen[bytes]) -> None:
    """End the child and every process it started; nothing outlives the call."""
    if sys.platform == "linux":
        _end_with_guard(child)
    elif hasattr(os, "killpg"):
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(child.pid, signal.SIGKILL)
    else:
        child.kill()
    child.wait()


def _end_with_guard(guard: subprocess.Popen[bytes]) -> None:
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
