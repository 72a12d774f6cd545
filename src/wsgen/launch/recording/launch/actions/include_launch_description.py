"""A launch file within another."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch.actions.set_launch_configuration import SetLaunchConfiguration
from launch.launch_context import LaunchContext
from launch.launch_description_source import LaunchDescriptionSource
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions
from wsgen.launch import known_packages
from wsgen.launch.record import RECORD

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.launch_description import LaunchDescription
    from launch.launch_description_entity import LaunchDescriptionEntity
    from launch.some_substitutions_type import SomeSubstitutionsType


class IncludeLaunchDescription(Action):
    """Sets the arguments and visits the description, both in the scope of the caller."""

    def __init__(
        self,
        launch_description_source: LaunchDescriptionSource | SomeSubstitutionsType,
        *,
        launch_arguments: Iterable[tuple[Any, Any]] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        if not isinstance(launch_description_source, LaunchDescriptionSource):
            from launch.launch_description_sources.any_launch_description_source import (
                AnyLaunchDescriptionSource,
            )

            launch_description_source = AnyLaunchDescriptionSource(launch_description_source)
        self.__source = launch_description_source
        self.__launch_arguments = () if launch_arguments is None else tuple(launch_arguments)

    @property
    def launch_description_source(self) -> LaunchDescriptionSource:
        """Where the description comes from."""
        return self.__source

    @property
    def launch_arguments(self) -> tuple[tuple[Any, Any], ...]:
        """Names and values."""
        return self.__launch_arguments

    def describe(self) -> str:
        """Itself in words."""
        return f"IncludeLaunchDescription({self.__source.location})"

    def get_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """The description, where it can be known before the launch."""
        description = self.__source.try_get_launch_description_without_context()
        return [] if description is None else [description]

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity]:
        """Load the description and give it, with the arguments before it."""
        description = self.__source.get_launch_description(context)
        file = self.__source.location
        if not RECORD.is_unknown(file):
            file = os.path.abspath(file)
        context.extend_locals(
            {
                "current_launch_file_path": file,
                "current_launch_file_directory": os.path.dirname(file),
            }
        )
        # The launch file that is played itself is included by nobody's line.
        is_include = self.wsgen_location is not None
        names = [_text(context, name) for name, _ in self.__launch_arguments]
        _require_arguments(description, list(names))
        return [
            *(SetLaunchConfiguration(name, value) for name, value in self.__launch_arguments),
            *([_Entrance(file, names)] if is_include else []),
            description,
            *([_Exit()] if is_include and known_packages.stand_in_of(file) else []),
        ]

    def argument_names_without_context(self) -> list[str]:
        """The names of the arguments, where they can be known before the launch."""
        names = []
        for name, _ in self.__launch_arguments:
            try:
                names.append(_text(LaunchContext(), name))
            except Exception:  # noqa: BLE001, S112, PERF203  a name that depends on the launch
                continue
        return names


class _Entrance(Action):
    """Notes the include, with its arguments as they were set."""

    def __init__(self, file: str, names: list[str]) -> None:
        super().__init__()
        self.__file = file
        self.__names = names

    def execute(self, context: LaunchContext) -> None:
        """Note it."""
        stand_in = known_packages.stand_in_of(self.__file)
        RECORD.includes.append(
            {
                "package": known_packages.package_of(self.__file),
                "file": self.__file,
                "arguments": {name: context.launch_configurations[name] for name in self.__names},
                "evaluated": stand_in is None and not RECORD.is_unknown(self.__file),
            }
        )


class _Exit(Action):
    """Notes what a launch file that is not here would have seen."""

    def execute(self, context: LaunchContext) -> None:
        """Add the configurations that it was not given, and has all the same."""
        RECORD.includes[-1]["configurations"] = {
            name: value
            for name, value in context.launch_configurations.items()
            if isinstance(value, str)
        }


def _text(context: LaunchContext, name: Any) -> str:
    return perform_substitutions(context, normalize_to_list_of_substitutions(name))


def _require_arguments(description: LaunchDescription, given: list[str]) -> None:
    """Refuse to include what declares an argument that nobody gives, before anything is done."""
    for (
        argument,
        includes,
    ) in description.get_launch_arguments_with_include_launch_description_actions():
        if argument.conditionally_included or argument.default_value is not None:
            continue
        for include in includes:
            given.extend(include.argument_names_without_context())
        if argument.name not in given:
            error = RuntimeError(
                f"Included launch description missing required argument '{argument.name}' "
                f"(description: '{argument.description}'), given: [{', '.join(given)}]"
            )
            error.wsgen_argument = argument.name  # type: ignore[attr-defined]
            raise error
