"""How beginners' build files fail, each way as a package: `wsgen check` says what to do."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from wsgen.pipeline.check import CheckRequest, check

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic

MANIFEST = """\
<package format="3">
  <name>crab</name>
  <version>0.0.1</version>
  <description>A crab on four wheels.</description>
  <maintainer email="ada@example.org">Ada</maintainer>
  <license>Apache-2.0</license>
  <exec_depend>robot_state_publisher</exec_depend>
  <export><build_type>BUILD_TYPE</build_type></export>
</package>
"""
CMAKE = """\
cmake_minimum_required(VERSION 3.8)
project(crab)
find_package(ament_cmake REQUIRED)
install(DIRECTORY launch urdf DESTINATION share/${PROJECT_NAME})
install(PROGRAMS scripts/walk.py DESTINATION lib/${PROJECT_NAME})
ament_package()
"""
SETUP = """\
from glob import glob
from setuptools import setup

setup(
    name='crab',
    packages=['crab'],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/crab']),
        ('share/crab', ['package.xml']),
        ('share/crab/launch', glob('launch/*.launch.py')),
        ('share/crab/urdf', glob('urdf/*.urdf')),
    ],
    entry_points={'console_scripts': ['walk.py = crab.walk:main']},
)
"""
CONFIGURATION = "[develop]\nscript_dir=$base/lib/crab\n[install]\ninstall_scripts=$base/lib/crab\n"
LAUNCH = """\
import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    with open(os.path.join(get_package_share_directory('crab'), 'urdf', 'crab.urdf')) as file:
        text = file.read()
    return LaunchDescription([
        Node(package='robot_state_publisher', executable='robot_state_publisher',
             parameters=[{'robot_description': text}]),
        Node(package='crab', executable='walk.py'),
    ])
"""
URDF = """\
<robot name="crab">
  <link name="base">
    <inertial>
      <mass value="2"/>
      <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <visual><geometry><box size="0.7 0.7 0.7"/></geometry></visual>
    <collision><geometry><box size="0.7 0.7 0.7"/></geometry></collision>
  </link>
</robot>
"""
WALK = "#!/usr/bin/env python3\n\n\ndef main():\n    print('walks')\n\n\n"
WALK += "if __name__ == '__main__':\n    main()\n"
COMMON = {"launch/crab.launch.py": LAUNCH, "urdf/crab.urdf": URDF}
OF_CMAKE = {**COMMON, "CMakeLists.txt": CMAKE, "scripts/walk.py": WALK}
OF_PYTHON = {
    **COMMON,
    "setup.py": SETUP,
    "setup.cfg": CONFIGURATION,
    "resource/crab": "",
    "crab/__init__.py": "",
    "crab/walk.py": WALK,
}


def run(folder: Path, build_type: str, file: str, old: str, new: str) -> tuple[Diagnostic, ...]:
    files = OF_PYTHON if build_type == "ament_python" else OF_CMAKE
    manifest = MANIFEST.replace("BUILD_TYPE", build_type)
    if build_type == "ament_cmake":
        tool = "<buildtool_depend>ament_cmake</buildtool_depend>\n  <exec"
        manifest = manifest.replace("<exec", tool, 1)
    for name, content in {**files, "package.xml": manifest}.items():
        path = folder / "src" / "crab" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if name == file:
            assert old in content
        if name != file or new != "GONE":
            path.write_text(content.replace(old, new) if name == file else content)
            path.chmod(0o755 if path.suffix == ".py" else 0o644)
    environment = {k: v for k, v in os.environ.items() if k != "AMENT_PREFIX_PATH"}
    return check(CheckRequest(paths=(folder,)), environment=environment).diagnostics


@pytest.mark.slow
@pytest.mark.parametrize("build_type", ["ament_cmake", "ament_python"])
def test_the_sound_package(tmp_path: Path, build_type: str) -> None:
    assert run(tmp_path, build_type, "", "", "") == ()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "old", "new", "name", "advice"),
    [
        # 1: a folder that no rule installs.
        ("CMakeLists.txt", " urdf", "", "file-not-installed", "urdf"),
        ("CMakeLists.txt", "launch ", "", "folder-not-installed", "install(DIRECTORY launch"),
        ("setup.py", "        ('share/crab/launch', glob('launch/*.launch.py')),\n", "",
         "folder-not-installed", "'share/crab/launch'"),
        ("setup.py", "*.launch.py", "*_launch.py", "empty-glob", "glob('launch/*.py')"),
        # 2: a folder that does not exist.
        ("CMakeLists.txt", " urdf", " urdf meshes", "missing-installed-path", "Git does not keep"),
        # 3: TYPE, a slash, a destination without the name.
        ("CMakeLists.txt", "launch urdf DESTINATION share/${PROJECT_NAME}",
         "launch urdf TYPE DATA", "wrong-destination", "DESTINATION share/${PROJECT_NAME}"),
        ("CMakeLists.txt", "launch urdf", "launch/ urdf/", "contents-installed",
         "Remove the slash"),
        ("CMakeLists.txt", "urdf DESTINATION share/${", "urdf DESTINATION share/{",
         "wrong-destination", "share/${PROJECT_NAME}"),
        # 4: ament_package().
        ("CMakeLists.txt", "ament_package()\n", "", "missing-ament-package", "ament_package()"),
        ("CMakeLists.txt", "ament_package()\n", "ament_package()\nament_export_libraries(x)\n",
         "command-after-ament-package", "Move ament_package()"),
        # 13: no executable found.
        ("setup.cfg", "", "GONE", "broken-console-script", "install_scripts=$base/lib/crab"),
        ("CMakeLists.txt", "install(PROGRAMS", "install(FILES", "program-not-executable",
         "install(PROGRAMS scripts/walk.py"),
        ("scripts/walk.py", "#!/usr/bin/env python3\n", "", "broken-shebang", "#!/usr/bin/env"),
        ("scripts/walk.py", "def main():", "def main()", "python-syntax-error", "colon"),
        ("crab/walk.py", "def main():", "def main()", "python-syntax-error", "colon"),
        ("setup.py", "crab.walk:main", "crab.walk:mian", "broken-console-script", "`main`"),
        # 16: an old CMake, a package of tests.
        ("CMakeLists.txt", "VERSION 3.8", "VERSION 2.8", "old-cmake-minimum", "VERSION 3.8...3.31"),
        ("CMakeLists.txt", "install(D", "find_package(ament_lint_auto REQUIRED)\ninstall(D",
         "test-package-required", "if(BUILD_TESTING)"),
    ],
)  # fmt: skip
def test_ways_to_fail(  # noqa: PLR0917
    tmp_path: Path, file: str, old: str, new: str, name: str, advice: str
) -> None:
    build_type = "ament_cmake" if file in OF_CMAKE else "ament_python"
    found = run(tmp_path, build_type, file, old, new)
    (wanted,) = (one for one in found if one.name == name)
    assert advice in (wanted.hint or "")
    assert wanted.file is not None
    assert wanted.line is not None or new == "GONE"
    if name == "python-syntax-error":
        assert [one.name for one in found] == [name]
