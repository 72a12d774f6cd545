"""Paths put together."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from launch.substitution import Substitution
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.launch_context import LaunchContext


class PathJoinSubstitution(Substitution):
    """Its parts with separators in between; an absolute part discards what is before it."""

    def __init__(self, substitutions: Iterable[str | Substitution]) -> None:
        self.__substitutions = normalize_to_list_of_substitutions(substitutions)

    @property
    def substitutions(self) -> list[Substitution]:
        """The parts."""
        return self.__substitutions

    def describe(self) -> str:
        """Itself in words."""
        return f"PathJoin({', '.join(sub.describe() for sub in self.__substitutions)})"

    def perform(self, context: LaunchContext) -> str:
        """The path."""
        parts = [context.perform_substitution(sub) for sub in self.__substitutions]
        return os.path.join(*parts) if parts else ""


class PathSubstitution(PathJoinSubstitution):
    """A path that `/` goes on from."""

    def __init__(self, path: str | Substitution) -> None:
        super().__init__([path])
