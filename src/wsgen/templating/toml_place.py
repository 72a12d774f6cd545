"""On which line of a TOML file something stands: the standard library's parser does not say."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

_WORD = r"""(?:"[^"]*"|'[^']*'|[\w-]+)"""
_DOTTED = rf"{_WORD}(?:\s*\.\s*{_WORD})*"
_HEADER = re.compile(rf"\s*(\[\[?)\s*({_DOTTED})\s*\]")
_KEY = re.compile(rf"\s*({_DOTTED})\s*=")


def find_line(text: str, where: Sequence[str]) -> int | None:
    """The line (from 1) of the key that is meant, or of what is nearest around it.

    `where` is the way to it, with the index of a table in an array as a number in digits. Keys
    within a table on one line are on that line. None if nothing of the way is in the text.
    """
    table: list[str] = []
    arrays: Counter[str] = Counter()
    best, found = 0, None
    for number, line in enumerate(text.splitlines(), start=1):
        header = _HEADER.match(line)
        if header is not None:
            table = _split(header[2])
            if header[1] == "[[":
                table.append(str(arrays[header[2]]))
                arrays[header[2]] += 1
            way = table
        elif (key := _KEY.match(line)) is not None:
            way = table + _split(key[1])
        else:
            continue
        shared = _shared(way, where)
        # The way leads here or goes on from here; a neighbour of what is meant is no place.
        if shared > best and shared in {len(way), len(where)}:
            best, found = shared, number
    return found


def _split(dotted: str) -> list[str]:
    return [word.strip("\"'") for word in re.findall(_WORD, dotted)]


def _shared(first: Sequence[str], second: Sequence[str]) -> int:
    """How many words two ways begin with alike."""
    for index, (one, other) in enumerate(zip(first, second, strict=False)):
        if one != other:
            return index
    return min(len(first), len(second))
