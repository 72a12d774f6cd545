"""What is recorded while a launch file is evaluated, in the child process.

There is one record in a process, because launch files make a `LaunchContext` of their own to
perform substitutions, and what these find out belongs to the same plan.

The commands of `Command([...])` are not executed: xacro runs in this process, given by who
evaluates the launch file; a few commands that only read or repeat are done here. The output of
every other one is known only where ROS is.
"""

from __future__ import annotations

import contextlib
import functools
import linecache
import os
import shlex
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from wsgen.isolation import child
from wsgen.launching.commands import requested_texts
from wsgen.model.plan import Origin, Unresolved
from wsgen.text.files import read_regular_text
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from types import FrameType

    from launch.base import Action, BaseEventHandler
    from wsgen.diagnostics import Diagnostic
    from wsgen.launching.live import Live
    from wsgen.model.plan import Include, LaunchArgument, Process

    Location = tuple[str, int]  # file, 1-based line
    CommandRunner = Callable[[Sequence[str]], "CommandOutcome"]


_OF_EXPANSIONS = (  # what is noted while xacro runs
    "texts",
    "opened",
    "lookups",
    "unset",
    "unresolved",
    "diagnostics",
    "unused_xacro_arguments",
    "left_out",
)
_NAME = lazy_pattern(r"[^\W\d]\w*")
_MACHINERY = os.path.dirname(os.path.dirname(__file__)) + os.sep  # all of wsgen
_NOT_THE_USERS = (_MACHINERY, "<frozen importlib")


class ForkError(Exception):
    """The launch file forks; raised in it, and reported."""


class NotPlainError(BaseException):
    """What is to be evaluated may leave something behind; see `launch.plain`."""


class UnknownText(str):
    """A text that stands for something unknown, also after what Python does with it."""

    __slots__ = ()

    def __add__(self, other: str) -> UnknownText:
        return UnknownText(super().__add__(other))

    def __radd__(self, other: str) -> UnknownText:
        return UnknownText(other + str(self))

    def __getitem__(self, key: Any) -> UnknownText:
        if isinstance(key, int) and not -len(self) <= key < len(self):
            raise IndexError(key)  # so that loops over it come to an end
        return self

    def __int__(self) -> int:
        return 0

    def __float__(self) -> float:
        return 0.0

    def _same(self, *_arguments: Any) -> UnknownText:
        return self

    capitalize = casefold = lower = swapcase = title = upper = _same
    lstrip = rstrip = strip = removeprefix = removesuffix = replace = _same


class CommandOutcome:
    """What a command line printed, and the error that xacro found."""

    __slots__ = ("code", "error", "stderr", "stdout", "unused")

    def __init__(
        self,
        stdout: str,
        stderr: str = "",
        code: int = 0,
        error: dict[str, Any] | None = None,
        unused: Sequence[Mapping[str, str]] = (),
    ) -> None:
        self.stdout = stdout
        self.stderr = stderr
        self.code = code
        self.error = error  # message, file, line of the mistake in the user's file
        self.unused = unused  # arguments of xacro: name, message, hint


class ArgumentUse:
    """Which launch arguments are given, and which are declared or read by anybody."""

    def __init__(self) -> None:
        self.declared: dict[str, None] = {}  # in order
        self.read: set[str] = set()
        # By includes: name, line of the include, whether the included file is not installed.
        self.given: list[tuple[str, Location, bool]] = []
        self.not_run: set[object] = set()  # launch files and functions that may yet read any
        self.is_unknown = False  # a package that is not installed takes part, and may read any

    def is_unused(self, name: str) -> bool:
        """Whether the argument is neither declared nor read; False where that is unknown."""
        is_known = not (self.is_unknown or self.not_run)
        return is_known and name not in self.declared and name not in self.read


