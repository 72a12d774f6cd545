"""What a hint suggests, and whether a misspelled word is so near to it that it must be meant."""

from __future__ import annotations

import re

SHORT = 4  # letters; of words up to this length, only capitals and the order of letters may differ
LONG = 8  # letters; from here on two letters may differ

_SUGGESTED = re.compile(r"Did you mean (?:`([^`]+)`|<([^>]+)>)\?")


def suggested(hint: str | None) -> str | None:
    """The one name that a hint asks for; None if it asks for none or several."""
    found = _SUGGESTED.search(hint or "")
    return None if found is None else found[1] or found[2]


def is_surely(written: str, meant: str) -> bool:
    """Whether a word is another one with a slip of the hand: `Revolute`, `inertail`, `bas_link`."""
    one, other = _plain(written), _plain(meant)
    if one == other or (sorted(one) == sorted(other) and len(one) > 1):
        return True
    length = min(len(one), len(other))
    allowed = 0 if length < SHORT else 1 if length < LONG else 2
    return _distance(one, other, allowed) <= allowed


def _plain(word: str) -> str:
    return re.sub(r"[\s_-]", "", word).casefold()


def _distance(one: str, other: str, most: int) -> int:
    """How many letters are changed, left out or added; more than `most` is not counted."""
    if abs(len(one) - len(other)) > most:
        return most + 1
    row = list(range(len(other) + 1))
    for place, letter in enumerate(one, start=1):
        before, row = row, [place]
        for column, another in enumerate(other, start=1):
            row.append(
                min(before[column] + 1, row[-1] + 1, before[column - 1] + (letter != another))
            )
    return row[-1]
