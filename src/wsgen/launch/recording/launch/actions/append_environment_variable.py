"""Append to an environment variable."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions
from launch.utilities.type_utils import normalize_typed_substitution, perform_typed_substitution

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType


class AppendEnvironmentVariable(Action):
    """Puts a value behind, or before, what a variable holds; sets it where it holds nothing."""

    def __init__(
        self,
        name: SomeSubstitutionsType,
        value: SomeSubstitutionsType,
        prepend: Any = False,  # noqa: FBT002  as the original
        separator: SomeSubstitutionsType = os.pathsep,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.__name = normalize_to_list_of_substitutions(name)
        self.__value = normalize_to_list_of_substitutions(value)
        self.__prepend = normalize_typed_substitution(prepend, bool)
        self.__separator = normalize_to_list_of_substitutions(separator)

    def execute(self, context: LaunchContext) -> None:
        """Append it."""
        name = perform_substitutions(context, self.__name)
        value = perform_substitutions(context, self.__value)
        separator = perform_substitutions(context, self.__separator)
        if name not in os.environ:
            os.environ[name] = value
        elif perform_typed_substitution(context, self.__prepend, bool):
            os.environ[name] = value + separator + os.environ[name]
        else:
            os.environ[name] = os.environ[name] + separator + value
