"""The elements of xacro files as they are written, each with its line; xacro keeps none.

Comments are skipped, so that commented-out elements are never found.
"""

from __future__ import annotations

import re
from contextlib import suppress
from typing import TYPE_CHECKING, NamedTuple
from xml.parsers import expat

from wsgen.text.files import read_regular
from wsgen.text.values import lazy_pattern
from wsgen.text.xmlsyntax import DEEPEST

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path


SIZE_LIMIT = 8 * 2**20  # bytes; the largest public xacro files have 2 % of it
MOST_ELEMENTS = 200_000  # that many hold their paths
# One without end goes to the end of the text: searching an end from each `<!--` would be quadratic.
COMMENT = lazy_pattern(r"<!--.*?(?:-->|\Z)", re.DOTALL)


class Written(NamedTuple):
    """An element as it is written."""

    file: Path
    line: int  # of its first character, 1-based
    tag: str  # with its prefix
    attributes: Mapping[str, str]  # values as xacro gets them: entities resolved
    path: tuple[str, ...]  # `label` of its ancestors and of itself
    data: bytes  # the whole file
    offset: int  # of its first character in `data`

    def line_of(self, attribute: str) -> int:
        """The line where an attribute of it begins; its own where it has no such attribute."""
        if attribute not in self.attributes:
            return self.line
        name = re.compile(rf"\s{re.escape(attribute)}\s*=".encode())
        found = name.search(self.data, self.offset)
        return self.line + (self.data.count(b"\n", self.offset, found.end()) if found else 0)


def label(tag: str, name: str | None) -> str:
    """What an element is called in a path: its tag, and of a macro also the name."""
    return f"{tag} {name}" if tag == "xacro:macro" else tag


def read_text(file: Path) -> str | None:
    """The text of a file, without a byte order mark; None where it cannot be read."""
    try:
        data = read_regular(file, SIZE_LIMIT)
        return data.decode("utf-8-sig") if len(data) <= SIZE_LIMIT else None
    except (OSError, ValueError):
        return None


def elements(file: Path, text: str) -> list[Written]:
    """All elements of the text, which `file` holds, as far as it is well-formed XML.

    What lies deeper or comes later than in any file that people write is left out.
    """
    data = text.encode("utf-8")
    found: list[Written] = []
    path: list[str] = []
    parser = expat.ParserCreate("utf-8")

    def start(tag: str, attributes: dict[str, str]) -> None:
        path.append(label(tag, attributes.get("name")))
        if len(path) > DEEPEST or len(found) >= MOST_ELEMENTS:
            raise expat.ExpatError
        found.append(
            Written(
                file,
                parser.CurrentLineNumber,
                tag,
                attributes,
                tuple(path),
                data,
                parser.CurrentByteIndex,
            )
        )

    def end(_: str) -> None:
        path.pop()

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    with suppress(expat.ExpatError):
        parser.Parse(data, True)
    # They hold the parser, which holds them: only the garbage collector would free them.
    parser.StartElementHandler = parser.EndElementHandler = None
    return found


def line_with(text: str, wanted: str) -> int | None:
    """The first line that holds a piece of text outside comments, 1-based."""
    place = without_comments(text).find(wanted)
    return None if place < 0 else text.count("\n", 0, place) + 1


def without_comments(text: str) -> str:
    """The text with blanks in the place of comments: places and line breaks stay."""
    return COMMENT.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), text)
