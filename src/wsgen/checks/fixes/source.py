"""The text of a file as it is written, and edits that change only what they must.

Line ends, a byte order mark and everything around an edit stay as they are.
"""

from __future__ import annotations

import codecs
import re
from bisect import bisect_right
from functools import cached_property
from typing import TYPE_CHECKING

from wsgen.text.files import read_regular
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path


SIZE_LIMIT = 8 * 2**20  # bytes; what people write by hand is far smaller


@dataclass(frozen=True, kw_only=True)
class Edit:
    """A piece of a text, and what takes its place."""

    start: int  # of the piece, in characters from the beginning of the text
    end: int  # behind the piece; equal to `start`: only something is added
    text: str


class SourceText:
    """A text with its line ends, as the file has them."""

    def __init__(self, file: Path, text: str, *, mark: bytes = b"") -> None:
        self.file = file
        self.text = text
        self.mark = mark  # the byte order mark before the text

    @cached_property
    def _starts(self) -> list[int]:
        return [0, *(found.end() for found in re.finditer(r"\n", self.text))]

    @property
    def newline(self) -> str:
        """The line end that the text uses."""
        return "\r\n" if "\r\n" in self.text else "\n"

    def line_at(self, place: int) -> int:
        """The line of a character, 1-based."""
        return bisect_right(self._starts, place)

    def start_of(self, line: int) -> int:
        """The place of the first character of a line; the end of the text for lines behind it."""
        return self._starts[line - 1] if 0 < line <= len(self._starts) else len(self.text)

    def indent_at(self, place: int) -> str:
        """The blanks before the first word of the line of a character."""
        start = self.start_of(self.line_at(place))
        found = re.compile(r"[ \t]*").match(self.text, start)
        return found[0] if found else ""

    def whole_lines(self, start: int, end: int) -> tuple[int, int]:
        """The span of a piece; with its line breaks if nothing else is on its lines."""
        first = self.start_of(self.line_at(start))
        rest = re.compile(r"[ \t]*(?:\r?\n|\Z)").match(self.text, end)
        if rest is not None and not self.text[first:start].strip():
            return first, rest.end()
        return start, end

    def encoded(self, text: str) -> bytes:
        """The bytes of the file with this text in place of its own."""
        return self.mark + text.encode("utf-8")


def read_source(file: Path) -> SourceText | None:
    """Read a file; None if it cannot be read, is not UTF-8 or too large."""
    try:
        data = read_regular(file, SIZE_LIMIT)
        if len(data) > SIZE_LIMIT:
            return None
        mark = codecs.BOM_UTF8 if data.startswith(codecs.BOM_UTF8) else b""
        return SourceText(file, data[len(mark) :].decode("utf-8"), mark=mark)
    except (OSError, ValueError):
        return None


def overlap(edits: Iterable[Edit], others: Iterable[Edit]) -> bool:
    """Whether an edit touches what another one changes; two that add at one place also do."""
    listed = list(others)
    return any(
        (one.start < other.end and other.start < one.end) or one.start == other.start
        for one in edits
        for other in listed
    )


def join_additions(edits: Iterable[Edit]) -> list[Edit]:
    """Of edits that only add, those at one place as one."""
    texts: dict[int, str] = {}
    for edit in edits:
        texts[edit.start] = texts.get(edit.start, "") + edit.text
    return [Edit(start=place, end=place, text=text) for place, text in texts.items()]


def apply(text: str, edits: Iterable[Edit]) -> str:
    """The text with all edits, which do not overlap."""
    parts, place = list[str](), 0
    for edit in sorted(edits, key=lambda one: (one.start, one.end)):
        parts += [text[place : edit.start], edit.text]
        place = edit.end
    return "".join((*parts, text[place:]))
