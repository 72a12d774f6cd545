"""The worlds that several launch files start: each is read once, with the meshes of its models."""

from __future__ import annotations

import threading
from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterable, Mapping
    from pathlib import Path

    from wsgen.descriptions.sdf.models import SdfFile
    from wsgen.diagnostics import Diagnostic
    from wsgen.pipeline.prepare import PrepareContext, PreparedRobot
    from wsgen.pipeline.started import Started


class ReadWorld(NamedTuple):
    """What is in a world file, and what is reported of the meshes of its models."""

    file: SdfFile
    models: list[PreparedRobot]
    diagnostics: tuple[Diagnostic, ...]


class KnownWorlds:
    """Reads worlds, those that are known only once. Threads may share it.

    Files must not change meanwhile.
    """

    def __init__(self, folder: Path, all_started: Iterable[Started | None]) -> None:
        """`folder` is for files that engines read; it must be there until they have read them.

        Of the worlds, only those are kept that several of the launch files start.
        """
        counts = Counter(one.simulator.world for one in all_started if one and one.simulator)
        self._shared = {name for name, count in counts.items() if count > 1}
        self._folder = folder
        self._lock = threading.Lock()
        self._locks: dict[Hashable, threading.Lock] = {}
        self._read: dict[Hashable, ReadWorld] = {}

    def read(  # noqa: PLR0913, PLR0917  what a world depends on
        self,
        name: str,
        file: Path,
        kind: str | None,
        context: PrepareContext,
        environment: Mapping[str, str],
        read: Callable[[PrepareContext], ReadWorld],
    ) -> ReadWorld:
        """What `read` returns for the world that a launch file calls so."""
        if name not in self._shared:
            return read(context)
        paths = (one for one in environment.items() if one[0].endswith("_PATH") or one[0] == "HOME")
        key = file, kind, context.with_colors, context.with_devices, frozenset(paths)
        with self._lock:
            lock = self._locks.setdefault(key, threading.Lock())
        with lock:  # others wait for the first one
            if key not in self._read:
                self._read[key] = read(replace(context, folder=self._folder))
            return self._read[key]
