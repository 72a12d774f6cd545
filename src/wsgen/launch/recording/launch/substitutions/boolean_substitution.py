"""Truth values put together."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.substitution import Substitution
from launch.substitutions.substitution_failure import SubstitutionFailure
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType


class BooleanSubstitution(Substitution):
    """Base: texts that must be true or false."""

    def __init__(self, *values: SomeSubstitutionsType) -> None:
        self.__values = [normalize_to_list_of_substitutions(value) for value in values]

    def describe(self) -> str:
        """Itself in words."""
        return f"{type(self).__name__}()"

    def perform(self, context: LaunchContext) -> str:
        """Itself as "true" or "false"."""
        truths = [_truth(perform_substitutions(context, value)) for value in self.__values]
        return str(self._combine(truths)).lower()

    def _combine(self, truths: list[bool]) -> bool:
        raise NotImplementedError


class NotSubstitution(BooleanSubstitution):
    """The opposite of one value."""

    def __init__(self, value: SomeSubstitutionsType) -> None:
        super().__init__(value)

    def _combine(self, truths: list[bool]) -> bool:
        return not truths[0]


class AllSubstitution(BooleanSubstitution):
    """Whether all values are true."""

    def _combine(self, truths: list[bool]) -> bool:
        return all(truths)


class AnySubstitution(BooleanSubstitution):
    """Whether at least one value is true."""

    def _combine(self, truths: list[bool]) -> bool:
        return any(truths)


class AndSubstitution(AllSubstitution):
    """Whether both values are true."""

    def __init__(self, left: SomeSubstitutionsType, right: SomeSubstitutionsType) -> None:
        super().__init__(left, right)


class OrSubstitution(AnySubstitution):
    """Whether one of two values is true."""

    def __init__(self, left: SomeSubstitutionsType, right: SomeSubstitutionsType) -> None:
        super().__init__(left, right)


def _truth(text: str) -> bool:
    if text.strip().lower() in {"true", "1"}:
        return True
    if text.strip().lower() in {"false", "0"}:
        return False
    raise SubstitutionFailure(f"cannot read '{text}' as true or false")
