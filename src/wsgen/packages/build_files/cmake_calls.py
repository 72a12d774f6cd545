"""Calls of CMake's commands, with the values of their arguments."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence
    from pathlib import Path

    from wsgen.packages.build_files.cmake_text import Argument, Call


class InstallRule(NamedTuple):
    """A call of install(), or of a command that calls it."""

    kind: str  # DIRECTORY, FILES, PROGRAMS, TARGETS, ...
    names: tuple[tuple[Argument, str], ...]  # each as it is written, and its path or name
    destination: str | None  # relative to the prefix; None: it has none
    place: Argument | None  # the argument with the destination
    file: Path
    call: Call
    folder: Path  # that paths are relative to
    is_certain: bool  # no condition around it is unknown
    in_tests: bool
    is_optional: bool = False
    rename: str = ""
    # PATTERN or REGEX, its text, and whether it excludes.
    patterns: tuple[tuple[str, str, bool], ...] = ()
    matching_only: bool = False  # FILES_MATCHING
    # Which files can be run: "all", "none", or those that can in the source: "source".
    runnable: str = "none"


class Mention(NamedTuple):
    """A call that a check looks at."""

    call: Call
    arguments: tuple[Argument, ...]  # expanded
    file: Path
    is_certain: bool
    in_tests: bool
    folder: Path  # that paths are relative to
    order: int  # grows from call to call


def texts(mention: Mention) -> list[str]:
    """The arguments of a call as texts."""
    return [argument.text for argument in mention.arguments]


def sections(
    words: Sequence[Argument], keywords: Collection[str]
) -> tuple[list[Argument], dict[str, list[Argument]]]:
    """The arguments before the first keyword, and those after each."""
    first: list[Argument] = []
    found: dict[str, list[Argument]] = {}
    current = first
    for word in words:
        if word.text in keywords:
            current = found.setdefault(word.text, [])
        else:
            current.append(word)
    return first, found
