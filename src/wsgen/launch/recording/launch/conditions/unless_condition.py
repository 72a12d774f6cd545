"""Unless a text is true."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.conditions.if_condition import IfCondition

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class UnlessCondition(IfCondition):
    """Holds when its text says false."""

    def _holds(self, context: LaunchContext) -> bool:
        return not super()._holds(context)
