"""What is known of moveit_configs_utils where it is not installed: robots, in the child process.

`MoveItConfigsBuilder` finds the robot of a MoveIt package as the real one does. The settings of
planners are unknown, because nothing here reads them.
"""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ament_index_python.resources import has_resource
from launch._unknown import Unknown
from launch.substitutions import Command
from launch_ros.parameter_descriptions import ParameterValue
from wsgen.launching import known_packages
from wsgen.launching.parameter_builder import (
    ParameterBuilder,
    ParameterBuilderFileNotFoundError,
    get_package_path,
    load_xacro,
    load_yaml,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

PACKAGE = "moveit_configs_utils"
_ENDING = "_moveit_config"
_NAMES = (
    *("robot_description", "robot_description_semantic", "robot_description_kinematics"),
    *("planning_pipelines", "trajectory_execution", "planning_scene_monitor", "sensors_3d"),
    *("move_group_capabilities", "joint_limits", "moveit_cpp", "pilz_cartesian_limits"),
)


class MoveItConfigs:
    """The parameters of MoveIt: a dictionary for each purpose."""

    robot_description: dict[str, Any]
    robot_description_semantic: dict[str, Any]

    def __init__(self, *, package_path: Path | None = None, **settings: Any) -> None:
        self.package_path = package_path
        for name in _NAMES:
            setattr(self, name, settings.get(name, {}))

    def to_dict(self) -> dict[str, Any]:
        """All of them together."""
        merged: dict[str, Any] = {}
        for name in _NAMES:
            value = getattr(self, name)
            merged.update(value if isinstance(value, dict) else {name: value})
        return merged


class MoveItConfigsBuilder(ParameterBuilder):
    """Finds the robot of a MoveIt package; every other setting is unknown."""

    def __new__(cls, robot_name: str = "", *_more: Any, **named: Any) -> Any:
        """An unknown one for a package that is not here."""
        package = named.get("package_name") or f"{named.get('robot_name', robot_name)}{_ENDING}"
        is_here = has_resource("packages", package) is not None
        return super().__new__(cls) if is_here else Unknown(f"{PACKAGE}.MoveItConfigsBuilder()")

    def __init__(
        self,
        robot_name: str,
        robot_description: str = "robot_description",
        package_name: str | None = None,
    ) -> None:
        super().__init__(package_name or f"{robot_name}{_ENDING}")
        self._name = robot_description
        own = Path("config", f"{robot_name}.urdf.xacro")
        assistant = self._package_path / ".setup_assistant"
        read = load_yaml(assistant) if assistant.exists() else {}
        settings = read.get("moveit_setup_assistant_config") or {}
        urdf = settings.get("urdf") or settings.get("URDF") or {}
        srdf = settings.get("srdf") or settings.get("SRDF") or {}
        self._urdf = self._package_path / "config" / f"{robot_name}.urdf"
        if (self._package_path / own).exists():
            self._urdf = self._package_path / own
        elif urdf:
            self._urdf = get_package_path(urdf["package"]) / urdf["relative_path"]
        words = (urdf.get("xacro_args") or "").split()
        self._mappings = dict(word.split(":=", 1) for word in words if ":=" in word)
        self._srdf = self._package_path / (
            srdf.get("relative_path") or Path("config", f"{robot_name}.srdf")
        )
        self._configs = MoveItConfigs(
            package_path=self._package_path,
            **{name: Unknown(f"{PACKAGE}.MoveItConfigs.{name}") for name in _NAMES[2:]},
        )

    def robot_description(
        self, file_path: Any = None, mappings: Mapping[Any, Any] | None = None
    ) -> MoveItConfigsBuilder:
        """Load the robot, from the file that the package names."""
        path = self._urdf if file_path is None else self._package_path / file_path
        with contextlib.suppress(ParameterBuilderFileNotFoundError):  # of a topic, then
            text = _description(path, mappings or self._mappings)
            self._configs.robot_description = {self._name: text}
        return self

    def robot_description_semantic(
        self, file_path: Any = None, mappings: Mapping[Any, Any] | None = None
    ) -> MoveItConfigsBuilder:
        """Load what MoveIt knows of the groups of the robot."""
        path = self._srdf if file_path is None else self._package_path / file_path
        self._configs.robot_description_semantic = {
            f"{self._name}_semantic": _description(path, mappings or {})
        }
        return self

    def __getattr__(self, name: str) -> Any:
        if name not in _NAMES:
            raise AttributeError(name)
        return lambda *_arguments, **_named: self  # loads what is unknown

    def to_moveit_configs(self) -> MoveItConfigs:
        """The parameters, with the robot in any case."""
        if not self._configs.robot_description:
            self.robot_description()
        if not self._configs.robot_description_semantic:
            self.robot_description_semantic()
        return self._configs

    def to_dict(self, *, include_moveit_configs: bool = True) -> dict[str, Any]:
        """All parameters."""
        configs = self.to_moveit_configs().to_dict() if include_moveit_configs else {}
        return {**self._parameters, **configs}


def _description(path: Path, mappings: Mapping[Any, Any]) -> Any:
    """The text of a robot; where substitutions are mapped to its arguments, a command for it."""
    if known_packages.is_in_shim(str(path)):
        return Unknown(f"xacro {path}")  # of a package that is not here
    if all(isinstance(value, str) for value in mappings.values()):
        return load_xacro(path, mappings)
    words: list[Any] = ["xacro ", str(path)]
    for name, value in mappings.items():
        words += [" ", name, ":=", value]
    return ParameterValue(Command(words), value_type=str)
