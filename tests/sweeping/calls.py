"""What children of executors are asked to do."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

_seen: list[str] = []  # what this process has been asked before


def double(number: float) -> float:
    return 2 * number


def own_id() -> int:
    return os.getpid()


def say(words: str) -> list[str]:
    """All that this process was ever told."""
    _seen.append(words)
    return _seen


def length(value: Mapping[str, str]) -> int:
    return len(value["text"])


def identity_of(value: object) -> int:
    """The same number for as long as the process keeps the value."""
    return id(value)


def content(value: Mapping[str, str]) -> Mapping[str, str]:
    """The content of the file that a value names, and where it is."""
    return {"text": Path(value["file"]).read_text(), "place": value["file"]}


def crash() -> None:
    os.kill(os.getpid(), signal.SIGSEGV)


def crash_first(marker: str) -> int:
    """Crash unless another process has."""
    if not Path(marker).exists():
        Path(marker).touch()
        crash()
    return os.getpid()


def crash_and_count(marker: str) -> None:
    with Path(marker).open("a") as stream:
        stream.write("x")
    crash()


def work_without_end() -> None:
    while True:
        pass


def grow() -> int:
    return len(bytearray(8 << 30))


def wrong() -> None:
    raise ValueError("It is wrong.")


def start_and_wait(marker: str) -> None:
    """Start a process, write its number and the own one, and wait."""
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
    Path(marker).write_text(f"{os.getpid()} {child.pid}")
    time.sleep(600)


def end_worker() -> None:
    """Kill the worker of Dask, which is the parent of the guard of this process."""
    guard = Path(f"/proc/{os.getppid()}/stat").read_text().rpartition(")")[2].split()
    os.kill(int(guard[1]), signal.SIGKILL)
    time.sleep(60)


def end_worker_first(marker: str) -> str:
    """The same, unless another process has."""
    if not Path(marker).exists():
        Path(marker).touch()
        end_worker()
    return "done"
