"""Nodes of a container, and what describes parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.utilities import normalize_to_list_of_substitutions
from launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue
from launch_ros.utilities import normalize_parameters, normalize_remap_rules

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.base import Condition, SomeSubstitutionsType

__all__ = ["ComposableNode", "Parameter", "ParameterFile", "ParameterValue"]


class ComposableNode:
    """A node that a container loads."""

    def __init__(  # noqa: PLR0913  as the original
        self,
        *,
        package: SomeSubstitutionsType,
        plugin: SomeSubstitutionsType,
        name: SomeSubstitutionsType | None = None,
        namespace: SomeSubstitutionsType | None = None,
        parameters: list[Any] | None = None,
        remappings: Iterable[Any] | None = None,
        extra_arguments: list[Any] | None = None,
        condition: Condition | None = None,
    ) -> None:
        self.package = normalize_to_list_of_substitutions(package)
        self.plugin = normalize_to_list_of_substitutions(plugin)
        self.name = None if name is None else normalize_to_list_of_substitutions(name)
        self.namespace = (
            None if namespace is None else normalize_to_list_of_substitutions(namespace)
        )
        self.parameters = normalize_parameters(parameters or [])
        self.remappings = normalize_remap_rules(remappings or [])
        self.extra_arguments = normalize_parameters(extra_arguments or [])
        self.condition = condition
