"""What is missing because git has not fetched a submodule, as in a clone that is not recursive."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.descriptions.rules import MISSING_COLLISION_MESH, MISSING_VISUAL_MESH
from wsgen.descriptions.sdf.includes import MODEL_LEFT_OUT
from wsgen.descriptions.xacro.reader import XACRO_FILE_FAILS
from wsgen.launching.explain_missing import FILE_NOT_INSTALLED, PACKAGE_NOT_FOUND, XACRO_FAILS
from wsgen.text.files import read_regular_text
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic

OF_LOOKUPS = frozenset(
    rule.code
    for rule in (
        *(FILE_NOT_INSTALLED, PACKAGE_NOT_FOUND, XACRO_FAILS, XACRO_FILE_FAILS),
        *(MISSING_COLLISION_MESH, MISSING_VISUAL_MESH, MODEL_LEFT_OUT),
    )
)
PATH = lazy_pattern(r"(?m)^[ \t]*path[ \t]*=[ \t]*(\S.*?)[ \t]*$")
MOST_LEVELS = 4  # from a package up to the top of its repository


class Submodule(NamedTuple):
    """One whose folder is empty or not there."""

    top: Path  # of the repository that names it
    path: str  # in that


def with_submodules(found: Iterable[Diagnostic], folders: Iterable[Path]) -> tuple[Diagnostic, ...]:
    """Say of what is missing which submodule brings it; `folders` are those of the packages."""
    reported = tuple(found)
    if not any(one.code in OF_LOOKUPS for one in reported):
        return reported
    absent = _absent(folders)
    return tuple(_explained(one, absent) for one in reported) if absent else reported


def _absent(folders: Iterable[Path]) -> list[Submodule]:
    tops = {top for folder in folders for top in (folder, *[*folder.parents][:MOST_LEVELS])}
    absent = []
    for top in sorted(tops):
        try:
            text = read_regular_text(top / ".gitmodules", errors="replace")
        except OSError:
            continue
        for path in PATH.findall(text):
            try:
                is_empty = not any((top / path).iterdir())
            except OSError:
                is_empty = not (top / path).exists()
            if is_empty:
                absent.append(Submodule(top, path))
    return absent


def _explained(one: Diagnostic, absent: Iterable[Submodule]) -> Diagnostic:
    if one.code not in OF_LOOKUPS:
        return one
    for submodule in absent:
        parts = submodule.path.split("/")
        # The install space has what is below a package; two folders of it tell it from others.
        words = ["/".join(parts[start:]) for start in range(max(len(parts) - 1, 1))]
        if one.code == PACKAGE_NOT_FOUND.code:
            words.append(parts[-1])  # most often it is the name of the repository
        pattern = "|".join(map(re.escape, words))
        if re.search(rf"(?<![\w.-])(?:{pattern})(?![\w.-])", one.message):
            return replace(
                one,
                hint=f"git has not fetched the submodule {submodule.path}: run "
                f"`git submodule update --init --recursive` in {submodule.top}.",
            )
    return one
