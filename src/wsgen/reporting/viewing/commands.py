"""What the user of a page wants of a simulation."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from wsgen.model.transform import Vector


class Push(NamedTuple):
    """A force that is to act on a robot."""

    entity: str
    link: str | None  # of those that are simulated; None: the root
    force: Vector  # N, in the world
    seconds: float  # simulated


class Step(NamedTuple):
    """So much simulated time is to pass, and then no more."""

    seconds: float


class SetRunning(NamedTuple):
    """The simulation is to go on, or to wait."""

    is_running: bool


class Reset(NamedTuple):
    """Everything is to be as it was at the beginning."""


Command = Push | Step | SetRunning | Reset
