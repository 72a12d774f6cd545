"""Find known names that are similar to a misspelled one, and suggest them in hints."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Sequence


# Least similarity of two words, as difflib measures it from 0 to 1.
SIMILAR = 0.6
MOST_LISTED = 8  # names in a hint
LONGEST = 200  # letters; difflib takes as many steps as two names have letters, multiplied


def nearest(name: str, known: Iterable[str], *, cutoff: float = SIMILAR) -> str | None:
    """Return the known name most similar to this one; None if none reaches `cutoff`."""
    near = _similar(name, set(known) - {name}, 1, cutoff)
    return near[0] if near else None


def misspelled_as(name: str, known: Iterable[str]) -> str | None:
    """The known name of which this one surely is a misspelling; None if it may be another name.

    Words are what `_` and `-` separate. The names differ in that alone, or in one letter of a word,
    two of a long one, but never in the first of all; digits are no typing mistakes, and short words
    with other letters mean something else. `msg` for `msgs` and `srv` for `srvs` are mistakes.
    """
    near = {
        other
        for other in known
        if other[:1] == name[:1]
        and abs(len(other) - len(name)) <= MOST_MISTAKES
        and other != name
        and _is_misspelled(name, other)
    }
    # A letter that is left out, as in `rclcp`, is more frequent than one too many.
    return min(
        near, key=lambda other: (mistakes_between(name, other), -len(other), other), default=None
    )


LONG_ENOUGH = 4  # letters of a word that a typing mistake leaves recognizable
LONG = 9
SHORT = 3
PLURALS = {("msg", "msgs"), ("srv", "srvs")}  # the last words of packages of interfaces
MOST_MISTAKES = 2  # words with a mistake, or letters of a long word


def _is_misspelled(name: str, other: str) -> bool:
    words, others = _words(name), _words(other)
    if "".join(words) == "".join(others):
        return True
    if len(words) != len(others):
        return False
    differing = [pair for pair in zip(words, others, strict=True) if pair[0] != pair[1]]
    return len(differing) <= MOST_MISTAKES and all(
        (
            min(len(word), len(meant)) >= LONG_ENOUGH
            or _is_swapped(word, meant)
            or _lacks_letter(word, meant)
            or (word, meant) in PLURALS
        )
        and word.strip("abcdefghijklmnopqrstuvwxyz") == meant.strip("abcdefghijklmnopqrstuvwxyz")
        and mistakes_between(word, meant) <= (MOST_MISTAKES if len(meant) >= LONG else 1)
        for word, meant in differing
    )


def _is_swapped(word: str, meant: str) -> bool:
    """Whether a short word has the letters of another one: `ors` for `ros`."""
    return len(meant) == SHORT and sorted(word) == sorted(meant)


def _lacks_letter(word: str, meant: str) -> bool:
    """Whether a word lacks a letter inside: `tst` for `test`."""
    return (
        len(word) == SHORT < len(meant)
        and (word[0], word[-1]) == (meant[0], meant[-1])
        and mistakes_between(word, meant) == 1
    )


def _words(name: str) -> list[str]:
    return name.lower().replace("-", "_").split("_")


def mistakes_between(word: str, other: str) -> int:
    """The number of letters that are missing, added, wrong, or swapped with the next one.

    It is the optimal string alignment distance.
    """
    rows: list[list[int]] = [[*range(len(other) + 1)]]
    for i, letter in enumerate(word, start=1):
        row = [i]
        for j, wanted in enumerate(other, start=1):
            cost = min(rows[-1][j] + 1, row[-1] + 1, rows[-1][j - 1] + (letter != wanted))
            if i > 1 and j > 1 and letter == other[j - 2] and word[i - 2] == wanted:
                cost = min(cost, rows[-2][j - 2] + 1)
            row.append(cost)
        rows.append(row)
    return rows[-1][-1]


def did_you_mean(*names: str) -> str:
    """Ask whether one of the names was meant."""
    return f"Did you mean {' or '.join(f'`{name}`' for name in names)}?"


def ask_for_nearest(name: str, known: Iterable[str], *, cutoff: float = SIMILAR) -> str:
    """Ask for the nearest name, followed by a space, to start a hint; empty if none is near."""
    near = nearest(name, known, cutoff=cutoff)
    return "" if near is None else f"{did_you_mean(near)} "


def advice(name: str, known: Iterable[str], otherwise: str, *, cutoff: float = SIMILAR) -> str:
    """Ask for the nearest of the known names, if one is near, and say what to do otherwise."""
    question = ask_for_nearest(name, known, cutoff=cutoff)
    return f"{question}If not, {otherwise[:1].lower()}{otherwise[1:]}" if question else otherwise


def suggest(name: str, known: Collection[str]) -> str:
    """Suggest the known names that are near, or list all of them."""
    near = _similar(name, known, 3, SIMILAR)
    if near:
        return did_you_mean(*near)
    if not known:
        return "Check the spelling: no name is known."
    return f"Known: {some_of(sorted(known), MOST_LISTED)}."


def _similar(name: str, known: Iterable[str], most: int, cutoff: float) -> list[str]:
    from difflib import get_close_matches  # noqa: PLC0415  3 ms that only a mistake pays

    if len(name) > LONGEST:
        return []
    names = [one for one in known if len(one) <= LONGEST]
    # Another case is the same word, which difflib finds as different as another one: `X`, `x`.
    same = sorted({one for one in names if one != name and one.casefold() == name.casefold()})
    near = get_close_matches(name, names, n=most, cutoff=cutoff)
    return [*same, *(one for one in near if one not in same)][:most]


def some_of(names: Sequence[str], most: int = 3) -> str:
    """The names on one line; of many, the first few and the number of the others."""
    listed = ", ".join(names[:most])
    return f"{listed} and {len(names) - most} more" if len(names) > most else listed


def some_named(names: Iterable[str], most: int = 3) -> str:
    """The same, of names as they are quoted in messages."""
    return some_of([f"`{name}`" for name in names], most)


_SUGGESTED = re.compile(r"Did you mean (?:`([^`]+)`|<([^>]+)>)\?")


def suggested(hint: str | None) -> str | None:
    """The one name that a hint asks for; None if it asks for none or several."""
    found = _SUGGESTED.search(hint or "")
    return None if found is None else found[1] or found[2]
