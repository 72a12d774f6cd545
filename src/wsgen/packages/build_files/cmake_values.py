"""Values of CMake where some are not known: texts, lists, conditions, regular expressions."""

from __future__ import annotations

import os
import re
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from wsgen.packages.build_files.cmake_text import QUOTED, UNQUOTED, Argument
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence


UNKNOWN = "\ue000"  # stands in a text for what is not known
SEMICOLON = "\ue001"  # one that does not separate elements
BUILD = "/\ue002build"  # stands for the build folder
PREFIX = "/\ue002prefix"  # stands for the install prefix

_REFERENCE = lazy_pattern(r"\$(ENV|CACHE)?\{")
_ESCAPES = {"n": "\n", "t": "\t", "r": "\r", "0": "\0", ";": SEMICOLON}


def is_known(text: str) -> bool:
    """Whether nothing in it is unknown."""
    return UNKNOWN not in text


def expand(text: str, look_up: Callable[[str, str], str]) -> str:
    """Replace the references to variables, and escapes.

    `look_up` gets the kind of the variable (ENV, CACHE or nothing) and its name.
    """
    if "$" not in text and "\\" not in text:
        return text
    return _expand(text, 0, look_up, is_inside=False)[0]


def _expand(
    text: str, position: int, look_up: Callable[[str, str], str], *, is_inside: bool
) -> tuple[str, int]:
    parts: list[str] = []
    while position < len(text):
        sign = text[position]
        reference = _REFERENCE.match(text, position) if sign == "$" else None
        if reference is not None:
            name, position = _expand(text, reference.end(), look_up, is_inside=True)
            parts.append(UNKNOWN if UNKNOWN in name else look_up(reference[1] or "", name))
        elif sign == "\\" and position + 1 < len(text):
            parts.append(_ESCAPES.get(text[position + 1], text[position + 1]))
            position += 2
        elif sign == "}" and is_inside:
            return "".join(parts), position + 1
        else:
            parts.append(sign)
            position += 1
    return "".join(parts), position


def split_list(text: str) -> list[str]:
    """The elements of a list; empty ones do not count, as in unquoted arguments."""
    return [part for part in text.split(";") if part] if ";" in text else [text] if text else []


TRUE = frozenset({"1", "ON", "YES", "TRUE", "Y"})
FALSE = frozenset({"", "0", "OFF", "NO", "FALSE", "N", "IGNORE", "NOTFOUND"})


def truth(text: str) -> bool | None:
    """The truth of a constant; None of a text that is neither true nor false, or not known."""
    if UNKNOWN in text:
        return None
    upper = text.upper()
    if upper in TRUE:
        return True
    if upper in FALSE or upper.endswith("-NOTFOUND"):
        return False
    try:
        return float(text) != 0
    except ValueError:
        return None


class Conditions:
    """Evaluates the condition of an if(); True, False or None, if it is not known."""

    def __init__(
        self,
        variable: Callable[[str], str | None],  # None: not defined; UNKNOWN: it may be
        exists: Callable[[str], bool | None],
        is_command: Callable[[str], bool | None],
        is_target: Callable[[str], bool | None],
        matches: Callable[[str, str], bool | None],  # a pattern, in a text
    ) -> None:
        self._variable = variable
        self._exists = exists
        self._is_command = is_command
        self._is_target = is_target
        self._matches = matches
        self._words: Sequence[Argument] = ()
        self._position = 0

    def evaluate(self, words: Sequence[Argument]) -> bool | None:
        """The value of a condition whose arguments are expanded."""
        self._words, self._position = words, 0
        try:
            value = self._or()
        except (IndexError, ValueError):
            return None
        return value if self._position == len(words) else None

    def _peek(self) -> str:
        if self._position >= len(self._words):
            return ""
        word = self._words[self._position]
        return word.text if word.kind == UNQUOTED else ""

    def _next(self) -> Argument:
        self._position += 1
        return self._words[self._position - 1]

    def _or(self) -> bool | None:
        value = self._and()
        while self._peek() == "OR":
            self._next()
            other = self._and()
            value = True if True in {value, other} else None if None in {value, other} else False
        return value

    def _and(self) -> bool | None:
        value = self._not()
        while self._peek() == "AND":
            self._next()
            other = self._not()
            value = False if False in {value, other} else None if None in {value, other} else True
        return value

    def _not(self) -> bool | None:
        if self._peek() == "NOT":
            self._next()
            value = self._not()
            return None if value is None else not value
        return self._test()

    def _test(self) -> bool | None:
        word = self._next()
        if word.kind == UNQUOTED:
            if word.text == "(":
                value = self._or()
                self._next()
                return value
            unary = _UNARY.get(word.text)
            if unary is not None and self._position < len(self._words):
                return unary(self, self._next().text)
        operator = self._peek()
        if operator in _BINARY:
            self._next()
            return self._compare(word, operator, self._next())
        return self._truth_of(word)

    def _truth_of(self, word: Argument) -> bool | None:
        value = truth(word.text)
        if value is not None or UNKNOWN in word.text:
            return value
        if word.kind == QUOTED:
            return False
        text = self._variable(word.text)
        if text is None:
            return False
        if UNKNOWN in text:
            return None
        value = truth(text)
        return True if value is None else value

    def _value(self, word: Argument) -> str:
        if word.kind != UNQUOTED:
            return word.text
        text = self._variable(word.text)
        if text is None or (UNKNOWN in text and not re.search(r"[A-Z]_|_[A-Z]", word.text)):
            return word.text
        return text

    def _compare(self, left: Argument, operator: str, right: Argument) -> bool | None:
        if operator == "IN_LIST":
            one, many = self._value(left), self._variable(right.text)
            if many is None:
                return False
            return None if UNKNOWN in one + many else one in many.split(";")
        one = self._value(left)
        other = right.text if operator == "MATCHES" else self._value(right)
        if UNKNOWN in one + other:
            return None
        if operator == "MATCHES":
            return self._matches(other, one)
        return _BINARY[operator](one, other)

    def _defined(self, name: str) -> bool | None:
        if name.startswith(("ENV{", "CACHE{")):
            return None
        text = self._variable(name)
        # An empty one may be one that was unset.
        return False if text is None else None if text in {"", UNKNOWN} else True

    def _folder(self, path: str) -> bool | None:
        found = self._exists(path)
        return found and os.path.isdir(path)


