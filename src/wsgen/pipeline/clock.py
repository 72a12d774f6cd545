"""How long each stage takes, told to whoever listens."""

from __future__ import annotations

import time
from contextlib import contextmanager
from typing import TYPE_CHECKING

from wsgen.events import Listener, StepEnded, StepStarted, post

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

STAGES = ("launch", "expand", "load", "simulate")


class Step:
    """What is being done; whoever does it says when it fails."""

    succeeded = True


class Clock:
    """Wall-clock seconds of the stages of one package."""

    def __init__(self, package: str, listener: Listener | None) -> None:
        self.package = package
        self.listener = listener
        self.started: float | None = None  # with the first step: packages wait for their turn
        self.seconds = dict.fromkeys(STAGES, 0.0)

    @contextmanager
    def step(self, stage: str, detail: str) -> Iterator[Step]:
        """Time what is done inside, and post its beginning and end."""
        if self.started is None:
            self.started = time.perf_counter()
        step = (self.package, stage)
        post(self.listener, StepStarted(step=step, detail=detail))
        started = time.perf_counter()
        running = Step()
        try:
            yield running
        except BaseException:
            running.succeeded = False
            raise
        finally:
            seconds = time.perf_counter() - started
            self.seconds[stage] += seconds
            post(
                self.listener,
                StepEnded(step=step, succeeded=running.succeeded, seconds=seconds, detail=detail),
            )

    def split(self, stage: str, other: str, seconds: float) -> None:
        """Say that so much of a stage's time was spent on what another stage is for."""
        self.seconds[stage] -= seconds
        self.seconds[other] += seconds

    def take(self, seconds: Mapping[str, float]) -> None:
        """Take over what a child has measured more exactly."""
        self.seconds.update({name: seconds[name] for name in STAGES if name in seconds})

    def read(self) -> dict[str, float]:
        """The stages, and the total since the first began."""
        total = 0.0 if self.started is None else time.perf_counter() - self.started
        return {**self.seconds, "total": total}
