"""What the commands of `Command([...])` print; none of them is executed.

xacro runs in this process, given by who evaluates the launch file. A few commands that only read
or repeat are done here. The output of every other one is known only where ROS is.
"""

from __future__ import annotations

import os
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.launch.record import RECORD, CommandOutcome

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.launch.record import Location


def run(words: Sequence[str], location: Location | None) -> CommandOutcome:
    """What a command line prints; a placeholder where that cannot be known."""
    if not words:
        return CommandOutcome("", stderr="the command line is empty", code=127)
    xacro = _xacro_words(words)
    if xacro is not None and RECORD.run_xacro is not None:
        outcome = RECORD.run_xacro(xacro)
        RECORD.note_unused_xacro_arguments(outcome.unused, location)
        return outcome
    program = os.path.basename(words[0])
    if program == "cat":
        return _cat(words[1:])
    if program == "echo":
        return CommandOutcome(" ".join(words[1:]) + "\n")
    line = shlex.join(words)
    why = "commands other than xacro and cat are not executed"
    return CommandOutcome(RECORD.note_unknown(line, why, location))


def _xacro_words(words: Sequence[str]) -> list[str] | None:
    """The words from `xacro` on, however it is started."""
    for start in (("ros2", "run", "xacro"), ("python3", "-m"), ("python", "-m"), ()):
        rest = words[len(start) :]
        begins = [os.path.basename(word) for word in words[:1]] + list(words[1 : len(start)])
        is_start = not start or begins == list(start)
        if is_start and rest and os.path.basename(rest[0]) in {"xacro", "xacro.py"}:
            return list(rest)
    return None


def _cat(files: Sequence[str]) -> CommandOutcome:
    text = ""
    for file in files:
        try:
            text += Path(file).read_text(encoding="utf-8")
            RECORD.note_text(text, os.path.abspath(file))
        except OSError as error:  # noqa: PERF203  each file may fail
            return CommandOutcome(
                "",
                stderr=f"cat: {file}: {error.strerror}",
                code=1,
                fault={"message": f"cat: {file}: {error.strerror}", "missing": file},
            )
    return CommandOutcome(text)
