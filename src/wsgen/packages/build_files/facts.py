"""Read what a package installs and requires from its build files.

The files that install rules of CMake install are those that are in the source folder.
"""

from __future__ import annotations

import fnmatch
import os
import re
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.model.build_facts import BuildFacts, Executable, InstalledFile, PythonPackage
from wsgen.packages.build_files import cmake_values
from wsgen.packages.build_files.cmake import Reader
from wsgen.packages.build_files.cmake_checks import (
    CMAKE_SYNTAX,
    DIFFERENT_NAMES,
    MISSING_BUILD_FILE,
    MISSING_PROJECT,
    check_commands,
    word_build_file,
)
from wsgen.packages.build_files.cmake_install import relative_destination
from wsgen.packages.build_files.cmake_values import BUILD, UNKNOWN, is_known
from wsgen.packages.build_files.install_checks import base_of, check_installed
from wsgen.packages.source_shares import INDEX
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from wsgen.diagnostics import Diagnostic
    from wsgen.packages.build_files.cmake_text import InstallRule


MOST_FILES = 20_000
# Folders that are installed by accident, with install(DIRECTORY .), and that nobody looks up.
UNSEEN_FOLDERS = frozenset({".git", "__pycache__", "build", "install", "log"})
STOPPING = frozenset({CMAKE_SYNTAX.code, MISSING_PROJECT.code, DIFFERENT_NAMES.code})
DATED = ("ament_target_dependencies",)  # what not every distribution has


def read_build_facts(
    source: Path, name: str, build_type: str, manifest_line: int | None = None
) -> tuple[BuildFacts, tuple[Diagnostic, ...]]:
    """Read the build files of a package, and report what is wrong with them.

    Args:
        source: the folder of package.xml, absolute.
        name: of the package, as package.xml has it.
        build_type: as package.xml has it; ament_python is read from setup.py, others from
            CMakeLists.txt.
        manifest_line: of the name in package.xml, 1-based.
    """
    missing = tuple(_missing_build_file(source, name, build_type))
    if build_type == "ament_python":
        from wsgen.packages.build_files.python_checks import read_python  # noqa: PLC0415  the others need none

        facts, found = read_python(source, name)
        return facts, missing or found
    reader = Reader(source, name, manifest_line)
    reader.read()
    facts = _cmake_facts(reader)
    if missing:
        return facts, missing
    found = tuple(check_commands(reader, build_type))
    if any(one.code in STOPPING for one in found):  # what is installed where follows from that
        return replace(facts, is_whole=False), found
    return facts, (*found, *check_installed(reader, facts, build_type))


def _missing_build_file(source: Path, name: str, build_type: str) -> Iterator[Diagnostic]:
    if build_type not in {"ament_cmake", "ament_python"}:
        return
    files = (source / "setup.py", source / "CMakeLists.txt")
    wanted, other = files if build_type == "ament_python" else files[::-1]
    if not wanted.is_file():
        message, hint = word_build_file(build_type, has_other=other.is_file())
        yield MISSING_BUILD_FILE.at(
            source / "package.xml", element=name, message=f"{name}: {message}", hint=hint
        )


def _cmake_facts(reader: Reader) -> BuildFacts:
    name = reader.name
    found = Installed(name=name, files=[], executables=[], python_packages=[], folders={})
    for rule in reader.rules:
        found.add_rule(rule)
    for program, mention in reader.components:
        found.executables.append(
            Executable(name=program, file=mention.file, line=mention.call.line)
        )
    for command in ("ament_package", "ament_auto_package"):
        for mention in reader.mentions.get(command, ())[:1]:
            for path, source in (
                (f"share/{name}/package.xml", reader.source / "package.xml"),
                (f"{INDEX}/{name}", None),
            ):
                found.files.append(
                    InstalledFile(
                        source=source,
                        destination=path,
                        file=mention.file,
                        line=mention.call.line,
                    )
                )
    return BuildFacts(
        build_file=reader.build_file,
        installed=tuple(found.files),
        executables=tuple(found.executables),
        targets=tuple(reader.targets.values()),
        required_packages=tuple(reader.required),
        python_packages=tuple(found.python_packages),
        folders=found.folders,
        environment=tuple(reader.environment),
        dated_calls={
            command: tuple((one.file, one.call.line) for one in reader.mentions[command])
            for command in DATED
            if command in reader.mentions
        },
        is_whole=reader.is_whole and found.is_whole and reader.build_file.is_file(),
    )


