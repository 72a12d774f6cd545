"""Shims of ROS packages: packages that launch files name and that need not be installed.

Their share folders can be looked up and joined, and their launch files be included: these declare
the same arguments with the same defaults as the real ones, because the defaults leak into the
caller. Defaults are those of gazebo_ros 3.7.0 (iron) and ros_gz_sim 0.254.2; what another
distribution does differently is named.
"""

from __future__ import annotations

import os
import posixpath
from functools import cache
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, NamedTuple

from wsgen.ros.names import released_packages
from wsgen.text.suggestions import nearest
from wsgen.text.tables import read_table
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


SURELY = 0.8  # so alike two words are, as difflib counts, that one is the other misspelled

_FLAGS_OF_BOTH = {"version": "false", "verbose": "false", "help": "false", "extra_gazebo_args": ""}

_GZSERVER = {
    "world": "",
    **_FLAGS_OF_BOTH,
    "lockstep": "false",
    "pause": "false",
    "physics": "",
    "play": "",
    "record": "false",
    "record_encoding": "",
    "record_path": "",
    "record_period": "",
    "record_filter": "",
    "seed": "",
    "iters": "",
    "minimal_comms": "false",
    "profile": "",
    "params_file": "",
    "gdb": "false",
    "valgrind": "false",
    "init": "true",
    "factory": "true",
    "force_system": "true",
    "server_required": "false",
}
_GZCLIENT = {**_FLAGS_OF_BOTH, "gdb": "false", "valgrind": "false", "gui_required": "false"}

_GZ_SPAWN_MODEL = {
    "world": "",
    "file": "",
    "model_string": "",
    "topic": "",
    "entity_name": "",
    "allow_renaming": "False",
    **dict.fromkeys(("x", "y", "z", "R", "P", "Y"), "0.0"),
}

_CONTAINER = {
    "container_name": "ros_gz_container",
    "create_own_container": "False",
    "use_composition": "False",
}
_BRIDGE: dict[str, str | None] = {
    "bridge_name": None,
    "config_file": None,
    **_CONTAINER,
    "namespace": "",
    "use_respawn": "False",
    "log_level": "info",
}

# Package -> launch file -> argument -> default, None where it must be given.
_LAUNCH_FILES: dict[str, dict[str, Mapping[str, str | None]]] = {
    "gazebo_ros": {
        "gazebo.launch.py": {"gui": "true", "server": "true", **_GZSERVER, **_GZCLIENT},
        "gzserver.launch.py": _GZSERVER,
        "gzclient.launch.py": _GZCLIENT,
    },
    "ros_gz_sim": {
        "gz_sim.launch.py": {
            "gz_args": "",
            "gz_version": "6",
            "ign_args": "",
            "ign_version": "",
            "debugger": "false",
            "on_exit_shutdown": "false",
            "debug_env": "false",
        },
        "gz_server.launch.py": {"world_sdf_file": "", "world_sdf_string": "", **_CONTAINER},
        "gz_spawn_model.launch.py": _GZ_SPAWN_MODEL,
        "ros_gz_sim.launch.py": {"world_sdf_file": "", "world_sdf_string": "", **_BRIDGE},
        "ros_gz_spawn_model.launch.py": {**_GZ_SPAWN_MODEL, **_BRIDGE},
    },
    "ros_gz_bridge": {"ros_gz_bridge.launch.py": _BRIDGE},
    "ros_ign_gazebo": {"ign_gazebo.launch.py": {"ign_args": "", "ign_version": "6"}},
}

# Programs of packages that need not be installed; launch files of those that have none above are
# recorded with the arguments they are given.
_EXECUTABLES = read_table(__file__, "known-packages.txt")
_OTHERS = _EXECUTABLES.keys() - _LAUNCH_FILES.keys()

# Other packages that were looked up and are not installed.
_declared: set[str] = set()

# What `gz_sim.launch.py` runs by default: the Gazebo of the distribution.
_GZ_VERSIONS = {"humble": "6", "iron": "6", "jazzy": "8", "kilted": "9"}

