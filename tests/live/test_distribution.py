"""ROS_DISTRO of nodes."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.live.needed_ros import distro_of_nodes, with_distro
from wsgen.packages.workspace.manifest import Dependency, Manifest
from wsgen.ros.environment import RosEnvironment


def _manifest(*dependencies: str) -> Manifest:
    named = tuple(Dependency(name=name, tag="depend", line=9) for name in dependencies)
    return Manifest(name="my_robot", build_type="ament_cmake", dependencies=named)


@pytest.mark.parametrize(
    ("dependencies", "simulator", "distro"),
    [
        (["gazebo_ros"], "classic", "humble"),  # of humble and iron the one with long-term support
        (["ros_gz_sim"], "gz", "kilted"),  # what runs
        (["xacro"], "classic", "humble"),  # the package does not say it, its simulator does
        (["xacro"], None, "kilted"),
        (["ros_ign_gazebo"], "gz", "humble"),
    ],
)
def test_the_package_and_its_simulator_tell(
    dependencies: list[str], simulator: str | None, distro: str
) -> None:
    manifest = _manifest(*dependencies)
    assert distro_of_nodes(manifest, simulator=simulator, installed="kilted") == distro


def test_what_the_user_says_goes_before() -> None:
    manifest = _manifest("gazebo_ros")
    found = distro_of_nodes(manifest, simulator="classic", installed="kilted", recorded="iron")
    assert found == "iron"
    found = distro_of_nodes(
        manifest, simulator="classic", installed="kilted", recorded="iron", set_by_user="jazzy"
    )
    assert found == "jazzy"


def test_without_a_package_the_simulator_tells() -> None:
    assert distro_of_nodes(None, simulator="classic", installed="kilted") == "humble"
    assert distro_of_nodes(None, simulator="gz", installed="kilted") == "kilted"


def test_a_sourced_ros_keeps_its_own() -> None:
    def ros(*, is_sourced: bool) -> RosEnvironment:
        variables = {"ROS_DISTRO": "kilted", "ROS_VERSION": "2"}
        return RosEnvironment(
            distro="kilted", is_sourced=is_sourced, python=Path("/python"), variables=variables
        )

    assert with_distro(ros(is_sourced=True), "humble").variables["ROS_DISTRO"] == "kilted"
    reported = with_distro(ros(is_sourced=False), "humble")
    assert reported.variables == {"ROS_DISTRO": "humble", "ROS_VERSION": "2"}
    assert reported.distro == "kilted"
