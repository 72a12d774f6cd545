"""An element of a launch file in XML or YAML, before anything is made of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wsgen.launch.record import Location


class Entity:
    """A tag with attributes and nested entities; knows which of them nobody asked for."""

    def __init__(self, type_name: str, location: Location) -> None:
        self.type_name = type_name
        self.location = location
        self._read: set[str] = set()

    def get(self, name: str, kind: Any = str, *, optional: bool = False) -> Any:
        """An attribute as that type; the text itself where it may hold substitutions.

        Raises:
            AttributeError: it is not there, and not optional.
            TypeError: it is of another type.
        """
        raise NotImplementedError

    def nested(self, name: str) -> list[Entity]:
        """The entities of that name which describe this one."""
        raise NotImplementedError

    def children(self) -> list[Entity]:
        """All nested entities, which are actions of their own."""
        raise NotImplementedError

    def require_all_read(self) -> None:
        """Refuse what nobody asked for, which is what nobody knows; ValueError."""
        raise NotImplementedError

    def missing(self, name: str, kind: Any) -> AttributeError:
        """The error of a missing attribute, in the words of the original."""
        return AttributeError(
            f"Attribute '{name}' of type '{kind}' not found in Entity '{self.type_name}'"
        )