_PROGRAMS = frozenset(
    ("gazebo", "gz", "gzclient", "gzserver", "ign", "ros2", "ruby", "rviz2", "xacro", "xterm")
)

# Programs that run until they are stopped; all others are assumed to do their work and exit.
_RUN_FOR_EVER = frozenset(
    (
        "async_slam_toolbox_node",
        "component_container",
        "component_container_isolated",
        "component_container_mt",
        "ekf_node",
        "gazebo",
        "gz",
        "gzclient",
        "gzserver",
        "ign",
        "image_bridge",
        "joint_state_publisher",
        "joint_state_publisher_gui",
        "parameter_bridge",
        "robot_state_publisher",
        "ros2_control_node",
        "rviz2",
        "static_transform_publisher",
        "sync_slam_toolbox_node",
        "teleop_twist_keyboard",
        "twist_mux",
    )
)


class LaunchFileShim:
    """A launch file of a package that is not installed."""

    __slots__ = ("name", "package")

    def __init__(self, package: str, name: str) -> None:
        self.package = package
        self.name = name

    @property
    def names(self) -> tuple[str, ...]:
        """The launch files that the package is known to have."""
        return tuple(_LAUNCH_FILES.get(self.package, ()))

    @property
    def has_known_arguments(self) -> bool:
        """Whether it is known which arguments it takes."""
        return self.package in _LAUNCH_FILES

    def arguments(self, distro: str) -> Mapping[str, str | None]:
        """Its arguments and their defaults; FileNotFoundError if the package has no such file."""
        files = _LAUNCH_FILES.get(self.package, {})
        if files and self.name not in files:
            error = FileNotFoundError(
                f"{self.package} has no launch file '{self.name}'; it has {', '.join(files)}"
            )
            error.wsgen_shim = self  # type: ignore[attr-defined]  # for who explains it
            raise error
        arguments = dict(files.get(self.name, {}))
        if "gz_version" in arguments:
            arguments["gz_version"] = _GZ_VERSIONS.get(distro, "10")
        if distro == "humble" and "world" in arguments and self.package == "gazebo_ros":
            arguments["world"] = os.path.join(_share("gazebo_ros"), "worlds", "empty.world")
        return arguments


ALL_PREFIXES = "/opt/ros"  # where ROS is installed, a folder for each distribution
PREFIXES = "WSGEN_ROS_PREFIXES"  # in the environment: that folder, if it is elsewhere


def prefix() -> str:
    """The prefix of packages that are not installed: where ROS would have installed them."""
    return f"{_all_prefixes()}/{os.environ.get('ROS_DISTRO', 'iron')}"


def _all_prefixes() -> str:
    return os.environ.get(PREFIXES, ALL_PREFIXES)


def is_known(package: str) -> bool:
    """Whether a package need not be installed."""
    return (
        package in _LAUNCH_FILES
        or package in _OTHERS
        or package in _declared
        or package.startswith("nav2_")
    )


def is_released(package: str) -> bool:
    """Whether a distribution of ROS 2 has the package."""
    return package in _released()


@cache
def _released() -> frozenset[str]:
    return frozenset(released_packages())


def names() -> set[str]:
    """The packages that need not be installed."""
    return {*_LAUNCH_FILES, *_OTHERS, *_declared}


def programs_of(package: str) -> tuple[str, ...]:
    """The programs of a package that need not be installed; none where they are not known."""
    return _EXECUTABLES.get(package, ())


def has_misspelled(package: str, program: str) -> bool:
    """Whether a program is surely none of a package, but nearly so called.

    Other names may be those of programs that another release has.
    """
    known = programs_of(package)
    if not known or program in known or program.removesuffix(".py") in known:
        return False
    return nearest(program, known, cutoff=SURELY) is not None


def forget_declared() -> None:
    """Forget what was declared, for another launch file."""
    _declared.clear()


def declare(package: str) -> None:
    """From here on the package is one of those that need not be installed."""
    _declared.add(package)


_DRIVE = lazy_pattern("[A-Za-z]:")


