"""One of two texts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.conditions.evaluate_condition_expression_impl import evaluate_condition_expression
from launch.substitution import Substitution
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType


class IfElseSubstitution(Substitution):
    """The first text where the condition is true, else the second."""

    def __init__(
        self,
        condition: SomeSubstitutionsType,
        if_value: SomeSubstitutionsType = "",
        else_value: SomeSubstitutionsType = "",
    ) -> None:
        if if_value == else_value == "":
            raise RuntimeError("One of if_value and else_value must be specified")
        self.__condition = normalize_to_list_of_substitutions(condition)
        self.__if_value = normalize_to_list_of_substitutions(if_value)
        self.__else_value = normalize_to_list_of_substitutions(else_value)

    def describe(self) -> str:
        """Itself in words."""
        return f"IfElse({' + '.join(sub.describe() for sub in self.__condition)})"

    def perform(self, context: LaunchContext) -> str:
        """The text."""
        holds = evaluate_condition_expression(context, self.__condition)
        return perform_substitutions(context, self.__if_value if holds else self.__else_value)
