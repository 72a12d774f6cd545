"""The outcome of a child process: its answer, or how it died.

One may die of a compiled module that is not imported, as the system lacks a library that it is
linked to. A wheel holds all its libraries but those that each Linux with a desktop has. A
container, a fresh Debian or a computer in a robot has no desktop.
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from wsgen.errors import EXIT_STOPPED
from wsgen.text.files import explain_write_error, full_folder
from wsgen.text.values import dataclass, lazy_pattern

if TYPE_CHECKING:
    from pathlib import Path


LAST_OUTPUT = 4000  # bytes of the child's output to keep
OUTPUT_LIMIT = 64 * 2**20  # bytes of a file, so that a child cannot fill the disk
# A child that shares its core with eight others takes nine times its CPU time.
WALL_CLOCK_FACTOR = 10.0

STOPPED = "was stopped by SIGSTOP, and nothing would have continued it"  # a reason
WINDOWS_ERRORS = 0xC0000000  # and above: exit codes of processes that Windows ended

Cause = Literal["cpu time", "wall-clock time", "memory", "output", "crash", "exception"]
CAUSES: dict[str | None, Cause] = {"SIGXCPU": "cpu time", "SIGXFSZ": "output"}  # by signal


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Limits of a child's CPU time, wall-clock time and memory."""

    seconds: float = 60.0  # CPU time of the child and of all it starts
    wall_clock: float | None = None  # s, for what sleeps; None: WALL_CLOCK_FACTOR times `seconds`
    memory: int = 4 * 2**30  # bytes of address space, where the system can limit it

    @property
    def wall_clock_seconds(self) -> float:
        """The limit of wall-clock time."""
        return self.seconds * WALL_CLOCK_FACTOR if self.wall_clock is None else self.wall_clock


DEFAULT_LIMITS = Limits()


@dataclass(frozen=True, kw_only=True)
class Answered:
    """The function returned."""

    value: Any  # as JSON returns it
    output: str  # the end of what Python and C code printed


@dataclass(frozen=True, kw_only=True)
class Died:
    """The function did not return."""

    reason: str  # without a subject: "used more than 60 s of CPU time", "crashed (SIGSEGV)"
    step: str  # the last one that the child announced; may be empty
    output: str  # the end of its output
    cause: Cause = "crash"

    def hint(self, otherwise: str) -> str:
        """Return what to do: `otherwise`, unless the cause has its own hint."""
        if self.cause == "wall-clock time":
            return (
                "Try again when the machine is less busy. If it takes as long again, look for code "
                "that sleeps or waits for input, a network or another process."
            )
        if self.cause == "output":
            return "Look for a loop that prints or writes without end."
        if self.reason == STOPPED:
            return "Look for what sends SIGSTOP to its own process."
        missing = find_missing_library(self.reason)
        if missing is not None and missing.command:
            return f"Install {missing.name}: {missing.command}"
        return otherwise


def conclude(scratch: Path, limits: Limits, *, returncode: int) -> Answered | Died:
    """Read the outcome of a child that ended by itself from its scratch folder.

    Args:
        scratch: The folder of its request.
        limits: Its limits.
        returncode: Its exit code; negative for the signal that ended it.

    Raises:
        NotReadableError: The disk of the folder is so full that no answer fits.
    """
    answer = _read_answer(scratch / "answer")
    if answer is None or "value" not in answer:
        full = full_folder(scratch)
        if full is not None:
            raise explain_write_error(full, scratch, what="a temporary file")
    if answer is None:
        return _read_end(scratch, limits, returncode)
    if "value" in answer:
        return Answered(value=answer["value"], output=read_tail(scratch / "output"))
    if "died" in answer:
        return read_death(scratch, answer["died"], answer["cause"])
    return _read_excess(scratch, limits, answer["cause"])


def _read_end(scratch: Path, limits: Limits, returncode: int) -> Died:
    """Read the outcome of a child that ended without an answer."""
    cause = CAUSES.get(_signal_name(returncode))
    if cause is not None:
        return _read_excess(scratch, limits, cause)
    return read_death(scratch, describe_exit(returncode))


def _read_excess(scratch: Path, limits: Limits, cause: Cause) -> Died:
    """Read the outcome of a child that exceeded a limit."""
    reasons: dict[Cause, str] = {
        "cpu time": f"used more than {limits.seconds:g} s of CPU time",
        "output": f"wrote more than {OUTPUT_LIMIT // 2**20} MB to its output or to a file",
        "memory": "exceeded its memory limit",
    }
    return read_death(scratch, reasons[cause], cause)


