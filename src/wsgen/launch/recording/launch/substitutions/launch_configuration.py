"""The value of a launch configuration."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.substitution import Substitution
from launch.substitutions.substitution_failure import SubstitutionFailure
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType


class LaunchConfiguration(Substitution):
    """What was set under a name; its own default only where nothing was."""

    def __init__(
        self,
        variable_name: SomeSubstitutionsType,
        *,
        default: Any | Iterable[Any] | None = None,
    ) -> None:
        self.__variable_name = normalize_to_list_of_substitutions(variable_name)
        self.__default = None if default is None else _normalize_default(default)

    @property
    def variable_name(self) -> list[Substitution]:
        """The name."""
        return self.__variable_name

    def describe(self) -> str:
        """Itself in words."""
        return f"LaunchConfig({' + '.join(sub.describe() for sub in self.__variable_name)})"

    def perform(self, context: LaunchContext) -> str:
        """The value, the default, or SubstitutionFailure."""
        name = perform_substitutions(context, self.__variable_name)
        if name in context.launch_configurations:
            value: str = context.launch_configurations[name]
            return value
        if self.__default is None:
            raise SubstitutionFailure(f"launch configuration '{name}' does not exist")
        return perform_substitutions(context, self.__default)


def _normalize_default(default: Any) -> list[Substitution]:
    """The default; what is neither text nor substitution counts as `str` writes it."""
    if isinstance(default, (str, Substitution)):
        return normalize_to_list_of_substitutions(default)
    try:
        items = list(default)
    except TypeError:
        return normalize_to_list_of_substitutions(str(default))
    return normalize_to_list_of_substitutions(
        [item if isinstance(item, Substitution) else str(item) for item in items]
    )
