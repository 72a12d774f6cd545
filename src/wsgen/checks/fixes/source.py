"""The text of a file as it is written, XML too, and edits that change only what they must.

Line ends, a byte order mark and everything around an edit stay as they are.

Words that are misspelled are corrected here, in files of any kind.
"""

from __future__ import annotations

import codecs
import functools
import re
from bisect import bisect_right
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

from wsgen.text.files import read_regular
from wsgen.text.suggestions import LONGEST, mistakes_between, suggested
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic


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


SHORT = 4  # letters; in shorter words only the order of letters may differ: `xzy`, not `fl` or `x`
LONG = 8  # letters; from here on two letters may differ

WORD = re.compile(r"[\w./:-]*\w")
COMMENT = re.compile(r"[ \t]*(?:<!--[ \t]*wsgen:(?:(?!-->).)*-->|#[ \t]*wsgen:[^\r\n]*)")
ON_ONE_LINE = re.compile(r"[ \t]*(?:\"(?!\")|'(?!')|\{.*\}[ \t]*(?:#.*)?\r?$)", re.MULTILINE)
ENTRY = re.compile(r"[ \t]*[\"']?[\w-]+[\"']?[ \t]*=")
_WORDS = re.compile(r"[A-Z]?[a-z]+|[A-Z]+|\d+|[^\W\d_]+")


def is_surely(written: str, meant: str) -> bool:
    """Whether a name is another one with a slip of the hand: `Revolute`, `inertail`, `base_lnk`.

    Names that count or place things differ as little: `arm_1` and `arm_2`, `l_wheel` and `r_wheel`
    are others. One word may differ, not in a number and not in its first or last letter alone.
    """
    if _plain(written) == _plain(meant):
        return True
    words, others = _WORDS.findall(written), _WORDS.findall(meant)
    if len(words) != len(others):
        return False
    differing = [
        (one.casefold(), other.casefold())
        for one, other in zip(words, others, strict=True)
        if one.casefold() != other.casefold()
    ]
    return len(differing) == 1 and _is_slip(*differing[0])


def _plain(name: str) -> str:
    return re.sub(r"[\s_-]", "", name).casefold()


def _is_slip(one: str, other: str) -> bool:
    if one[0] != other[0] or one.isdigit() or other.isdigit():
        return False
    if sorted(one) == sorted(other):
        return True
    if len(one) == len(other) and one[:-1] == other[:-1]:
        return False
    length = max(len(one), len(other))
    if length > LONGEST:
        return False
    allowed = 0 if length < SHORT else 1 if length < LONG else 2
    return mistakes_between(one, other) <= allowed


def _line(source: SourceText, line: int | None) -> tuple[int, str]:
    """The place of a line, and its text."""
    start = source.start_of(line or 0)
    return start, source.text[start : source.start_of((line or 0) + 1)]


