"""Refuse arguments of the wrong type."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any


def ensure_argument_type(
    argument: Any, types: Any, argument_name: str, caller: str | None = None
) -> None:
    """Raise TypeError unless the argument is an instance of one of the types."""
    accepted = list(types) if isinstance(types, Iterable) else [types]
    if any(isinstance(argument, one) for one in accepted):
        return
    who = f"'{caller}' " if caller else ""
    raise TypeError(
        f"{who}expected '{argument_name}' to be one of {accepted}, but got '{argument}' "
        f"of type '{type(argument)}'"
    )
