"""The names that somebody may have meant."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection

MOST_LISTED = 8


def suggest(name: str, known: Collection[str]) -> str:
    """Say which known names are near, or else which there are; a sentence for a hint."""
    near = get_close_matches(name, known, n=3, cutoff=0.6)
    if near:
        return f"Did you mean {' or '.join(near)}?"
    if not known:
        return "There are no packages."
    names = sorted(known)
    more = f" and {len(names) - MOST_LISTED} more" if len(names) > MOST_LISTED else ""
    return f"There are: {', '.join(names[:MOST_LISTED])}{more}."
