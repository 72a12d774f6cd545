"""Explain what is missing, or wrong in a xacro file: packages, share files, descriptions."""

from __future__ import annotations

import os
from typing import Any, NamedTuple

from wsgen.launch import codes, known_packages


class Explanation(NamedTuple):
    """What is told of an exception; file and line only where they are not the launch file's."""

    code: str
    message: str
    hint: str
    file: str | None = None
    line: int | None = None
    element: str | None = None


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
        fault.get("hint") or "Mend the xacro file; `xacro FILE` shows the same error.",
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
        or f"Check the spelling. If it is right, add <exec_depend>{package}</exec_depend> to "
        "package.xml, and build it in this workspace or install it.",
        file,
        line,
        package,
    )


def file_error(error: BaseException) -> Explanation | None:
    """A file that is not there or cannot be read."""
    if not isinstance(error, OSError):
        return None
    if not isinstance(error, (FileNotFoundError, NotADirectoryError)):
        return Explanation(
            codes.NOT_READABLE,
            f"{error.strerror or error}: '{error.filename}'.",
            "Check the path and its permissions.",
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
