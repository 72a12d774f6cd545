"""The regular expressions of CMake, as far as Python's `re` reads them alike and in a known time.

Whoever wrote the build file chose both the pattern and the text, and `re` tries some patterns on
some texts for years. What it may try too long, a repeated group above all, is not known here.

Source: cmake-language documentation of string(), "Regex Specification", and RegularExpression.cxx
of KWSys.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import NamedTuple

LONGEST = 500  # letters of a pattern
MOST_TRIES = 10_000_000  # of Python's `re`
# A set of letters (a backslash stands for itself there), an escaped letter, or a letter.
_PARTS = re.compile(r"\[\^?\]?[^\]]*\]|\\.|.", re.DOTALL)
_REPEATING = frozenset("*+?")
_NOT_REPEATABLE = frozenset(("", "^", "$", "(", "|", *_REPEATING))


class Regex(NamedTuple):
    """A pattern, and what its search costs at most."""

    python: re.Pattern[str]
    repetitions: int  # without a bound
    choices: int
    has_start: bool

    def tries(self, text: str) -> int:
        """At most how many ways a search in the text tries."""
        tries: int = max(len(text), 2) ** (self.repetitions + 1) * 2 ** min(self.choices, 30)
        return tries

    def search(self, text: str) -> bool | None:
        """Whether the pattern matches somewhere in the text; None if that may take too long."""
        if self.tries(text) > MOST_TRIES:
            return None
        return self.python.search(text) is not None


@lru_cache(256)
def compiled(pattern: str) -> Regex | None:
    """The regular expression of a pattern; None if CMake refuses it, or it repeats groups."""
    if len(pattern) > LONGEST:
        return None
    parts = _PARTS.findall(pattern)
    for before, part in zip(("", *parts), parts, strict=False):
        if part in _REPEATING and (before in _NOT_REPEATABLE or (before == ")" and part != "?")):
            return None
    if {"[", "\\"} & {*parts}:  # a set that does not end, or an escape of nothing
        return None
    try:
        python = re.compile("".join(map(_as_python, parts)), re.DOTALL)
    except (re.error, RecursionError, OverflowError):
        return None
    return Regex(
        python=python,
        repetitions=parts.count("*") + parts.count("+"),
        choices=parts.count("|") + parts.count("?"),
        has_start="^" in parts,
    )


def _as_python(part: str) -> str:
    if len(part) == 1:
        return {"^": r"(?:\A)", "$": r"(?:\Z)"}.get(
            part, part if part in "().*+?|" else re.escape(part)
        )
    if part.startswith("\\"):
        return re.escape(part[1])
    start = "[^" if part.startswith("[^") else "["
    return start + re.sub(r"[\\\[\]&~|^]", r"\\\g<0>", part[len(start) : -1]) + "]"


def search(pattern: str, text: str) -> bool | None:
    """Whether CMake finds the pattern in the text; None if that is not known."""
    regex = compiled(pattern)
    return None if regex is None else regex.search(text)


def replace(pattern: str, replacement: str, text: str) -> str | None:
    """What string(REGEX REPLACE) makes of the text; None if that is not known.

    Where CMake's versions differ in what they take for the start of a text after the first match
    (policy CMP0186), nothing is known.
    """
    regex = compiled(pattern)
    if regex is None or regex.search("") is not False or regex.tries(text) > MOST_TRIES:
        return None  # CMake refuses to replace an empty text
    parts: list[str] = []
    position = 0
    while position < len(text) and (match := regex.python.search(text, position)) is not None:
        if match.end() == match.start():  # CMake: "matched an empty string"
            return None
        filled = _filled(replacement, match)
        if filled is None:
            return None
        parts += (text[position : match.start()], filled)
        position = match.end()
        if regex.has_start and regex.search(text[position:]) is not False:
            return None
    return "".join(parts) + text[position:]


def _filled(replacement: str, match: re.Match[str]) -> str | None:
    """The replacement, with what the groups matched; None where CMake may refuse it."""
    parts: list[str] = []
    position = 0
    for reference in re.finditer(r"\\(.?)", replacement, re.DOTALL):
        sign = reference[1]
        if sign.isdigit() and int(sign) <= match.re.groups and match[int(sign)] is not None:
            value = match[int(sign)]
        elif sign in {"n", "\\"}:
            value = "\n" if sign == "n" else sign
        else:
            return None
        parts += (replacement[position : reference.start()], value)
        position = reference.end()
    return "".join(parts) + replacement[position:]
