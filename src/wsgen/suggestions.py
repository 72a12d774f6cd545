"""Find known names that are similar to a misspelled one, and suggest them in hints."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Sequence


# Least similarity of two words, as difflib measures it from 0 to 1.
SIMILAR = 0.6
MOST_LISTED = 8  # names in a hint


def nearest(name: str, known: Iterable[str], *, cutoff: float = SIMILAR) -> str | None:
    """Return the known name most similar to this one; None if none reaches `cutoff`."""
    near = _similar(name, set(known) - {name}, 1, cutoff)
    return near[0] if near else None


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
        return "No packages are known."
    names = sorted(known)
    more = f" and {len(names) - MOST_LISTED} more" if len(names) > MOST_LISTED else ""
    return f"Known: {', '.join(names[:MOST_LISTED])}{more}."


def _similar(name: str, known: Iterable[str], most: int, cutoff: float) -> list[str]:
    from difflib import get_close_matches  # noqa: PLC0415  3 ms that only a mistake pays

    return get_close_matches(name, [*known], n=most, cutoff=cutoff)


def some_of(names: Sequence[str], most: int = 3) -> str:
    """The names on one line; of many, the first few and the number of the others."""
    listed = ", ".join(names[:most])
    return f"{listed} and {len(names) - most} more" if len(names) > most else listed
