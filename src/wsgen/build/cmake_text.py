"""Read the calls in a CMakeLists.txt without running it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


_QUOTED = r'"(?:[^"\\]|\\.)*"'
_COMMENT = re.compile(rf"{_QUOTED}|(#\[(=*)\[.*?\]\2\]|#[^\n]*)", re.DOTALL)
_STRING = re.compile(rf'{_QUOTED}|".*\Z', re.DOTALL)  # the last one may have no end
_WORD = re.compile(rf'{_QUOTED}|[^\s"]+', re.DOTALL)
# With parentheses inside the parentheses, as in if(NOT (A AND B)), but not inside those again.
_CALL = re.compile(
    rf"\b([A-Za-z_]\w*)[ \t]*\(((?:{_QUOTED}|[^()\"]|\((?:{_QUOTED}|[^()\"])*\))*)\)", re.DOTALL
)

BLOCKS = ("block", "foreach", "function", "if", "macro", "while")  # each ends with end...()


@dataclass(frozen=True, kw_only=True)
class Call:
    """One call of a command."""

    command: str  # in lower case: CMake ignores case
    arguments: tuple[str, ...]
    line: int  # 1-based, of the command
    argument_lines: tuple[int, ...]  # 1-based, of each argument


def read_calls(file: Path) -> tuple[Call, ...]:
    """List the calls in the order of the text; empty if the file cannot be read."""
    try:
        text = file.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ()
    return tuple(_find_calls(_blank_comments(text)))


def find_open_block(file: Path) -> tuple[Call | None, Call | None]:
    """Find the call that opens a block that is not closed, or closes one that is not open.

    Returns:
        The call that opens a block without an end, and the call that ends another block instead;
        either may be None, and both are if all blocks match.
    """
    opened: list[Call] = []
    for call in read_calls(file):
        if call.command in BLOCKS:
            opened.append(call)
        elif call.command.startswith("end") and call.command[3:] in BLOCKS:
            if not opened or opened[-1].command != call.command[3:]:
                return (opened[-1] if opened else None), call
            opened.pop()
    return (opened[-1] if opened else None), None


def find_open_quote(file: Path) -> int | None:
    """Guess the line of a quotation mark that is not closed.

    It is the last one if their number is odd, or an earlier one whose string contains the closing
    parenthesis of its line.
    """
    try:
        text = _blank_comments(file.read_text(encoding="utf-8", errors="replace"))
    except OSError:
        return None
    for match in _STRING.finditer(text):
        first_line, line_break, _ = match[0].partition("\n")
        if not match[0].endswith('"', 1) or (line_break and first_line.rstrip().endswith(")")):
            return _line_at(text, match.start())
    return None


def _find_calls(text: str) -> Iterator[Call]:
    for match in _CALL.finditer(text):
        words = list(_WORD.finditer(match[2]))
        offsets = [match.start(2) + word.start() for word in words]
        yield Call(
            command=match[1].lower(),
            arguments=tuple(word[0].strip('"') for word in words),
            line=_line_at(text, match.start()),
            argument_lines=tuple(_line_at(text, offset) for offset in offsets),
        )


def _blank_comments(text: str) -> str:
    """Remove comments, keeping the line breaks."""
    return _COMMENT.sub(lambda match: "\n" * match[0].count("\n") if match[1] else match[0], text)


def _line_at(text: str, offset: int) -> int:
    return text.count("\n", 0, offset) + 1
