"""Explain what is missing, or wrong in a xacro file: packages, share files, descriptions."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.launch import codes, known_packages
from wsgen.launch.record import RECORD
from wsgen.suggestions import advice, did_you_mean, nearest

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.launch.record import Location


class Explanation(NamedTuple):
    """What is told of an exception; file and line only where they are not the launch file's."""

    code: str
    message: str
    hint: str
    file: str | None = None
    line: int | None = None
    element: str | None = None
    written: str | None = None  # the text that is wrong: its line is meant, where there is one


def of_xacro(error: BaseException, fault: dict[str, Any] | None) -> Explanation | None:
    """What xacro found fault with; None where it did not."""
    outcome = getattr(error, "wsgen_outcome", None)
    fault = fault or (outcome.fault if outcome is not None else None)
    if fault is None:
        return None
    if fault.get("missing"):
        return _missing_file(fault["missing"])
    if fault.get("package"):
        return _missing_package(
            fault["package"], fault.get("file"), fault.get("line"), fault.get("hint")
        )
    return Explanation(
        codes.XACRO_FAILS,
        f"xacro fails: {fault['message']}",
        fault.get("hint") or "Fix the xacro file; `xacro FILE` shows the same error.",
        fault.get("file"),
        fault.get("line"),
        fault.get("element"),
    )


def package_error(error: BaseException) -> Explanation | None:
    """A package, or every package, that is not found."""
    if type(error).__name__ == "PackageNotFoundError":
        return _missing_package(str(getattr(error, "name", error)))
    if isinstance(error, OSError) and "AMENT_PREFIX_PATH" in str(error):
        return Explanation(
            codes.PACKAGE_NOT_FOUND,
            "No install space is sourced: AMENT_PREFIX_PATH is not set.",
            "Source install/setup.bash first.",
        )
    return None


def _missing_package(
    package: str, file: str | None = None, line: int | None = None, hint: str | None = None
) -> Explanation:
    return Explanation(
        codes.PACKAGE_NOT_FOUND,
        f"The package '{package}' is not found.",
        hint
        or advice(
            package,
            packages(),
            f"Add <exec_depend>{package}</exec_depend> to package.xml, and build it in this "
            "workspace or install it.",
        ),
        file,
        line,
        package,
        package,
    )


def packages() -> set[str]:
    """The packages that are installed, and those that need not be."""
    from ament_index_python.packages import get_packages_with_prefixes

    return {*get_packages_with_prefixes(), *known_packages.names()}


def file_error(error: BaseException) -> Explanation | None:
    """A file that is not there or cannot be read."""
    if not isinstance(error, OSError):
        return None
    if not isinstance(error, (FileNotFoundError, NotADirectoryError)):
        return Explanation(
            codes.NOT_READABLE,
            f"The file '{error.filename}' cannot be read: {error.strerror or error}.",
            "Check the path and its permissions.",
        )
    stand_in = getattr(error, "wsgen_stand_in", None)
    if stand_in is not None:
        return Explanation(
            codes.FILE_NOT_INSTALLED,
            f"{error}.",
            advice(stand_in.name, stand_in.names, "Check the path in the launch file."),
            element=stand_in.name,
            written=stand_in.name,
        )
    if error.filename is None:
        return Explanation(
            codes.FILE_NOT_INSTALLED, f"{error}.", "Check the path in the launch file."
        )
    return _missing_file(os.fspath(error.filename))


