"""Where something is inserted among its likes, so that no line of the author changes."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.source import Edit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.checks.fixes.source import SourceText

_COMMENT = re.compile(r"[ \t]*(?:#[^\n]*)?")


class Item(NamedTuple):
    """One of several likes, as it is written."""

    key: str  # by which they may be sorted
    start: int
    end: int


def insert_among(
    source: SourceText, items: Sequence[Item], key: str, text: str, *, comma: str = ""
) -> Edit | None:
    """Insert a line among likes: in their order, if they have one, else behind them.

    Args:
        source: The text.
        items: The likes, as they are written; at least one.
        key: By which the new one is sorted.
        text: Of the new line, without the comma behind it.
        comma: What is behind each of them, in the language of the text; empty for none.

    Returns:
        The edit; None where the likes are not on lines of their own.
    """
    keys = [one.key for one in items]
    is_sorted = len(keys) > 1 and keys == sorted(keys)
    above = next((one for one in items if is_sorted and one.key > key), None)
    if above is not None:
        return _above(source, above, f"{text}{comma}")
    last = items[-1]
    if not _begins_line(source, last):
        return None
    behind = _COMMENT.match(source.text, last.end)
    if comma:
        found = re.compile(rf"[ \t]*{re.escape(comma)}").match(source.text, last.end)
        if found is None:  # none may be added to the last one
            return _above(source, last, f"{text}{comma}")
        behind = _COMMENT.match(source.text, found.end())
    rest = re.compile(r"\r?\n").match(source.text, behind.end() if behind else last.end)
    if rest is None:
        return _above(source, last, f"{text}{comma}")
    line = f"{source.indent_at(last.start)}{text}{comma}{source.newline}"
    return Edit(start=rest.end(), end=rest.end(), text=line)


def _begins_line(source: SourceText, item: Item) -> bool:
    start = source.start_of(source.line_at(item.start))
    return not source.text[start : item.start].strip()


def _above(source: SourceText, item: Item, text: str) -> Edit | None:
    if not _begins_line(source, item):
        return None
    place = source.start_of(source.line_at(item.start))
    indent = source.indent_at(item.start)
    return Edit(start=place, end=place, text=f"{indent}{text}{source.newline}")


def insert_below(source: SourceText, place: int, text: str, *, apart: bool = False) -> Edit:
    """Insert lines below the line of a place.

    Args:
        source: The text.
        place: In the line.
        text: The lines, with line feeds between them.
        apart: A blank line is above them, and below what is not blank.
    """
    newline = source.newline
    lines = text.replace("\n", newline)
    at = source.start_of(source.line_at(place) + 1)
    if at == len(source.text) and not source.text.endswith("\n"):
        return Edit(start=at, end=at, text=f"{newline}{newline if apart else ''}{lines}")
    above = newline if apart else ""
    rest = source.text[at:].partition("\n")[0].strip() if apart else ""
    below = newline if rest else ""
    return Edit(start=at, end=at, text=f"{above}{lines}{newline}{below}")


def insert_above(source: SourceText, place: int, text: str, *, apart: bool = False) -> Edit:
    """Insert lines above the line of a place; with `apart` blank lines are around them."""
    newline = source.newline
    line = source.line_at(place)
    at = source.start_of(line)
    lines = text.replace("\n", newline)
    is_close = apart and line > 1 and source.text[source.start_of(line - 1) : at].strip()
    above, below = newline if is_close else "", newline if apart else ""
    return Edit(start=at, end=at, text=f"{above}{lines}{newline}{below}")
