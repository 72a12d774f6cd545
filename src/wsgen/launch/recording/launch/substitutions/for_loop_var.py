"""Variables of loops."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.actions.for_loop import local_of
from launch.substitution import Substitution
from launch.substitutions.substitution_failure import SubstitutionFailure
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType


class ForEachVar(Substitution):
    """The value of a variable of the loop that this stands in."""

    def __init__(
        self, name: SomeSubstitutionsType, *, default_value: SomeSubstitutionsType | None = None
    ) -> None:
        self.__name = normalize_to_list_of_substitutions(name)
        self.__default_value = (
            None if default_value is None else normalize_to_list_of_substitutions(default_value)
        )

    def describe(self) -> str:
        """Itself in words."""
        return f"{type(self).__name__}({' + '.join(sub.describe() for sub in self.__name)})"

    def perform(self, context: LaunchContext) -> str:
        """The value."""
        name = perform_substitutions(context, self.__name)
        found = context.get_locals_as_dict().get(local_of(name))
        if found is not None:
            return str(found)
        if self.__default_value is None:
            raise SubstitutionFailure(f"no value available for loop variable '{name}'")
        return perform_substitutions(context, self.__default_value)


class ForLoopIndex(ForEachVar):
    """The number of the iteration."""

    def __init__(self, name: SomeSubstitutionsType) -> None:
        super().__init__(name)
