"""A name that no other process has."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.substitution import Substitution
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType


class AnonName(Substitution):
    """The same name for the same text; not random here, so that plans can be compared."""

    def __init__(self, name: SomeSubstitutionsType) -> None:
        self.__name = normalize_to_list_of_substitutions(name)

    def describe(self) -> str:
        """Itself in words."""
        return f"AnonName({' + '.join(sub.describe() for sub in self.__name)})"

    def perform(self, context: LaunchContext) -> str:
        """The name."""
        name = perform_substitutions(context, self.__name)
        names = context.launch_configurations.setdefault("anon_names", {})
        anonymous: str = names.setdefault(name, f"{name}_anonymous_{len(names)}")
        return anonymous
