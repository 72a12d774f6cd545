"""Read what a package installs and requires from its build files."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.model.build_facts import BuildFacts, Executable, InstalledFile
from wsgen.packages.build_files.cmake import Reader
from wsgen.packages.build_files.cmake_checks import (
    CMAKE_SYNTAX,
    DIFFERENT_NAMES,
    MISSING_BUILD_FILE,
    MISSING_PROJECT,
    check_commands,
    word_build_file,
)
from wsgen.packages.build_files.install_checks import check_installed
from wsgen.packages.build_files.installed import MARKER, Installed

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic


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
        from wsgen.packages.build_files.python_facts import read_python  # noqa: PLC0415  the others need none

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
                (f"{MARKER}/{name}", None),
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
        exported_packages=tuple(reader.exported),
        environment=tuple(reader.environment),
        dated_calls={
            command: tuple((one.file, one.call.line) for one in reader.mentions[command])
            for command in DATED
            if command in reader.mentions
        },
        is_whole=reader.is_whole and found.is_whole and reader.build_file.is_file(),
    )
