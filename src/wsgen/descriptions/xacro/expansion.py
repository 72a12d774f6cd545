"""Expand xacro files, in the calling process; the one place that imports xacro.

xacro keeps its state in module globals, so they are set back before each run. A xacro file may
hold expressions that never end: call this in a child process (`wsgen.isolation`).
"""

from __future__ import annotations

import contextlib
import functools
import importlib
import io
import os
import sys
import time
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple
from xml.parsers.expat import ExpatError

import xacro

from wsgen.descriptions.xacro.result import Expansion, ExpansionError, UnusedArgument
from wsgen.packages.source_shares import note_use
from wsgen.text.files import read_regular, refuse_irregular
from wsgen.text.xmlsyntax import find_excess

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from wsgen.descriptions.xacro.result import ExpansionRequest


LARGEST = 2**25  # bytes that are looked at before xacro reads them


class _YamlWhenUsed(ModuleType):
    """Stands for yaml, which takes longer to import than most robots to expand."""

    def __getattr__(self, name: str) -> Any:
        return getattr(importlib.import_module("yaml"), name)


def _import_substitution_args() -> Any:
    """Import the module of xacro for `$(…)`, which imports yaml for values that few robots have."""
    if "yaml" in sys.modules:
        return importlib.import_module("xacro.substitution_args")
    sys.modules["yaml"] = _YamlWhenUsed("yaml")
    try:
        return importlib.import_module("xacro.substitution_args")
    finally:
        del sys.modules["yaml"]


_substitution_args = _import_substitution_args()


def _open_regular(file: Any, mode: str = "r", **keywords: Any) -> Any:
    """`open`, which waits for no named pipe and reads no device."""
    if "r" in mode:
        refuse_irregular(file)
    return open(file, mode, **keywords)  # noqa: PTH123  what xacro calls


xacro.open = _open_regular  # what it finds before the built-in one
_parse_any = xacro.parse


def _parse_usual(inp: Any, filename: Any = None) -> Any:
    """`xacro.parse`, which makes no tree of what is larger than anything that people write."""
    if inp is None:
        with contextlib.suppress(OSError, ValueError):
            data = read_regular(Path(xacro.root_dir, filename), LARGEST)
            mistake = find_excess(data, with_depth=True)
            if mistake is not None:
                error = ExpatError(mistake.message)
                error.lineno = mistake.line
                raise error
    return _parse_any(inp, filename)


xacro.parse = _parse_usual


class CommandResult(NamedTuple):
    """What the xacro command line does."""

    stdout: str
    stderr: str
    code: int
    error: dict[str, Any] | None = None  # see `explain_error`
    unused: Sequence[dict[str, str]] = ()  # see `_Arguments.find_unused`
    arguments: Mapping[str, str] | None = None  # see `_Arguments.asked`


class Watch:
    """Records what xacro does from now on in this process, also when a launch file calls it itself.

    `note` is given every text that an expanded document is written as, with the file it came from.
    `note_unused` is given the arguments that a launch file gives to xacro and no xacro file uses.
    """

    def __init__(
        self,
        note: Callable[[str, str], None],
        note_unused: Callable[[Sequence[dict[str, str]]], None],
    ) -> None:
        self.seconds = 0.0  # wall-clock, spent in xacro so far
        self._note = note
        self._note_unused = note_unused
        self._is_running = False
        self._parse = xacro.parse
        xacro.parse = self._timed(self._parse_and_watch)
        self._process = xacro.process_doc
        xacro.process_doc = self._timed(self._process_and_watch)
        self._main = xacro._process  # noqa: SLF001  what `xacro.process` calls
        xacro._process = self._process_without_exit  # noqa: SLF001  same

    def _parse_and_watch(self, inp: Any, filename: Any = None) -> Any:
        document = self._parse(inp, filename)
        file = getattr(inp, "name", None) if filename is None else filename
        if isinstance(file, (str, os.PathLike)) and document is not inp:
            path = str(Path(xacro.root_dir, file).absolute())
            document.wsgen_file = path  # for the explanation of an error in it
            write = self._timed(document.toprettyxml)

            def write_and_note(*arguments: Any, **keywords: Any) -> Any:
                text = write(*arguments, **keywords)
                self._note(text if isinstance(text, str) else text.decode(), path)
                return text

            document.toprettyxml = write_and_note  # `toxml` calls it too
        return document

    def _process_and_watch(self, doc: Any, mappings: Any = None, **keywords: Any) -> None:
        if not isinstance(mappings, dict) or isinstance(mappings, _Arguments):
            self._process(doc, mappings, **keywords)
            return
        arguments = _Arguments(mappings)
        self._process(doc, arguments, **keywords)
        mappings.update(arguments)  # as xacro does
        self._note_unused(arguments.find_unused())

    def _process_without_exit(self, *arguments: Any) -> None:
        """Raise the error after which xacro would print it and end the process."""
        try:
            self._main(*arguments)
        except SystemExit as end:
            sys.stdout = sys.__stdout__  # xacro has put another one in its place
            raise (end.__context__ or end) from None

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


