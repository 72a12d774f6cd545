"""Start a child process, wait for its answer, and say how it died if there is none."""

from __future__ import annotations

import contextlib
import json
import math
import os
import pickle
import signal
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.errors import NotReadableError
from wsgen.isolation.lifeline import open_lifeline

if TYPE_CHECKING:
    from collections.abc import Mapping

BOOTSTRAP = str(Path(__file__).with_name("bootstrap.py"))
SPARE_CPU_SECONDS = 5  # above the wall-clock limit: whatever becomes of the parent, it ends
LAST_WORDS = 4000  # characters of the child's output that are worth telling

# Numerical libraries start a thread for every core when they are imported; nothing here uses
# them, and without them numpy is imported in half the CPU time.
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}


@dataclass(frozen=True, kw_only=True)
class Limits:
    """How long and how large a child may grow."""

    seconds: float = 60.0  # wall-clock
    memory: int = 4 * 2**30  # bytes of address space, where the system can limit it


@dataclass(frozen=True, kw_only=True)
class Answered:
    """The function returned."""

    value: Any  # as JSON gives it back
    output: str  # the last of what Python and C code printed meanwhile


@dataclass(frozen=True, kw_only=True)
class Died:
    """The function did not return."""

    reason: str  # goes on after "it": "took longer than 60 s", "crashed (SIGSEGV)"
    step: str  # what the child had announced that it was doing; may be empty
    output: str  # its last words


def run(
    task: str,
    *arguments: object,
    limits: Limits = Limits(),
    environment: Mapping[str, str] | None = None,
    folder: Path | None = None,
) -> Answered | Died:
    """Call `module:function` with the arguments in a fresh interpreter.

    The arguments travel pickled (they are ours); the answer travels as JSON, because nothing that
    foreign code had its hands on is unpickled. `environment` replaces the child's environment;
    the module search path stays wsgen's own, with the environment's PYTHONPATH behind it, so that
    a sourced ROS of another Python cannot put its modules in the place of wsgen's. `folder` is the
    child's working directory.

    The child and its children end with the call and with this process, however it ends.
    """
    variables = os.environ if environment is None else environment
    with tempfile.TemporaryDirectory(prefix="wsgen-") as scratch, open_lifeline() as lifeline:
        request = {
            "task": task,
            "arguments": arguments,
            "memory": limits.memory,
            "cpu_seconds": math.ceil(limits.seconds) + SPARE_CPU_SECONDS,
            "lifeline": lifeline,
            "path": [entry for entry in sys.path if entry],
            "scratch": scratch,
        }
        with Path(scratch, "output").open("wb") as output:
            try:
                child = subprocess.Popen(
                    [sys.executable, "-I", BOOTSTRAP],
                    stdin=subprocess.PIPE,
                    stdout=output,
                    stderr=subprocess.STDOUT,
                    cwd=folder,
                    env={**variables, **ONE_THREAD},
                    pass_fds=(lifeline,),
                    start_new_session=True,  # so that its own children can be ended with it
                )
            except OSError as error:
                raise NotReadableError(
                    f"A child process could not be started: {error.strerror}.",
                    hint="Check that the working folder exists and that memory is free.",
                ) from error
        out_of_time = False
        try:
            # A child that dies before it has read the request is seen by its exit code.
            with contextlib.suppress(BrokenPipeError):
                child.communicate(pickle.dumps(request), timeout=limits.seconds)
        except subprocess.TimeoutExpired:
            out_of_time = True
        finally:
            _end(child)
        output_tail = _read_tail(Path(scratch, "output"))
        answer = _read_answer(Path(scratch, "answer"))
        if answer is not None and "value" in answer and not out_of_time:
            return Answered(value=answer["value"], output=output_tail)
        if out_of_time:
            reason = f"took longer than {limits.seconds:g} s"
        elif answer is not None:
            reason = answer["died"]
        else:
            reason = _describe_exit(child.returncode)
        return Died(reason=reason, step=_read_tail(Path(scratch, "step")), output=output_tail)


def _end(child: subprocess.Popen[bytes]) -> None:
    """End the child and every process it started; nothing outlives the call."""
    if hasattr(os, "killpg"):
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(child.pid, signal.SIGKILL)
    else:
        child.kill()
    child.wait()


def _describe_exit(code: int) -> str:
    if code < 0:
        with contextlib.suppress(ValueError):
            return f"crashed ({signal.Signals(-code).name})"
    return f"ended with exit code {code} and no answer"


def _read_answer(file: Path) -> dict[str, Any] | None:
    try:
        answer = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return answer if isinstance(answer, dict) else None


def _read_tail(file: Path) -> str:
    try:
        with file.open("rb") as stream:
            stream.seek(0, os.SEEK_END)
            stream.seek(max(0, stream.tell() - LAST_WORDS))
            return stream.read().decode("utf-8", "replace").strip()
    except OSError:
        return ""
