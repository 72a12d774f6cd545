"""Expand xacro files, in the calling process; the one place that imports xacro.

xacro keeps its state in module globals, so they are set back before each run. A xacro file may
hold expressions that never end: call this in a child process (`wsgen.isolation`).
"""

from __future__ import annotations

import contextlib
import io
import os
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import xacro

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence


class CommandResult(NamedTuple):
    """What the xacro command line does."""

    stdout: str
    stderr: str
    code: int
    fault: dict[str, Any] | None = None  # see `find_fault`


class Watch:
    """Sees what xacro does from now on in this process, also when a launch file calls it itself.

    `note` is given every text that an expanded document is written as, with the file it came from.
    """

    def __init__(self, note: Callable[[str, str], None]) -> None:
        self.seconds = 0.0  # wall-clock, spent in xacro so far
        self._note = note
        self._is_running = False
        self._parse = xacro.parse
        xacro.parse = self._timed(self._parse_and_watch)
        xacro.process_doc = self._timed(xacro.process_doc)

    def _parse_and_watch(self, inp: Any, filename: Any = None) -> Any:
        document = self._parse(inp, filename)
        file = getattr(inp, "name", None) if filename is None else filename
        if isinstance(file, (str, os.PathLike)) and document is not inp:
            path = str(Path(xacro.root_dir, file).absolute())
            document.wsgen_file = path  # for who explains what is wrong in it
            write = self._timed(document.toprettyxml)

            def write_and_note(*arguments: Any, **keywords: Any) -> Any:
                text = write(*arguments, **keywords)
                self._note(text if isinstance(text, str) else text.decode(), path)
                return text

            document.toprettyxml = write_and_note  # `toxml` calls it too
        return document

    def _timed(self, function: Callable[..., Any]) -> Callable[..., Any]:
        def timed(*arguments: Any, **keywords: Any) -> Any:
            if self._is_running:
                return function(*arguments, **keywords)
            self._is_running = True
            started = time.perf_counter()
            try:
                return function(*arguments, **keywords)
            finally:
                self._is_running = False
                self.seconds += time.perf_counter() - started

        return timed


def expand(file: Path, mappings: Mapping[str, str]) -> CommandResult:
    """Expand a xacro file with these arguments, whose values may be any text.

    `stdout` is the URDF where `code` is 0; else `fault` says what is wrong with which file.
    """
    return _run([str(file)], mappings)


def expand_for_parent(file: str, mappings: Mapping[str, str]) -> dict[str, Any]:
    """`expand` in a child process; gives the fields of the result by name."""
    return expand(Path(file), mappings)._asdict()


def run_command(words: Sequence[str]) -> CommandResult:
    """Do what the command line `xacro …` does; the first word is the program."""
    return _run(words[1:], {})


def _run(words: Sequence[str], mappings: Mapping[str, str]) -> CommandResult:
    _reset()
    stdout, stderr = io.StringIO(), io.StringIO()
    fault = None
    with contextlib.redirect_stdout(stdout), contextlib.redirect_stderr(stderr):
        try:
            options, file = xacro.process_args(list(words))
            code, fault = _process(file, options, mappings)
        except SystemExit as end:  # the option parser leaves like this
            code = end.code if isinstance(end.code, int) else 1
        except RuntimeError as error:  # an argument that is no name:=value
            sys.stderr.write(f"{error}\n")
            code = 1
    return CommandResult(stdout.getvalue(), stderr.getvalue(), code, fault)


def _process(
    file: str, options: Any, mappings: Mapping[str, str]
) -> tuple[int, dict[str, Any] | None]:
    """Expand and write, as `xacro.main` does, and keep the exception that it only prints."""
    options.mappings = {**options.mappings, **mappings}
    xacro.root_dir = options.root_dir or os.curdir
    try:
        document = xacro.process_file(file, **vars(options))
    except Exception as error:  # noqa: BLE001  expressions in xacro files raise anything
        sys.stderr.write(f"error: {error}\n")
        if options.verbosity:
            xacro.print_location()
        return 2, find_fault(error) or {"message": str(error) or repr(error), "file": file}
    if options.just_deps:
        text = " ".join(sorted(set(xacro.all_includes)))
    else:
        text = document.toprettyxml(indent="  ")
    if options.output:
        Path(options.output).write_text(text, encoding="utf-8")
    else:
        sys.stdout.write(text)
    return 0, None


def _reset() -> None:
    """Set back what one expansion leaves for the next."""
    xacro.init_stacks(None)
    xacro.all_includes.clear()
    xacro.substitution_args_context.clear()
    xacro.verbosity = 1
    xacro.root_dir = os.curdir


def find_fault(error: BaseException) -> dict[str, Any] | None:
    """What an exception that xacro raised is about; None for any other exception.

    The keys are those of `wsgen.description.xacro_fault`.
    """
    # Read where something is wrong only, that is, seldom.
    from wsgen.description.xacro_fault import explain  # noqa: PLC0415

    read = (*reversed(xacro.filestack or ()), *reversed(xacro.all_includes))
    return explain(error, [file and str(Path(xacro.root_dir, file)) for file in read])
