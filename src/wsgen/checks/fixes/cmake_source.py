"""Fixes of where CMakeLists.txt installs folders, and the places of commands and arguments."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.source import Edit
from wsgen.packages.build_files.cmake_text import BRACKET, QUOTED, parse

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.checks.fixes.source import SourceText
    from wsgen.diagnostics import Diagnostic


class Argument(NamedTuple):
    """An argument of a command."""

    start: int
    end: int
    text: str  # without quotes


class Command(NamedTuple):
    """A call of a command."""

    name: str  # in lower case
    start: int  # of its name
    end: int  # behind its closing parenthesis
    arguments: tuple[Argument, ...]


def read_commands(source: SourceText) -> list[Command]:
    """All calls before the first mistake of syntax, in the order of the text."""
    calls, _ = parse(source.text)
    return [
        Command(
            call.command,
            call.start,
            call.stop,
            tuple(
                Argument(one.start, one.stop, one.text)
                for one in call.written
                if one.kind in {QUOTED, BRACKET} or one.text not in {"(", ")"}
            ),
        )
        for call in calls
    ]


def command_at(source: SourceText, line: int | None, *names: str) -> Command | None:
    """The call with one of these names that a line is in; None where several are."""
    on_line = [
        command
        for command in read_commands(source)
        if command.name in names
        and source.line_at(command.start) <= (line or 0) <= source.line_at(command.end - 1)
    ]
    return on_line[0] if len(on_line) == 1 else None


SHARE = "share/${PROJECT_NAME}"


def _destination(command: Command) -> Argument | None:
    """The argument of DESTINATION, if the call has one."""
    for keyword, argument in zip(command.arguments, command.arguments[1:], strict=False):
        if keyword.text == "DESTINATION":
            return argument
    return None


def _folders(command: Command) -> list[Argument]:
    """The folders of install(DIRECTORY ...)."""
    words = command.arguments
    if not words or words[0].text != "DIRECTORY":
        return []
    end = next(
        (n for n, one in enumerate(words) if one.text in {"DESTINATION", "TYPE"}), len(words)
    )
    return list(words[1:end])


def remove_last_slashes(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Install folders, and not what is in them."""
    command = command_at(source, diagnostic.line, "install")
    if command is None:
        return []
    return [
        Edit(start=one.start, end=one.end, text=source.text[one.start : one.end].replace("/", ""))
        for one in _folders(command)
        if re.fullmatch(r"\w+/", one.text)
    ]


def shorten_destination(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Install a folder beside the others, and not into one of its own name."""
    command = command_at(source, diagnostic.line, "install")
    place = command and _destination(command)
    if command is None or place is None or len(_folders(command)) != 1:
        return []
    name = _folders(command)[0].text
    parent, _, last = place.text.rstrip("/").rpartition("/")
    if last != name or not parent:
        return []
    written = source.text[place.start : place.end]
    return [Edit(start=place.start, end=place.end, text=written.replace(place.text, parent))]


_NO_DOLLAR = re.compile(r"(?<!\$)\{PROJECT_NAME\}|\$?\(PROJECT_NAME\)|\$PROJECT_NAME\b")
_NOT_SET = re.compile(r"whose variable (\w+) is not set")


def fix_destination(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Install into the share folder of the package."""
    command = command_at(source, diagnostic.line, "install")
    if command is None:
        return []
    place = _destination(command)
    if place is None:
        return _replace_type(command)
    written = source.text[place.start : place.end]
    unset = _NOT_SET.search(diagnostic.message)
    if unset is not None:
        text = written.replace(f"${{{unset[1]}}}", "${PROJECT_NAME}")
    elif _NO_DOLLAR.search(written):
        text = _NO_DOLLAR.sub("${PROJECT_NAME}", written)
    elif place.text.rstrip("/") == "share":
        text = written.replace(place.text, SHARE)
    elif place.text.startswith("${PROJECT_NAME}"):
        text = written.replace("${PROJECT_NAME}", SHARE, 1)
    else:
        return []
    return [Edit(start=place.start, end=place.end, text=text)] if text != written else []


def _replace_type(command: Command) -> Sequence[Edit]:
    for keyword, argument in zip(command.arguments, command.arguments[1:], strict=False):
        if keyword.text == "TYPE" and argument.text == "DATA":
            return [Edit(start=keyword.start, end=argument.end, text=f"DESTINATION {SHARE}")]
    return []