class Record:
    """What would start, what was included, and what could not be found out."""

    def __init__(self) -> None:
        self.package: str | None = None  # the one whose launch file is evaluated
        self.arguments: dict[str, LaunchArgument] = {}  # declared ones by name, in order
        self.processes: list[Process] = []
        self.includes: list[Include] = []
        self.unresolved: list[Unresolved] = []
        self.diagnostics: list[Diagnostic] = []
        self.launch_files: list[str] = []  # evaluated ones, in order
        self.reading: Location | None = None  # element of an XML or YAML file that is made into one
        self.made_at: tuple[Location | None] | None = None  # what the shim itself makes
        self.run_xacro: CommandRunner | None = None
        self.live: Live | None = None  # starts what is described; None: a plan is made
        self.environment: dict[str, str] = {}  # as it was before the launch file ran
        self.unset: dict[str, Location] = {}  # variables that are None for the user's files
        self.unknown_texts: set[str] = set()  # what stands in texts for what is not known
        self.texts: dict[str, str] = {}  # what files became, see `_fold` -> the file
        self.with_origins = False  # whether what follows is noted
        self.read: dict[str, str] = {}  # absolute paths of files that were read, and their use
        self.made: dict[str, str] = {}  # files that the evaluation writes -> what they are made of
        self.opened: list[str] = []  # robots and worlds that the launch file opened itself
        self.opened_by_xacro: list[str] | None = None  # files and folders; None: it does not run
        self.argument_use = ArgumentUse()
        self.unused_xacro_arguments: list[tuple[Mapping[str, str], Location | None]] = []
        self.visited: Location | None = None  # the line of the entity that is visited
        self.handlers: list[BaseEventHandler] = []  # of events, that were registered in a plan
        self.skipped: list[Action] = []  # visited ones whose condition did not hold
        self.is_cut_short = False  # something ends the launch while more was to come
        self.is_ending = False  # what happens now is what the end of the launch brings about
        # The files that processes would write: path, text, and the xacro file it was made from.
        self.written: dict[str, str] = {}
        self.written_from: dict[str, str] = {}
        self.prompt: str | None = None  # of what the launch file asked last
        self.unanswered = False  # it asks more than there are answers
        self.lookups: dict[str, Location | None] = {}  # packages that the user's files look up
        # Launch files and nodes that are not on this machine: name, package, who asks for them.
        self.left_out: list[tuple[str, str, Location | None]] = []
        # Whether an exception ends only what raised it; the diagnostic is then noted.
        self.ends_branch: Callable[[Exception], bool] = lambda _error: False
        self.plain_file: str | None = None  # the launch file, where who asks has checked it
        self.is_shared = False  # the process evaluates other launch files, too
        self.is_refused = False  # this one needs a process of its own

    def forget(self) -> None:
        """Make it as new, for another launch file."""
        vars(self).clear()
        vars(self).update(vars(Record()))

    @contextlib.contextmanager
    def apart(self) -> Iterator[Record]:
        """Give what an expansion notes in this context, without what was noted before it.

        At the end it is added to what was noted before.
        """
        noted = Record()
        before = {name: vars(self)[name] for name in _OF_EXPANSIONS}
        vars(self).update({name: vars(noted)[name] for name in _OF_EXPANSIONS})
        try:
            yield noted
        finally:
            vars(self).update(before)
            self._add(noted)

    def _add(self, noted: Record) -> None:
        self.texts.update(noted.texts)
        self.opened.extend(noted.opened)
        self.unset.update(noted.unset)
        self.left_out.extend(noted.left_out)
        self.unused_xacro_arguments.extend(noted.unused_xacro_arguments)
        for package, location in noted.lookups.items():
            self.lookups.setdefault(package, location)
        self.unresolved.extend(one for one in noted.unresolved if one not in self.unresolved)
        for diagnostic in noted.diagnostics:
            self.report(diagnostic)

    def require_plain(self, is_plain: Callable[[], bool]) -> None:
        """Refuse to execute what is not plain in a process that is shared."""
        if self.is_shared and not is_plain():
            self.is_refused = True
            raise NotPlainError

    def report(self, diagnostic: Diagnostic) -> None:
        """Note a diagnostic, unless the same was noted of the same thing."""
        key = (diagnostic.code, diagnostic.element or diagnostic.message)
        if key not in {(one.code, one.element or one.message) for one in self.diagnostics}:
            self.diagnostics.append(diagnostic)

    def note_unresolved(self, what: str, why: str, location: Location | None) -> None:
        """Note a value that only a real ROS could give."""
        file, line = split_location(location)
        entry = Unresolved(what=what, why=why, file=file, line=line)
        if entry not in self.unresolved:
            self.unresolved.append(entry)

    def note_unknown(self, what: str, why: str, location: Location | None) -> str:
        """Note a value that only a real ROS could give; gives the text that stands for it."""
        self.note_unresolved(what, why, location)
        text = UnknownText(f"$({what})")
        self.unknown_texts.add(text)
        return text

    def is_unknown(self, text: str) -> bool:
        """Whether a text has one in it that stands for something unknown."""
        return "$(" in text and any(unknown in text for unknown in self.unknown_texts)

    def mark(self, text: str) -> str:
        """The text, marked if it has something unknown in it."""
        return UnknownText(text) if self.is_unknown(text) else text

    def note_unused_xacro_arguments(
        self, unused: Sequence[Mapping[str, str]], location: Location | None = None
    ) -> None:
        """Note the arguments that are given to xacro and that the xacro file does not have."""
        if unused:
            # xacro itself calls this, where a launch file calls xacro.
            place = location or next((one for one in callers() if not _is_of_xacro(one[0])), None)
            self.unused_xacro_arguments += [(argument, place) for argument in unused]

    def note_text(self, text: str, file: str) -> None:
        """Note that a text, as a description of a robot is one, was made from a file."""
        self.texts[_fold(text)] = file

    def source_of(self, text: str) -> str | None:
        """The file that a text was made from; None where that is not known."""
        return self.texts.get(_fold(text))

    def origin(self, location: Location | None) -> Origin | None:
        """A place, as plans have it; None where it is not known or nobody asked for it."""
        if location is None or not self.with_origins:
            return None
        return Origin(file=Path(location[0]), line=location[1] or None)

    def find_description_files(self) -> None:
        """Note with each process which file the description is of that it is given."""
        for index, process in enumerate(self.processes):
            requested = requested_texts(process.command or ())
            parameters = (
                value
                for name, value in process.parameters.items()
                if not name.endswith("_semantic")  # of MoveIt
            )
            for value in (*parameters, *process.arguments, *requested):
                if isinstance(value, str) and value.lstrip().startswith("<"):
                    file = self._file_of(_fold(value))
                    self.processes[index] = replace(
                        process, description_file=None if file is None else Path(file)
                    )

    def _file_of(self, text: str) -> str | None:
        if text in self.texts:
            return self.texts[text]
        for file in dict.fromkeys(self.opened):
            with contextlib.suppress(OSError, ValueError):
                self.texts.setdefault(_fold(read_regular_text(Path(file))), file)
        self.opened.clear()  # reading them was seen as well
        return self.texts.get(text)

    def changed_environment(self) -> dict[str, str]:
        """Variables that differ now from what they were before the launch file ran."""
        before, now = self.environment, child.copy_environment()
        if now == before:
            return {}
        return {name: value for name, value in now.items() if before.get(name) != value}


