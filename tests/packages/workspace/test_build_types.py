"""The build type of a package.xml, with facts alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.packages.workspace.manifest import Entry, Manifest
from wsgen.packages.workspace.package_xml import check_build_type

FILE = Path("package.xml")


def manifest(build_type: str | None, *, has_export: bool = True) -> Manifest:
    entries: dict[tuple[str, ...], tuple[Entry, ...]] = {}
    if has_export:
        entries["export",] = (Entry("", 9, {}),)
    if build_type is not None:
        entries["export", "build_type"] = (Entry(build_type, 10, {}),)
    return Manifest(name="demo", build_type=build_type or "catkin", file=FILE, entries=entries)


@pytest.mark.parametrize(
    ("has_export", "is_python", "line", "hint"),
    [
        (True, False, 9, "Add below <export>: <build_type>ament_cmake</build_type>"),
        (False, False, None, "Add: <export><build_type>ament_cmake</build_type></export>"),
        (True, True, 9, "Add below <export>: <build_type>ament_python</build_type>"),
    ],
)
def test_a_missing_build_type(
    has_export: bool, is_python: bool, line: int | None, hint: str
) -> None:
    (found,) = check_build_type(
        manifest(None, has_export=has_export),
        calls_ament_package=not is_python,
        is_python=is_python,
    )
    assert (found.code, found.line, found.hint) == ("PKG009", line, hint)


def test_a_misspelled_build_type() -> None:
    (found,) = check_build_type(manifest("ament_cmke"), calls_ament_package=True, is_python=False)
    assert (found.code, found.line) == ("PKG008", 10)
    assert "Did you mean `ament_cmake`" in (found.hint or "")


@pytest.mark.parametrize("build_type", ["ament_cmake", "ament_python", "cmake", "ament_cargo"])
def test_known_build_types_and_those_of_extensions(build_type: str) -> None:
    found = check_build_type(manifest(build_type), calls_ament_package=True, is_python=False)
    assert [*found] == []


def test_a_package_of_ros_1() -> None:
    assert [*check_build_type(manifest(None), calls_ament_package=False, is_python=False)] == []
