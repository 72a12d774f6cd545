"""What an ament_python package installs, and what is wrong with its setup.py."""

from __future__ import annotations

import os
import posixpath
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.model.build_facts import BuildFacts, Executable, InstalledFile, PythonPackage
from wsgen.packages.build_files.facts import MARKER
from wsgen.packages.build_files.python_checks import check_setup
from wsgen.packages.build_files.python_setup import CONSOLE_SCRIPTS, Setup, folder_of, read_setup

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.diagnostics import Diagnostic


def read_python(source: Path, name: str) -> tuple[BuildFacts, tuple[Diagnostic, ...]]:
    """Read setup.py and setup.cfg of a package."""
    setup, configuration = read_setup(source)
    facts = _python_facts(setup, source, name)
    return facts, tuple(check_setup(setup, configuration, facts, source, name))


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
        place = posixpath.normpath(posixpath.join(one.folder, path.name))
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
            if one.name and setup.scripts_group == CONSOLE_SCRIPTS
        ]
        executables += [
            Executable(name=os.path.basename(file), file=setup.file, line=at, source=source / file)
            for file, at in setup.script_files
        ]
    executables += [
        Executable(
            name=posixpath.basename(one.destination),
            file=one.file,
            line=one.line,
            source=one.source,
        )
        for one in installed.values()
        if posixpath.dirname(one.destination) == f"lib/{name}"
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
