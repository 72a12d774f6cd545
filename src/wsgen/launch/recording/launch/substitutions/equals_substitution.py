"""Whether two texts are equal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.substitution import Substitution
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class EqualsSubstitution(Substitution):
    """Either "true" or "false"; numbers are equal when they are close, `true` equals `1`."""

    def __init__(self, left: Any, right: Any) -> None:
        self.__left = _normalize(left)
        self.__right = _normalize(right)

    def describe(self) -> str:
        """Itself in words."""
        return f"{type(self).__name__}()"

    def perform(self, context: LaunchContext) -> str:
        """Whether both sides are equal."""
        return str(self._are_equal(context)).lower()

    def _are_equal(self, context: LaunchContext) -> bool:
        left = _value(perform_substitutions(context, self.__left))
        right = _value(perform_substitutions(context, self.__right))
        if isinstance(left, float) and isinstance(right, float):
            import math

            return math.isclose(left, right)
        return left == right


def _normalize(side: Any) -> list[Substitution]:
    return normalize_to_list_of_substitutions(
        str(side) if isinstance(side, (bool, int, float)) else side
    )


def _value(text: str) -> bool | float | str:
    if text.lower() in {"true", "false"}:
        return text.lower() == "true"
    try:
        return float(text)
    except ValueError:
        return text