def shim_of(file: str) -> LaunchFileShim | None:
    """The launch file of a known package that a path means, unless it is installed."""
    package = package_of(file)
    if package is None or not is_in_shim(file) or os.path.exists(file):
        return None
    return LaunchFileShim(package, os.path.basename(as_on_linux(file)))


def package_of(file: str) -> str | None:
    """The package whose share folder a path lies in."""
    _, found, rest = as_on_linux(file).rpartition("/share/")
    return rest.split("/", 1)[0] if found and "/" in rest else None


def absent_package_of(file: str) -> str | None:
    """The package of a path in ROS that is not on this machine; None where that is not so."""
    package, path = package_of(file), as_on_linux(file)
    if package is None or not path.startswith(f"{_all_prefixes()}/"):
        return None
    share = path[: path.rindex("/share/")] + f"/share/{package}"
    return None if os.path.isdir(share) else package


def is_in_shim(file: str) -> bool:
    """Whether a path leads into the share folder of a package that is not installed.

    Where no ROS is, a path that somebody wrote out, as /opt/ros/humble/share/gazebo_ros/..., means
    that of any distribution.
    """
    package = package_of(file)
    if package is None or not is_known(package):
        return False
    path, everywhere = as_on_linux(file), f"{_all_prefixes()}/"
    if path.startswith(_share(package)):
        return True
    inside = path.removeprefix(everywhere).partition("/")[2] if path.startswith(everywhere) else ""
    return inside.startswith(f"share/{package}/") and not os.path.isdir(prefix())


def as_on_linux(path: str) -> str:
    """A path of any system, without a drive and with slashes."""
    return _DRIVE.sub("", path).replace("\\", "/")


def program_path(name: str) -> str | None:
    """Where a program of ROS or Gazebo would be."""
    return f"{prefix()}/bin/{name}" if name in _PROGRAMS else None


def runs_for_ever(program: str) -> bool:
    """Whether a program does not exit by itself."""
    return program in _RUN_FOR_EVER


def _share(package: str) -> str:
    return f"{prefix()}/share/{package}/"


# Modules of ROS that launch files import; the names are those of their packages.
KNOWN_MODULES = frozenset(
    (
        "ament_package",
        "composition_interfaces",
        "controller_manager",
        "launch_pytest",
        "launch_testing",
        "launch_testing_ament_cmake",
        "launch_testing_ros",
        "moveit_configs_utils",
        "nav2_simple_commander",
        "osrf_pycommon",
        "rcl_interfaces",
        "rclpy",
        "ros2launch",
        "ros2pkg",
        "ros2run",
        "rosidl_runtime_py",
        "rospkg",
        "tf2_ros",
        "tf_transformations",
    )
)


class PlaceInPackage(NamedTuple):
    """Where a package has a file."""

    package: str
    inside: str  # its path below the share folder, with slashes


def find_in_package(
    path: str, share_of: Callable[[str], Path | None] | None = None
) -> PlaceInPackage | None:
    """The place in a package that is meant by a path like `~/other_ws/src/PACKAGE/config/a.yaml`.

    Args:
        path: A path, of any system, where nothing is.
        share_of: Gives the share folder of a package, if there is one; without it the packages are
            those of AMENT_PREFIX_PATH.
    """
    parts = PurePosixPath(posixpath.normpath(as_on_linux(path))).parts
    for index in range(len(parts) - 2, 0, -1):  # inner folders first: `install/P/share/P/...`
        package, inside = parts[index], "/".join(parts[index + 1 :])
        share = (share_of or _share_on_path)(package)
        if package != ".." and share is not None and os.path.isfile(share / inside):
            return PlaceInPackage(package, inside)
    return None


def _share_on_path(package: str) -> Path | None:
    from ament_index_python.packages import get_packages_with_prefixes

    prefix = get_packages_with_prefixes().get(package)
    return None if prefix is None else Path(prefix, "share", package)


def in_python(place: PlaceInPackage) -> str:
    """The expression of a launch file in Python for that place."""
    return f"os.path.join(get_package_share_directory('{place.package}'), '{place.inside}')"
