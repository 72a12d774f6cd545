"""Which processes are meant."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from launch.action import Action


def matches_action(target_action: Action) -> Callable[[Action], bool]:
    """Whether an action is this very one."""
    return lambda action: action is target_action
