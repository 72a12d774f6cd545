"""Read TOML on every Python, and find the lines of keys."""

from __future__ import annotations

import re
import sys
from collections import Counter
from typing import TYPE_CHECKING, Any

from wsgen.files import refuse_irregular

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
    """Read the document of a file.

    Raises:
        OSError: the file cannot be read.
        ValueError: it is not TOML, or not UTF-8; the message says where.
    """
    if file.exists():
        refuse_irregular(file)
    document: dict[str, Any] = tomllib.loads(file.read_text(encoding="utf-8"))
    return document


def find_line(text: str, where: Sequence[str]) -> int | None:
    """Find the line (from 1) of a key, or of the nearest table around it.

    `where` is the path of keys, with the index of a table in an array as a number in digits. Keys
    of an inline table are on its line. None if nothing of the path is in the text. The parser of
    the standard library does not give the lines of values.
    """
    table: list[str] = []
    arrays: Counter[str] = Counter()
    best, found = 0, None
    for number, line in enumerate(text.splitlines(), start=1):
        header = re.match(_HEADER, line)
        if header is not None:
            table = _within_arrays(_split(header[2]), arrays, is_array=header[1] == "[[")
            path = table
        elif (key := re.match(_KEY, line)) is not None:
            path = table + _split(key[1])
        else:
            continue
        shared = _shared(path, where)
        # One path must contain the other: a sibling of the key is not its place.
        if shared > best and shared in {len(path), len(where)}:
            best, found = shared, number
    return found


def _within_arrays(words: list[str], arrays: Counter[str], *, is_array: bool) -> list[str]:
    """Return the path to a table, with the indices of the arrays around it, counted by `arrays`."""
    path: list[str] = []
    for place, word in enumerate(words, start=1):
        path.append(word)
        name = ".".join(path)
        if is_array and place == len(words):
            arrays[name] += 1
        if arrays[name]:
            path.append(str(arrays[name] - 1))
    return path


def _split(dotted: str) -> list[str]:
    return [word.strip("\"'") for word in re.findall(_WORD, dotted)]


def _shared(first: Sequence[str], second: Sequence[str]) -> int:
    """Count the words that two paths have in common at their start."""
    for index, (one, other) in enumerate(zip(first, second, strict=False)):
        if one != other:
            return index
    return min(len(first), len(second))
