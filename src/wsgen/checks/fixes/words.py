"""Fixes of single words in files of any kind, and of comments that allow nothing."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.checks.fixes.meant import is_surely
from wsgen.checks.fixes.source import Edit
from wsgen.text.suggestions import suggested

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.checks.fixes.source import SourceText
    from wsgen.diagnostics import Diagnostic


WORD = re.compile(r"[\w./:-]*\w")
COMMENT = re.compile(r"[ \t]*(?:<!--[ \t]*wsgen:(?:(?!-->).)*-->|#[ \t]*wsgen:[^\r\n]*)")
ON_ONE_LINE = re.compile(r"[ \t]*(?:\"(?!\")|'(?!')|\{.*\}[ \t]*(?:#.*)?\r?$)", re.MULTILINE)
ENTRY = re.compile(r"[ \t]*[\"']?[\w-]+[\"']?[ \t]*=")


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
