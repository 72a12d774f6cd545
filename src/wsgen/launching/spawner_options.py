"""The options of the spawners, read as these programs do.

`spawn_entity.py` (gazebo_ros) reads them with argparse, which takes a value in the word of a short
option, as in `-z 0.5` or `-z0.5`, and the beginning of a long one, as in `-ent`. `create`
(ros_gz_sim) reads them with gflags: `-name value`, `-name=value` or `--name=value`; it ignores what
it does not know. It takes node parameters too, which win over the options. Those of
controller_manager's `spawner` are for checks and for the one of live runs. Source: the programs, of
ros-controls/ros2_control controller_manager/controller_manager/spawner.py (Humble to Kilted).
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn

from wsgen.diagnostics import Rule, Severity
from wsgen.text.suggestions import advice, did_you_mean
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import Process


INVALID_SPAWNER_OPTION = Rule(
    code="SPN004",
    name="invalid-spawner-option",
    severity=Severity.ERROR,
    severity_varies="a warning about an option that `create` ignores",
    summary="The spawner does not accept its options.",
    what="Reads the arguments of `spawn_entity.py` and `create`, and the parameters of `create`, "
    "as these programs do.",
    why="The spawner ends with an error message, and the robot does not appear. `create` ignores "
    "options that it does not know.",
    example="arguments=['-topic', 'robot_description']  # of spawn_entity.py",
    instead="arguments=['-topic', 'robot_description', '-entity', 'my_robot']",
)

POSE = ("x", "y", "z", "R", "P", "Y")
LETTER = 2  # the length of an option of one letter, with which many words begin


class Options(NamedTuple):
    """What a spawner takes."""

    with_value: Mapping[str, str | float | None]  # with what they are without one
    flags: frozenset[str]
    sources: tuple[str, ...]  # what says what is spawned; the first one counts
    entity: str  # the option that names the model
    needs_entity: bool  # else the model has its own name
    is_strict: bool  # refuses unknown options and a second source
    reads_parameters: bool

    @property
    def names(self) -> frozenset[str]:
        """All of them."""
        return self.flags | self.with_value.keys()


SPAWN_ENTITY = Options(
    with_value={
        **dict.fromkeys(("file", "topic", "database", "entity", "wait", "spawn_service_timeout")),
        **dict.fromkeys(("reference_frame", "gazebo_namespace", "robot_namespace"), ""),
        "timeout": 30.0,
        **dict.fromkeys(POSE, 0.0),
    },
    flags=frozenset(("stdin", "unpause", "package_to_model", "b")),
    sources=("file", "topic", "database", "stdin"),
    entity="entity",
    needs_entity=True,
    is_strict=True,
    reads_parameters=False,
)
CREATE = Options(
    with_value=dict.fromkeys(
        ("world", "file", "param", "string", "topic", "name", "allow_renaming", *POSE)
    ),
    flags=frozenset(("allow_renaming",)),
    sources=("file", "param", "string", "topic"),
    entity="name",
    needs_entity=False,
    is_strict=False,
    reads_parameters=True,
)
# By package, because names repeat.
SPAWNERS = {
    ("gazebo_ros", "spawn_entity.py"): SPAWN_ENTITY,
    ("ros_gz_sim", "create"): CREATE,
    ("ros_ign_gazebo", "create"): CREATE,
}
SPAWNER_PROGRAMS = frozenset(executable for _, executable in SPAWNERS)
CONTROLLER_SPAWNERS = frozenset(("spawner", "spawner.py"))  # of controller_manager


class Read(NamedTuple):
    """Options without their dashes, and what is wrong with them."""

    values: Mapping[str, str]
    diagnostics: list[Diagnostic]


class _Remark(NamedTuple):
    message: str
    hint: str


def read_options(process: Process, options: Options) -> Read:
    """The options of a spawner, from its arguments and, where it reads them, its parameters."""
    values, unknown, errors = _read_words(process, options)
    if options.reads_parameters:
        known = options.names
        given = {
            name: str(value)
            for name, value in process.parameters.items()
            if name in known and value != ""
        }
        if any(name in options.sources for name in given):
            values = {name: text for name, text in values.items() if name not in options.sources}
        values.update(given)
    lacking = [] if errors else list(_lacking(process, options, values))
    if unknown and (options.is_strict or lacking):  # what is lacking follows from them
        errors, unknown, lacking = [*errors, *unknown], [], []
    return Read(
        values,
        [
            *_report(process, (*errors, *lacking), Severity.ERROR),
            *_report(process, unknown, Severity.WARNING),
        ],
    )


def _report(
    process: Process, remarks: Iterable[_Remark], severity: Severity
) -> Iterator[Diagnostic]:
    for message, hint in remarks:
        yield INVALID_SPAWNER_OPTION.at(
            process.file,
            process.line,
            process.executable,
            message=message,
            hint=hint,
            severity=severity,
        )


def _lacking(process: Process, options: Options, values: Mapping[str, str]) -> Iterator[_Remark]:
    given = [name for name in options.sources if name in values]
    if not given or (options.is_strict and len(given) > 1):
        all_sources = ", ".join(f"-{name}" for name in options.sources)
        found = " and ".join(f"-{name}" for name in given) or "none of them"
        exactly = "exactly " if options.is_strict else ""
        yield _Remark(
            f"{process.executable} needs {exactly}one of {all_sources}, but is given {found}.",
            "Usually it is '-topic', 'robot_description'.",
        )
    # With an empty one the model keeps its own name (gazebo_ros_factory.cpp).
    if options.needs_entity and options.entity not in values:
        yield _Remark(
            f"{process.executable} is not given -{options.entity}, the name of the model.",
            f"Add '-{options.entity}', 'NAME' to its arguments.",
        )


def _read_words(
    process: Process, options: Options
) -> tuple[dict[str, str], list[_Remark], list[_Remark]]:
    """The values, and what is said of unknown words and of missing values."""
    words = list(process.arguments)
    if "--ros-args" in words:
        del words[words.index("--ros-args") :]
    return (_read_strictly if options.is_strict else _read_flags)(process, words, options)


def _read_strictly(
    process: Process, words: list[str], options: Options
) -> tuple[dict[str, str], list[_Remark], list[_Remark]]:
    """As `_read_words`, of words that argparse reads."""
    try:
        values, rest = parse_spawn_entity(words, options.with_value, options.flags)
    except RefusedError as error:
        return {}, [], [_refused(process, words, str(error))]
    # What follows an unknown option is its value.
    before = ["", *rest]
    unknown = [
        _unknown(process, word, options)
        for word, previous in zip(rest, before, strict=False)
        if word.startswith("-") or not previous.startswith("-") or " " in previous
    ]
    return values, unknown, []


_NO_VALUE = lazy_pattern(r"argument (-\w+): expected one argument")


def _refused(process: Process, words: list[str], message: str) -> _Remark:
    """What is said of words that argparse refuses."""
    lacking = _NO_VALUE.fullmatch(message)
    if lacking is None:
        return _Remark(
            f"{process.executable} refuses its arguments: {message}.",
            "Write each option and each value as a separate item of `arguments`.",
        )
    option = lacking[1]
    value = next((after for word, after in itertools.pairwise(words) if word == option), "")
    # `-1` and `-.5` are values for argparse, `-1e-3` is an option.
    is_number = value[1:2].isdigit()
    return _Remark(
        f"{option} of {process.executable} has no value"
        f"{f': argparse takes {value} for an option' if is_number else ''}.",
        f"Write '{option}={value}'." if is_number else f"Add it: {option} VALUE.",
    )


def _read_flags(
    process: Process, words: list[str], options: Options
) -> tuple[dict[str, str], list[_Remark], list[_Remark]]:
    """As `_read_words`, of words that gflags reads."""
    found = read_flags(words, options)
    return (
        found.values,
        [_unknown(process, word, options) for word in found.unknown],
        [
            _Remark(f"{word} of {process.executable} has no value.", f"Add it: {word} VALUE.")
            for word in found.without_value
        ],
    )


class Flags(NamedTuple):
    """What gflags makes of words."""

    values: dict[str, str]
    unknown: list[str]
    without_value: list[str]


def read_flags(words: Iterable[str], options: Options) -> Flags:
    """The options of a program that reads them with gflags: `-name a`, `--name=a`."""
    found = Flags({}, [], [])
    rest = list(words)
    while rest:
        word = rest.pop(0)
        name, has_value, value = word.lstrip("-").partition("=")
        name = name.replace("-", "_")  # gflags takes dashes for underscores
        if not word.startswith("-") or name not in options.names:
            found.unknown.append(word)
            if word.startswith("-") and not has_value and rest and rest[0][:1] != "-":
                rest.pop(0)  # its value
        elif has_value:
            found.values[name] = value
        elif name in options.flags and not (
            name in options.with_value and rest and rest[0] in {"true", "false"}
        ):
            found.values[name] = "true"
        elif rest:
            found.values[name] = rest.pop(0)
        else:
            found.without_value.append(word)
    return found


def _unknown(process: Process, word: str, options: Options) -> _Remark:
    if " " in word.strip():
        return _Remark(
            f"'{word}' is a single argument of {process.executable}, which does not know it.",
            "Write each option and each value as a separate item of `arguments`.",
        )
    names = [f"-{name}" for name in sorted(options.names)]
    glued = next(
        (
            name
            for name in names
            if len(name) > LETTER and word.startswith(name) and len(word) > len(name) + 1
        ),
        None,  # `-topics` is a typing mistake
    )
    if glued is not None:
        return _Remark(
            f"'{word}' is a single argument of {process.executable}, which does not know it.",
            f"Write a comma after '{glued}': '{glued}', '{word.removeprefix(glued).lstrip('= ')}'",
        )
    does = "does not know" if options.is_strict else "ignores"
    is_name = word.lstrip("-") in {"entity", "model", "name"}  # as other spawners call it
    return _Remark(
        f"{process.executable} {does} '{word}'.",
        did_you_mean(f"-{options.entity}")
        if is_name
        else advice(word, names, f"Use one of {' '.join(names)}."),
    )


class RefusedError(Exception):
    """What `argparse` says of arguments that it does not accept."""


_SECONDS = frozenset(("timeout", "spawn_service_timeout"))
NUMBERS = _SECONDS | frozenset("xyzRPY")


def parse_spawn_entity(
    words: Sequence[str], with_value: Iterable[str], flags: Iterable[str]
) -> tuple[dict[str, str], list[str]]:
    """The values of the options, those of flags "true", and the words that are no option.

    Raises:
        RefusedError: An option has no value, or a wrong one, or is the beginning of several.
    """
    from argparse import SUPPRESS, ArgumentParser  # which few launch files need

    class Parser(ArgumentParser):
        def error(self, message: str) -> NoReturn:
            raise RefusedError(message)

    parser = Parser(argument_default=SUPPRESS, add_help=False)
    for name in with_value:
        kind: dict[str, Any] = {"type": float} if name in _SECONDS else {}
        parser.add_argument(f"-{name}", dest=name, **kind)
    for name in flags:
        parser.add_argument(f"-{name}", dest=name, action="store_const", const="true")
    parser.add_argument("-h", "--help", action="store_const", const="true")
    values, rest = parser.parse_known_args(words)
    return {name: str(value) for name, value in vars(values).items()}, rest


# Names -> what it is if it is not given. False: a flag; a number: takes a number; an empty tuple:
# may be given several times.
ControllerOptions = dict[tuple[str, ...], str | float | tuple[()] | None]

OF_SPAWNER: ControllerOptions = {
    ("-c", "--controller-manager"): "controller_manager",
    ("-n", "--namespace"): None,
    ("-t", "--controller-type"): None,
    ("--controller-manager-timeout",): 0.0,
    ("--switch-timeout",): 5.0,
    ("--service-call-timeout",): 10.0,
    ("--activate-as-group",): False,
    ("--switch-asap", "--no-switch-asap"): False,
    ("-u", "--unload-on-kill"): False,
}
# After `--controller NAME`, for it alone.
OF_CONTROLLER: ControllerOptions = {
    ("-p", "--param-file"): (),
    ("--load-only",): False,
    ("--inactive",): False,
    ("--stopped",): False,
    ("--controller-ros-args",): (),
}
