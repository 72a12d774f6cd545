"""What launch_param_builder and moveit_configs_utils are where they are not installed, in a child.

Parameters come from files of a package. `MoveItConfigsBuilder` finds the robot of a MoveIt package
as the real one does. The settings of planners are unknown, because nothing here reads them.
"""

from __future__ import annotations

import contextlib
import errno
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ament_index_python.packages import get_package_share_directory
from ament_index_python.resources import has_resource
from launch._unknown import Unknown
from launch.substitutions import Command
from launch_ros.parameter_descriptions import ParameterValue
from wsgen.launching import known_packages
from wsgen.launching.record import CommandOutcome, caller, run_command

if TYPE_CHECKING:
    from collections.abc import Mapping
    from os import PathLike

    Text = str | PathLike[str]


class ParameterBuilderFileNotFoundError(FileNotFoundError, KeyError):
    """A file does not exist: a KeyError in the original, explained as any other such error."""


class XacroError(Exception):
    """The error of xacro is in the outcome."""

    def __init__(self, outcome: CommandOutcome) -> None:
        super().__init__(outcome.stderr)
        self.wsgen_outcome = outcome


def raise_if_file_not_found(file_path: Text) -> None:
    """Raise ParameterBuilderFileNotFoundError where there is no file."""
    if not os.path.exists(file_path):
        raise ParameterBuilderFileNotFoundError(errno.ENOENT, "No such file", str(file_path))


def get_package_path(package_name: str) -> Path:
    """The share folder of a package."""
    return Path(get_package_share_directory(package_name))


def load_file(file_path: Text) -> str:
    """The text of a file."""
    raise_if_file_not_found(file_path)
    return Path(file_path).read_text(encoding="utf-8")


def load_yaml(file_path: Text) -> Any:
    """What is in a file of YAML."""
    import yaml

    return yaml.safe_load(load_file(file_path))


def load_xacro(file_path: Text, mappings: Mapping[str, str] | None = None) -> str:
    """What xacro makes of a file."""
    raise_if_file_not_found(file_path)
    arguments = (f"{name}:={value}" for name, value in (mappings or {}).items())
    outcome = run_command(["xacro", str(file_path), *arguments], caller())
    if outcome.code:
        raise XacroError(outcome)
    return outcome.stdout


class ParameterBuilder:
    """Gathers parameters; a path that is not absolute is one in the share folder of the package."""

    def __init__(self, package_name: str) -> None:
        self._package_path = get_package_path(package_name)
        self._parameters: dict[str, Any] = {}

    def yaml(self, file_path: Text, parameter_namespace: str | None = None) -> ParameterBuilder:
        """Add what is in a file of YAML, below the name if there is one."""
        loaded = load_yaml(self._package_path / file_path)
        place = self._parameters
        if parameter_namespace:
            place = self._parameters.setdefault(parameter_namespace, {})
        place.update(loaded)
        return self

    def file_parameter(self, parameter_name: str, file_path: Text) -> ParameterBuilder:
        """Add the text of a file."""
        return self.parameter(parameter_name, load_file(self._package_path / file_path))

    def xacro_parameter(
        self, parameter_name: str, file_path: Text, mappings: Mapping[str, str] | None = None
    ) -> ParameterBuilder:
        """Add what xacro makes of a file."""
        return self.parameter(parameter_name, load_xacro(self._package_path / file_path, mappings))

    def parameter(self, parameter_name: str, parameter_value: Any) -> ParameterBuilder:
        """Add a value."""
        self._parameters[parameter_name] = parameter_value
        return self

    def to_dict(self) -> dict[str, Any]:
        """All parameters."""
        return self._parameters


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
