"""What a launch file would start, without starting it."""

from __future__ import annotations

from collections.abc import Mapping  # noqa: TC003  a plan is decoded by its type hints
from dataclasses import field
from pathlib import Path  # noqa: TC003
from typing import Any

from wsgen.diagnostics import Diagnostic  # noqa: TC001
from wsgen.text.values import dataclass


@dataclass(frozen=True, kw_only=True)
class LaunchRequest:
    """A launch file to evaluate."""

    launch_file: Path  # absolute
    package: str | None  # the one whose launch file it is, if that is known
    arguments: Mapping[str, str]
    answers: tuple[str, ...] = ()  # to what the launch file asks on standard input, in order
    only_arguments: bool = False  # ask for the declared arguments, as --show-args does
    with_origins: bool = False  # note where everything is written, and which files are read


@dataclass(frozen=True, kw_only=True)
class Origin:
    """Where something of a plan is written."""

    file: Path
    line: int | None = None  # 1-based; None where it is not known


# Who gives a launch argument its value.
COMMAND_LINE, INCLUDE, DEFAULT, LAUNCH_FILE = "command line", "include", "default", "launch file"
SETTERS = (COMMAND_LINE, INCLUDE, DEFAULT, LAUNCH_FILE)


@dataclass(frozen=True, kw_only=True)
class LaunchArgument:
    """An argument that the launch file declares."""

    name: str
    default: str | None  # None: the caller must give it
    value: str | None  # what it has in this plan; None where it was only asked for
    description: str = ""
    is_conditional: bool = False  # declared only if some condition holds or some event happens
    origin: Origin | None = None  # of its declaration
    set_by: str | None = None  # a member of `SETTERS`; None where it was only asked for
    set_at: Origin | None = None  # where that is written, unless it is the command line


@dataclass(frozen=True, kw_only=True)
class Process:
    """A process that would start; a composable node's container is one too."""

    package: str | None  # None: not a ROS node
    executable: str | None
    name: str | None = None
    namespace: str = ""
    parameters: Mapping[str, Any] = field(default_factory=dict)
    arguments: tuple[str, ...] = ()
    # For each of the arguments the launch configuration that it is the value of, if it is one.
    configurations: tuple[str | None, ...] = ()
    remappings: tuple[tuple[str, str], ...] = ()
    command: tuple[str, ...] | None = None  # of ExecuteProcess
    is_shell: bool = False  # the words of the command, with blanks between them, go to a shell
    environment: Mapping[str, str] = field(default_factory=dict)  # what differs from the launch's
    container: str | None = None  # of a composable node, which is not a process: its host
    starts: str = "launch"  # "launch", "timer 3.0", "exit of NAME", "start of NAME", "shutdown"
    start_time: float = 0.0  # s of virtual time after the launch; others exit without delay
    file: Path | None = None  # the launch file that says so
    line: int | None = None
    # The xacro, URDF or SDF file that the text of a parameter or an argument was made from.
    description_file: Path | None = None
    # Where each parameter, argument and remapping is written, with `LaunchRequest.with_origins`.
    parameter_origins: Mapping[str, Origin] = field(default_factory=dict)  # by name
    argument_origins: tuple[Origin | None, ...] = ()  # of each of the arguments
    remapping_origins: tuple[Origin | None, ...] = ()  # of each of the remappings


@dataclass(frozen=True, kw_only=True)
class Include:
    """A launch file that is included."""

    package: str | None
    file: Path
    arguments: Mapping[str, str] = field(default_factory=dict)
    evaluated: bool = True  # False: the package is not installed, its launch file was not run
    # What a launch file that was not run would have seen: given, inherited and its own defaults.
    configurations: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Lookup:
    """A package of which a launch file looks up a folder or starts a program."""

    package: str
    file: Path  # the launch file
    line: int  # 1-based


@dataclass(frozen=True, kw_only=True)
class FileRead:
    """A file that the evaluation read, or that a process which starts is given."""

    path: Path  # absolute
    use: str  # "launch file", "parameters", "module", "read" or "given"
    sha256: str | None  # of the content, hexadecimal; None where the file cannot be read


# Why something is `Unresolved`: a module; what a module that is absent would start, or say.
ABSENT_MODULE = "its Python module is not installed"
STARTS_UNKNOWN = "what it starts comes from a Python module that is not installed"
OF_ABSENT_MODULE = "it comes from a Python module that is not installed"


@dataclass(frozen=True, kw_only=True)
class Unresolved:
    """Something whose value cannot be known without a real ROS."""

    what: str
    why: str
    file: Path | None = None
    line: int | None = None


@dataclass(frozen=True, kw_only=True)
class LaunchPlan:
    """The outcome of evaluating a launch file."""

    package: str | None
    launch_file: Path
    arguments: tuple[LaunchArgument, ...] = ()
    processes: tuple[Process, ...] = ()
    includes: tuple[Include, ...] = ()
    lookups: tuple[Lookup, ...] = ()  # the first of each package by files of the user
    environment: Mapping[str, str] = field(default_factory=dict)  # what the launch file sets
    # What processes would write that expand a xacro file: absolute path -> text, and -> xacro file.
    written: Mapping[str, str] = field(default_factory=dict)
    written_from: Mapping[str, str] = field(default_factory=dict)
    unresolved: tuple[Unresolved, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()
    files: tuple[FileRead, ...] = ()  # by path, with `LaunchRequest.with_origins`
    unanswered: bool = False  # the launch file asks more than there are answers
    is_complete: bool = True  # False: an error ended the evaluation
    seconds_in_xacro: float = 0.0  # wall-clock, a part of the time that the evaluation took

    @property
    def evaluated_files(self) -> tuple[Path, ...]:
        """The launch files that were run: this one, and those that it includes."""
        included = (include.file for include in self.includes if include.evaluated)
        return tuple(dict.fromkeys((self.launch_file, *included)))

    def is_unknown(self, text: str) -> bool:
        """Whether a text, or a word of one, has something in it that stands for what is unknown."""
        return any(f"{entry.what.split()[-1]})" in text for entry in self.unresolved if entry.what)