def _numbers(test: Callable[[float, float], bool]) -> Callable[[str, str], bool]:
    return lambda one, other: test(float(one), float(other))


def _versions(test: Callable[[tuple[int, ...], tuple[int, ...]], bool]) -> Callable[..., bool]:
    def compare(one: str, other: str) -> bool:
        first, second = version(one), version(other)
        width = max(len(first), len(second))
        padded = [numbers + (0,) * (width - len(numbers)) for numbers in (first, second)]
        return test(padded[0], padded[1])

    return compare


def version(text: str) -> tuple[int, ...]:
    """The numbers of a version."""
    return tuple(int(part) for part in re.findall(r"\d+", text.partition("-")[0]))


def _unknown(one: str, other: str) -> bool:
    raise ValueError(one, other)


_TESTS: dict[str, Callable[..., bool]] = {
    "EQUAL": lambda one, other: one == other,
    "LESS": lambda one, other: one < other,
    "GREATER": lambda one, other: one > other,
    "LESS_EQUAL": lambda one, other: one <= other,
    "GREATER_EQUAL": lambda one, other: one >= other,
}
_BINARY: dict[str, Callable[[str, str], bool]] = {
    **{name: _numbers(test) for name, test in _TESTS.items()},
    **{f"VERSION_{name}": _versions(test) for name, test in _TESTS.items()},
    **{f"STR{name}": test for name, test in _TESTS.items()},
    "PATH_EQUAL": lambda one, other: os.path.normpath(one) == os.path.normpath(other),
    "MATCHES": _unknown,  # the reader looks for the pattern
    "IN_LIST": lambda one, other: one in other.split(";"),
    "IS_NEWER_THAN": _unknown,
}
_UNARY: dict[str, Callable[[Conditions, str], bool | None]] = {
    "EXISTS": lambda self, path: self._exists(path),
    "IS_DIRECTORY": lambda self, path: self._folder(path),
    "IS_ABSOLUTE": lambda self, path: None if UNKNOWN in path else path.startswith("/"),
    "IS_SYMLINK": lambda self, path: None,
    "COMMAND": lambda self, name: self._is_command(name),
    "TARGET": lambda self, name: self._is_target(name),
    "TEST": lambda self, name: None,
    "POLICY": lambda self, name: True,
    "DEFINED": lambda self, name: self._defined(name),
}


# The regular expressions of CMake, as far as Python's `re` reads them alike and in a known time:
# whoever wrote the build file chose both the pattern and the text, and `re` tries some patterns on
# some texts for years. What it may try too long, a repeated group above all, is not known here.
# Source: cmake-language documentation of string(), "Regex Specification", and RegularExpression.cxx
# of KWSys.

LONGEST = 500  # letters of a pattern
MOST_TRIES = 10_000_000  # of Python's `re`
# A set of letters (a backslash stands for itself there), an escaped letter, or a letter.
_PARTS = lazy_pattern(r"\[\^?\]?[^\]]*\]|\\.|.", re.DOTALL)
_REPEATING = frozenset("*+?")
_NOT_REPEATABLE = frozenset(("", "^", "$", "(", "|", *_REPEATING))


class Regex(NamedTuple):
    """A pattern, and what its search costs at most."""

    python: re.Pattern[str]
    repetitions: int  # without a bound
    choices: int

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
def compiled_regex(pattern: str) -> Regex | None:
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


def search_regex(pattern: str, text: str) -> bool | None:
    """Whether CMake finds the pattern in the text; None if that is not known."""
    regex = compiled_regex(pattern)
    return None if regex is None else regex.search(text)
