"""A local of the context."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.substitution import Substitution
from launch.substitutions.substitution_failure import SubstitutionFailure

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class LocalSubstitution(Substitution):
    """An expression over the context's locals, such as `event.reason`."""

    def __init__(self, expression: str, description: str | None = None) -> None:
        self.__expression = expression
        self.__description = description

    @property
    def expression(self) -> str:
        """The expression."""
        return self.__expression

    def describe(self) -> str:
        """Itself in words."""
        return f"LocalVar('{self.__description or self.__expression}')"

    def perform(self, context: LaunchContext) -> str:
        """Its value as text."""
        try:
            value = eval(self.__expression, {}, context.get_locals_as_dict())  # noqa: S307  the launch file is a program already
        except Exception as error:
            raise SubstitutionFailure(
                f"cannot find '{self.__expression}' in locals: {error}"
            ) from error
        return str(value)
