"""The dependencies of a package.xml, with facts alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from wsgen.checks.rules.dependencies import check_circles, check_dependencies, common_distros
from wsgen.diagnostics import Severity
from wsgen.packages.workspace.manifest import Dependency, Manifest

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic

FILE = Path("package.xml")
WORKSPACE = frozenset({"my_robot", "my_robot_description", "arm_msgs"})


def manifest(*dependencies: tuple[str, str] | tuple[str, str, str]) -> Manifest:
    """A manifest with dependencies: tag, name and condition; the first one is in line 10."""
    return Manifest(
        name="my_robot",
        build_type="ament_cmake",
        file=FILE,
        dependencies=tuple(
            Dependency(tag=tag, name=name, line=line, condition=rest[0] if rest else None)
            for line, (tag, name, *rest) in enumerate(dependencies, start=10)
        ),
    )


def check(
    *dependencies: tuple[str, str] | tuple[str, str, str], distro: str | None = None
) -> list[Diagnostic]:
    return [*check_dependencies(manifest(*dependencies), workspace=WORKSPACE, distro=distro)]


@pytest.mark.parametrize(
    ("tag", "name", "code", "hint"),
    [
        ("exec_depend", "robot_state_publiser", "PKG068", "robot_state_publisher</exec_depend>."),
        ("exec_depend", "xarco", "PKG068", "Write <exec_depend>xacro</exec_depend>."),
        ("exec_depend", "ros-gz-sim", "PKG068", "Write <exec_depend>ros_gz_sim</exec_depend>."),
        ("depend", "my_robot_desciption", "PKG068", "Write <depend>my_robot_description</depend>."),
        ("depend", "behaviortree_ros2", "PKG069", "Clone behaviortree_ros2 into the workspace"),
        ("depend", "smart_can_msgs", "PKG069", "Clone smart_can_msgs"),
        ("exec_depend", "python3-stockfish", "PKG069", "Remove <exec_depend>python3-stockfish"),
        ("depend", "roscpp", "PKG071", "Write <depend>rclcpp</depend>."),
        ("depend", "nodelet", "PKG071", "Write <depend>rclcpp_components</depend>."),
        ("depend", "dynamic_reconfigure", "PKG071", "Remove <depend>dynamic_reconfigure</depend>"),
        ("exec_depend", "numpy", "PKG072", "Write <exec_depend>python3-numpy</exec_depend>."),
        ("depend", "rclpy_action", "PKG072", "Write <depend>rclpy</depend>."),
        ("exec_depend", "cv2", "PKG072", "Write <exec_depend>python3-opencv</exec_depend>."),
        ("exec_depend", "python-numpy", "PKG072", "Write <exec_depend>python3-numpy<"),
        ("buildtool_depend", "ament_python", "PKG073", "Remove <buildtool_depend>ament_python<"),
    ],
)
def test_names_that_nobody_knows(tag: str, name: str, code: str, hint: str) -> None:
    (found,) = check(("depend", "rclcpp"), (tag, name))
    assert (found.code, found.file, found.line, found.element) == (code, FILE, 11, name)
    assert hint in (found.hint or "")


@pytest.mark.parametrize(
    "name",
    [
        *("xacro", "ros_gz_sim", "gazebo_ros", "arm_msgs", "my_robot_description"),
        *("python3-numpy", "eigen", "gz-sim8", "ament_cmake_python", "gazebo"),
        *("python-transforms3d-pip", "joint_state_controller"),
    ],
)
@pytest.mark.parametrize("tag", ["depend", "exec_depend", "test_depend"])
def test_known_names(tag: str, name: str) -> None:
    assert check((tag, name)) == []


def test_a_condition_that_ros_2_does_not_meet() -> None:
    assert check(("depend", "roscpp", "$ROS_VERSION == 1")) == []
    (found,) = check(("depend", "roscpp", "$ROS_VERSION == 2"))
    assert found.code == "PKG071"


def test_an_unknown_name_is_reported_once() -> None:
    (found,) = check(("build_depend", "roscpp"), ("exec_depend", "roscpp"))
    assert found.line == 10


@pytest.mark.parametrize(
    ("name", "distro", "hint"),
    [
        ("gazebo_ros", "jazzy", "Write <exec_depend>ros_gz_sim</exec_depend>"),
        ("gazebo_ros2_control", "kilted", "Write <exec_depend>gz_ros2_control</exec_depend>"),
        ("gz_sim_vendor", "humble", "Clone gz_sim_vendor"),
    ],
)
def test_the_distribution_lacks_it(name: str, distro: str, hint: str) -> None:
    (found,) = check(("exec_depend", name), distro=distro)
    assert (found.code, found.line, found.element) == ("PKG070", 10, name)
    assert found.severity is (Severity.WARNING if name == "gz_sim_vendor" else Severity.ERROR)
    assert f"not released for ROS 2 {distro}" in found.message
    assert hint in (found.hint or "")


@pytest.mark.parametrize(
    ("name", "distro"),
    [("gazebo_ros", "humble"), ("gazebo_ros", None), ("gazebo_ros", "future"), ("xacro", "jazzy")],
)
def test_the_distribution_has_it_or_is_unknown(name: str, distro: str | None) -> None:
    assert check(("exec_depend", name), distro=distro) == []


def test_no_distribution_has_both() -> None:
    (found,) = check(
        ("exec_depend", "xacro"), ("exec_depend", "gazebo_ros"), ("exec_depend", "gz_sim_vendor")
    )
    assert (found.code, found.line) == ("PKG074", 12)
    assert "both `gazebo_ros` (foxy, humble, iron) and `gz_sim_vendor` (jazzy," in found.message
    assert found.hint == "Write <exec_depend>ros_gz_sim</exec_depend> for gazebo_ros."


def test_conditions_resolve_a_conflict() -> None:
    assert (
        check(
            ("exec_depend", "gazebo_ros", "$ROS_DISTRO == humble"),
            ("exec_depend", "gz_sim_vendor", "$ROS_DISTRO != humble"),
        )
        == []
    )


def test_old_packages_may_be_cloned() -> None:
    assert check(("depend", "moveit_py"), ("depend", "dsr_msgs2")) == []


def test_common_distros() -> None:
    assert common_distros(["xacro", "gazebo_ros", "unknown", "eigen"]) == (
        "foxy",
        "humble",
        "iron",
    )
    assert common_distros(["gazebo_ros", "gz_sim_vendor"]) == ()


def test_duplicates() -> None:
    (found,) = check(("exec_depend", "xacro"), ("exec_depend", "rviz2"), ("exec_depend", "xacro"))
    assert (found.code, found.line, found.element) == ("PKG075", 12, "xacro")
    assert found.message == "<exec_depend>xacro</exec_depend> is also in line 10."


def test_other_tags_and_conditions_are_no_duplicates() -> None:
    assert check(("build_depend", "rclcpp"), ("exec_depend", "rclcpp")) == []
    assert (
        check(
            ("depend", "rclcpp", "$ROS_DISTRO == humble"),
            ("depend", "rclcpp", "$ROS_DISTRO == jazzy"),
        )
        == []
    )


def needing(name: str, *dependencies: tuple[str, str]) -> Manifest:
    return replace(manifest(*dependencies), name=name)


@pytest.mark.parametrize(
    ("manifests", "circle"),
    [
        ((needing("a", ("depend", "b")), needing("b", ("exec_depend", "rclcpp"))), None),
        ((needing("a", ("depend", "b")), needing("b", ("doc_depend", "a"))), None),
        ((needing("a", ("depend", "a")),), None),  # which is no package.xml
        ((needing("a", ("depend", "b")), needing("b", ("test_depend", "a"))), "a → b → a"),
        (
            (
                needing("c", ("depend", "a")),
                needing("a", ("exec_depend", "d"), ("exec_depend", "b")),
                needing("b", ("build_depend", "c")),
                needing("d"),
            ),
            "a → b → c → a",
        ),
        # One that only leads into a circle is in none.
        (
            (
                needing("a", ("depend", "b")),
                needing("b", ("depend", "c")),
                needing("c", ("depend", "b")),
            ),
            "b → c → b",
        ),
    ],
)
def test_circles_of_packages(manifests: tuple[Manifest, ...], circle: str | None) -> None:
    by_name = {one.name: one for one in manifests}
    found = [one for each in manifests for one in check_circles(each, by_name)]
    assert [one.code for one in found] == (["PKG090"] if circle else [])
    assert all(f": {circle}." in one.message for one in found)