def read_death(scratch: Path, reason: str, cause: Cause = "crash") -> Died:
    """Read the outcome of a child that died of this reason."""
    return Died(
        reason=reason,
        step=read_tail(scratch / "step"),
        output=read_tail(scratch / "output"),
        cause=cause,
    )


def read_lateness(scratch: Path, limits: Limits) -> Died:
    """Read the outcome of a child that took too long."""
    reason = f"did not end within {limits.wall_clock_seconds:g} s"
    reason += " (it waits for something, or the machine is busy)"
    return read_death(scratch, reason, "wall-clock time")


def describe_exit(code: int) -> str:
    """Describe how a process ended that left no answer."""
    if code == EXIT_STOPPED:
        return STOPPED
    name = f"0x{code:X}" if code >= WINDOWS_ERRORS else _signal_name(code)
    if name is not None:
        return f"crashed ({name})"
    return f"ended with exit code {code} and no answer"


def _signal_name(code: int) -> str | None:
    """Return the name of the signal that ended a process; Windows never does so."""
    with contextlib.suppress(ValueError):
        return signal.Signals(-code).name
    return None


def read_tail(file: Path) -> str:
    """Read the end of a text file; empty if it does not exist."""
    try:
        with file.open("rb") as stream:
            stream.seek(0, os.SEEK_END)
            stream.seek(max(0, stream.tell() - LAST_OUTPUT))
            return stream.read().decode("utf-8", "replace").strip()
    except OSError:
        return ""


def _read_answer(file: Path) -> dict[str, Any] | None:
    try:
        answer = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return answer if isinstance(answer, dict) else None


# Debian's and Ubuntu's package of each library that the wheels for Linux may leave to the system.
DEBIAN_PACKAGES = {
    "libEGL.so.1": "libegl1",
    "libGL.so.1": "libgl1",
    "libGLU.so.1": "libglu1-mesa",
    "libGLX.so.0": "libglx0",
    "libICE.so.6": "libice6",
    "libOpenGL.so.0": "libopengl0",
    "libSM.so.6": "libsm6",
    "libX11.so.6": "libx11-6",
    "libXext.so.6": "libxext6",
    "libXrender.so.1": "libxrender1",
    "libatomic.so.1": "libatomic1",
    "libexpat.so.1": "libexpat1",
    "libgcc_s.so.1": "libgcc-s1",
    "libglib-2.0.so.0": "libglib2.0-0",
    "libgobject-2.0.so.0": "libglib2.0-0",
    "libgomp.so.1": "libgomp1",
    "libgthread-2.0.so.0": "libglib2.0-0",
    "libstdc++.so.6": "libstdc++6",
    "libxcb.so.1": "libxcb1",
    "libz.so.1": "zlib1g",
}
ON_LINUX = lazy_pattern(r"([\w.+-]+\.so[\w.]*): cannot open shared object file")  # of glibc
ON_MACOS = lazy_pattern(r"Library not loaded: (?:\S*/)?(\S+)")
# It names the module, and not what is missing: nearly always the runtime of Microsoft's compiler.
ON_WINDOWS = "DLL load failed while importing"
WINDOWS_RUNTIME = "the Visual C++ runtime"


class MissingLibrary(NamedTuple):
    """A library of the system that a compiled module needs."""

    name: str  # of its file; for people where the message does not have it
    command: str  # that installs it, or finds what to install; empty if none is known

    @property
    def advice(self) -> str:
        """What to do: the command, or to install it in some other way."""
        return self.command or f"Install {self.name}"


def find_missing_library(error: str) -> MissingLibrary | None:
    """Find the library that the text of an ImportError is about; None if it is about another."""
    if ON_WINDOWS in error:
        return MissingLibrary(WINDOWS_RUNTIME, "winget install Microsoft.VCRedist.2015+.x64")
    on_linux = ON_LINUX.search(error)
    if on_linux is not None:
        name = on_linux[1]
        package = DEBIAN_PACKAGES.get(name)
        return MissingLibrary(
            name, f"sudo apt install {package}" if package else f"apt-file search {name}"
        )
    on_macos = ON_MACOS.search(error)
    return None if on_macos is None else MissingLibrary(on_macos[1], "")