def _fold(text: str) -> str:
    """The text without the layout that YAML takes away where it reads it."""
    return " ".join(text.split())


RECORD = Record()


def split_location(location: Location | None) -> tuple[Path | None, int | None]:
    """File and line of a place, both None where it is not known."""
    return (None, None) if location is None else (Path(location[0]), location[1])


def caller() -> Location | None:
    """The line that called into the shim; None where no line of the user did."""
    if RECORD.reading is not None:
        return RECORD.reading
    if RECORD.made_at is not None:
        return RECORD.made_at[0]
    return _find_line(sys._getframe(1))[0]  # noqa: SLF001  no stack has to be built for it


def callers() -> Iterator[Location]:
    """The lines of the user's files, and of libraries, that are being executed, innermost first."""
    frame: FrameType | None = sys._getframe(1)  # noqa: SLF001  same
    while frame is not None:
        found, frame = _find_line(frame)
        if found is not None:
            yield found


def _find_line(frame: FrameType | None) -> tuple[Location | None, FrameType | None]:
    """The line of a frame, or of the first of its callers that is none of wsgen's.

    The frame that called it comes back, too; both are None where no line is the user's.
    """
    first, known = child.first_frame(), _namespaces
    while frame is not first and frame is not None:
        # Not by its code at first: who reads that has Python call the audit hook each time.
        names = frame.f_globals
        if id(names) not in known:
            file = frame.f_code.co_filename
            if not _is_machinery(file):
                return (file, frame.f_lineno), frame.f_back
            if vars(sys.modules.get(names.get("__name__", ""), _NO_MODULE)) is names:
                known[id(names)] = names
        frame = frame.f_back
    return None, None


