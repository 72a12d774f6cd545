"""The known name that somebody may have meant, and the sentence that asks for it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable


# How alike two words are, as difflib counts from 0 to 1, before one is taken for the other.
ALIKE = 0.6
MOST_LISTED = 8  # names in a hint


def nearest(name: str, known: Iterable[str], *, cutoff: float = ALIKE) -> str | None:
    """The other known name that is most like this one; None where none is at least `cutoff`."""
    near = _alike(name, set(known) - {name}, 1, cutoff)
    return near[0] if near else None


def did_you_mean(*names: str) -> str:
    """The question whether one of the names was meant."""
    return f"Did you mean {' or '.join(f'`{name}`' for name in names)}?"


def ask_for_nearest(name: str, known: Iterable[str]) -> str:
    """The question that a hint begins with, and a space; empty where no known name is near."""
    near = nearest(name, known)
    return "" if near is None else f"{did_you_mean(near)} "


def advice(name: str, known: Iterable[str], otherwise: str) -> str:
    """Ask for the nearest of the known names, if one is near, and say what to do otherwise."""
    question = ask_for_nearest(name, known)
    return f"{question}If not, {otherwise[:1].lower()}{otherwise[1:]}" if question else otherwise


def suggest(name: str, known: Collection[str]) -> str:
    """Say which known names are near, or else which there are; a sentence for a hint."""
    near = _alike(name, known, 3, ALIKE)
    if near:
        return did_you_mean(*near)
    if not known:
        return "There are no packages."
    names = sorted(known)
    more = f" and {len(names) - MOST_LISTED} more" if len(names) > MOST_LISTED else ""
    return f"There are: {', '.join(names[:MOST_LISTED])}{more}."


def _alike(name: str, known: Iterable[str], most: int, cutoff: float) -> list[str]:
    from difflib import get_close_matches  # noqa: PLC0415  3 ms that only a mistake pays

    return get_close_matches(name, [*known], n=most, cutoff=cutoff)
