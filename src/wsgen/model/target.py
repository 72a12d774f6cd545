"""What a package is generated for: a ROS 2 distribution with a simulator.

The facts are data in one table, each with its source. Only combinations whose templates exist are
in it.
"""

from __future__ import annotations

from dataclasses import dataclass

from wsgen.errors import RequestError

SIMULATORS = {"classic": "Gazebo Classic", "gz": "Gazebo Sim"}

# Distributions that are still released or that people still run (REP-2000), oldest first, and
# those of them for which Gazebo Classic was released (rosdistro's gazebo_ros_pkgs).
DISTROS = ("humble", "iron", "jazzy", "kilted", "lyrical", "rolling")
DISTROS_WITH_CLASSIC = ("humble", "iron")


@dataclass(frozen=True, kw_only=True)
class Target:
    """A distribution and a simulator, with what templates and checks need to know of them."""

    distro: str  # ROS 2 distribution, lower case
    simulator: str  # a key of SIMULATORS
    ubuntu: str  # version of the Tier 1 platform
    end_of_life: str | None  # ISO date; None: still supported
    cmake_minimum: str  # that every generated CMakeLists asks for
    sdf_version: str  # newest SDFormat that the simulator reads

    @property
    def name(self) -> str:
        """As in the names of the golden folders, for example `iron-classic`."""
        return f"{self.distro}-{self.simulator}"


# REP-2000, endoflife.date (ROS 2), and sdformat's CMakeLists for the SDFormat version.
TARGETS = (
    Target(
        distro="iron",
        simulator="classic",
        ubuntu="22.04",
        end_of_life="2024-12-04",
        # 3.22 is what Ubuntu 22.04 has; CMake 4 warns about minimums below 3.10.
        cmake_minimum="3.20",
        sdf_version="1.7",
    ),
)

DEFAULT_TARGET = TARGETS[0]


def choose_target(distro: str, simulator: str | None = None) -> Target:
    """The target of a distribution and a simulator, by default the distribution's usual one.

    Raises:
        RequestError: there is no such target; says why, and which one is nearest.
    """
    if simulator is None:
        simulator = "classic" if distro == "iron" else "gz"
    for target in TARGETS:
        if (target.distro, target.simulator) == (distro, simulator):
            return target
    nearest = next((t for t in TARGETS if t.distro == distro), DEFAULT_TARGET)
    raise RequestError(
        _why_not(distro, simulator),
        hint=f"Take --distro {nearest.distro} --sim {nearest.simulator}.",
    )


def _why_not(distro: str, simulator: str) -> str:
    if distro not in DISTROS:
        return f"{distro!r} is no ROS 2 distribution that wsgen knows: {', '.join(DISTROS)}."
    if simulator == "classic" and distro not in DISTROS_WITH_CLASSIC:
        return f"Gazebo Classic is not released for ROS 2 {distro}."
    return f"No template is made for ROS 2 {distro} with {SIMULATORS[simulator]} yet."
