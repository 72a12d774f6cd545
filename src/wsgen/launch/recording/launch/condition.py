"""Whether an action is executed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch._located import Located

if TYPE_CHECKING:
    from collections.abc import Callable

    from launch.launch_context import LaunchContext


class Condition(Located):
    """A predicate on the context; its last answer is kept, as in the original."""

    def __init__(self, *, predicate: Callable[[LaunchContext], bool] | None = None) -> None:
        self._predicate = predicate
        self._last: bool | None = None

    def evaluate(self, context: LaunchContext) -> bool:
        """Whether it holds now."""
        if self._predicate is None:
            raise NotImplementedError("a Condition needs a predicate")
        self._last = self._predicate(context)
        return self._last

    def describe(self) -> str:
        """Itself in words."""
        return f"{type(self).__name__}({self._predicate})"
