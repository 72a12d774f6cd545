"""Python modules of packages that are not here: imported all the same, and unknown.

What a launch file takes from them is unknown, see `launch._unknown`. A module that nobody knows
and no package.xml declares stays the ImportError that it is.
"""

from __future__ import annotations

import sys
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import TYPE_CHECKING, Any

from wsgen.launch.record import RECORD, caller

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from wsgen.launch.record import Location


# Modules of ROS that launch files import; the names are those of their packages.
KNOWN = frozenset(
    (
        "ament_package",
        "composition_interfaces",
        "controller_manager",
        "launch_param_builder",
        "launch_pytest",
        "launch_testing",
        "launch_testing_ament_cmake",
        "launch_testing_ros",
        "moveit_configs_utils",
        "nav2_common",
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
MESSAGES = ("_msgs", "_interfaces", "_srvs")


def _is_of_library(location: Location | None) -> bool:
    """Whether a library looks for something that it can do without."""
    return location is None or location[0].startswith((sys.prefix, sys.base_prefix))


class AbsentModule(ModuleType):
    """Every name in it is unknown."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        from launch._unknown import Unknown

        return Unknown(f"{self.__name__}.{name}")


class AbsentModules:
    """The last finder: it is asked for what no other one has found."""

    def __init__(self, is_declared: Callable[[str], bool]) -> None:
        self._is_declared = is_declared

    def find_spec(
        self, name: str, _path: Sequence[str] | None = None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find modules of absent packages, and what may be in them."""
        package, _, inside = name.partition(".")
        if inside and not isinstance(sys.modules.get(package), AbsentModule):
            return None  # the package is here, and has no such module
        location = caller()
        if not inside and (_is_of_library(location) or not self._is_expected(package)):
            return None
        if not inside:
            RECORD.note_unresolved(package, "its Python module is not here", location)
            RECORD.argument_use.is_unknown = True
        return ModuleSpec(name, self, is_package=True)  # type: ignore[arg-type]  # all it needs

    def _is_expected(self, package: str) -> bool:
        return package in KNOWN or package.endswith(MESSAGES) or self._is_declared(package)

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Make an empty module."""
        return AbsentModule(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        """Nothing is in it."""
