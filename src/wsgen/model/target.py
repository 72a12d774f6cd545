"""What a package is generated for: a ROS 2 distribution with a simulator.

The facts are data in one table, each with its source. Only combinations whose templates exist are
in it.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Target:
    """A distribution and a simulator, with what templates and checks need to know of them."""

    distro: str  # ROS 2 distribution, lower case
    simulator: str  # "classic" or "gz"
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
