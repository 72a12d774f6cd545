"""The options of the spawners, read as these programs do.

`spawn_entity.py` (gazebo_ros) reads `-name value` as argparse does, `create` (ros_gz_sim) as gflags
does: `-name value`, `-name=value` or `--name=value`; it ignores what it does not know. It takes
node parameters too, which win over the options. Source: the programs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.suggestions import advice, did_you_mean
from wsgen.values import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

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


class Options(NamedTuple):
    """What a spawner takes."""

    with_value: frozenset[str]
    flags: frozenset[str]
    sources: tuple[str, ...]  # what says what is spawned; the first one counts
    entity: str  # the option that names the model
    default_entity: str  # its value where it may be left out; empty where it may not
    is_strict: bool  # refuses unknown options and a second source
    reads_parameters: bool


SPAWN_ENTITY = Options(
    with_value=frozenset(
        (
            "file",
            "topic",
            "database",
            "entity",
            "reference_frame",
            "gazebo_namespace",
            "robot_namespace",
            "timeout",
            "spawn_service_timeout",
            "wait",
            *POSE,
        )
    ),
    flags=frozenset(("stdin", "unpause", "package_to_model", "b")),
    sources=("file", "topic", "database", "stdin"),
    entity="entity",
    default_entity="",
    is_strict=True,
    reads_parameters=False,
)
CREATE = Options(
    with_value=frozenset(
        ("world", "file", "param", "string", "topic", "name", "allow_renaming", *POSE)
    ),
    flags=frozenset(("allow_renaming",)),
    sources=("file", "param", "string", "topic"),
    entity="name",
    default_entity="robot",
    is_strict=False,
    reads_parameters=True,
)


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
        known = options.with_value | options.flags
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
            f"{process.executable} needs {exactly}one of {all_sources}, and is given {found}.",
            "Usually it is '-topic', 'robot_description'.",
        )
    if not values.get(options.entity) and not options.default_entity:
        yield _Remark(
            f"{process.executable} is not given -{options.entity}, the name of the model.",
            f"Add '-{options.entity}', 'NAME' to its arguments.",
        )


def _read_words(
    process: Process, options: Options
) -> tuple[dict[str, str], list[_Remark], list[_Remark]]:
    """The values, and what is said of unknown words and of missing values."""
    values: dict[str, str] = {}
    unknown: list[_Remark] = []
    errors: list[_Remark] = []
    words = list(process.arguments)
    while words:
        word = words.pop(0)
        if word == "--ros-args":
            break
        name, has_value, value = word.lstrip("-").partition("=")
        if not options.is_strict:  # gflags takes dashes for underscores
            name = name.replace("-", "_")
        if not word.startswith("-") or name not in options.with_value | options.flags:
            unknown.append(_unknown(process, word, options))
            if word.startswith("-") and not has_value and words and words[0][:1] != "-":
                words.pop(0)  # its value
        elif has_value:
            values[name] = value
        elif name in options.flags and not (
            name in options.with_value and words and words[0] in {"true", "false"}
        ):
            values[name] = "true"
        elif words:
            values[name] = words.pop(0)
        else:
            message = f"{word} of {process.executable} has no value."
            errors.append(_Remark(message, f"Add it: {word} VALUE."))
    return values, unknown, errors


def _unknown(process: Process, word: str, options: Options) -> _Remark:
    if " " in word.strip():
        return _Remark(
            f"'{word}' is one argument of {process.executable}, which does not know it.",
            "Write each option and each value as a separate item of `arguments`.",
        )
    names = [f"-{name}" for name in sorted(options.with_value | options.flags)]
    does = "does not know" if options.is_strict else "ignores"
    is_name = word.lstrip("-") in {"entity", "model", "name"}  # as other spawners call it
    return _Remark(
        f"{process.executable} {does} '{word}'.",
        did_you_mean(f"-{options.entity}")
        if is_name
        else advice(word, names, f"It knows {' '.join(names)}."),
    )
