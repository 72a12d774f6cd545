"""`wsgen check` reads whatever lies in a package: pipes, devices, dead links, and nonsense."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

import pytest

from wsgen.pipeline.check import CheckRequest, check

if TYPE_CHECKING:
    from pathlib import Path

MANIFEST = """<package format="3">
  <name>arm</name><version>0.1.0</version><description>An arm.</description>
  <maintainer email="me@example.org">Me</maintainer><license>MIT</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
BUILD_FILE = """cmake_minimum_required(VERSION 3.16)
project(arm)
find_package(ament_cmake REQUIRED)
install(DIRECTORY launch urdf config DESTINATION share/${PROJECT_NAME})
ament_package()
"""
NAMES = (
    *("CMakeLists.txt", "setup.py", "setup.cfg", "wsgen.toml"),
    *("launch/a.launch.py", "urdf/a.urdf", "urdf/a.xacro", "config/a.yaml", "config/a.rviz"),
    *("urdf/a.sdf", "launch/a.launch.xml", "launch/a.launch.yaml", "arm/node.py"),
)


def write_package(folder: Path, build_type: str) -> Path:
    manifest = MANIFEST.replace("ament_cmake", build_type)
    for name, text in (("package.xml", manifest), ("CMakeLists.txt", BUILD_FILE)):
        (folder / name).write_text(text)
    for name in ("launch", "urdf", "config", "arm"):
        (folder / name).mkdir()
    return folder


def codes_of(folder: Path) -> set[str]:
    found = check(CheckRequest(paths=[folder]), environment=os.environ)
    return {one.code for one in found.diagnostics}


@pytest.mark.skipif(sys.platform == "win32", reason="has no named pipes")
@pytest.mark.parametrize("build_type", ["ament_cmake", "ament_python"])
@pytest.mark.parametrize("name", NAMES)
def test_a_named_pipe_is_not_opened(tmp_path: Path, name: str, build_type: str) -> None:
    write_package(tmp_path, build_type)
    (tmp_path / name).unlink(missing_ok=True)
    os.mkfifo(tmp_path / name)
    codes_of(tmp_path)


@pytest.mark.skipif(sys.platform == "win32", reason="has no named pipes")
def test_a_manifest_that_is_a_named_pipe(tmp_path: Path) -> None:
    package = tmp_path / "src" / "arm"
    package.mkdir(parents=True)
    os.mkfifo(package / "package.xml")
    assert codes_of(tmp_path) == {"PKG002"}


def test_a_manifest_that_is_nested_without_end(tmp_path: Path) -> None:
    write_package(tmp_path, "ament_cmake")
    (tmp_path / "package.xml").write_text(
        "<package>" + "<a>" * 20_000 + "</a>" * 20_000 + "</package>"
    )
    assert codes_of(tmp_path) == {"PKG004"}
