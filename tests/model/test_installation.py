import pytest

from wsgen.model.target import TARGETS, Target, apt_install, apt_source, debian_name, image

# Step 2 of the tutorial, typed as there, without the editor.
TUTORIAL = (
    "ros-iron-joint-state-publisher",
    "ros-iron-joint-state-publisher-gui",
    "ros-iron-xacro",
    "ros-iron-gazebo-ros-pkgs",
    "ros-iron-ros-core",
    "ros-iron-geometry2",
)


def test_everything_that_the_tutorial_installs() -> None:
    words = apt_install(Target(distro="iron", simulator="classic")).split()
    assert words[:3] == ["sudo", "apt", "install"]
    assert set(TUTORIAL) <= set(words)
    assert set(words[3:]) - set(TUTORIAL) == {
        "ros-iron-robot-state-publisher",
        "python3-colcon-common-extensions",
    }


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_every_target_has_its_simulator(target: Target) -> None:
    line = apt_install(target)
    classic, gz = (debian_name(name, target.distro) for name in ("gazebo_ros_pkgs", "ros_gz"))
    assert (classic in line) == (target.simulator == "classic")
    assert (gz in line) == (target.simulator == "gz")
    assert "rosdep" not in line
    assert "_" not in line
    assert "\n" not in line


def test_what_has_ended_is_in_the_snapshots() -> None:
    iron = apt_source(Target(distro="iron", simulator="classic"))
    assert "http://snapshots.ros.org/iron/final/ubuntu jammy main" in iron
    jazzy = apt_source(Target(distro="jazzy", simulator="gz"))
    assert "ros2-apt-source_1.2.0.noble_all.deb" in jazzy
    assert "{" not in iron + jazzy


def test_image() -> None:
    assert image(Target(distro="lyrical", simulator="gz")) == "ros:lyrical-ros-base"
