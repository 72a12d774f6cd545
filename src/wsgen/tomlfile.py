"""TOML files; the one place that knows where the parser of this Python is."""

from __future__ import annotations

import re
import sys
from collections import Counter
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


_WORD = r"""(?:"[^"]*"|'[^']*'|[\w-]+)"""
_DOTTED = rf"{_WORD}(?:\s*\.\s*{_WORD})*"
_HEADER = rf"\s*(\[\[?)\s*({_DOTTED})\s*\]"
_KEY = rf"\s*({_DOTTED})\s*="


def load(file: Path) -> dict[str, Any]:
    """The document of a file.

    Raises:
        OSError: the file cannot be read.
        ValueError: it is no TOML, or not UTF-8; the message says where.
    """
    document: dict[str, Any] = tomllib.loads(file.read_text(encoding="utf-8"))
    return document


def find_line(text: str, where: Sequence[str]) -> int | None:
    """The line (from 1) of the key that is meant, or of what is nearest around it.

    `where` is the way to it, with the index of a table in an array as a number in digits. Keys
    within a table on one line are on that line. None if nothing of the way is in the text. The
    standard library's parser does not say on which line something stands.
    """
    table: list[str] = []
    arrays: Counter[str] = Counter()
    best, found = 0, None
    for number, line in enumerate(text.splitlines(), start=1):
        header = re.match(_HEADER, line)
        if header is not None:
            table = _within_arrays(_split(header[2]), arrays, is_array=header[1] == "[[")
            way = table
        elif (key := re.match(_KEY, line)) is not None:
            way = table + _split(key[1])
        else:
            continue
        shared = _shared(way, where)
        # The way leads here or goes on from here; a neighbor of what is meant is no place.
        if shared > best and shared in {len(way), len(where)}:
            best, found = shared, number
    return found


def _within_arrays(words: list[str], arrays: Counter[str], *, is_array: bool) -> list[str]:
    """The way to a table, with the indices of the arrays around it; `arrays` counts them."""
    way: list[str] = []
    for place, word in enumerate(words, start=1):
        way.append(word)
        name = ".".join(way)
        if is_array and place == len(words):
            arrays[name] += 1
        if arrays[name]:
            way.append(str(arrays[name] - 1))
    return way


def _split(dotted: str) -> list[str]:
    return [word.strip("\"'") for word in re.findall(_WORD, dotted)]


def _shared(first: Sequence[str], second: Sequence[str]) -> int:
    """How many words two ways begin with alike."""
    for index, (one, other) in enumerate(zip(first, second, strict=False)):
        if one != other:
            return index
    return min(len(first), len(second))
