"""From diagnostics to new texts of files, and to the disk."""

from __future__ import annotations

import ast
import os
import re
import warnings
from typing import TYPE_CHECKING

from wsgen.checks.fixes.manifests import DEPENDENCY
from wsgen.checks.fixes.registry import FIXERS, file_to_fix
from wsgen.checks.fixes.source import apply, overlap, read_source
from wsgen.packages.workspace.layout import (
    INSTALL_LAYOUT,
    find_packages,
    read_package,
    workspace_around,
)
from wsgen.packages.workspace.manifest import way_between
from wsgen.text.files import write_file
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.checks.fixes.source import Edit, SourceText
    from wsgen.diagnostics import Diagnostic


MANIFEST = "package.xml"


@dataclass(frozen=True, kw_only=True)
class FileFix:
    """What the fixes make of a file."""

    file: Path  # links are resolved: the file that is written
    before: str  # its text, with its line ends
    after: str
    data: bytes  # its new content
    fixed: tuple[Diagnostic, ...]  # what is then gone


@dataclass(frozen=True, kw_only=True)
class FixPlan:
    """The fixes of all files, and what has no fix although its rule has one."""

    files: tuple[FileFix, ...]
    refused: tuple[tuple[Diagnostic, str], ...]  # with the reason

    @property
    def fixed(self) -> tuple[Diagnostic, ...]:
        """What the fixes remove."""
        return tuple(found for one in self.files for found in one.fixed)


def plan_fixes(diagnostics: Iterable[Diagnostic], roots: Sequence[Path]) -> FixPlan:
    """Compute the fixes in files below `roots`; nothing is written.

    Of two fixes that touch the same place, the first is made: check again for the second.
    """
    by_file: dict[Path, list[Diagnostic]] = {}
    refused: list[tuple[Diagnostic, str]] = []
    checked = [root.resolve() for root in roots]
    for found in dict.fromkeys(diagnostics):
        file = file_to_fix(found) if found.name in FIXERS else None
        if file is None:
            continue
        file = file.resolve()
        reason = _reason_to_refuse(file, checked)
        if reason is None:
            by_file.setdefault(file, []).append(found)
        else:
            refused.append((found, reason))
    files = []
    dependencies = _Dependencies()
    for file, those in by_file.items():
        fix, rest = _fix_file(file, those, dependencies)
        files += [fix] if fix else []
        refused += rest
    return FixPlan(files=tuple(files), refused=tuple(refused))


def _reason_to_refuse(file: Path, roots: Sequence[Path]) -> str | None:
    """Why a file must not be changed."""
    if not any(file == root or root in file.parents for root in roots):
        return "the file is outside of what is checked"
    if any((folder / INSTALL_LAYOUT).exists() for folder in file.parents):
        return "the file is in an install space: fix its source"
    if not file.is_file():
        return "the file does not exist"
    if not os.access(file, os.W_OK):
        return "the file is read-only"
    return None


class _Dependencies:
    """Which packages of the workspaces need which others; colcon builds no circle of them."""

    def __init__(self) -> None:
        self._of: dict[Path, dict[str, set[str]]] = {}  # by the folder of the workspace

    def add(self, file: Path, edits: Iterable[Edit]) -> str | None:
        """Add those that edits of a package.xml declare; why not, if they close a circle."""
        added = {
            name
            for edit in edits
            for _, name in DEPENDENCY.findall(edit.text)
            if file.name == MANIFEST
        }
        package = read_package(file.parent) if added else None
        if package is None:
            return None
        needed = self._around(file.parent)
        for name in sorted(added):
            way = way_between(name, package.name, lambda one: needed.get(one, ()))
            if way is not None:
                circle = " → ".join((package.name, *way))
                return f"colcon refuses packages that need each other: {circle}"
        needed.setdefault(package.name, set()).update(added)
        return None

    def _around(self, folder: Path) -> dict[str, set[str]]:
        workspace = workspace_around(folder)
        if workspace is None:
            return {}
        if workspace.root not in self._of:
            self._of[workspace.root] = {
                package.name: {one.name for one in package.manifest.dependencies}
                for package in find_packages(workspace)
                if package.manifest is not None
            }
        return self._of[workspace.root]


def _fix_file(
    file: Path, diagnostics: Sequence[Diagnostic], dependencies: _Dependencies
) -> tuple[FileFix | None, list[tuple[Diagnostic, str]]]:
    source = read_source(file)
    refused: list[tuple[Diagnostic, str]] = []
    if source is None:
        return None, [(found, "the file is not UTF-8, or too large") for found in diagnostics]
    edits: list[Edit] = []
    fixed: list[Diagnostic] = []
    was_whole = is_whole(source, source.text)
    for found in diagnostics:
        own = [*FIXERS[found.name](found, source)]
        if own and set(own) <= set(edits):  # one cause, reported twice
            fixed.append(found)
            continue
        if not own:
            refused.append((found, "the text does not show what is meant"))
        elif overlap(own, edits):
            refused.append((found, "another fix touches the same place"))
        elif was_whole and not is_whole(source, apply(source.text, [*edits, *own])):
            refused.append((found, "the fix would break the file"))
        elif (circle := dependencies.add(file, own)) is not None:
            refused.append((found, circle))
        else:
            edits += own
            fixed.append(found)
    after = apply(source.text, edits)
    if after == source.text:
        return None, refused
    fix = FileFix(
        file=file,
        before=source.text,
        after=after,
        data=source.encoded(after),
        fixed=tuple(fixed),
    )
    return fix, refused


def is_whole(source: SourceText, text: str) -> bool:
    """Whether a text can be parsed, if it is Python or XML."""
    suffix = source.file.suffix
    if suffix == ".py":
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                ast.parse(text)
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            return False
    elif text.lstrip("\ufeff \t\r\n").startswith("<"):
        from wsgen.text.xmlsyntax import find_mistake  # noqa: PLC0415  most files need it, CMake does not

        return find_mistake(text.encode()) is None
    return True


def write_fixes(plan: FixPlan) -> Iterator[Path]:
    """Write the files, each whole or not at all; those that are written.

    Raises:
        NotReadableError: A file cannot be written; it is unchanged, and those after it are.
    """
    for one in plan.files:
        write_file(one.file, one.data)
        yield one.file


def unified_diff(fix: FileFix, name: str) -> list[str]:
    """The lines of what a fix changes, as `diff -u` and `git diff` print them."""
    from difflib import unified_diff as compare  # noqa: PLC0415  only --diff needs it

    lines = []
    before, after = (re.findall(r"[^\n]*\n|[^\n]+", text) for text in (fix.before, fix.after))
    for line in compare(before, after, f"a/{name}", f"b/{name}"):
        lines.append(line.removesuffix("\n"))
        if line[:1] in {" ", "-", "+"} and not line.endswith("\n"):
            lines.append("\\ No newline at end of file")
    return lines
