"""What follows from what is not installed: one cause is one diagnostic.

A folder that no rule installs lacks all that launch files and robots look up in it, and a program
that is not installed cannot be started by any node. What follows is then folded into the diagnostic
about the build file, which takes over its severity and its message: the fix is there.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.checks.rules.package_uses import UNDECLARED_DEPENDENCY
from wsgen.checks.rules.plugins import PLUGIN_OF_OTHER_SIMULATOR
from wsgen.checks.rules.ros2_control import UNSUITED_HARDWARE
from wsgen.descriptions.xacro.reader import XACRO_FILE_FAILS
from wsgen.diagnostics import Severity
from wsgen.launching.explain_missing import EXECUTABLE_NOT_FOUND, PACKAGE_NOT_FOUND, XACRO_FAILS
from wsgen.launching.undeclared import UNDECLARED_PACKAGE
from wsgen.packages.build_files.cmake_checks import DIFFERENT_NAMES, MISSING_INSTALLED_PATH
from wsgen.packages.build_files.install_checks import (
    CONTENTS_INSTALLED,
    FOLDER_NOT_INSTALLED,
    PROGRAM_NOT_EXECUTABLE,
    PROGRAM_NOT_INSTALLED,
    REPEATED_FOLDER,
    WRONG_DESTINATION,
)
from wsgen.packages.build_files.python_checks import BROKEN_SCRIPT
from wsgen.text.suggestions import suggested
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from wsgen.diagnostics import Diagnostic


OF_FOLDERS = frozenset(
    rule.code
    for rule in (CONTENTS_INSTALLED, FOLDER_NOT_INSTALLED, REPEATED_FOLDER, WRONG_DESTINATION)
)
_OF_PROGRAMS = frozenset(
    rule.code for rule in (BROKEN_SCRIPT, PROGRAM_NOT_EXECUTABLE, PROGRAM_NOT_INSTALLED)
)
_NOT_FOUND = frozenset(rule.code for rule in (PACKAGE_NOT_FOUND, XACRO_FILE_FAILS))
_FOLLOWING = ("LCH", "ROB", "SPN", "WLD")  # families
_PLACE = lazy_pattern(r"(?<![\w.-])share/([\w-]+)/([\w.-]+)")
_GIVEN = lazy_pattern(r"'([\w.-]+)/[^']*' of ([\w-]+), which is not installed")
_PACKAGE = lazy_pattern(r"package '([\w-]+)'")
_ORDER = list(Severity)


def fold_not_installed(
    diagnostics: Iterable[Diagnostic], folders: Mapping[str, Path]
) -> tuple[Diagnostic, ...]:
    """Fold what follows from build files into the diagnostics about them.

    Args:
        diagnostics: Of all packages that are checked.
        folders: Of these packages, by name.
    """
    found = tuple(diagnostics)
    causes = [one for one in found if one.code in OF_FOLDERS | _OF_PROGRAMS]
    if not causes:
        return tuple(_without_echoes(found))
    followed: dict[Diagnostic, list[Diagnostic]] = {}
    left: list[Diagnostic] = []
    for one in found:
        cause = next(_causes_of(one, causes, folders), None)
        if cause is None:
            left.append(one)
        else:
            followed.setdefault(cause, []).append(one)
    kept = [_with_worst(one, followed[one]) if one in followed else one for one in left]
    return tuple(_without_echoes(kept))


def _without_echoes(diagnostics: Sequence[Diagnostic]) -> Iterator[Diagnostic]:
    """Without what a misspelled folder of install(), or a misspelled package, causes elsewhere."""
    meant = {
        (one.file, suggested(one.hint))
        for one in diagnostics
        if one.code == MISSING_INSTALLED_PATH.code
    }
    programs = {Path(name).name for _, name in meant if name is not None}
    renamed = {
        one.element for one in diagnostics if one.code == DIFFERENT_NAMES.code and one.element
    }
    unnamed = {one.reason for one in diagnostics if one.code == DIFFERENT_NAMES.code and one.reason}
    of_launch = {(one.file, one.line) for one in diagnostics if one.code in _OF_LAUNCH}
    of_others = {one.file for one in diagnostics if one.code == PLUGIN_OF_OTHER_SIMULATOR.code}
    for one in diagnostics:
        if (
            (one.code == FOLDER_NOT_INSTALLED.code and (one.file, one.element) in meant)
            or (one.code == EXECUTABLE_NOT_FOUND.code and one.element in programs)
            or (one.code in _NOT_FOUND and suggested(one.hint) in renamed)
            or (one.code in _OF_NAMES and not unnamed.isdisjoint(_WORD.findall(one.message)))
            # Of what a launch file expands, both say the same.
            or (one.code == XACRO_FILE_FAILS.code and (one.file, one.line) in of_launch)
            # It is compared with a plugin that is wrong itself.
            or (one.code == UNSUITED_HARDWARE.code and one.file in of_others)
        ):
            continue
        yield one


_WORD = lazy_pattern(r"[\w-]+")
_OF_NAMES = frozenset(
    rule.code for rule in (PACKAGE_NOT_FOUND, UNDECLARED_DEPENDENCY, UNDECLARED_PACKAGE)
)
_OF_LAUNCH = frozenset(rule.code for rule in (PACKAGE_NOT_FOUND, XACRO_FAILS))


def _causes_of(
    found: Diagnostic, causes: Sequence[Diagnostic], folders: Mapping[str, Path]
) -> Iterator[Diagnostic]:
    if not found.code.startswith(_FOLLOWING):
        return
    if found.code == EXECUTABLE_NOT_FOUND.code:
        package = _PACKAGE.search(found.message)
        names = [(package[1], found.element or "", _OF_PROGRAMS)] if package else []
    else:
        names = [(one[1], one[2], OF_FOLDERS) for one in _PLACE.finditer(found.message)]
        names += [(one[2], one[1], OF_FOLDERS) for one in _GIVEN.finditer(found.message)]
    for package_name, name, codes in names:
        folder = folders.get(package_name)
        for cause in causes:
            is_of_package = (
                folder is not None and cause.file is not None and cause.file.is_relative_to(folder)
            )
            if cause.code in codes and is_of_package and _names(cause, name):
                yield cause


def _names(cause: Diagnostic, name: str) -> bool:
    """Whether a diagnostic is about a folder or program of that name."""
    if not name:
        return False
    texts = [cause.element or "", cause.message]
    if cause.code == BROKEN_SCRIPT.code:  # which is about a package, and names it first
        texts = [cause.message.partition(": ")[2]]
    elif cause.code in _OF_PROGRAMS:  # messages name the package, too
        texts = [cause.element or ""]
    word = re.compile(rf"(?<![\w.-]){re.escape(name)}(?![\w-]|\.\w)")
    return any(word.search(text) for text in texts)


def _with_worst(cause: Diagnostic, consequences: Sequence[Diagnostic]) -> Diagnostic:
    """The cause, as severe as the worst that follows from it, with the message of that."""
    worst = min(consequences, key=lambda one: _ORDER.index(one.severity))
    others = len(consequences) - 1
    more = f" {others} more diagnostic{'s' if others > 1 else ''} would follow." if others else ""
    return replace(
        cause,
        severity=min(cause.severity, worst.severity, key=_ORDER.index),
        message=f"{cause.message} {_place(worst)}{worst.message}{more}",
    )


def _place(found: Diagnostic) -> str:
    if found.file is None:
        return ""
    line = f" (line {found.line})" if found.line else ""
    return f"In {found.file.name}{line}: "
