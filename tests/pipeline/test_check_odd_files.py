"""`wsgen check` reads whatever lies in a package: pipes, devices, dead links, and nonsense."""

from __future__ import annotations

import os
import shutil
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
    folder.mkdir(exist_ok=True)
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
    assert codes_of(tmp_path) == {"PKG001"}


@pytest.mark.slow
@pytest.mark.parametrize("encoding", ["utf-7", "rot13"])
def test_an_encoding_that_no_parser_of_xml_reads(tmp_path: Path, encoding: str) -> None:
    write_package(tmp_path, "ament_cmake")
    head = f'<?xml version="1.0" encoding="{encoding}"?>\n'
    (tmp_path / "package.xml").write_text(head + MANIFEST)
    found = check(CheckRequest(paths=[tmp_path]), environment=os.environ).diagnostics
    assert [one.code for one in found] == ["PKG001"]
    assert f"the encoding `{encoding}`" in found[0].message
    (tmp_path / "package.xml").write_text(MANIFEST)
    (tmp_path / "urdf" / "a.urdf").write_text(f'{head}<robot name="a"><link name="b"/></robot>')
    (tmp_path / "urdf" / "a.xacro").write_text(f'{head}<robot name="a"/>')
    (tmp_path / "urdf" / "a.sdf").write_text(f"{head}<sdf version='1.6'/>")
    (tmp_path / "launch" / "a.launch.xml").write_text(f"{head}<launch/>")
    assert "LCH023" in codes_of(tmp_path)


DEEP = "<a>" * 20_000 + "</a>" * 20_000
MANY = " ".join(f"a{number}=''" for number in range(20_000))
LARGE = {
    "package.xml": (MANIFEST, "PKG001"),
    "urdf/a.urdf": ('<robot name="a"></robot>', "ROB001"),
    "urdf/a.sdf": ('<sdf version="1.6"></sdf>', "ROB001"),
    "launch/a.launch.xml": ("<launch ></launch>", "LCH023"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", LARGE)
def test_more_of_xml_than_anybody_writes(tmp_path: Path, name: str) -> None:
    text, code = LARGE[name]
    for large in (text.replace("</", f"{DEEP}</", 1), text.replace(" ", f" {MANY} ", 1)):
        write_package(tmp_path / "arm", "ament_cmake")
        (tmp_path / "arm" / name).write_text(large)
        assert code in codes_of(tmp_path / "arm")
        shutil.rmtree(tmp_path / "arm")


@pytest.mark.slow
def test_xacro_makes_no_tree_of_what_is_nested_without_end(tmp_path: Path) -> None:
    write_package(tmp_path, "ament_cmake")
    (tmp_path / "urdf" / "a.xacro").write_text(f'<robot name="a">{DEEP}</robot>')
    launch = (
        "import os, xacro\n"
        "from ament_index_python.packages import get_package_share_directory\n"
        "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n"
        "def generate_launch_description():\n"
        "    file = os.path.join(get_package_share_directory('arm'), 'urdf', 'a.xacro')\n"
        "    text = xacro.process_file(file).toxml()\n"
        "    return LaunchDescription([Node(package='robot_state_publisher', executable="
        "'robot_state_publisher', parameters=[{'robot_description': text}])])\n"
    )
    (tmp_path / "launch" / "a.launch.py").write_text(launch)
    found = check(CheckRequest(paths=[tmp_path]), environment=os.environ).diagnostics
    messages = [one.message for one in found if one.code == "LCH008"]
    assert [one for one in messages if "nested more than 256 deep" in one], found
