"""Which processes are meant."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from launch.actions.execute_local import ExecuteLocal


def matches_name(name: str) -> Callable[[ExecuteLocal], bool]:
    """Whether a process has this name."""
    return lambda action: action.process_name == name


def matches_pid(pid: int) -> Callable[[ExecuteLocal], bool]:
    """No process has a number here."""
    del pid
    return lambda _action: False
