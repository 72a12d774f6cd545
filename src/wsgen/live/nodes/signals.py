"""How programs of a live run end when launch or a terminal asks them to."""

from __future__ import annotations

import signal

ENDING = (signal.SIGINT, signal.SIGTERM)
SECONDS_UNTIL_AGAIN = 1.0  # after an end that has not come


def raise_when_ended() -> None:
    """From now on, have the first SIGINT or SIGTERM raise KeyboardInterrupt; ignore others then.

    Python drops what is raised in finalizers and in callbacks from C: it is raised again until
    `ignore_ends` is called, as who catches it does first.
    """
    for number in ENDING:
        signal.signal(number, _interrupt)


def _interrupt(_number: int, _frame: object) -> None:
    _take_ends()
    signal.signal(signal.SIGALRM, _interrupt)
    signal.setitimer(signal.ITIMER_REAL, SECONDS_UNTIL_AGAIN)
    raise KeyboardInterrupt


def _take_ends() -> None:
    """Do nothing at these signals.

    Of one that has come, and is yet to be handled, Python prints an error if it is ignored now.
    """
    for number in ENDING:
        signal.signal(number, lambda _number, _frame: None)


def ignore_ends() -> None:
    """From now on, ignore these signals: the process ends already."""
    _take_ends()
    for number in ENDING:
        signal.signal(number, signal.SIG_IGN)
    signal.setitimer(signal.ITIMER_REAL, 0.0)
