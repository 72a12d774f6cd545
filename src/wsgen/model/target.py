"""What a package is generated for: a ROS 2 distribution with a simulator.

Also how to install it: the packages of apt, where apt gets them, and the container. That is data as
in `wsgen.model.facts`, with its source beside it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from wsgen.errors import RequestError
from wsgen.model.facts import (
    DISTROS,
    OF_CLASSIC,
    OF_DISTROS,
    PLUGINS,
    PROGRAMS,
    RELEASED_FOR,
    ROS2_CONTROL_HARDWARE,
)
from wsgen.text.suggestions import did_you_mean, nearest
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Mapping


CLASSIC, SIM = "classic", "gz"  # the simulators
SIMULATORS = {CLASSIC: "Gazebo Classic", SIM: "Gazebo Sim"}
DISTROS_WITH_CLASSIC = RELEASED_FOR["gazebo_ros"]


class Plugin(NamedTuple):
    """A plugin of the simulator, as its tag names it."""

    filename: str
    name: str


@dataclass(frozen=True, kw_only=True)
class Target:
    """A distribution and a simulator, with what templates and checks need to know of them.

    Dates are of the form YYYY-MM-DD, or YYYY-MM where no day is announced.
    """

    distro: str  # one of DISTROS
    simulator: str  # a key of SIMULATORS

    @property
    def name(self) -> str:
        """As in the names of the golden folders, for example `iron-classic`."""
        return f"{self.distro}-{self.simulator}"

    @property
    def ros(self) -> str:
        """The distribution as people write it, for example `ROS 2 Iron`."""
        return f"ROS 2 {self.distro.capitalize()}"

    @property
    def gazebo(self) -> str:
        """The simulator as people write it, for example `Gazebo Harmonic`."""
        if self.simulator == "classic":
            return f"Gazebo Classic {OF_CLASSIC['version'][1]}"
        return f"Gazebo {self.fact('gz_name')}"

    @property
    def ubuntu(self) -> str:
        """Version of the Tier 1 platform."""
        return self.fact("ubuntu")

    @property
    def end_of_life(self) -> str | None:
        """When the distribution's updates end; None: never."""
        return _of_distro("end_of_life", self.distro)

    @property
    def has_ended(self) -> bool:
        """Whether the distribution had its last update by the date of these facts."""
        return self.fact("support") == "ended"

    @property
    def cmake_minimum(self) -> str:
        """That every generated CMakeLists asks for."""
        return self.fact("cmake_minimum")

    @property
    def sdf_version(self) -> str:
        """Newest SDFormat that the simulator reads."""
        if self.simulator == "classic":
            return OF_CLASSIC["sdf_version"][1]
        return self.fact("gz_sdf_version")

    @property
    def frame_tag(self) -> str:
        """Element of a sensor that says in which frame its messages are."""
        return "frame_name" if self.simulator == "classic" else self.fact("gz_frame_tag")

    @property
    def programs(self) -> Mapping[str, str]:
        """What starts the simulator and puts a robot into it, by role (`facts.PROGRAMS`)."""
        return {role: value for role, (_, value) in PROGRAMS[self.simulator].items()}

    @property
    def plugins(self) -> Mapping[str, Plugin]:
        """The plugins of the simulator by role (`facts.PLUGINS`)."""
        return {role: Plugin(*names) for role, (_, *names) in PLUGINS[self.simulator].items()}

    @property
    def ros2_control_hardware(self) -> str:
        """The hardware plugin of ros2_control that is the simulator."""
        return ROS2_CONTROL_HARDWARE[self.simulator][1]

    def fact(self, name: str) -> str:
        """A fact about the distribution that every one has (`facts.OF_DISTROS`)."""
        value = _of_distro(name, self.distro)
        if value is None:
            raise KeyError(name)
        return value


def _of_distro(fact: str, distro: str) -> str | None:
    return OF_DISTROS[fact][1 + DISTROS.index(distro)]


TARGETS = tuple(
    Target(distro=distro, simulator=simulator)
    for simulator in SIMULATORS
    for distro in (DISTROS_WITH_CLASSIC if simulator == "classic" else DISTROS)
)
# Distribution -> the simulator that is meant where none is named; for the others it is gz.
USUAL_SIMULATOR = {"iron": CLASSIC}
DEFAULT_TARGET = next(
    target for target in TARGETS if (target.distro, target.simulator) == ("iron", "classic")
)


def choose_target(
    distro: str, simulator: str | None = None, *, is_from_environment: bool = False
) -> Target:
    """The target of a distribution and a simulator, by default the distribution's usual one.

    `is_from_environment` says that the distribution is that of $ROS_DISTRO, and was not typed.

    Raises:
        RequestError: The target does not exist; the error names the nearest one.
    """
    wanted = simulator or USUAL_SIMULATOR.get(distro, "gz")
    for target in TARGETS:
        if (target.distro, target.simulator) == (distro, wanted):
            return target
    if distro in DISTROS:
        raise RequestError(
            f"Gazebo Classic is not released for ROS 2 {distro}, only for"
            f" {' and '.join(DISTROS_WITH_CLASSIC)}.",
            hint=f"Use --distro {distro} --sim gz; or, to stay with Gazebo Classic,"
            f" --distro {DISTROS_WITH_CLASSIC[0]}.",
        )
    raise _unknown_distro(distro, simulator, is_from_environment=is_from_environment)


def _unknown_distro(
    distro: str, simulator: str | None, *, is_from_environment: bool
) -> RequestError:
    possible = DISTROS_WITH_CLASSIC if simulator == "classic" else DISTROS
    lasting = [name for name in possible if _of_distro("support", name) == "long-term"]
    lower = distro.lower()
    near = lower if lower in possible else nearest(lower, possible)
    known = f"not a ROS 2 distribution that wsgen knows: {', '.join(DISTROS)}."
    option = f"--distro {near or lasting[-1]}" + (f" --sim {simulator}" if simulator else "")
    if is_from_environment:
        return RequestError(
            f"ROS_DISTRO={distro} in the environment is {known}",
            hint=f"Name the target, for example {option}; or run: unset ROS_DISTRO",
        )
    hint = f"Write for example {option}" if near is None else did_you_mean(option)
    return RequestError(f"{distro!r} is {known}", hint=hint)


def end_of_life_note(target: Target, today: str) -> str | None:
    """One sentence if the target has no updates any more on a day (YYYY-MM-DD), else None."""
    if _is_past(target.end_of_life, today):
        living = [name for name in DISTROS if not _is_past(_of_distro("end_of_life", name), today)]
        lasting = [name for name in living if _of_distro("support", name) == "long-term"] or living
        near = [name for name in lasting if _of_distro("ubuntu", name) == target.ubuntu][:1]
        instead = " or ".join(
            f"--distro {name} (until {_of_distro('end_of_life', name) or 'further notice'})"
            for name in dict.fromkeys((*near, lasting[-1]))
        )
        return f"{target.ros} has had no updates since {target.end_of_life}; use {instead}."
    if target.simulator == "classic" and _is_past(OF_CLASSIC["end_of_life"][1], today):
        return (
            f"Gazebo Classic has had no updates since {OF_CLASSIC['end_of_life'][1]}; use --sim gz"
            f" (Gazebo {target.fact('gz_name')}, until {target.fact('gz_end_of_life')})."
        )
    return None


def _is_past(date: str | None, today: str) -> bool:
    """A month is past when it is over."""
    return date is not None and today[: len(date)] > date


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
