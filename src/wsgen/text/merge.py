"""Merge two versions of a text that have come from a third, line by line, as `git merge` does.

It merges bytes, so that any encoding in which a line end is a byte goes through. Line ends are no
difference: what is merged has those of the text of the user.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence


OURS, THEIRS = "ours", "theirs"
MARKS = (b"<<<<<<< ", b"=======", b">>>>>>> ")


class Merged(NamedTuple):
    """What is merged."""

    data: bytes
    conflicts: int  # places where both have changed the same lines


def merge(base: bytes, ours: bytes, theirs: bytes, *, label: str, prefer: str = "") -> Merged:
    """Merge what `theirs` has made of `base` into `ours`.

    Each line of `ours` that is not in `base` is in the result. Where both have changed the same
    lines, it has both between the marks of git, `label` behind the last one; or with `prefer`,
    OURS or THEIRS, those of one.
    """
    raw = [line + b"\n" for line in ours.removesuffix(b"\n").split(b"\n")] if ours else []
    if ours and not ours.endswith(b"\n"):
        raw[-1] = raw[-1][:-1]
    keys = [_keys(one) for one in (base, ours, theirs)]
    end = b"\r\n" if ours.count(b"\r\n") * 2 > ours.count(b"\n") else b"\n"
    pieces: list[bytes] = []
    conflicts = 0
    before = (0, 0, 0)
    for place in _stable(*keys):
        of_base, of_ours, of_theirs = (
            part[one:other] for part, one, other in zip(keys, before, place, strict=True)
        )
        mine = raw[before[1] : place[1]]
        before = (place[0] + 1, place[1] + 1, place[2] + 1)
        chosen = _choose(of_base, of_ours, of_theirs, prefer)
        if chosen == OURS:
            pieces += mine
        elif chosen == THEIRS:
            pieces += [line + end for line in of_theirs]
        else:
            conflicts += 1
            first, last = _shared_ends(of_ours, of_theirs)
            stop = len(mine) - last
            pieces += mine[:first]
            pieces.append(MARKS[0] + b"yours" + end)
            pieces += mine[first:stop]
            pieces.append(MARKS[1] + end)
            pieces += [line + end for line in of_theirs[first : len(of_theirs) - last]]
            pieces.append(MARKS[2] + label.encode() + end)
            pieces += mine[stop:]
        pieces += raw[place[1] : place[1] + 1]
    for number, piece in enumerate(pieces[:-1]):
        if not piece.endswith(b"\n"):  # it was the last line
            pieces[number] = piece + end
    data = b"".join(pieces)
    if ours and not ours.endswith(b"\n") and not data.endswith(label.encode() + end):
        data = data.removesuffix(end)
    return Merged(data, conflicts)


def is_same(one: bytes, other: bytes) -> bool:
    """Whether two texts differ at most in their line ends."""
    return one == other or _keys(one) == _keys(other)


def _keys(text: bytes) -> list[bytes]:
    """The lines without their ends."""
    return [line.rstrip(b"\r") for line in text.removesuffix(b"\n").split(b"\n")] if text else []


def _choose(
    base: Sequence[bytes], ours: Sequence[bytes], theirs: Sequence[bytes], prefer: str
) -> str:
    """Whose lines stand where base, ours and theirs have these; empty: those of both."""
    if theirs in (base, ours):
        return OURS
    return THEIRS if ours == base else prefer


def _stable(
    base: list[bytes], ours: list[bytes], theirs: list[bytes]
) -> list[tuple[int, int, int]]:
    """The lines that all three have, by their numbers, in order; and the end of each."""
    mine, other = _matches(base, ours), _matches(base, theirs)
    same = [(line, mine[line], other[line]) for line in mine if line in other]
    return [*same, (len(base), len(ours), len(theirs))]


def _matches(base: list[bytes], other: list[bytes]) -> dict[int, int]:
    """The lines of `base` that `other` has, in order: number there, number here."""
    from difflib import SequenceMatcher  # noqa: PLC0415  most files are merged without it

    blocks = SequenceMatcher(None, base, other, autojunk=False).get_matching_blocks()
    return {one + step: here + step for one, here, size in blocks for step in range(size)}


def _shared_ends(one: Sequence[bytes], other: Sequence[bytes]) -> tuple[int, int]:
    """How many lines two lists have in common at their start, and of the rest at their end."""
    most = min(len(one), len(other))
    first = next((at for at in range(most) if one[at] != other[at]), most)
    rest = range(1, most - first + 1)
    return first, next((at - 1 for at in rest if one[-at] != other[-at]), most - first)