_NO_MODULE = ModuleType("")
_namespaces: dict[int, Mapping[str, Any]] = {}  # of modules that are none of the user's, by id


def _is_of_xacro(file: str) -> bool:
    xacro = sys.modules.get("xacro")
    folder = os.path.dirname(getattr(xacro, "__file__", None) or "")
    return bool(folder) and os.path.dirname(file) == folder


@functools.cache
def _is_machinery(file: str) -> bool:
    return file.startswith(_NOT_THE_USERS)


def locate(error: BaseException, fallback: Location | None) -> None:
    """Attach to an exception the line of the user's files that it is about, once."""
    if hasattr(error, "wsgen_location"):
        return
    location = last_user_line(error) or fallback
    if location is not None:
        error.wsgen_location = location  # type: ignore[attr-defined]


def last_user_line(error: BaseException) -> Location | None:
    """The deepest line of a launch file in the exception's traceback."""
    found = None
    step = error.__traceback__
    while step is not None:
        file = step.tb_frame.f_code.co_filename
        if file in RECORD.launch_files:
            found = (file, step.tb_lineno)
        step = step.tb_next
    return found


def unknown_in_line(error: BaseException) -> str | None:
    """The unknown value that the deepest line of a launch file works with, where it failed.

    Misspelled names fail with any value.
    """
    step, found = error.__traceback__, None
    while step is not None and not isinstance(error, (NameError, SyntaxError, ImportError)):
        code = step.tb_frame.f_code
        if code.co_filename in RECORD.launch_files:
            line = linecache.getline(code.co_filename, step.tb_lineno)
            values = {**step.tb_frame.f_globals, **step.tb_frame.f_locals}
            named = [values[name] for name in _NAME.findall(line) if name in values]
            found = next((repr(value) for value in named if _is_unknown(value)), None)
        step = step.tb_next
    return found


def _is_unknown(value: Any) -> bool:
    is_text = isinstance(value, str) and RECORD.is_unknown(value)
    return is_text or hasattr(type(value), "wsgen_is_unknown")


# The blank is missing between xacro and the file.
_GLUED = lazy_pattern(r"xacro\S+\.(?:xacro|urdf|xml)")


def run_command(words: Sequence[str], location: Location | None) -> CommandOutcome:
    """What a command line prints; for a plan, a placeholder where that cannot be known."""
    if not words:
        return CommandOutcome("", stderr="the command line is empty", code=127)
    xacro = xacro_words(words)
    if xacro is not None and RECORD.run_xacro is not None:
        RECORD.lookups.setdefault("xacro", location)
        outcome = RECORD.run_xacro(xacro)
        RECORD.note_unused_xacro_arguments(outcome.unused, location)
        return outcome
    if _GLUED.fullmatch(words[0]):
        why = f"no program is named '{words[0]}'"
        return CommandOutcome("", stderr=why, code=127, error={"glued": words[0]})
    return _run_other(words, location) if RECORD.live is None else RECORD.live.run_command(words)


def _run_other(words: Sequence[str], location: Location | None) -> CommandOutcome:
    program = os.path.basename(words[0])
    if program == "cat":
        return _cat(words[1:])
    if program == "echo":
        return CommandOutcome(" ".join(words[1:]) + "\n")
    line = shlex.join(words)
    why = "commands other than xacro and cat are not executed"
    return CommandOutcome(RECORD.note_unknown(line, why, location))


def xacro_words(words: Sequence[str]) -> list[str] | None:
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
            text += read_regular_text(Path(file))
            RECORD.note_text(text, os.path.abspath(file))
        except OSError as error:  # noqa: PERF203  each file may fail
            return CommandOutcome(
                "",
                stderr=f"cat: {file}: {error.strerror}",
                code=1,
                error={"message": f"cat: {file}: {error.strerror}", "missing": file},
            )
    return CommandOutcome(text)
