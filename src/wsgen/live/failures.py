"""Programs of a live run that have died by themselves with an error.

The launch service notes them in the live folder, and who has started the run says what to correct.
"""

from __future__ import annotations

import json
from contextlib import suppress
from typing import TYPE_CHECKING

from wsgen.isolation.codec import decode, encode
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from pathlib import Path

FILE = "failed.json"  # in the live folder: `FailedPrograms`


@dataclass(frozen=True, kw_only=True)
class FailedProgram:
    """What is known of one."""

    name: str  # as the launch file calls it
    place: str | None = None  # in its source, where that was reported: "line 2 of "
    "src/rover/driver.py"
    is_built: bool = True  # what is corrected there has to be installed
    missing_module: str | None = None  # whose absence has ended it
    is_of_user: bool = True  # it is none of ROS, and none of wsgen


@dataclass(frozen=True, kw_only=True)
class FailedPrograms:
    """All of a run."""

    programs: tuple[FailedProgram, ...] = ()


class Failures:
    """Notes them while the run goes on.

    Args:
        folder: That of the run.
    """

    def __init__(self, folder: Path) -> None:
        self._file = folder / FILE
        self._programs: dict[str, FailedProgram] = {}  # by the name of the process

    def add(self, process: str, program: FailedProgram) -> None:
        """Note one."""
        self._programs[process] = program
        self._write()

    def remove(self, process: str) -> None:
        """Forget one that was started again, and has ended well."""
        if self._programs.pop(process, None) is not None:
            self._write()

    def _write(self) -> None:
        with suppress(OSError):  # a hint depends on it, no more
            failed = FailedPrograms(programs=tuple(self._programs.values()))
            self._file.write_text(encode(failed), encoding="utf-8")


def read_failures(folder: Path) -> tuple[FailedProgram, ...]:
    """Those of the run of a folder."""
    try:
        text = (folder / FILE).read_text(encoding="utf-8")
        return decode(json.loads(text), FailedPrograms).programs
    except (OSError, ValueError):  # none, or on a full disk
        return ()
