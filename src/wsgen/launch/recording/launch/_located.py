"""Objects that remember the line of the launch file that made them."""

from __future__ import annotations

from typing import Any

from wsgen.launch.record import caller


class Located:
    """Base of entities and substitutions; also of those that users write."""

    wsgen_location: tuple[str, int] | None

    def __new__(cls, *_arguments: Any, **_keywords: Any) -> Any:
        """Remember the line; in `__new__` because users forget `super().__init__()`."""
        made = object.__new__(cls)
        made.wsgen_location = caller()
        return made
