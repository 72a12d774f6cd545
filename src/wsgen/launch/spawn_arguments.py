"""The options of the programs that spawn robots.

`spawn_entity.py` (gazebo_ros) reads `-name value` as argparse does, `create` (ros_gz_sim) as
gflags does: `-name value`, `-name=value` or `--name=value`; it takes node parameters too, which
win over the options.
"""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, NamedTuple

from wsgen.suggestions import advice

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.model.plan import Process

_POSE = ("x", "y", "z", "R", "P", "Y")


class Options(NamedTuple):
    """What a spawner takes."""

    with_value: frozenset[str]
    flags: frozenset[str]
    sources: tuple[str, ...]  # exactly one of these says what is spawned
    entity: str  # the option that names the model
    default_entity: str  # its value where it may be left out; empty where it may not
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
            *_POSE,
        )
    ),
    flags=frozenset(("stdin", "unpause", "package_to_model", "b")),
    sources=("file", "topic", "database", "stdin"),
    entity="entity",
    default_entity="",
    reads_parameters=False,
)
CREATE = Options(
    with_value=frozenset(
        ("world", "file", "param", "string", "topic", "name", "allow_renaming", *_POSE)
    ),
    flags=frozenset(("allow_renaming",)),
    sources=("file", "param", "string", "topic"),
    entity="name",
    default_entity="robot",
    reads_parameters=True,
)


class Read(NamedTuple):
    """Options without their dashes, and what is wrong with them: what and what to do."""

    values: Mapping[str, str]
    faults: list[tuple[str, str]]


def read(process: Process, options: Options) -> Read:
    """The options of a spawner, from its arguments and, where it reads them, its parameters."""
    values, faults = _read_words(process, options)
    if faults:  # what is lacking may follow from them
        return Read(values, faults)
    if options.reads_parameters:
        known = options.with_value | options.flags
        values.update(
            {
                name: str(value)
                for name, value in process.parameters.items()
                if name in known and value != ""
            }
        )
    given = [name for name in options.sources if name in values]
    all_sources = ", ".join(f"-{name}" for name in options.sources)
    if len(given) != 1:
        found = " and ".join(f"-{name}" for name in given) or "none of them"
        faults.append(
            (
                f"{process.executable} needs exactly one of {all_sources}, and is given {found}.",
                "Usually it is '-topic', 'robot_description'.",
            )
        )
    if not values.get(options.entity) and not options.default_entity:
        faults.append(
            (
                f"{process.executable} is not given -{options.entity}, the name of the model.",
                f"Add '-{options.entity}', 'NAME' to its arguments.",
            )
        )
    return Read(values, faults)


def _read_words(process: Process, options: Options) -> tuple[dict[str, str], list[tuple[str, str]]]:
    values: dict[str, str] = {}
    faults: list[tuple[str, str]] = []
    words = list(process.arguments)
    while words:
        word = words.pop(0)
        if word == "--ros-args":
            break
        name, has_value, value = word.lstrip("-").partition("=")
        if not word.startswith("-") or name not in options.with_value | options.flags:
            faults.append(_unknown(process, word, options))
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
            faults.append(
                (f"{word} of {process.executable} has no value.", f"Add it: {word} VALUE.")
            )
    return values, faults


def _unknown(process: Process, word: str, options: Options) -> tuple[str, str]:
    if " " in word.strip():
        return (
            f"'{word}' is one argument of {process.executable}, and none that it knows.",
            "Each option and each value is an item of its own in the list of arguments.",
        )
    names = [f"-{name}" for name in sorted(options.with_value | options.flags)]
    return (
        f"{process.executable} does not know '{word}'.",
        advice(word, names, f"It knows {' '.join(names)}."),
    )


def split(line: str) -> list[str]:
    """The words of a command line; what cannot be split counts as one word."""
    try:
        return shlex.split(line)
    except ValueError:
        return [line]
