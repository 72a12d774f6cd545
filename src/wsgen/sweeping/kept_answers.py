"""Reads each mesh file once, however many variants of a robot have it."""

from __future__ import annotations

import pickle
import tempfile
import threading
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.descriptions.meshes import inspection, shape_meshes
from wsgen.isolation.result import DEFAULT_LIMITS, Answered, Died, Limits

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.isolation.parent import Run


TASKS = (inspection.TASK, shape_meshes.TASK)  # take a list and a folder, and answer one by one
MOST = 10_000  # answers that are kept; the files of others are the variant's own


class KeptAnswers:
    """Runs tasks, and answers what was asked before about the same mesh or shape.

    What a child writes for kept answers goes into `folder`, which must be there as long as the
    robots are used. Threads may share it.
    """

    def __init__(self, run: Run, folder: Path) -> None:
        self._run = run
        self._folder = folder
        self._lock = threading.Lock()
        self._kept: dict[tuple[str, bytes], Any] = {}

    @property
    def is_full(self) -> bool:
        """Whether files of further meshes are the variant's own, and are removed with it."""
        return len(self._kept) > MOST

    def run(
        self,
        task: str,
        *arguments: object,
        limits: Limits = DEFAULT_LIMITS,
        environment: Mapping[str, str] | None = None,
        folder: Path | None = None,
    ) -> Answered | Died:
        """Call a task in a child, or answer what it has answered before; see `parent.run`."""
        if task not in TASKS or self.is_full:
            return self._run(
                task, *arguments, limits=limits, environment=environment, folder=folder
            )
        asked: list[object] = list(arguments[0])  # type: ignore[call-overload]
        keys = [(task, pickle.dumps(one)) for one in asked]
        with self._lock:
            new = [place for place, key in enumerate(keys) if key not in self._kept]
        if new:
            outcome = self._run(
                task,
                [asked[place] for place in new],
                Path(tempfile.mkdtemp(prefix="meshes-", dir=self._folder)),
                limits=limits,
                environment=environment,
                folder=folder,
            )
            if isinstance(outcome, Died):  # its step is the place of what it died of
                is_place = outcome.step.isdecimal()
                return replace(outcome, step=str(new[int(outcome.step)])) if is_place else outcome
            with self._lock:
                for place, answer in zip(new, outcome.value, strict=True):
                    self._kept.setdefault(keys[place], answer)
        return Answered(value=[self._kept[key] for key in keys], output="")
