"""How to install a target: the packages of apt, where apt gets them, and the container.

Data as in `wsgen.model.facts`, with its source beside it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsgen.model.target import Target


# Steps 1 and 2 of the tutorial install these, and step 5 starts robot_state_publisher. In all
# distributions (ros/rosdistro, DISTRO/distribution.yaml).
ROS_PACKAGES = (
    "ros_core",
    "geometry2",
    "joint_state_publisher",
    "joint_state_publisher_gui",
    "robot_state_publisher",
    "xacro",
)
# Simulator -> the package that brings it with all of its ROS side: from ros-gz, or with what it
# depends on, Gazebo itself comes, too (gazebosim/docs, common/ros_installation.md).
SIMULATOR_PACKAGES = {"classic": "gazebo_ros_pkgs", "gz": "ros_gz"}
# Packages that hold packages and install nothing of their own.
VARIANTS = ("ros_core", "geometry2", "gazebo_ros_pkgs", "ros_gz")
# The `colcon build` of step 3; every image of ROS has it (osrf/docker_images, ros-base).
COLCON = "python3-colcon-common-extensions"

# From https://github.com/ros-infrastructure/ros-apt-source, as osrf/docker_images uses it; there is
# one for each Ubuntu from jammy to resolute.
APT_SOURCE_VERSION = "1.2.0"
APT_SOURCE = (
    "curl -fLo /tmp/ros2-apt-source.deb https://github.com/ros-infrastructure/ros-apt-source/"
    "releases/download/{version}/ros2-apt-source_{version}.{codename}_all.deb"
    " && sudo apt install /tmp/ros2-apt-source.deb && sudo apt update"
)
# What has ended is kept there, under a key of its own (osrf/docker_images#794).
SNAPSHOT_KEY = "4B63CF8FDE49746E98FA01DDAD19BAB3CBF125EA"
SNAPSHOT_KEYRING = "/usr/share/keyrings/ros2-snapshots-archive-keyring.gpg"
SNAPSHOT_SOURCE = (
    "gpg --keyserver keyserver.ubuntu.com --recv-keys {key}"
    " && gpg --export {key} | sudo tee {keyring} > /dev/null"
    ' && echo "deb [signed-by={keyring}] http://snapshots.ros.org/{distro}/final/ubuntu {codename}'
    ' main" | sudo tee /etc/apt/sources.list.d/ros2-snapshots.list && sudo apt update'
)
APT_HOSTS = ("packages.ros.org", "snapshots.ros.org")

# docker-library/official-images, library/ros; that of Iron is its last one, of 2025-03
# (docker-library/official-images#18594, #19048).
IMAGE = "ros:{distro}-ros-base"


def debian_name(package: str, distro: str) -> str:
    """The Debian package of a ROS package (ros-infrastructure/rosdep, gbpdistro_support.py)."""
    return f"ros-{distro}-{package.replace('_', '-')}"


def ros_packages(target: Target) -> tuple[str, ...]:
    """The ROS packages that the tutorial needs for a target."""
    return (*ROS_PACKAGES, SIMULATOR_PACKAGES[target.simulator])


def apt_install(target: Target) -> str:
    """The one command for what steps 1 and 2 of the tutorial install, but for its editor."""
    names = [debian_name(package, target.distro) for package in ros_packages(target)]
    return f"sudo apt install {' '.join((*names, COLCON))}"


def in_container(install: str) -> str:
    """The same command in a container of `image`: its user is root, its list of packages empty."""
    return f"apt update && {install.removeprefix('sudo ')}"


def apt_source(target: Target) -> str:
    """The command that gives apt the address of the target's packages."""
    codename = target.fact("ubuntu_codename")
    if target.has_ended:
        return SNAPSHOT_SOURCE.format(
            key=SNAPSHOT_KEY, keyring=SNAPSHOT_KEYRING, distro=target.distro, codename=codename
        )
    return APT_SOURCE.format(version=APT_SOURCE_VERSION, codename=codename)


def image(target: Target) -> str:
    """The image of a container with the target's ROS."""
    return IMAGE.format(distro=target.distro)
