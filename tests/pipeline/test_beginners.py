"""The ways in which beginners fail that files show: each as one change to a sound package.

Three more show on the machine alone, and `wsgen doctor` tells them: an overlay that is not sourced,
a Python without catkin_pkg, empy 4.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from cart_package import check_cart

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.slow

LAUNCH = "launch/cart.launch.py"
ROBOT = "urdf/cart.urdf.xacro"
CREATE = "package='ros_gz_sim', executable='create'"
WAYS = {
    "a folder is not installed": (
        ("CMakeLists.txt", "launch urdf worlds config", "urdf worlds config"),
        {("folder-not-installed", "CMakeLists.txt")},
    ),
    "install() names a folder that does not exist": (
        ("CMakeLists.txt", "worlds config", "worlds config meshes"),
        {("missing-installed-path", "CMakeLists.txt")},
    ),
    "a trailing slash changes what is installed": (
        ("CMakeLists.txt", "launch urdf worlds config", "launch urdf/ worlds config"),
        {("contents-installed", "CMakeLists.txt")},
    ),
    "ament_package() is missing": (
        ("CMakeLists.txt", "ament_package()", ""),
        {("missing-ament-package", "CMakeLists.txt")},
    ),
    "ament_package() is not last": (
        (
            "CMakeLists.txt",
            "find_package(ament_cmake REQUIRED)\n",
            "find_package(ament_cmake REQUIRED)\nament_package()\n",
        ),
        {("repeated-ament-package", "CMakeLists.txt")},
    ),
    "a package is used and not declared": (
        ("package.xml", "<exec_depend>xacro</exec_depend>", ""),
        {("undeclared-package", LAUNCH)},
    ),
    "a dependency is misspelled": (
        ("package.xml", "<exec_depend>xacro</exec_depend>", "<exec_depend>xarco</exec_depend>"),
        {("misspelled-dependency", "package.xml")},
    ),
    "the spawner is that of Gazebo Classic": (
        (LAUNCH, CREATE, "package='gazebo_ros', executable='spawn_entity.py'"),
        {("spawner-of-other-simulator", LAUNCH)},
    ),
    "gazebo_ros is not there on Jazzy": (
        (
            "package.xml",
            "<exec_depend>ros_gz_sim</exec_depend>",
            "<exec_depend>ros_gz_sim</exec_depend><exec_depend>gazebo_ros</exec_depend>",
        ),
        {("unreleased-dependency", "package.xml")},
    ),
    "create is given the name of another world": (
        ("worlds/office.sdf", 'name="office"', 'name="default"'),
        {("other-world-name", LAUNCH)},
    ),
    "a mesh is not there": (
        (
            ROBOT,
            '<visual name="v"><geometry><box size="1 1 0.2"/>',
            '<visual name="v"><geometry><mesh filename="package://cart/meshes/body.stl"/>',
        ),
        {("missing-visual-mesh", ROBOT)},
    ),
    "a colon in a comment, without ParameterValue": (
        (
            LAUNCH,
            "ParameterValue(Command(['xacro ', path]), value_type=str)",
            "Command(['xacro ', path])",
        ),
        {("description-as-yaml", LAUNCH)},
    ),
    "a link has no inertia": (
        (
            ROBOT,
            "<gazebo>\n",
            (
                '<link name="arm"><visual name="v"><geometry><box size="1 1 1"/>'
                '</geometry></visual></link><joint name="j" type="continuous">'
                '<parent link="base_link"/>'
                '<child link="arm"/></joint><gazebo>\n'
            ),
        ),
        {("dropped-link", ROBOT)},
    ),
    "a program is not installed": (
        (LAUNCH, "package='rviz2', executable='rviz2'", "package='cart', executable='talker.py'"),
        {("executable-not-found", LAUNCH)},
    ),
    "CMake 4 refuses an old cmake_minimum_required()": (
        ("CMakeLists.txt", "VERSION 3.16", "VERSION 3.0"),
        {("old-cmake-minimum", "CMakeLists.txt")},
    ),
    "tests require what is not on every machine": (
        (
            "CMakeLists.txt",
            "ament_package()",
            "find_package(ament_lint_auto REQUIRED)\nament_package()",
        ),
        {("test-package-required", "CMakeLists.txt")},
    ),
    "tests require what package.xml does not declare": (
        (
            "CMakeLists.txt",
            "ament_package()",
            "if(BUILD_TESTING)\n  find_package(ament_lint_auto REQUIRED)\nendif()\nament_package()",
        ),
        {("undeclared-test-dependency", "CMakeLists.txt")},
    ),
}


def test_the_package_is_sound(tmp_path: Path) -> None:
    _, outcome = check_cart(tmp_path, {})
    assert [one for one in outcome.diagnostics if one.severity.value != "info"] == []


@pytest.mark.parametrize("way", WAYS)
def test_each_way_is_reported_with_what_to_do(tmp_path: Path, way: str) -> None:
    (file, old, new), expected = WAYS[way]
    package, outcome = check_cart(tmp_path, {file: (old, new)})
    reported = {
        (one.name, one.file.relative_to(package).as_posix()): one.hint
        for one in outcome.diagnostics
        if one.file is not None and one.line is not None
    }
    assert expected <= {*reported}, reported
    assert all(reported[one] for one in expected)
