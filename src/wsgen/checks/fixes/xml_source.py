"""XML as it is written: the places of tags, attributes and texts, which no parser keeps."""

from __future__ import annotations

import functools
import re
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from wsgen.checks.fixes.source import SourceText


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