@dataclass
class Installed:
    """Collects what the install rules of a package install."""

    name: str  # of the package
    files: list[InstalledFile]
    executables: list[Executable]
    python_packages: list[PythonPackage]
    folders: dict[str, Path]
    is_whole: bool = True

    def add_rule(self, rule: InstallRule) -> None:
        """Add what a rule installs."""
        if rule.kind == "PYTHON":
            self._add_python(rule)
            return
        place = None if rule.destination is None else relative_destination(rule.destination)
        if place is None:
            self.is_whole = self.is_whole and not (rule.destination and UNKNOWN in rule.destination)
            return
        if rule.kind == "TARGETS":
            self._add_target(rule, place)
            return
        for argument, path in rule.names:
            if not is_known(path):
                self.is_whole = False
            elif path.startswith(BUILD):
                if rule.kind == "DIRECTORY":
                    self.is_whole = False
                else:
                    self._add(rule, None, _join(place, rule.rename or base_of(path)), argument.line)
            elif rule.kind == "DIRECTORY":
                self._add_folder(rule, path, place, argument.line)
            elif os.path.lexists(path):
                self._add(rule, path, _join(place, rule.rename or base_of(path)), argument.line)

    def _add(self, rule: InstallRule, source: str | None, destination: str, line: int) -> None:
        path = None if source is None else Path(os.path.normpath(source))
        self.files.append(
            InstalledFile(source=path, destination=destination, file=rule.file, line=line)
        )
        folder, _, name = destination.rpartition("/")
        if folder == f"lib/{self.name}" and _can_run(rule, path):
            self.executables.append(Executable(name=name, file=rule.file, line=line, source=path))

    def _add_target(self, rule: InstallRule, place: str) -> None:
        argument, name = rule.names[0]
        if UNKNOWN in name:
            self.is_whole = False
            return
        self._add(rule, None, _join(place, name), argument.line or rule.call.line)

    def _add_folder(self, rule: InstallRule, path: str, place: str, line: int) -> None:
        base = "" if path.endswith(("/", "/.")) else os.path.basename(path)
        top = os.path.normpath(path)
        target = _join(place, base)
        if not rule.patterns:
            self.folders.setdefault(target, Path(top))
        for below, file in list_files(top, _filter(rule)):
            if len(self.files) > MOST_FILES:
                self.is_whole = False
                return
            self._add(rule, file, _join(target, below), line)

    def _add_python(self, rule: InstallRule) -> None:
        argument, path = rule.names[0]
        if not is_known(path) or not is_known(argument.text):
            self.is_whole = False
        else:
            name = argument.text.removesuffix(".py").replace("/", ".")
            self.python_packages.append(
                PythonPackage(
                    name=name,
                    source=Path(os.path.normpath(path)),
                    file=rule.file,
                    line=argument.line,
                )
            )


def list_files(
    folder: str, accepts: Callable[[str, bool], bool], below: str = ""
) -> Iterator[tuple[str, str]]:
    """The files in a folder and below: the path from the folder, and the whole path.

    `accepts` gets a path and whether it is a folder. A link to a folder is one file.
    """
    try:
        with os.scandir(folder) as entries:
            listed = sorted(entries, key=lambda entry: entry.name)
    except (OSError, ValueError):  # a name with a null byte
        return
    for entry in listed:
        is_folder = entry.is_dir(follow_symlinks=False)
        if not accepts(entry.path, is_folder):
            continue
        name = f"{below}{entry.name}"
        if not is_folder:
            yield name, entry.path
        elif entry.name not in UNSEEN_FOLDERS or below:
            yield from list_files(entry.path, accepts, f"{name}/")


def _filter(rule: InstallRule) -> Callable[[str, bool], bool]:
    """What install(DIRECTORY) accepts: the first pattern that excludes decides.

    Source: cmake-install(1), "FILES_MATCHING", and cmFileCopier::CollectMatchProperties.
    """
    if not rule.patterns:
        return lambda _path, _is_folder: True
    tests = [(_test(kind, text), excludes) for kind, text, excludes in rule.patterns]

    def accepts(path: str, is_folder: bool) -> bool:  # noqa: FBT001
        # What is not known does not keep a file away.
        found = [(matches(path), excludes) for matches, excludes in tests]
        if (True, True) in found:
            return False
        is_named = any(match is not False and not excludes for match, excludes in found)
        return is_named or is_folder or not rule.matching_only

    return accepts


@cache
def _test(kind: str, text: str) -> Callable[[str], bool | None]:
    if kind == "REGEX":
        return lambda path: cmake_values.search_regex(text, path)
    # The pattern is that of the last parts of the path; * and ? do not match a slash.
    inner = fnmatch.translate(text).removesuffix(r"\Z").removeprefix("(?s:").removesuffix(")")
    inner = inner.replace(".*", "[^/]*") if "*" in text else inner
    pattern = re.compile(f"/{inner}$")
    return lambda path: pattern.search(path) is not None


def _join(folder: str, name: str) -> str:
    return f"{folder}/{name}" if folder and name else folder or name


def _can_run(rule: InstallRule, path: Path | None) -> bool:
    """Whether the installed file can be run; a library cannot."""
    if rule.kind == "TARGETS":
        return rule.rename in {"executable", ""}
    if rule.runnable == "source":
        return path is not None and os.access(path, os.X_OK)
    return rule.runnable == "all"
