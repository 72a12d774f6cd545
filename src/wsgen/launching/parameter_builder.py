"""What launch_param_builder is where it is not installed: parameters from files of a package."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ament_index_python.packages import get_package_share_directory
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
