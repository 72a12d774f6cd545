"""Merge the files that a template makes now into those of a package that the user has changed."""

from __future__ import annotations

import os
import stat
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.errors import NotReadableError
from wsgen.packages.workspace.settings import FILE
from wsgen.pipeline.package_record import with_record
from wsgen.text.files import LARGEST_TEXT, read_whole
from wsgen.text.merge import OURS, is_same, merge
from wsgen.text.printable import count_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from wsgen.pipeline.package_record import Values

    Tree = Mapping[str, bytes]


# What happens to a file.
CREATED, CHANGED, MERGED, MOVED = "created", "changed", "merged", "moved"
REMOVED, KEPT, CONFLICT = "removed", "kept", "conflict"
BESIDE = ".from-template"  # behind the name of a file that cannot be merged
ALIKE = 0.7  # of the lines of two files, for one to be the other after a move
LARGEST_MOVED = 2**20  # bytes of a file that may have moved: templates have texts
NOT_OF_A_PACKAGE = frozenset({"build", "install", "log", "node_modules", "__pycache__"})


class Change(NamedTuple):
    """What happens to a file of the package."""

    path: str
    kind: str
    before: bytes | None  # None: there is none at the path
    after: bytes | None  # same
    note: str = ""  # the rest of a sentence about it


def bytes_of(file: Path) -> bytes | None:
    """What a file holds; None where there is none.

    Raises:
        NotReadableError: it cannot be read.
    """
    try:
        return read_whole(file, LARGEST_TEXT)
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as error:
        raise NotReadableError(
            f"{file} cannot be read: {error.strerror}; nothing was written.",
            hint="Make it readable, or move it away.",
        ) from error


