"""Whether two texts differ."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.substitutions.equals_substitution import EqualsSubstitution

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class NotEqualsSubstitution(EqualsSubstitution):
    """The opposite of `EqualsSubstitution`."""

    def perform(self, context: LaunchContext) -> str:
        """Whether both sides differ."""
        return str(not self._are_equal(context)).lower()
