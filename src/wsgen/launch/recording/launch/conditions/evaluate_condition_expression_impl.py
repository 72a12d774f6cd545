"""The truth of a text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.conditions.invalid_condition_expression_error import InvalidConditionExpressionError
from launch.utilities.perform_substitutions_impl import perform_substitutions
from wsgen.launch.record import RECORD

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.substitution import Substitution


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
