"""Words that are misspelled, in files of any kind: what is surely meant, and the fixes."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.checks.fixes.source import Edit
from wsgen.text.suggestions import LONGEST, mistakes_between, suggested

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.checks.fixes.source import SourceText
    from wsgen.diagnostics import Diagnostic


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
