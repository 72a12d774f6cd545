"""What build files install according to `BuildFacts` is what a build installs."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

from building.building import PACKAGE_XML, build_here
from wsgen.packages.build_files.facts import read_build_facts
from wsgen.packages.workspace.manifest import Manifest, read_manifest

WORKSPACES = Path(__file__).parents[2] / "workspaces"
# What ament and colcon make, each for its own use.
MADE = ("cmake/", "environment/", "hook/", "local_setup", "package.")

CMAKE = """\
cmake_minimum_required(VERSION 3.20)
project(demo LANGUAGES NONE)
find_package(ament_cmake REQUIRED)
find_package(ament_cmake_python REQUIRED)

#[[ install(DIRECTORY secret DESTINATION share/${PROJECT_NAME}) ]]
set(folders launch)
list(APPEND folders urdf worlds)
install(
  DIRECTORY ${folders}  # three of them
  DESTINATION share/${PROJECT_NAME}/
)
function(share folder)
  cmake_parse_arguments(ARG "FLAT" "AS" "EXCEPT" ${ARGN})
  if(ARG_AS)
    install(DIRECTORY ${folder}/ DESTINATION share/${PROJECT_NAME}/${ARG_AS})
  elseif(ARG_FLAT)
    file(GLOB found RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} "${folder}/*.yaml")
    list(REMOVE_ITEM found ${ARG_EXCEPT})
    install(FILES ${found} DESTINATION share/${PROJECT_NAME})
  endif()
endfunction()
share(config FLAT EXCEPT config/b.yaml)
share("my maps" AS maps)
install(DIRECTORY meshes DESTINATION share/${PROJECT_NAME}
  FILES_MATCHING PATTERN "*.stl" PATTERN "*.dae" PATTERN "old" EXCLUDE
  REGEX ".*_raw\\\\..*" EXCLUDE)
foreach(kind IN ITEMS one two)
  if(NOT kind STREQUAL "two" AND EXISTS "${CMAKE_CURRENT_SOURCE_DIR}/models/${kind}.sdf")
    install(FILES models/${kind}.sdf DESTINATION share/${PROJECT_NAME}/models RENAME ${kind}_1.sdf)
  endif()
endforeach()
install(PROGRAMS scripts/go.py DESTINATION lib/${PROJECT_NAME})
install(PROGRAMS scripts/go.py DESTINATION lib/${PROJECT_NAME} RENAME go)
install(FILES scripts/note.txt DESTINATION lib/${PROJECT_NAME})
install(DIRECTORY tools/ DESTINATION lib/${PROJECT_NAME} USE_SOURCE_PERMISSIONS)
ament_python_install_package(${PROJECT_NAME}_py)
add_subdirectory(more)
ament_package()
"""
MORE = """\
string(REPLACE "e" "3" name "here")
install(FILES text.txt DESTINATION share/${PROJECT_NAME}/${name})
install(DIRECTORY . DESTINATION share/${PROJECT_NAME}/whole PATTERN CMakeLists.txt EXCLUDE)
"""
SETUP = """\
import os
from glob import glob
from setuptools import find_packages, setup

package_name = 'demo'


def rows(*folders):
    found = []
    for folder in folders:
        for path, _, names in os.walk(folder):
            files = [os.path.join(path, name) for name in names if not name.endswith('.txt')]
            if files:
                found.append((os.path.join('share', package_name, path), files))
    return found


setup(
    name=package_name,
    version='0.1.0',
    packages=find_packages(exclude=['test']),
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
        (f'share/{package_name}/launch', glob('launch/*launch.[pxy][yma]*')),
        *rows('meshes', 'models'),
        ('lib/' + package_name, ['scripts/go.py']),
    ],
    entry_points={'console_scripts': ['start = demo_py.node:main']},
)
"""
CONFIGURATION = "[develop]\nscript_dir=$base/lib/demo\n[install]\ninstall_scripts=$base/lib/demo\n"
FILES = (
    *("launch/a.launch.py", "launch/b_launch.xml", "launch/helper.py", "urdf/parts/a.xacro"),
    *("worlds/.hidden", "worlds/w.sdf", "config/a.yaml", "config/b.yaml", "my maps/m.pgm"),
    *("meshes/a.stl", "meshes/a_raw.stl", "meshes/old/b.stl", "meshes/new/c.dae", "meshes/d.txt"),
    *("models/one.sdf", "models/two.sdf", "scripts/go.py", "scripts/note.txt", "tools/run.sh"),
    *("demo_py/__init__.py", "more/text.txt", "more/deep/other.txt", "resource/demo"),
)


def installed(prefix: Path, name: str) -> tuple[set[str], set[str]]:
    """The files in the share folder, and the programs."""
    share, programs = prefix / "share" / name, prefix / "lib" / name
    files = {str(one.relative_to(share)) for one in share.rglob("*") if one.is_file()}
    found = {
        one.name
        for one in (programs.iterdir() if programs.is_dir() else ())
        if one.is_file() and os.access(one, os.X_OK)
    }
    return {one for one in files if not one.startswith(MADE)}, found


def compare(root: Path, name: str, folder: Path, build_type: str) -> None:
    facts, _ = read_build_facts(folder, name, build_type)
    files, programs = installed(root / "install" / name, name)
    assert facts.is_whole
    assert {one for one in facts.shared(name) if not one.startswith(MADE)} == files
    assert {one.name for one in facts.executables} == programs


def write(root: Path) -> Path:
    folder = root / "src" / "demo"
    for name in FILES:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text("#!/bin/sh\n")
    (folder / "demo_py/node.py").write_text("def main():\n    pass\n")
    (folder / "tools/run.sh").chmod(0o755)
    return folder


@pytest.mark.slow
def test_cmake(tmp_path: Path) -> None:
    folder = write(tmp_path)
    (folder / "package.xml").write_text(PACKAGE_XML)
    (folder / "CMakeLists.txt").write_text(CMAKE)
    (folder / "more/CMakeLists.txt").write_text(MORE)
    assert build_here(tmp_path).succeeded
    compare(tmp_path, "demo", folder, "ament_cmake")


@pytest.mark.slow
def test_python(tmp_path: Path) -> None:
    folder = write(tmp_path)
    (folder / "scripts/go.py").chmod(0o755)
    (folder / "package.xml").write_text(PACKAGE_XML.replace("ament_cmake", "ament_python"))
    (folder / "setup.py").write_text(SETUP)
    (folder / "setup.cfg").write_text(CONFIGURATION)
    assert build_here(tmp_path).succeeded
    compare(tmp_path, "demo", folder, "ament_python")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["five_launch_files", "moveit_settings", "python_package"])
def test_workspaces(tmp_path: Path, name: str) -> None:
    shutil.copytree(WORKSPACES / name, tmp_path / "ws")
    root = tmp_path / "ws"
    assert build_here(root).succeeded
    for file in root.glob("src/*/package.xml"):
        manifest = read_manifest(file)
        assert isinstance(manifest, Manifest)
        compare(root, manifest.name, file.parent, manifest.build_type)
