"""The distribution that a package is for."""

from __future__ import annotations

import pytest

from wsgen.checks.rules.manifests import Target, target_of
from wsgen.packages.workspace.manifest import Dependency, Manifest


def manifest(*names: str, condition: str | None = None) -> Manifest:
    return Manifest(
        name="demo",
        build_type="ament_cmake",
        dependencies=tuple(
            Dependency(tag="exec_depend", name=name, line=9, condition=condition) for name in names
        ),
    )


@pytest.mark.parametrize(
    ("given", "recorded", "sourced", "expected"),
    [
        ("jazzy", "humble", "iron", ("jazzy", "--distro")),
        (None, "humble", "iron", ("humble", "wsgen.toml")),
        (None, None, "iron", ("iron", "ROS_DISTRO")),
        (None, None, "", (None, "package.xml")),
    ],
)
def test_what_tells_it(
    given: str | None,
    recorded: str | None,
    sourced: str | None,
    expected: tuple[str | None, str],
) -> None:
    target = target_of(manifest("gazebo_ros"), given=given, recorded=recorded, sourced=sourced)
    assert (target.distro, target.source) == expected


def test_what_the_dependencies_leave() -> None:
    assert target_of(manifest("gazebo_ros", "xacro")) == Target(
        distros=("foxy", "humble", "iron"), source="package.xml"
    )
    assert target_of(manifest("gazebo_ros", "ros_gz_sim")).distros == ("humble", "iron")
    assert target_of(manifest("xacro")).source == ""
    assert target_of(manifest("xacro")).distros[-1] == "rolling"
    assert target_of(None).source == ""
    assert target_of(manifest("gazebo_ros"), workspace={"gazebo_ros"}).source == ""
    assert target_of(manifest("gazebo_ros", condition="$A == 1")).source == ""


def test_dependencies_that_no_distribution_has_tell_nothing() -> None:
    assert target_of(manifest("gazebo_ros", "gz_sim_vendor")).source == ""
