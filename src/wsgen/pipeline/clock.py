"""Time the stages of a package and post their progress as events."""

from __future__ import annotations

import threading
import time
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

from wsgen.events import Listener, StepEnded, StepProgressed, StepStarted, post

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path


LOOK_EVERY = 0.2  # s; between two reads of the progress of a child process
DRAW = "draw"
STAGES = ("launch", "expand", "load", "simulate")  # of a validation


class Step:
    """What is being done; set `succeeded` when it fails."""

    succeeded = True
    # Drawing is done within a step, and posted as a separate one.
    drawn = ""  # the names of the files; empty where nothing was to be drawn
    drawing = 0.0  # wall-clock s
    is_drawn = True


class Clock:
    """Wall-clock seconds of the stages of one package."""

    def __init__(self, package: str, listener: Listener | None) -> None:
        self.package = package
        self.listener = listener
        self.before = 0.0  # s
        self.started: float | None = None  # with the first step: packages wait for their turn
        self.seconds = dict.fromkeys(STAGES, 0.0)

    @contextmanager
    def step(self, stage: str, detail: str, *, takes_long: bool = False) -> Iterator[Step]:
        """Time what is done inside, and post its beginning and end."""
        if self.started is None:
            self.started = time.perf_counter()
        step = (self.package, stage)
        post(self.listener, StepStarted(step=step, detail=detail, takes_long=takes_long))
        started = time.perf_counter()
        running = Step()
        try:
            yield running
        except Exception:
            running.succeeded = False
            self._end(step, started, running, detail)
            raise
        # A step that is interrupted does not end.
        self._end(step, started, running, detail)

    def _end(self, step: tuple[str, str], started: float, ended: Step, detail: str) -> None:
        seconds = time.perf_counter() - started
        self.seconds[step[1]] = self.seconds.get(step[1], 0.0) + seconds
        post(
            self.listener,
            StepEnded(
                step=step,
                succeeded=ended.succeeded,
                seconds=seconds - ended.drawing,
                detail=detail,
            ),
        )
        if ended.drawn:
            drawing = StepEnded(
                step=(self.package, DRAW),
                succeeded=ended.is_drawn,
                seconds=ended.drawing,
                detail=ended.drawn,
            )
            post(self.listener, drawing)

    @contextmanager
    def watch(self, stage: str, file: Path | None) -> Iterator[None]:
        """Post the progress that a child process writes to a file, while it runs."""
        if self.listener is None or file is None:
            yield
            return
        done = threading.Event()
        watcher = threading.Thread(target=self._watch, args=(stage, file, done), daemon=True)
        watcher.start()
        try:
            yield
        finally:
            done.set()
            watcher.join()

    def _watch(self, stage: str, file: Path, done: threading.Event) -> None:
        posted = ""
        while not done.wait(LOOK_EVERY):
            with suppress(OSError):  # the file is not written yet
                text = file.read_text(encoding="utf-8")
                if text not in {"", posted}:
                    posted = text
                    post(self.listener, StepProgressed(step=(self.package, stage), detail=text))

    def add(self, stage: str, seconds: float) -> None:
        """Add what a stage took before the first step."""
        self.seconds[stage] += seconds
        self.before += seconds

    def split(self, stage: str, other: str, seconds: float) -> None:
        """Move so many seconds from one stage to another."""
        self.seconds[stage] -= seconds
        self.seconds[other] += seconds

    def take(self, seconds: Mapping[str, float]) -> None:
        """Take over what a child has measured more exactly."""
        self.seconds.update({name: seconds[name] for name in STAGES if name in seconds})

    def read(self) -> dict[str, float]:
        """The stages, and the total since the first began."""
        total = 0.0 if self.started is None else time.perf_counter() - self.started
        return {**self.seconds, "total": self.before + total}
