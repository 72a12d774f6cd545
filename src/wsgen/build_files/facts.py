"""Read what a package installs and requires from its build files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.build_files.cmake import Reader
from wsgen.build_files.installed import Installed
from wsgen.model.build_facts import BuildFacts, Executable, InstalledFile

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic


MARKER = "share/ament_index/resource_index/packages"  # below the prefix


def read_build_facts(
    source: Path, name: str, build_type: str
) -> tuple[BuildFacts, tuple[Diagnostic, ...]]:
    """Read the build files of a package, and report what is wrong with them.

    Args:
        source: the folder of package.xml, absolute.
        name: of the package, as package.xml has it.
        build_type: as package.xml has it; ament_python is read from setup.py, others from
            CMakeLists.txt.
    """
    if build_type == "ament_python":
        return BuildFacts(build_file=source / "setup.py", is_whole=False), ()
    reader = Reader(source, name)
    reader.read()
    return _cmake_facts(reader), ()


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
        is_whole=reader.is_whole and found.is_whole and reader.build_file.is_file(),
    )