class Merging:
    """The files of a package while they are merged.

    Args:
        folder: That of the package.
        base, theirs: The files that the template makes, then and now.
        values: Of the record in wsgen.toml, now.
        prefer: Whose lines to take in conflicts (`merge`).
        label: Of the template, behind marks of conflicts.
    """

    def __init__(  # noqa: PLR0913, PLR0917  what is merged, and how
        self, folder: Path, base: Tree, theirs: Tree, values: Values, prefer: str, label: str
    ) -> None:
        self.folder, self.base, self.theirs = folder, base, theirs
        self.values, self.prefer, self.label = values, prefer, label
        gone = {path: base[path] for path in base if path not in theirs}
        new = {path: theirs[path] for path in theirs if path not in base and self._is_free(path)}
        self.moved = _moves(gone, new)  # by the template
        changed = [path for path in base if base[path] != theirs.get(path)]
        lost = {path: base[path] for path in changed if self._is_free(path)}
        self.moved_by_user = _moves(lost, self._strangers(lost)) if lost else {}

    def changes(self) -> Iterator[Change]:
        """What happens to each file that the template or its answers have changed."""
        for path in sorted({*self.base, *self.theirs} - {*self.moved.values()}):
            target = self.moved.get(path, path)
            base, theirs = self.base.get(path), self.theirs.get(target)
            if base == theirs and target == path != FILE:
                continue
            place = self.moved_by_user.get(path, path)
            if place != path:
                target = place
            change = self._change(place, target, base, theirs)
            if change is not None:
                yield change
                if change.path == target != place:
                    yield Change(place, REMOVED, self._read(place), None, f"is {target} now")

    def _change(  # noqa: PLR0911  the cases in their order
        self, place: str, target: str, base: bytes | None, theirs: bytes | None
    ) -> Change | None:
        """What happens to the file at a place, which the template wants at `target`."""
        special = self._special(place)
        if special is not None:
            return self._beside(place, theirs, f"is {special}: it was not changed")
        ours = self._read(place)
        if ours is None:
            if base is None:
                return Change(place, CREATED, None, theirs)
            note = "was deleted by you, and does not come back"
            return None if theirs is None else Change(place, KEPT, None, None, note)
        if theirs is None:
            if base is not None and is_same(ours, base):
                return Change(place, REMOVED, ours, None, "is not in the template any more")
            note = "is not in the template any more; you changed it"
            return Change(place, KEPT, ours, ours, note)
        if target == place and is_same(ours, theirs):
            return None
        if base is None:
            return self._beside(place, theirs, "is yours, and the template has one now")
        if b"\0" in ours:
            return self._beside(place, theirs, "is not a text: it was not changed")
        return self._merged(place, target, base, ours, theirs)

    def _merged(
        self, place: str, target: str, base: bytes, ours: bytes, theirs: bytes
    ) -> Change | None:
        mine = ours
        if place == FILE:  # the record cannot be in conflict
            base, mine, theirs = (self._recorded(one) for one in (base, ours, theirs))
        merged = merge(base, mine, theirs, label=self.label, prefer=self.prefer)
        if merged.data == ours and target == place:
            return None
        kind = CHANGED if is_same(base, mine) else MERGED
        note = f"was {place}" if target != place else ""
        if merged.conflicts:
            kind, note = CONFLICT, f"has {count_of(merged.conflicts, 'conflict')}"
        elif note:
            kind = MOVED
        return Change(target, kind, None if target != place else ours, merged.data, note)

    def _recorded(self, data: bytes) -> bytes:
        """A wsgen.toml with the record of now."""
        return with_record(data.decode(), self.values, self.folder / FILE).encode()

    def _beside(self, place: str, theirs: bytes | None, note: str) -> Change:
        """Keep a file, with that of the template beside it."""
        beside, number = f"{place}{BESIDE}", 1
        if theirs is None or self.prefer == OURS or self._special(beside):
            return Change(place, KEPT, None, None, note)
        while not self._is_free(beside) and self._read(beside) != theirs:
            number += 1
            beside = f"{place}{BESIDE}-{number}"
        note = f"is the template's: {place} {note}"
        return Change(beside, CONFLICT, self._read(beside), theirs, note)

    def _read(self, path: str) -> bytes | None:
        return bytes_of(self.folder / path)

    def _is_free(self, path: str) -> bool:
        return not os.path.lexists(self.folder / path) and self._special(path) is None

    def _special(self, path: str) -> str | None:
        """What a path is, or leads through, that is no file or folder of the package."""
        parts = Path(path).parts
        for count in range(1, len(parts) + 1):
            place = self.folder.joinpath(*parts[:count])
            try:
                mode = place.lstat().st_mode
            except OSError:
                return None
            if stat.S_ISLNK(mode):
                return "a link" if count == len(parts) else f"behind the link {place.name}"
            if count == len(parts) and not stat.S_ISREG(mode):
                return "a folder" if stat.S_ISDIR(mode) else "no regular file"
            if count < len(parts) and not stat.S_ISDIR(mode):
                return f"below {place.name}, which is a file"
        return None

    def _strangers(self, lost: Tree) -> dict[str, bytes]:
        """The files of the package that are of no template, and may be what was lost."""
        found, suffixes = {}, {Path(path).suffix for path in lost}
        for place, folders, names in os.walk(self.folder):
            folders[:] = [
                one for one in folders if not one.startswith(".") and one not in NOT_OF_A_PACKAGE
            ]
            for name in names:
                file = Path(place, name)
                path = file.relative_to(self.folder).as_posix()
                if (
                    path not in {*self.base, *self.theirs}
                    and file.suffix in suffixes
                    and self._special(path) is None
                    and file.stat().st_size <= LARGEST_MOVED
                ):
                    found[path] = self._read(path) or b""
        return found


def _moves(gone: Tree, new: Tree) -> dict[str, str]:
    """Where files have gone: to the new ones that are most like them."""
    moves: dict[str, str] = {}
    for path, data in gone.items():
        ranked = [
            (_alike(data, other), name == Path(place).name, place)
            for name in [Path(path).name]
            for place, other in new.items()
            if Path(place).suffix == Path(path).suffix and place not in moves.values()
        ]
        share, _, place = max(ranked, default=(0.0, False, ""))
        if share >= ALIKE:
            moves[path] = place
    return moves


def _alike(one: bytes, other: bytes) -> float:
    """Which share of their lines two texts have in common."""
    from collections import Counter  # noqa: PLC0415  files seldom move

    lines, others = (Counter(line.strip() for line in text.split(b"\n")) for text in (one, other))
    return 2 * (lines & others).total() / (lines.total() + others.total())
