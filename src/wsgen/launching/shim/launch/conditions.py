"""All conditions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch._finder import show_public_names
from launch._utilities import (
    normalize_optional,
    normalize_to_list_of_substitutions,
    perform_substitutions,
)
from launch.base import Condition
from wsgen.launching.record import RECORD

if TYPE_CHECKING:
    from launch.base import SomeSubstitutionsType, Substitution
    from launch.launch_context import LaunchContext


class InvalidConditionExpressionError(RuntimeError):
    """The text of a condition is none of true, 1, false, 0."""


def evaluate_condition_expression(context: LaunchContext, expression: list[Substitution]) -> bool:
    """True for "true" and "1", false for "false" and "0", whatever their case."""
    text = perform_substitutions(context, expression)
    stripped = text.strip().lower()
    if stripped in {"true", "1"}:
        return True
    if stripped in {"false", "0"}:
        return False
    if RECORD.is_unknown(text):
        return False  # noted where it was found to be unknown
    raise InvalidConditionExpressionError(
        f"invalid condition expression, expected one of [true, 1, false, 0] but got '{text}', "
        f"expanded from '{' + '.join(sub.describe() for sub in expression)}'"
    )


class IfCondition(Condition):
    """Holds when its text says true."""

    def __init__(self, predicate_expression: SomeSubstitutionsType) -> None:
        self.__expression = normalize_to_list_of_substitutions(predicate_expression)
        super().__init__(predicate=self._holds)

    def _holds(self, context: LaunchContext) -> bool:
        return evaluate_condition_expression(context, self.__expression)

    def describe(self) -> str:
        """Itself in words."""
        return f"IfCondition({' + '.join(sub.describe() for sub in self.__expression)})"


class LaunchConfigurationEquals(Condition):
    """Holds when the configuration has this value; with None, when it is not set."""

    def __init__(
        self,
        launch_configuration_name: str,
        expected_value: SomeSubstitutionsType | None,
    ) -> None:
        self.__name = launch_configuration_name
        RECORD.argument_use.read.add(launch_configuration_name)
        self.__expected = normalize_optional(expected_value)
        super().__init__(predicate=self._holds)

    def _holds(self, context: LaunchContext) -> bool:
        value = context.launch_configurations.get(self.__name)
        if self.__expected is None:
            return value is None
        return bool(value == perform_substitutions(context, self.__expected))


class LaunchConfigurationNotEquals(LaunchConfigurationEquals):
    """The opposite of `LaunchConfigurationEquals`."""

    def _holds(self, context: LaunchContext) -> bool:
        return not super()._holds(context)


class UnlessCondition(IfCondition):
    """Holds when its text says false."""

    def _holds(self, context: LaunchContext) -> bool:
        return not super()._holds(context)


show_public_names(__name__)
