"""Evaluate the conditions of a package.xml (REP 149), as far as their variables are known."""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING

from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable


_TOKEN = lazy_pattern(r"""\s*(?:(\(|\)|<=|>=|==|!=|<|>)|\$(\w+)|"([^"]*)"|'([^']*)'|([\w./+-]+))""")
_COMPARISONS: dict[str, Callable[[str, str], bool]] = {
    "<=": operator.le,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    ">": operator.gt,
}


class _SyntaxError(Exception):
    """Not a condition; it does not leave this module."""


def holds(condition: str, distro: str | None) -> bool | None:
    """Whether a condition holds in ROS 2; None where that depends on what is not known.

    Args:
        condition: the value of the attribute, such as `$ROS_DISTRO == humble`.
        distro: the distribution; None where it is not known.
    """
    known = {"ROS_VERSION": "2", "ROS_PYTHON_VERSION": "3"}
    if distro is not None:
        known["ROS_DISTRO"] = distro
    try:
        reader = _Reader(_tokens(condition), known)
        value = reader.alternatives()
    except _SyntaxError:
        return None
    return None if reader.tokens else value


def _tokens(condition: str) -> list[tuple[str, str]]:
    """Its tokens in reversed order: kind (`sign`, `variable`, `value` or `word`) and text."""
    found: list[tuple[str, str]] = []
    text = condition.rstrip()
    place = 0
    while place < len(text):
        match = _TOKEN.match(text, place)
        if match is None:
            raise _SyntaxError
        place = match.end()
        kind = ("sign", "variable", "value", "value", "word")[(match.lastindex or 1) - 1]
        found.append((kind, match[match.lastindex or 1]))
    return found[::-1]


class _Reader:
    """Evaluates while it parses; a value is None where it is not known."""

    def __init__(self, tokens: list[tuple[str, str]], known: dict[str, str]) -> None:
        self.tokens = tokens
        self._known = known

    def alternatives(self) -> bool | None:
        values = [self._conjunction()]
        while self._take(("word", "or")):
            values.append(self._conjunction())
        return True if True in values else None if None in values else False

    def _conjunction(self) -> bool | None:
        values = [self._comparison()]
        while self._take(("word", "and")):
            values.append(self._comparison())
        return False if False in values else None if None in values else True

    def _comparison(self) -> bool | None:
        if self._take(("sign", "(")):
            value = self.alternatives()
            if not self._take(("sign", ")")):
                raise _SyntaxError
            return value
        left = self._operand()
        kind, sign = self._next()
        if kind != "sign" or sign not in _COMPARISONS:
            raise _SyntaxError
        right = self._operand()
        return None if left is None or right is None else _COMPARISONS[sign](left, right)

    def _operand(self) -> str | None:
        kind, text = self._next()
        if kind == "sign":
            raise _SyntaxError
        return self._known.get(text) if kind == "variable" else text

    def _next(self) -> tuple[str, str]:
        if not self.tokens:
            raise _SyntaxError
        return self.tokens.pop()

    def _take(self, token: tuple[str, str]) -> bool:
        if self.tokens and self.tokens[-1] == token:
            self.tokens.pop()
            return True
        return False
