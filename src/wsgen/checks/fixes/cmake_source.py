"""CMake as it is written: the places of commands and arguments."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from wsgen.packages.build_files.cmake_text import BRACKET, QUOTED, parse

if TYPE_CHECKING:
    from wsgen.checks.fixes.source import SourceText


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
