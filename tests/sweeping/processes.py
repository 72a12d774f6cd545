"""Which processes are still there."""

from __future__ import annotations

import time
from pathlib import Path


def is_alive(number: int) -> bool:
    try:
        state = Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


def wait_for(file: Path, seconds: float = 300.0) -> list[int]:
    """The numbers in a file, as soon as there are any."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if file.exists() and (text := file.read_text()):
            return list(map(int, text.split()))
        time.sleep(0.05)
    raise AssertionError(f"{file} is not written")


def have_ended(numbers: list[int], seconds: float = 300.0) -> bool:
    end = time.monotonic() + seconds
    while any(map(is_alive, numbers)) and time.monotonic() < end:
        time.sleep(0.05)
    return not any(map(is_alive, numbers))
