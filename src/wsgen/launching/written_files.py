"""What processes write that expand a xacro file into another file, such as a world.

xacro runs in this process, and the text stays in the plan. Only what lies in the folder for
temporary files is written there too, because the launch file may read it; it is removed in the end.
"""

from __future__ import annotations

import contextlib
import os
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.launching.commands import shell_commands
from wsgen.launching.record import RECORD, xacro_words

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.launching.record import CommandOutcome, Location
    from wsgen.model.plan import Process


_SHELLS = ("sh", "bash")
_copies: list[Path] = []


class XacroError(Exception):
    """A process that expands a xacro file fails."""

    def __init__(self, outcome: CommandOutcome) -> None:
        super().__init__(outcome.stderr.strip())
        self.wsgen_outcome = outcome  # says which file it is about


def note(process: Process, location: Location | None, *, shell: bool) -> None:
    """Note the files that a process writes if it is xacro; raises XacroError where that fails."""
    words = list(process.command or ())
    if process.package == "xacro":
        words = [process.executable or "", *process.arguments]
    for command in _commands(words, shell=shell):
        xacro = xacro_words(command)
        output = None if xacro is None else _take_output(xacro)
        if xacro is None or output is None or RECORD.run_xacro is None:
            continue
        unknown = [word for word in (*xacro, output) if RECORD.is_unknown(word)]
        if unknown:
            RECORD.note_unresolved(shlex.join(command), "a part of it is not known", location)
        if not all(":=" in word for word in unknown):
            continue
        RECORD.lookups.setdefault("xacro", location)
        xacro = [word for word in xacro if word not in unknown]  # the defaults of the xacro file
        outcome = RECORD.run_xacro(xacro)
        RECORD.note_unused_xacro_arguments(outcome.unused, location)
        if outcome.code != 0:
            raise XacroError(outcome)
        _write(output, outcome.stdout)


def _commands(words: list[str], *, shell: bool) -> Iterator[list[str]]:
    """The command lines of a process; those that a shell would run, one by one."""
    line = " ".join(words) if shell else None
    if len(words) > 2 and os.path.basename(words[0]) in _SHELLS and words[1] == "-c":  # noqa: PLR2004
        line = words[2]
    if line is None:
        yield words
        return
    for command in shell_commands(line):
        yield [os.path.expanduser(os.path.expandvars(word)) for word in command]


def _take_output(words: list[str]) -> str | None:
    """Take the file that xacro writes out of its words; None if it writes to standard output."""
    for index, word in enumerate(words[:-1]):
        if word in {"-o", ">"}:
            output = words[index + 1]
            del words[index : index + 2]
            return output
    return None


def _write(output: str, text: str) -> None:
    import tempfile

    path, source = os.path.abspath(output), RECORD.source_of(text)
    RECORD.written[path] = text
    if source is not None:
        RECORD.written_from[path] = source
    if Path(output).is_relative_to(tempfile.gettempdir()) and not os.path.exists(path):
        with contextlib.suppress(OSError):
            Path(path).write_text(text, encoding="utf-8")
            _copies.append(Path(path))


def remove_copies() -> None:
    """Remove what was written for the evaluation; to be called when that is over."""
    RECORD.is_ending = False
    while _copies:
        _copies.pop().unlink(missing_ok=True)
