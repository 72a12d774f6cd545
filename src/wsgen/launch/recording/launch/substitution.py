"""A text that is known only when it is performed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch._located import Located

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class Substitution(Located):
    """Base of all substitutions, also of those that users write."""

    def perform(self, context: LaunchContext) -> str:
        """The text, given the state of the launch at this moment."""
        raise NotImplementedError

    def describe(self) -> str:
        """Itself in words."""
        return self.__repr__()

    def __truediv__(self, other: Any) -> Substitution:
        """Path joining, as newer releases allow."""
        from launch.substitutions.path_join_substitution import PathJoinSubstitution

        return PathJoinSubstitution([self, other])