class _Arguments(dict[str, str]):
    """The arguments that are given to xacro; remembers which of them a xacro file asks for."""

    def __init__(self, given: Mapping[str, str]) -> None:
        super().__init__(given)
        self._given = tuple(given)
        self._asked: set[str] = set()

    def __contains__(self, name: object) -> bool:  # <xacro:arg>
        self._asked.add(str(name))
        return super().__contains__(name)

    def __getitem__(self, name: str) -> str:  # $(arg)
        self._asked.add(name)
        return super().__getitem__(name)

    def asked(self) -> dict[str, str]:
        """The arguments that a xacro file declares, with their values."""
        return {name: value for name, value in self.items() if name in self._asked}

    def find_unused(self) -> list[dict[str, str]]:
        """The given arguments that no file names: each with name, message and hint.

        To be called while xacro still knows which files it has read.
        """
        unused = [name for name in self._given if name not in self._asked]
        if not unused:
            return []
        # Imported only after an error, that is, seldom.
        from wsgen.descriptions.xacro.explanation import unused_arguments  # noqa: PLC0415

        return unused_arguments(unused, self._asked, _files_read())


def expand(file: Path, mappings: Mapping[str, str]) -> CommandResult:
    """Expand a xacro file with these arguments, whose values may be any text.

    `stdout` is the URDF where `code` is 0; otherwise `error` explains the error.
    """
    return _run([str(file)], mappings)


def expand_for_parent(request: ExpansionRequest) -> Expansion | ExpansionError:
    """`expand` in a child process, which may expand any number of files."""
    _note_finds_once()
    result = expand(Path(request.file), request.arguments)
    if result.code == 0:
        unused = tuple(UnusedArgument(**one) for one in result.unused)
        return Expansion(urdf=result.stdout, unused=unused, arguments=result.arguments or {})
    error = result.error or {"message": result.stderr.strip()}
    fields = ExpansionError.__dataclass_fields__
    return ExpansionError(**{name: error[name] for name in fields if name in error})


@functools.cache
def _note_finds_once() -> None:
    """Note which packages `$(find …)` looks up; launch files have their own way to find them."""
    find = _substitution_args._eval_find  # noqa: SLF001  xacro has no hook for it

    def find_and_note(package: str) -> str:
        share: str = find(package)
        note_use(package, os.environ)
        return share

    _substitution_args._eval_find = find_and_note  # noqa: SLF001  same
    _substitution_args._eval_dict["find"] = find_and_note  # noqa: SLF001  of $(eval …)


def run_command(words: Sequence[str], *, rewrite: Callable[[str], str] = str) -> CommandResult:
    """Do what the command line `xacro …` does; the first word is the program.

    The expanded text goes through `rewrite`.
    """
    return _run(words[1:], {}, rewrite)


