"""The regular expressions of CMake, in a time that grows with the text alone.

Python's `re` has another syntax, and tries some patterns on some texts for years. Whoever wrote the
build file chose both, so that what takes too long is not known here.

Source: cmake-language documentation of string(), "Regex Specification", and RegularExpression.cxx
of KWSys.
"""

from __future__ import annotations

import re
from functools import lru_cache

from wsgen.values import NamedTuple

LONGEST = 2_000  # letters of a pattern
DEEPEST = 40  # groups in each other; KWSys has 32
MOST_WORK = 2_000_000  # letters of a text, and states of the pattern on the way to them
MOST_TRANSITIONS = 20_000  # that are remembered
MOST_TRIES = 10_000_000  # of Python's `re`, for replacements


class Letters(NamedTuple):
    """The letters that match at a place of the pattern: these, or all but these."""

    letters: frozenset[str]
    is_negated: bool

    def has(self, letter: str) -> bool:
        """Whether a letter is one of them."""
        return (letter in self.letters) is not self.is_negated


class InvalidRegexError(ValueError):
    """CMake refuses the pattern, or it is larger than anything that is read here."""


_START, _END, _MATCH, _SPLIT = "start", "end", "match", "split"
# Letters, or one of the four above; and the places that may come next.
Instruction = tuple["Letters | str", tuple[int, ...]]


class Regex:
    """A pattern, as an automaton whose states are made when a text needs them."""

    def __init__(self, pattern: str) -> None:
        """Read the pattern.

        Raises:
            InvalidRegexError: CMake would refuse it.
        """
        parser = _Parser(pattern)
        self.for_python = parser.for_python
        self.repeats_groups = parser.repeats_groups
        self.repetitions = parser.repetitions
        self.choices = parser.choices
        self.has_start = parser.has_start
        self.work = 0  # of all searches so far; MOST_WORK says what counts
        self._program = parser.program
        self._next: dict[tuple[frozenset[int], str], frozenset[int]] = {}
        self._again = self._follow((0,), is_start=False, is_end=False)

    def search(self, text: str) -> bool | None:
        """Whether the pattern matches somewhere in the text; None if that takes too long."""
        before = self.work
        state = self._follow((0,), is_start=True, is_end=False)
        last = len(self._program) - 1
        for letter in text:
            if last in state:
                return True
            if self.work - before > MOST_WORK:
                return None
            self.work += 1
            following = self._next.get((state, letter))
            if following is None:
                following = self._step(state, letter)
            state = following
        return last in self._follow(tuple(state), is_start=not text, is_end=True)

    def _step(self, state: frozenset[int], letter: str) -> frozenset[int]:
        reached: list[int] = []
        for place in state:
            what, following = self._program[place]
            if isinstance(what, Letters) and what.has(letter):
                reached += following
        after = self._follow(tuple(reached), is_start=False, is_end=False) | self._again
        self.work += len(state)
        if len(self._next) > MOST_TRANSITIONS:
            self._next.clear()
        self._next[state, letter] = after
        return after

    def _follow(self, places: tuple[int, ...], *, is_start: bool, is_end: bool) -> frozenset[int]:
        """The places that are reached without a letter."""
        found: set[int] = set()
        waiting = list(places)
        while waiting:
            place = waiting.pop()
            if place in found:
                continue
            found.add(place)
            what, following = self._program[place]
            if what == _SPLIT or (what == _START and is_start) or (what == _END and is_end):
                waiting += following
        self.work += len(found)
        return frozenset(found)


