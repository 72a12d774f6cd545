"""What is used and what is declared, with facts alone."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from wsgen.checks.rules.package_uses import (
    check_required,
    check_tests,
    check_uses,
    declared_by,
    may_be_unused,
    unused_dependencies,
)
from wsgen.diagnostics import Severity
from wsgen.model.build_facts import BuildFacts, InstalledFile, RequiredPackage
from wsgen.packages.workspace.manifest import Dependency, Manifest
from wsgen.packages.workspace.package_uses import (
    CONTROLLER,
    DESCRIPTION,
    LAUNCH,
    NODE,
    PLUGIN,
    PackageUse,
)

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic

FILE = Path("src/my_robot/package.xml")
LAUNCH_FILE = Path("src/my_robot/launch/robot.launch.py")
CMAKE = Path("src/my_robot/CMakeLists.txt")
NODE_FILE = Path("src/my_robot/my_robot/driver.py")


def manifest(name: str, **dependencies: str) -> Manifest:
    """A manifest with dependencies: by tag, the names; the first one is in line 10."""
    return Manifest(
        name=name,
        build_type="ament_cmake",
        file=FILE,
        dependencies=tuple(
            Dependency(tag=tag, name=one, line=line)
            for line, (tag, one) in enumerate(
                ((tag, one) for tag, names in dependencies.items() for one in names.split()),
                start=10,
            )
        ),
    )


def launch(*packages: str) -> list[PackageUse]:
    return [
        PackageUse(package, LAUNCH_FILE, line, LAUNCH)
        for line, package in enumerate(packages, start=5)
    ]


def check(uses: list[PackageUse], *others: Manifest, **dependencies: str) -> list[Diagnostic]:
    checked = manifest("my_robot", **dependencies)
    manifests = {one.name: one for one in (checked, *others)}
    return [*check_uses(checked, uses, manifests=manifests, distro=None)]


def test_a_launch_file_with_undeclared_packages() -> None:
    (found,) = check(launch("rviz2", "my_robot", "joy", "xacro", "rviz2"), exec_depend="xacro")
    assert (found.code, found.file, found.line) == ("LCH045", LAUNCH_FILE, 5)
    assert found.message == "package.xml does not declare joy, rviz2, which the launch file uses."
    assert found.hint == (
        "Add to package.xml: <exec_depend>joy</exec_depend> <exec_depend>rviz2</exec_depend>"
    )


def test_packages_of_gazebo_that_later_distributions_do_not_have() -> None:
    def check_for(distro: str | None, *packages: str) -> list[Diagnostic]:
        checked = manifest("my_robot")
        manifests = {"my_robot": checked}
        return [*check_uses(checked, launch(*packages), manifests=manifests, distro=distro)]

    (found,) = check_for("jazzy", "ros_ign_gazebo")
    assert (found.code, found.severity) == ("PKG070", Severity.ERROR)
    assert (found.file, found.hint) == (LAUNCH_FILE, "Use ros_gz_sim.")
    assert check_for("jazzy", "gazebo_ros") == []  # SPN105 says it
    (found,) = check_for("humble", "ros_ign_gazebo")
    assert found.hint == "Add to package.xml: <exec_depend>ros_ign_gazebo</exec_depend>"
    (found,) = check_for(None, "gazebo_ros", "rviz2")
    assert found.code == "LCH045"
    assert (found.hint or "").endswith("; from jazzy on, write ros_gz_sim for gazebo_ros")


@pytest.mark.parametrize("kind", [NODE, DESCRIPTION])
def test_a_node_or_robot_with_an_undeclared_package(kind: str) -> None:
    (found,) = check([PackageUse("nav_msgs", NODE_FILE, 3, kind)])
    assert (found.code, found.file, found.line) == ("PKG085", NODE_FILE, 3)
    assert found.message == "package.xml does not declare nav_msgs, which driver.py uses."


@pytest.mark.parametrize(
    "dependencies",
    [
        {"exec_depend": "rviz2"},
        {"depend": "rviz2"},
        {"run_depend": "rviz2"},
        {"test_depend": "rviz2"},
        {"exec_depend": "desktop"},
        {"exec_depend": "rvzi2"},  # reported as misspelled
        {"exec_depend": "arm_bringup"},
    ],
)
def test_what_is_declared_or_brought(dependencies: dict[str, str]) -> None:
    assert check(launch("rviz2"), manifest("arm_bringup", depend="rviz2"), **dependencies) == []


def test_a_package_of_the_workspace() -> None:
    (found,) = check(launch("arm_tools"), manifest("arm_tools"))
    assert found.code == "LCH045"
    # It needs this one: declared, both would need each other.
    assert check(launch("arm_tools"), manifest("arm_tools", build_depend="my_robot")) == []


def test_a_package_that_nobody_knows_is_not_reported_here() -> None:
    assert check(launch("my_lost_package")) == []


def test_declared_for_the_build_alone() -> None:
    (found,) = check(launch("xacro"), build_depend="rclcpp xacro")
    assert (found.code, found.file, found.line) == ("PKG084", FILE, 11)
    assert found.hint == "Write <depend>xacro</depend>."
    (found,) = check(launch("xacro"), build_export_depend="xacro")
    assert found.hint == "Add <exec_depend>xacro</exec_depend>."


def test_declared_by_packages_of_the_workspace() -> None:
    manifests = {
        one.name: one
        for one in (
            manifest("a", build_depend="b", test_depend="t"),
            manifest("b", exec_depend="c", build_depend="x"),
            manifest("c", depend="a rviz2"),
        )
    }
    assert declared_by(manifests, "a", {"build_depend"}, None) == {"b", "c", "a", "rviz2"}


def required(name: str, *, required: bool = True, in_tests: bool = False) -> RequiredPackage:
    return RequiredPackage(name=name, file=CMAKE, line=7, required=required, in_tests=in_tests)


def check_build(one: RequiredPackage, **dependencies: str) -> list[Diagnostic]:
    checked = manifest("my_robot", **dependencies)
    return [*check_required(checked, [one], manifests={"my_robot": checked}, distro=None)]


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        *(("rclcp", "rclcpp"), ("geometry_msg", "geometry_msgs"), ("tf2_rso", "tf2_ros")),
        ("ament_cmak", "ament_cmake"),
    ],
)
def test_a_misspelled_package_of_the_build(name: str, meant: str) -> None:
    (found,) = check_build(required(name), depend="rclcpp tf2_ros")
    assert (found.code, found.line, found.hint) == ("PKG088", 7, f"Did you mean `{meant}`?")
    assert found.severity is Severity.ERROR  # CMake stops there


def test_a_name_that_package_xml_misspells_alike() -> None:
    (found,) = check_build(required("geometry_msg"), depend="geometry_msg")
    assert (found.code, found.hint) == ("PKG088", "Did you mean `geometry_msgs`?")
    # It may be a package that is not here, and is only nearly the name of another one here.
    assert check_build(required("my_robt"), depend="my_robt") == []
    assert check_build(required("nav-msgs"), depend="nav-msgs") == []


@pytest.mark.parametrize("name", ["yaml-cpp", "Eigen3", "sophus", "urdfdom", "my_libs", "gz-sim8"])
def test_packages_that_are_none_of_ros(name: str) -> None:
    assert check_build(required(name), depend="rclcpp") == []


def test_an_undeclared_package_of_the_build() -> None:
    (found,) = check_build(required("sensor_msgs"))
    assert (found.code, found.file, found.line) == ("PKG087", CMAKE, 7)
    assert found.hint == "Add to package.xml: <depend>sensor_msgs</depend>"


@pytest.mark.parametrize(
    "one",
    [
        required("sensor_msgs", required=False),
        required("sensor_msgs", in_tests=True),
        required("ament_cmake_python"),
        required("Eigen3"),
        required("rcutils"),  # rclcpp brings it
        required("pluginlib"),
        required("octomap"),  # liboctomap-dev brings it, too
        required("nav_msgs"),  # rosdep installs it
        required("rosidl_default_generators"),  # PKG080
    ],
)
def test_what_the_build_may_require(one: RequiredPackage) -> None:
    dependencies = {"depend": "rclcpp", "build_depend": "pluginlib", "exec_depend": "nav_msgs"}
    assert check_build(one, **dependencies) == []


def check_of_tests(name: str, **dependencies: str) -> list[Diagnostic]:
    checked = manifest("my_robot", **dependencies)
    one = required(name, in_tests=True)
    return [*check_tests(checked, [one], manifests={"my_robot": checked}, distro=None)]


@pytest.mark.parametrize("name", ["ament_lint_auto", "ament_cmake_gtest", "ament_cmake_cpplint"])
def test_an_undeclared_package_of_tests(name: str) -> None:
    (found,) = check_of_tests(name, buildtool_depend="ament_cmake")
    assert (found.code, found.file, found.line) == ("PKG089", CMAKE, 7)
    assert found.hint == f"Add to package.xml: <test_depend>{name}</test_depend>"


@pytest.mark.parametrize(
    ("name", "declared"),
    [
        ("ament_lint_auto", "ament_lint_auto"),
        ("ament_lint_auto", "amnet_lint_auto"),  # misspelled, and reported
        ("ament_cmake_cpplint", "ament_lint_common"),
        ("ament_cmake_gtest", "ament_cmake_ros"),
        ("sensor_msgs", ""),  # not of tests alone: what is tested may bring it
        ("ament_cmake_test", ""),  # ament_cmake brings it
    ],
)
def test_what_tests_may_require(name: str, declared: str) -> None:
    assert check_of_tests(name, test_depend=declared) == []
    outside = manifest("my_robot")
    assert not [
        *check_tests(outside, [required(name)], manifests={"my_robot": outside}, distro=None)
    ]


ROBOT_FILE = Path("src/my_robot/urdf/robot.xacro")


@pytest.mark.parametrize(
    ("kind", "package", "started"),
    [
        (PLUGIN, "gazebo_ros2_control", "gazebo_ros"),
        (PLUGIN, "gz_ros2_control", "ros_gz_sim"),
        (PLUGIN, "gazebo_plugins", "gazebo_ros"),
        (CONTROLLER, "diff_drive_controller", "controller_manager"),
    ],
)
def test_plugins_and_controllers_of_what_is_started(kind: str, package: str, started: str) -> None:
    used = PackageUse(package, ROBOT_FILE, 9, kind)
    (found,) = check([*launch(started), used], depend=started.replace("ros_gz_sim", "ros_gz"))
    assert (found.code, found.file, found.line) == ("PKG085", ROBOT_FILE, 9)
    assert check([used]) == []  # another package starts it


@pytest.mark.parametrize(
    ("package", "declared"),
    [
        ("gazebo_ros2_control", "gz_ros2_control"),
        ("gazebo_plugins", "gazebo_ros_pkgs"),
        ("gazebo_plugins", "ros_gz_sim"),
    ],
)
def test_robots_with_plugins_for_several_simulators(package: str, declared: str) -> None:
    uses = [*launch("gazebo_ros"), PackageUse(package, ROBOT_FILE, 9, PLUGIN)]
    assert check(uses, exec_depend=f"gazebo_ros {declared}") == []


def test_all_controllers_come_together() -> None:
    used = PackageUse("diff_drive_controller", ROBOT_FILE, 9, CONTROLLER)
    assert (
        check([*launch("controller_manager"), used], exec_depend="ros2_controllers ros2_control")
        == []
    )


INSTALLED = InstalledFile(
    source=LAUNCH_FILE, destination="share/my_robot/launch/robot.launch.py", file=CMAKE, line=5
)


def test_what_may_be_unused() -> None:
    checked = manifest(
        "my_robot",
        depend="rclcpp std_msgs nav_msgs pluginlib",
        exec_depend="sensor_msgs rviz2",
        test_depend="geometry_msgs",
    )
    build = BuildFacts(
        build_file=CMAKE, installed=(INSTALLED,), required_packages=(required("rclcpp"),)
    )
    uses = [PackageUse("nav_msgs", NODE_FILE, 3, NODE)]
    assert may_be_unused(checked, build, uses) == {"std_msgs", "sensor_msgs"}
    assert may_be_unused(checked, BuildFacts(build_file=CMAKE), uses) == set()


def test_unused_dependencies_are_one_diagnostic() -> None:
    checked = manifest("my_robot", build_depend="std_msgs", exec_depend="std_msgs nav_msgs xacro")
    (found,) = unused_dependencies(checked, {"std_msgs", "nav_msgs"})
    assert (found.code, found.line, found.element) == ("PKG086", 10, "nav_msgs")
    assert "mentions nav_msgs, std_msgs, which" in found.message
    assert (found.hint or "").endswith(
        "<build_depend>std_msgs</build_depend> <exec_depend>std_msgs</exec_depend> "
        "<exec_depend>nav_msgs</exec_depend>"
    )
    assert [*unused_dependencies(checked, ())] == []


def test_a_plugin_of_a_description_that_another_package_spawns() -> None:
    used = PackageUse("gz_ros2_control", ROBOT_FILE, 9, PLUGIN)
    own = manifest("my_robot")

    def found(**declared: str) -> list[str]:
        bringup = manifest("bringup", **declared)
        manifests = {"my_robot": own, "bringup": bringup}
        return [one.code for one in check_uses(own, [used], manifests=manifests, distro="jazzy")]

    assert found(exec_depend="my_robot ros_gz_sim") == ["PKG085"]
    assert found(exec_depend="my_robot ros_gz_sim gz_ros2_control") == []
    assert found(exec_depend="my_robot rviz2") == []  # it is only shown
    assert found(exec_depend="ros_gz_sim") == []