def _run(
    words: Sequence[str], mappings: Mapping[str, str], rewrite: Callable[[str], str] = str
) -> CommandResult:
    reset()
    stdout, stderr = io.StringIO(), io.StringIO()
    error = None
    unused: list[dict[str, str]] = []
    values: dict[str, str] = {}
    with contextlib.redirect_stdout(stdout), contextlib.redirect_stderr(stderr):
        try:
            options, file = xacro.process_args(list(words))
            arguments = options.mappings = _Arguments({**options.mappings, **mappings})
            code, error = _process(file, options, rewrite)
            unused = [] if code else arguments.find_unused()
            values = arguments.asked()
        except SystemExit as end:  # the option parser leaves like this
            code = end.code if isinstance(end.code, int) else 1
        except RuntimeError as refusal:  # an argument that is no name:=value
            sys.stderr.write(f"{refusal}\n")
            code = 1
    return CommandResult(stdout.getvalue(), stderr.getvalue(), code, error, unused, values)


def _process(
    file: str, options: Any, rewrite: Callable[[str], str]
) -> tuple[int, dict[str, Any] | None]:
    """Expand and write, as `xacro.main` does, and keep the exception that it only prints."""
    xacro.root_dir = options.root_dir or os.curdir
    try:
        document = xacro.process_file(file, **vars(options))
    except Exception as error:  # noqa: BLE001  expressions in xacro files raise anything
        sys.stderr.write(f"error: {error}\n")
        if options.verbosity:
            xacro.print_location()
        return 2, explain_error(error) or {"message": str(error) or repr(error), "file": file}
    if options.just_deps:
        text = " ".join(sorted(set(xacro.all_includes)))
    else:
        text = rewrite(document.toprettyxml(indent="  "))
    if options.output:
        Path(options.output).parent.mkdir(parents=True, exist_ok=True)
        Path(options.output).write_text(text, encoding="utf-8")
    else:
        sys.stdout.write(text)
    return 0, None


def reset() -> None:
    """Set back what one expansion leaves for the next."""
    xacro.init_stacks(None)
    xacro.all_includes.clear()
    xacro.substitution_args_context.clear()
    xacro.verbosity = 1
    xacro.root_dir = os.curdir


def explain_error(error: BaseException) -> dict[str, Any] | None:
    """Explain an exception that xacro raised; None for any other exception.

    The keys are those of `wsgen.descriptions.xacro.explanation.Explanation`.
    """
    # Imported only after an error, that is, seldom.
    from wsgen.descriptions.xacro.explanation import explain  # noqa: PLC0415

    explanation = explain(error, _files_read())
    return None if explanation is None else dict(explanation)


def _files_read() -> list[str]:
    """The files that xacro has read, the one that it is in first."""
    read = (*reversed(xacro.filestack or ()), *reversed(xacro.all_includes))
    return [file and str(Path(xacro.root_dir, file)) for file in read]


# What most robots are written with: properties, arguments, conditions, macros with blocks, math.
_WARM_UP = """<?xml version="1.0"?>
<robot name="robot" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="mass" default="1.5"/>
  <xacro:property name="mass" value="$(arg mass)"/>
  <xacro:property name="size" value="0.1 ${2 * mass} 0.3"/>
  <xacro:macro name="part" params="name parent:=^ length:=${mass / 3} side *origin **content">
    <link name="${name}_link">
      <inertial><mass value="${mass * length}"/><xacro:insert_block name="origin"/></inertial>
      <xacro:if value="${side == 1}">
        <collision><geometry><box size="${size}"/></geometry></collision>
      </xacro:if>
      <xacro:unless value="${side == 1 and length > 0}"><xacro:insert_block name="content"/>
      </xacro:unless>
    </link>
  </xacro:macro>
  <xacro:property name="parent" value="base"/>
  <xacro:part name="left" side="${1}"><origin xyz="0 ${sin(pi / 2) * mass} 0"/>
    <extra><visual/></extra></xacro:part>
  <xacro:part name="right" side="${-1}"><origin xyz="0 ${cos(radians(30)) * mass} 0"/>
    <extra><visual/></extra></xacro:part>
</robot>
"""


def warm_up() -> None:
    """Expand a small robot: what Python prepares at first use, forked children then have.

    A fork server calls it before it forks. It halves the CPU time of a child.
    """
    for _ in range(3):
        reset()
        document = xacro.parse(_WARM_UP)
        xacro.process_doc(document, mappings=_Arguments({}))
        document.toprettyxml(indent="  ")
    reset()
