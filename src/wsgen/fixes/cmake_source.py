"""CMake as it is written: the places of commands and arguments."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from wsgen.fixes.source import SourceText


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


_PIECE = re.compile(
    r"(?P<comment>#\[(?P<hash>=*)\[.*?\](?P=hash)\]|#[^\n]*)"
    r'|(?P<quoted>"(?:[^"\\]|\\.)*")'
    r"|(?P<bracket>\[(?P<equals>=*)\[.*?\](?P=equals)\])"
    r"|(?P<open>\()|(?P<close>\))"
    r'|(?P<word>(?:[^\s()#"\\]|\\.|\$\([^)\s]*\))+)',
    re.DOTALL,
)


def read_commands(source: SourceText) -> list[Command]:
    """All calls, in the order of the text."""
    found: list[Command] = []
    name: re.Match[str] | None = None
    depth = 0
    arguments: list[Argument] = []
    for piece in _PIECE.finditer(source.text):
        kind = piece.lastgroup
        if piece["comment"] is not None:
            continue
        if piece["open"]:
            depth += 1
        elif piece["close"]:
            depth -= 1
            if depth == 0 and name is not None:
                command = Command(name[0].lower(), name.start(), piece.end(), tuple(arguments))
                found.append(command)
                name, arguments = None, []
            depth = max(depth, 0)
        elif depth == 0:
            name, arguments = (piece if piece["word"] else None), []
        elif kind is not None:
            text = piece[0][1:-1] if piece["quoted"] is not None else piece[0]
            arguments.append(Argument(piece.start(), piece.end(), text))
    return found


def command_at(source: SourceText, line: int | None, *names: str) -> Command | None:
    """The call with one of these names that a line is in; None where several are."""
    on_line = [
        command
        for command in read_commands(source)
        if command.name in names
        and source.line_at(command.start) <= (line or 0) <= source.line_at(command.end - 1)
    ]
    return on_line[0] if len(on_line) == 1 else None
