"""What became of a child process: its answer, or how it died."""

from __future__ import annotations

import contextlib
import json
import os
import signal
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

LAST_WORDS = 4000  # characters of the child's output that are worth telling


@dataclass(frozen=True, kw_only=True)
class Limits:
    """How long and how large a child may grow."""

    seconds: float = 60.0  # wall-clock
    memory: int = 4 * 2**30  # bytes of address space, where the system can limit it


DEFAULT_LIMITS = Limits()


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


def conclude(scratch: Path, *, returncode: int) -> Answered | Died:
    """Read what a child that ended by itself left in its scratch folder.

    Args:
        scratch: The folder of its request.
        returncode: Its exit code; negative for the signal that ended it.
    """
    answer = _read_answer(scratch / "answer")
    if answer is None:
        return read_death(scratch, describe_exit(returncode))
    if "value" in answer:
        return Answered(value=answer["value"], output=read_tail(scratch / "output"))
    return read_death(scratch, answer["died"])


def read_death(scratch: Path, reason: str) -> Died:
    """What the child left that died of this."""
    return Died(
        reason=reason, step=read_tail(scratch / "step"), output=read_tail(scratch / "output")
    )


def describe_lateness(limits: Limits) -> str:
    """Say that the time was over."""
    return f"took longer than {limits.seconds:g} s"


def describe_exit(code: int) -> str:
    """Say how a process ended that was to leave something and did not."""
    if code < 0:
        with contextlib.suppress(ValueError):
            return f"crashed ({signal.Signals(-code).name})"
    return f"ended with exit code {code} and no answer"


def read_tail(file: Path) -> str:
    """The end of a text file; empty if there is no file."""
    try:
        with file.open("rb") as stream:
            stream.seek(0, os.SEEK_END)
            stream.seek(max(0, stream.tell() - LAST_WORDS))
            return stream.read().decode("utf-8", "replace").strip()
    except OSError:
        return ""


def _read_answer(file: Path) -> dict[str, Any] | None:
    try:
        answer = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return answer if isinstance(answer, dict) else None
