"""`wsgen build`: what it prints of the programs' own words."""

import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE_XML = """\
<package format="3">
  <name>demo</name>
  <version>0.0.0</version>
  <description>A robot for tests.</description>
  <maintainer email="somebody@example.com">Somebody</maintainer>
  <license>Apache-2.0</license>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
CMAKE = """\
cmake_minimum_required(VERSION 3.20)
project(demo LANGUAGES NONE)
find_package(ament_cmake REQUIRED)
ament_package()
"""


@pytest.fixture
def package(tmp_path: Path) -> Path:
    folder = tmp_path / "src" / "demo"
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(PACKAGE_XML)
    (folder / "CMakeLists.txt").write_text(CMAKE)
    return folder


def build(package: Path, *options: str) -> tuple[int, str]:
    """The exit code and what was printed."""
    run = subprocess.run(
        [sys.executable, "-m", "wsgen", "build", *options],
        cwd=package,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.stdout == ""
    return run.returncode, run.stderr


def test_a_traceback_that_is_explained_is_for_verbose(package: Path) -> None:
    (package / "package.xml").write_text(PACKAGE_XML.replace("<license>Apache-2.0</license>", ""))
    code, printed = build(package)
    assert code == 1
    assert "Traceback" not in printed
    assert "try: Add: <license>Apache-2.0</license>" in printed
    assert "Traceback" in build(package, "-v")[1]


def test_the_output_of_an_unknown_failure_is_printed_once(package: Path) -> None:
    (package / "CMakeLists.txt").write_text(CMAKE + "message(FATAL_ERROR\n  strange)\n")
    for options in ((), ("-v",)):
        code, printed = build(package, *options)
        assert code == 1
        assert printed.count("CMake Error at CMakeLists.txt:5") == 1
    assert "CMake Error at" not in build(package, "-q")[1]


def test_warnings_of_a_good_build_are_printed(package: Path) -> None:
    (package / "CMakeLists.txt").write_text(CMAKE + "message(WARNING strange)\n")
    code, printed = build(package)
    assert code == 0
    assert "strange" in printed


def test_a_workspace_that_cannot_be_written(package: Path) -> None:
    (package.parents[1] / "build").touch()
    code, printed = build(package)
    assert code == 4
    assert "cannot write" in printed
