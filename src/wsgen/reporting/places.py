"""Where on its line a diagnostic is: the columns of the element, attribute or name it means."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.checks.fixes.source import SourceText, read_source
from wsgen.checks.fixes.xml_source import find_tag
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic


QUOTED = re.compile(r"`([^`\n]+)`|'([^'\n]+)'|\"([^\"\n]+)\"|<([\w:.-]+)>|\b(\w+)\(\)")
_LETTER = re.compile(r"[^\W\d]")


@dataclass(frozen=True, kw_only=True)
class Place:
    """A piece of a line."""

    column: int  # of its first character, 1-based
    end_column: int  # of the character behind its last
    text: str  # the whole line, without its end


class Places:
    """Finds places; each file is read once."""

    def __init__(self) -> None:
        self._sources: dict[Path, SourceText | None] = {}

    def find(self, diagnostic: Diagnostic) -> Place | None:
        """The place of a diagnostic; None where it has no line, or the file has no such line."""
        if diagnostic.file is None or diagnostic.line is None:
            return None
        if diagnostic.file not in self._sources:
            self._sources[diagnostic.file] = read_source(diagnostic.file)
        source = self._sources[diagnostic.file]
        if source is None:
            return None
        begin = source.start_of(diagnostic.line)
        text = source.text[begin : source.start_of(diagnostic.line + 1)].rstrip("\r\n")
        if not text.strip():
            return None
        start, end = _in_tag(diagnostic, source, begin, text) or _in_line(diagnostic, text)
        return Place(column=start + 1, end_column=end + 1, text=text)


def _in_tag(
    diagnostic: Diagnostic, source: SourceText, begin: int, text: str
) -> tuple[int, int] | None:
    """The attribute or the start tag, as far as it is on the line."""
    if not source.text.lstrip().startswith("<"):
        return None
    found = find_tag(source, diagnostic.line, diagnostic.element)
    if found is None:
        return None
    tag, attribute = found
    written = tag.attributes.get(attribute)
    span = (written.name.start, written.value.end + 1) if written else tag.start
    start, end = max(span[0] - begin, 0), min(span[1] - begin, len(text))
    return (start, end) if start < end else None


def _in_line(diagnostic: Diagnostic, text: str) -> tuple[int, int]:
    """What the diagnostic names, if the line has it; else the line without its indent."""
    names = [
        name
        for text_of in (diagnostic.message, diagnostic.hint or "")
        for found in QUOTED.findall(text_of)
        for name in found
        if _LETTER.search(name)  # `1` is anywhere
    ]
    for name in (diagnostic.element or "", *names):
        place = re.search(rf"(?<!\w){re.escape(name)}(?!\w)", text) if name else None
        if place is not None:
            return place.start(), place.end()
    start = len(text) - len(text.lstrip())
    return start, len(text.rstrip())
