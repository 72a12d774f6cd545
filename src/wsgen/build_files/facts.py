"""Read what a package installs and requires from its build files."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.build_files.cmake import Reader
from wsgen.build_files.cmake_checks import (
    CMAKE_SYNTAX,
    DIFFERENT_NAMES,
    MISSING_BUILD_FILE,
    MISSING_PROJECT,
    check_commands,
)
from wsgen.build_files.install_checks import check_installed
from wsgen.build_files.installed import Installed
from wsgen.build_files.python_checks import check_setup
from wsgen.build_files.python_setup import Setup, read_setup
from wsgen.model.build_facts import BuildFacts, Executable, InstalledFile, PythonPackage

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.diagnostics import Diagnostic


STOPPING = frozenset({CMAKE_SYNTAX.code, MISSING_PROJECT.code, DIFFERENT_NAMES.code})
DATED = ("ament_target_dependencies",)  # what not every distribution has
MARKER = "share/ament_index/resource_index/packages"  # below the prefix


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
        setup, configuration = read_setup(source)
        facts = _python_facts(setup, source, name)
        return facts, missing or tuple(check_setup(setup, configuration, facts, source, name))
    reader = Reader(source, name, manifest_line)
    reader.read()
    facts = _cmake_facts(reader)
    if missing:
        return facts, missing
    found = tuple(check_commands(reader, build_type))
    if any(one.code in STOPPING for one in found):  # what is installed where follows from that
        return replace(facts, is_whole=False), found
    return facts, (*found, *check_installed(reader, facts))


def _missing_build_file(source: Path, name: str, build_type: str) -> Iterator[Diagnostic]:
    cmake, setup = source / "CMakeLists.txt", source / "setup.py"
    wanted, other, other_type = {
        "ament_python": (setup, cmake, "ament_cmake"),
        "ament_cmake": (cmake, setup, "ament_python"),
    }.get(build_type, (source, source, ""))
    if not wanted.exists():
        tool = "CMake" if wanted is cmake else "setuptools"
        yield MISSING_BUILD_FILE.at(
            source / "package.xml",
            element=name,
            message=f"{name}: {wanted.name} is missing; {tool} builds and installs the package "
            "with it.",
            hint=f"Write <build_type>{other_type}</build_type> in package.xml: {other.name} exists."
            if other.exists()
            else f"Restore it (git checkout {wanted.name}), or write one.",
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


def _python_facts(setup: Setup, source: Path, name: str) -> BuildFacts:
    line = setup.call_line or 1
    # colcon installs both where data_files does not have them.
    installed = {
        f"{MARKER}/{name}": InstalledFile(
            source=None, destination=f"{MARKER}/{name}", file=setup.file, line=line
        ),
        f"share/{name}/package.xml": InstalledFile(
            source=source / "package.xml",
            destination=f"share/{name}/package.xml",
            file=setup.file,
            line=line,
        ),
    }
    for one in setup.data_files:
        path = source / one.name
        place = os.path.normpath(os.path.join(one.folder, path.name))
        if path.is_file() and not place.startswith(("/", "..")):
            installed[place] = InstalledFile(
                source=Path(os.path.normpath(path)),
                destination=place,
                file=setup.file,
                line=one.line,
            )
    executables: list[Executable] = []
    if installs_scripts_for_ros(setup, name):
        executables += [
            Executable(name=one.name, file=one.file, line=one.line, entry_point=one.target)
            for one in setup.scripts
        ]
        executables += [
            Executable(name=os.path.basename(file), file=setup.file, line=at, source=source / file)
            for file, at in setup.script_files
        ]
    executables += [
        Executable(
            name=os.path.basename(one.destination),
            file=one.file,
            line=one.line,
            source=one.source,
        )
        for one in installed.values()
        if os.path.dirname(one.destination) == f"lib/{name}"
        and one.source is not None
        and os.access(one.source, os.X_OK)
    ]
    return BuildFacts(
        build_file=setup.file,
        installed=tuple(installed.values()),
        executables=tuple(executables),
        python_packages=tuple(_python_packages(setup, source)),
        is_whole=setup.is_whole and setup.call_line is not None,
    )


def installs_scripts_for_ros(setup: Setup, name: str) -> bool:
    """Whether setup.cfg has setuptools write scripts to lib/PACKAGE."""
    place = (setup.install_scripts or "").replace("$base/", "").rstrip("/")
    return place == f"lib/{name}"


def _python_packages(setup: Setup, source: Path) -> Iterator[PythonPackage]:
    for package, line in setup.packages or ():
        folder = source / folder_of(package, setup)
        if folder.is_dir():
            yield PythonPackage(name=package, source=folder, file=setup.file, line=line)
    for module, line in setup.modules:
        file = source / setup.package_folders.get("", "") / f"{module.replace('.', '/')}.py"
        if file.is_file():
            yield PythonPackage(name=module, source=file, file=setup.file, line=line)


def folder_of(package: str, setup: Setup) -> str:
    """The folder of a Python package, as package_dir of setuptools says it."""
    parts = package.split(".")
    for length in range(len(parts), -1, -1):
        folder = setup.package_folders.get(".".join(parts[:length]))
        if folder is not None:
            return os.path.join(folder, *parts[length:])
    return os.path.join(*parts)