class _Parser:
    """Reads a pattern into a program, and into a pattern for Python's `re`."""

    def __init__(self, pattern: str) -> None:
        if len(pattern) > LONGEST:
            raise InvalidRegexError(pattern)
        self._pattern = pattern
        self._position = 0
        self._depth = 0
        self.program: list[Instruction] = []
        self.repetitions = 0  # without a bound
        self.choices = 0
        self.repeats_groups = False
        self.has_start = False
        self.for_python, _ = self._alternatives()
        if self._position < len(pattern):
            raise InvalidRegexError(pattern)
        self.program.append((_MATCH, ()))

    def _peek(self) -> str:
        return self._pattern[self._position : self._position + 1]

    def _take(self) -> str:
        letter = self._peek()
        if not letter:
            raise InvalidRegexError(self._pattern)
        self._position += 1
        return letter

    def _alternatives(self) -> tuple[str, bool]:
        """Read up to a closing parenthesis; whether what matches has a letter in any case."""
        start = len(self.program)
        python, has_width = self._sequence()
        ends: list[int] = []
        while self._peek() == "|":
            self._position += 1
            self.choices += 1
            self._insert(start, (_SPLIT, (1, len(self.program) - start + 2)))
            ends.append(len(self.program))
            self.program.append((_SPLIT, ()))
            start = len(self.program)
            more, has_more_width = self._sequence()
            python, has_width = f"{python}|{more}", has_width and has_more_width
        for end in ends:
            self.program[end] = (_SPLIT, (len(self.program),))
        return python, has_width

    def _insert(self, place: int, instruction: Instruction) -> None:
        """Put an instruction, whose next places count from itself, before what is there."""
        what, following = instruction
        self.program[place:] = [
            (what, tuple(place + one for one in following)),
            *(
                (other, tuple(one + 1 if one >= place else one for one in next_ones))
                for other, next_ones in self.program[place:]
            ),
        ]

    def _sequence(self) -> tuple[str, bool]:
        parts: list[str] = []
        has_width = False
        while self._peek() not in {"", "|", ")"}:
            part, has_more_width = self._piece()
            parts.append(part)
            has_width = has_width or has_more_width
        return "".join(parts), has_width

    def _piece(self) -> tuple[str, bool]:
        start = len(self.program)
        is_group = self._peek() == "("
        python, has_width = self._atom()
        sign = self._peek()
        if sign not in {"*", "+", "?"} or not sign:
            return python, has_width
        self._position += 1
        if not has_width and sign != "?":  # KWSys: "*+ operand could be empty"
            raise InvalidRegexError(self._pattern)
        if self._peek() in {"*", "+", "?"} and self._peek():  # KWSys: "nested *?+"
            raise InvalidRegexError(self._pattern)
        length = len(self.program) - start
        if sign == "+":
            self.program.append((_SPLIT, (start, len(self.program) + 1)))
        elif sign == "*":
            self._insert(start, (_SPLIT, (1, length + 2)))
            self.program.append((_SPLIT, (start,)))
        else:
            self._insert(start, (_SPLIT, (1, length + 1)))
            self.choices += 1
        if sign != "?":
            self.repetitions += 1
            self.repeats_groups = self.repeats_groups or is_group
        return python + sign, has_width and sign == "+"

    def _atom(self) -> tuple[str, bool]:
        letter = self._take()
        if letter == "(":
            self._depth += 1
            if self._depth > DEEPEST:
                raise InvalidRegexError(self._pattern)
            inner, has_width = self._alternatives()
            if self._take() != ")":
                raise InvalidRegexError(self._pattern)
            self._depth -= 1
            return f"({inner})", has_width
        if letter in {"*", "+", "?"}:
            raise InvalidRegexError(self._pattern)
        if letter in {"^", "$"}:
            self.has_start = self.has_start or letter == "^"
            self._add(_START if letter == "^" else _END)
            return r"(?:\A)" if letter == "^" else r"(?:\Z)", False
        if letter == ".":
            self._add(Letters(frozenset(), is_negated=True))
            return r"[\s\S]", True
        if letter == "[":
            letters = self._letters()
            self._add(letters)
            inside = "".join(re.escape(one) for one in sorted(letters.letters))
            return f"[{'^' if letters.is_negated else ''}{inside}]", True
        letter = self._take() if letter == "\\" else letter
        self._add(Letters(frozenset(letter), is_negated=False))
        return re.escape(letter), True

    def _add(self, what: Letters | str) -> None:
        self.program.append((what, (len(self.program) + 1,)))

    def _letters(self) -> Letters:
        """The letters in brackets; a backslash stands for itself there."""
        is_negated = self._peek() == "^"
        self._position += is_negated
        listed: list[str] = []
        if self._peek() in {"]", "-"} and self._peek():
            listed.append(self._take())
        while self._peek() != "]":
            letter = self._take()
            if letter != "-" or self._peek() in {"]", ""} or not listed:
                listed.append(letter)
                continue
            first, last = ord(listed[-1]), ord(self._take())
            if first > last or last - first > 0x1000:
                raise InvalidRegexError(self._pattern)
            listed += map(chr, range(first, last + 1))
        self._position += 1
        return Letters(frozenset(listed), is_negated)


@lru_cache(256)
def compiled(pattern: str) -> Regex | None:
    """The regular expression of a pattern; None if CMake refuses it."""
    try:
        return Regex(pattern)
    except (InvalidRegexError, RecursionError):
        return None


def search(pattern: str, text: str) -> bool | None:
    """Whether CMake finds the pattern in the text; None if that is not known."""
    regex = compiled(pattern)
    return None if regex is None else regex.search(text)


def replace(pattern: str, replacement: str, text: str) -> str | None:
    """What string(REGEX REPLACE) makes of the text; None if that is not known.

    Only the patterns whose worst case is short are tried. Where CMake's versions differ in what
    they take for the start of a text after the first match (policy CMP0186), nothing is known.
    """
    regex = compiled(pattern)
    if regex is None or regex.repeats_groups or regex.search("") is not False:
        return None  # CMake refuses to replace an empty text
    tries = max(len(text), 2) ** (regex.repetitions + 1) * 2 ** min(regex.choices, 30)
    if tries > MOST_TRIES:
        return None
    parts: list[str] = []
    position = 0
    of_python = re.compile(regex.for_python)
    while position < len(text) and (match := of_python.search(text, position)) is not None:
        if match.end() == match.start():  # CMake: "matched an empty string"
            return None
        filled = _filled(replacement, match)
        if filled is None:
            return None
        parts += (text[position : match.start()], filled)
        position = match.end()
        if regex.has_start and search(pattern, text[position:]) is not False:
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
