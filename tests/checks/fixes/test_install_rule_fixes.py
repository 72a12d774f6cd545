"""Fixes of what CMakeLists.txt installs: what is fixed is reported no more."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.checks.fixes.plan import plan_fixes, write_fixes
from wsgen.packages.build_files.facts import read_build_facts

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic

START = "cmake_minimum_required(VERSION 3.8)\nproject(bot)\nfind_package(ament_cmake REQUIRED)\n"
END = "\nament_package()\n"
ALL = "install(DIRECTORY launch urdf DESTINATION share/${PROJECT_NAME})"
RUNS = "import rclpy\nif __name__ == '__main__':\n    print()\n"


def write(folder: Path, text: str) -> None:
    for name in ("launch/a.launch.py", "urdf/b.urdf", "package.xml"):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).touch()
    (folder / "CMakeLists.txt").write_text(START + text + END)


def report(folder: Path) -> tuple[Diagnostic, ...]:
    return read_build_facts(folder, "bot", "ament_cmake")[1]


def fix(folder: Path) -> None:
    """Apply the fixes, twice; then nothing is reported."""
    assert report(folder)
    for _ in range(2):
        list(write_fixes(plan_fixes(report(folder), [folder])))
    assert report(folder) == ()


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("install(DIRECTORY launch urdf DESTINATION share/{PROJECT_NAME})", ALL),
        ("install(DIRECTORY launch urdf DESTINATION share/${PROJECT_NAM})", ALL),
        ("install(DIRECTORY launch urdf DESTINATION share)", ALL),
        ("install(DIRECTORY launch urdf DESTINATION ${PROJECT_NAME})", ALL),
        ("install(DIRECTORY launch urdf TYPE DATA)", ALL),
        ("install(DIRECTORY launch/ urdf/ DESTINATION share/${PROJECT_NAME})", ALL),
        ("install(DIRECTORY urdf DESTINATION share/${PROJECT_NAME})",
         "install(DIRECTORY urdf launch DESTINATION share/${PROJECT_NAME})"),
        ("install(DIRECTORY\n  urdf\n  DESTINATION share/${PROJECT_NAME})",
         "install(DIRECTORY\n  urdf\n  launch\n  DESTINATION share/${PROJECT_NAME})"),
        ("install(FILES urdf/b.urdf DESTINATION share/${PROJECT_NAME}/urdf)",
         ("install(FILES urdf/b.urdf DESTINATION share/${PROJECT_NAME}/urdf)\n"
         "install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})")),
        (ALL + "\ninstall(DIRECTORY urdf DESTINATION share/bot/urdf)",
         ALL + "\ninstall(DIRECTORY urdf DESTINATION share/bot)"),
    ],
)  # fmt: skip
def test_install(tmp_path: Path, before: str, after: str) -> None:
    write(tmp_path, before)
    fix(tmp_path)
    assert (tmp_path / "CMakeLists.txt").read_text() == START + after + END


@pytest.mark.parametrize(
    "script",
    [
        RUNS.encode(),
        f"#!/usr/bin/env python3\n{RUNS}".replace("\n", "\r\n").encode(),
        f"#!/usr/bin/python\n{RUNS}".encode(),
    ],
)
def test_scripts(tmp_path: Path, script: bytes) -> None:
    write(tmp_path, f"{ALL}\ninstall(PROGRAMS go.py DESTINATION lib/${{PROJECT_NAME}})")
    (tmp_path / "go.py").write_bytes(script)
    (tmp_path / "go.py").chmod(0o755)
    fix(tmp_path)
    assert (tmp_path / "go.py").read_bytes() == f"#!/usr/bin/env python3\n{RUNS}".encode()


def test_a_late_command(tmp_path: Path) -> None:
    write(tmp_path, ALL)
    file = tmp_path / "CMakeLists.txt"
    file.write_text(f"{file.read_text()}ament_export_dependencies(rclcpp)\n")
    fix(tmp_path)
    assert file.read_text().endswith("ament_export_dependencies(rclcpp)\nament_package()\n")
