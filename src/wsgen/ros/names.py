"""The names that ROS 2 knows: packages released for its distributions, and keys of rosdep."""

from __future__ import annotations

from functools import cache
from pathlib import Path

ROSDEP = "rosdep"
ROS_NAMES = Path(__file__).with_name("ros-names.txt")
CMAKE_NAMES = Path(__file__).with_name("cmake-names.txt")
PYPI_NAMES = Path(__file__).with_name("pypi-names.txt")


@cache
def released_packages() -> dict[str, tuple[str, ...]]:
    """The distributions that a package is released for, by its name; oldest first.

    Source: ros/rosdistro, which lists foxy, humble, iron, jazzy, kilted, lyrical and rolling.
    """
    return {
        name: tuple(heading.split())
        for heading, names in _blocks().items()
        if heading != ROSDEP
        for name in names
    }


def is_released(name: str) -> bool:
    """Whether ROS has a package of this name, in a tenth of the time that all names take."""
    packages, _, _ = ROS_NAMES.read_text(encoding="utf-8").partition(f"\n{ROSDEP}:\n")
    lines = packages.splitlines()
    return any(f" {name} " in f" {line} " for line in lines if line[:1] != "#" and line[-1:] != ":")


@cache
def rosdep_keys() -> frozenset[str]:
    """The system dependencies that package.xml may name. Source: ros/rosdistro."""
    return frozenset(_blocks()[ROSDEP])


@cache
def cmake_packages() -> frozenset[str]:
    """Other names that find_package() of a ROS package may ask for: Gazebo's, and libraries."""
    lines = CMAKE_NAMES.read_text(encoding="utf-8").splitlines()
    return frozenset(name for line in lines if not line.startswith("#") for name in line.split())


@cache
def pypi_names() -> dict[str, str]:
    """What `pip install` takes for Python modules whose packages have other names."""
    lines = PYPI_NAMES.read_text(encoding="utf-8").splitlines()
    return dict(line.split() for line in lines if not line.startswith("#"))


@cache
def _blocks() -> dict[str, list[str]]:
    """The names below each heading of the file."""
    text = ROS_NAMES.read_text(encoding="utf-8")
    blocks = (block.partition(":\n") for block in text.split("\n\n")[1:])
    return {heading: names.split() for heading, _, names in blocks}
