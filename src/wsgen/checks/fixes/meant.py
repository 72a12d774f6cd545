"""Whether a misspelled word is so near to another one that this must be meant."""

from __future__ import annotations

import re

from wsgen.text.suggestions import LONGEST, mistakes_between

SHORT = 4  # letters; in shorter words only the order of letters may differ: `xzy`, not `fl` or `x`
LONG = 8  # letters; from here on two letters may differ

_WORDS = re.compile(r"[A-Z]?[a-z]+|[A-Z]+|\d+|[^\W\d_]+")


def is_surely(written: str, meant: str) -> bool:
    """Whether a name is another one with a slip of the hand: `Revolute`, `inertail`, `base_lnk`.

    Names that count or place things differ as little: `arm_1` and `arm_2`, `l_wheel` and `r_wheel`
    are others. One word may differ, not in a number and not in its first or last letter alone.
    """
    if _plain(written) == _plain(meant):
        return True
    words, others = _WORDS.findall(written), _WORDS.findall(meant)
    if len(words) != len(others):
        return False
    differing = [
        (one.casefold(), other.casefold())
        for one, other in zip(words, others, strict=True)
        if one.casefold() != other.casefold()
    ]
    return len(differing) == 1 and _is_slip(*differing[0])


def _plain(name: str) -> str:
    return re.sub(r"[\s_-]", "", name).casefold()


def _is_slip(one: str, other: str) -> bool:
    if one[0] != other[0] or one.isdigit() or other.isdigit():
        return False
    if sorted(one) == sorted(other):
        return True
    if len(one) == len(other) and one[:-1] == other[:-1]:
        return False
    length = max(len(one), len(other))
    if length > LONGEST:
        return False
    allowed = 0 if length < SHORT else 1 if length < LONG else 2
    return mistakes_between(one, other) <= allowed