def _missing_file(path: str) -> Explanation:
    package = known_packages.package_of(path)
    if package is not None and known_packages.is_stand_in(path):
        return Explanation(
            codes.PACKAGE_NOT_FOUND,
            f"A file of the package '{package}' is needed, and the package is not installed "
            f"here: '{path}'.",
            f"Build {package} in this workspace, or source an installation that has it.",
            element=package,
        )
    joined = _glued_package(path)
    if joined is not None:
        return Explanation(
            codes.FILE_NOT_INSTALLED,
            f"The file '{path}' is not there: '/' is missing after the share folder of {joined}.",
            f"Write os.path.join(get_package_share_directory('{joined}'), ...).",
            element=path,
        )
    missing, beside = first_missing(path)
    near = nearest(missing, beside)
    if near is not None:
        return Explanation(
            codes.FILE_NOT_INSTALLED,
            f"The file '{path}' is not there.",
            did_you_mean(near),
            element=missing,
            written=missing,
        )
    if package is not None and known_packages.is_known(package):
        return Explanation(
            codes.FILE_NOT_INSTALLED,
            f"The package '{package}' has no file '{path}'.",
            "Check the path in the launch file.",
            element=path,
        )
    if package is None:
        return Explanation(
            codes.FILE_NOT_INSTALLED,
            f"The file '{path}' is not there.",
            "Look it up in the share folder of a package: get_package_share_directory('PACKAGE').",
            element=path,
        )
    inside = path.rpartition(f"/share/{package}/")[2]
    folder, found, _ = inside.partition("/")
    what = f"DIRECTORY {folder}" if found else f"FILES {inside}"
    return Explanation(
        codes.FILE_NOT_INSTALLED,
        f"'{inside}' is not in the install space of {package}: '{path}' is not there.",
        f"Install it: install({what} DESTINATION share/${{PROJECT_NAME}}) in the CMakeLists.txt "
        f"of {package}, above ament_package(), then build again. If that is there, check the "
        "spelling of the path.",
        element=path,
    )


def _glued_package(path: str) -> str | None:
    """The package whose share folder has become one word with what should be in it."""
    share, found, rest = path.rpartition("/share/")
    name = rest.split("/", 1)[0]
    if not found or os.path.isdir(f"{share}/share/{name}"):
        return None
    try:
        glued = [other for other in os.listdir(f"{share}/share") if name.startswith(other)]
    except (OSError, ValueError):
        return None
    return max(glued, key=len, default=None)


def first_missing(path: str) -> tuple[str, list[str]]:
    """The first part of a path that is not there, and what is in its place."""
    missing = Path(path)
    # Unlike the method, this does not raise where a name is too long or a folder is closed.
    while not os.path.isdir(missing.parent) and missing.parent != missing:
        missing = missing.parent
    try:
        return missing.name, os.listdir(missing.parent)
    except OSError:
        return missing.name, []


def executable_error(error: BaseException) -> Explanation | None:
    """A program that a package does not have."""
    found = re.match(r"executable '(.*)' not found on the libexec directory '(.*)'", str(error))
    if found is None:
        return None
    program, folder = found.groups()
    try:
        names = os.listdir(folder)
    except OSError:
        names = []
    package = os.path.basename(folder)
    known = sorted({*names, *known_packages.programs_of(package)})
    near = nearest(program, known)
    if not known_packages.is_known(package):
        hint = advice(program, known, "Let CMakeLists.txt install it to lib/${PROJECT_NAME}.")
    elif near is not None:
        hint = did_you_mean(near)
    else:
        hint = f"It has {', '.join(known)}." if known else "Check the spelling."
    return Explanation(
        codes.EXECUTABLE_NOT_FOUND,
        f"The package '{package}' has no executable '{program}'.",
        hint,
        element=program,
        written=program,
    )


def report_unused_arguments(
    launch_file: str, given: Sequence[str], of_includes: Sequence[tuple[str, Location, bool]]
) -> None:
    """Report launch arguments that nobody declares or reads.

    `given` are those of the command line; `of_includes` the names that includes give, with the
    line of the include and whether the included file is only stood in for.
    """
    for file in RECORD.launch_files:
        if b"argv" in Path(file).read_bytes():
            return  # it may look for its arguments in the command line
    declared = list(RECORD.argument_use.declared)
    for name in given:
        RECORD.note_diagnostic(
            codes.UNUSED_ARGUMENT,
            "warning",
            f"The launch argument `{name}` has no effect: no launch file declares or reads it.",
            (launch_file, None),
            hint=advice(
                name,
                declared,
                f"Remove it, or declare it: DeclareLaunchArgument('{name}', default_value=...).",
            ),
            element=name,
        )
    for name, location, is_stand_in in of_includes:
        # What is stood in for may take more arguments in another release.
        if is_stand_in and nearest(name, declared, cutoff=known_packages.SURELY) is None:
            continue
        RECORD.note_diagnostic(
            codes.UNUSED_INCLUDE_ARGUMENT,
            "warning",
            f"The launch argument `{name}` has no effect: the included launch file does not "
            "declare or read it.",
            location,
            hint=advice(name, declared, "Remove it from launch_arguments."),
            element=name,
        )