def fix_word(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write the suggested word for the only one on the line that it must be meant by."""
    meant = suggested(diagnostic.hint)
    start, text = _line(source, diagnostic.line)
    if meant is None or diagnostic.line is None:
        return []
    found = [one for one in WORD.finditer(text) if is_surely(one[0], meant) and one[0] != meant]
    if len(found) != 1 or meant in WORD.findall(text):
        return []
    return [Edit(start=start + found[0].start(), end=start + found[0].end(), text=meant)]


def remove_allowance(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Remove a comment, or a line of wsgen.toml, that allows what nothing breaks."""
    start, text = _line(source, diagnostic.line)
    if source.file.name == "wsgen.toml":
        entry = ENTRY.match(text)
        is_whole = entry is not None and ON_ONE_LINE.match(text, entry.end()) is not None
        return [Edit(start=start, end=start + len(text), text="")] if is_whole else []
    found = list(COMMENT.finditer(text))
    if len(found) != 1 or "," in found[0][0].partition("allow")[2].partition(":")[0]:
        return []
    first, last = start + found[0].start(), start + found[0].end()
    if not text[: found[0].start()].strip():
        first, last = source.whole_lines(start + len(text) - len(text.lstrip()), last)
    return [Edit(start=first, end=last, text="")]


class Span(NamedTuple):
    """A piece of the text."""

    start: int
    end: int


class Attribute(NamedTuple):
    """An attribute of a tag."""

    name: Span
    value: Span  # without its quotes
    text: str  # the value as it is written, entities included


class Tag(NamedTuple):
    """An element as it is written."""

    name: str
    start: Span  # its start tag, from `<` to `>`
    attributes: dict[str, Attribute]
    is_empty: bool  # <tag/>
    end: Span | None  # its end tag; None if it has none
    path: tuple[Tag, ...]  # the elements around it, the root first; without their ends

    def content(self) -> Span:
        """What is between its start and its end tag."""
        return Span(self.start.end, self.end.start if self.end else self.start.end)


_TOKEN = re.compile(
    r"<!--.*?(?:-->|\Z)|<!\[CDATA\[.*?(?:\]\]>|\Z)|<\?.*?(?:\?>|\Z)|<!DOCTYPE[^>\[]*(?:\[.*?\])?[^>]*>"
    r"|</(?P<end>[^\s<>/]+)\s*>"
    r"|<(?P<start>[^\s<>/!?]+)(?P<attributes>(?:[^<>\"'/]|\"[^\"]*\"|'[^']*'|/(?!>))*)(?P<empty>/?)>",
    re.DOTALL,
)
_ATTRIBUTE = re.compile(r"([^\s=\"'/]+)\s*=\s*(?:\"([^\"]*)\"|'([^']*)')", re.DOTALL)
_STEP = re.compile(r"[^/\[]+(?:\[@[\w:]+='[^']*'\])*")
_NAMED = re.compile(r"\[@([\w:]+)='([^']*)'\]")


@functools.lru_cache(maxsize=4)
def read_tags(text: str) -> tuple[Tag, ...]:
    """All elements, in the order of their start tags; what is in comments is none."""
    found: list[Tag] = []
    opened: list[int] = []  # indices in `found`
    for token in _TOKEN.finditer(text):
        if token["start"] is not None:
            around = tuple(found[index] for index in opened)
            offset = token.start("attributes")
            attributes = {
                one[1]: Attribute(
                    Span(offset + one.start(1), offset + one.end(1)),
                    Span(*(offset + place for place in one.span(2 if one[2] is not None else 3))),
                    one[2] if one[2] is not None else one[3],
                )
                for one in _ATTRIBUTE.finditer(token["attributes"])
            }
            is_empty = bool(token["empty"])
            found.append(
                Tag(token["start"], Span(*token.span()), attributes, is_empty, None, around)
            )
            if not is_empty:
                opened.append(len(found) - 1)
        elif token["end"] is not None and opened and found[opened[-1]].name == token["end"]:
            index = opened.pop()
            found[index] = found[index]._replace(end=Span(*token.span()))
    return tuple(found)


def steps(element: str) -> list[str]:
    """The steps of an XML path: `link[@name='arm']/visual` has two."""
    return _STEP.findall(element)


def find_tag(source: SourceText, line: int | None, element: str | None) -> tuple[Tag, str] | None:
    """Find the element that a diagnostic is about, in the text that a person wrote.

    Returns:
        The element, and the attribute that the path ends with or an empty text; None where it is
        not certain which one is meant.
    """
    path = steps(element or "")
    attribute = path.pop()[1:] if path and path[-1].startswith("@") else ""
    if not path or line is None:
        return None
    name = path[-1].partition("[")[0]
    on_line = [
        tag for tag in read_tags(source.text) if tag.name == name and _is_on(source, tag, line)
    ]
    if len(on_line) > 1:
        on_line = [tag for tag in on_line if _fits(tag, path)]
    return (on_line[0], attribute) if len(on_line) == 1 else None


def _is_on(source: SourceText, tag: Tag, line: int) -> bool:
    """Whether a start tag is on a line; parsers differ in whether its first or its last counts."""
    return source.line_at(tag.start.start) <= line <= source.line_at(tag.start.end - 1)


def _fits(tag: Tag, path: Sequence[str]) -> bool:
    """Whether an element and those around it have the names, and the attributes, of a path."""
    for around, step in zip(reversed((*tag.path, tag)), reversed(path), strict=False):
        if around.name != step.partition("[")[0]:
            return False
        for key, value in _NAMED.findall(step):
            written = around.attributes.get(key)
            if written is None or written.text != value:
                return False
    return True


def children(tags: Sequence[Tag], parent: Tag) -> Iterator[Tag]:
    """The elements directly in another one."""
    for tag in tags:
        if tag.path and tag.path[-1].start == parent.start:
            yield tag
