"""How programs of a live run end when launch or a terminal tells them to."""

from __future__ import annotations

import signal

ENDING = (signal.SIGINT, signal.SIGTERM)


def raise_when_ended() -> None:
    """From now on, have the first SIGINT or SIGTERM raise KeyboardInterrupt; ignore others then."""
    for number in ENDING:
        signal.signal(number, _interrupt)


def _interrupt(_number: int, _frame: object) -> None:
    ignore_ends()
    raise KeyboardInterrupt


def ignore_ends() -> None:
    """From now on, ignore these signals: the process ends already."""
    for number in ENDING:
        signal.signal(number, signal.SIG_IGN)
