"""What several worker processes of a test run need, made by the one that asks for it first."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if sys.platform == "linux":
    import fcntl

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    import pytest

ROOT = Path(__file__).parents[1]


def made_once(factory: pytest.TempPathFactory, name: str, make: Callable[[Path], object]) -> Path:
    """A folder of this name that `make` has filled, once in a run of tests: no test changes it.

    Who comes second waits. Where `make` fails, the next one who asks tries again.
    """
    shared = factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:  # each worker has a folder below that of the run
        shared = shared.parent
    folder = shared / f"once-{name}"
    with _locked(shared / f"once-{name}.lock"):
        done = shared / f"once-{name}.done"
        if not done.exists():
            folder.mkdir(exist_ok=True)
            make(folder)
            done.touch()
    return folder


def wait_for_unpacking(folder: Path) -> None:
    """Wait for what fills a folder while other tests run: `.ci/run` holds a lock of its name."""
    lock = Path(f"{folder}.lock")
    if lock.exists():
        with _locked(lock):
            pass


@contextlib.contextmanager
def _locked(file: Path) -> Iterator[None]:
    with file.open("w") as held:
        if sys.platform == "linux":
            fcntl.flock(held, fcntl.LOCK_EX)
        yield


def wheel_of_wsgen(factory: pytest.TempPathFactory) -> Path:
    """wsgen as users install it, built from this repository."""

    def build(folder: Path) -> None:
        pip = (sys.executable, "-m", "pip", "--disable-pip-version-check")
        command = [*pip, "wheel", "--quiet", "--no-deps", "-w", str(folder), str(ROOT)]
        subprocess.run(command, check=True, capture_output=True)

    return next(made_once(factory, "wheel", build).glob("wsgen-*.whl"))
