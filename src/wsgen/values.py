"""`dataclass` as the standard library's, for classes that are cheaper to define.

`dataclasses` compiles six methods for each frozen class, half a millisecond that every command pays
for every class that it loads. Here all classes share those that compare, hash and show.
"""

from __future__ import annotations

import dataclasses
from functools import cache
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass  # noqa: PLC0414, TID251  type checkers know it
else:

    def dataclass(
        cls: type | None = None, /, *, frozen: bool = False, kw_only: bool = False
    ) -> Any:
        """As `dataclasses.dataclass`, with the options that wsgen uses."""

        def make(cls: type) -> type:
            shared = {"__eq__": _equal, "__repr__": _show, "__hash__": _hash if frozen else None}
            for name, method in shared.items():
                if name not in cls.__dict__:
                    setattr(cls, name, method)
            made = dataclasses.dataclass  # noqa: TID251  what this is made of
            return made(cls, eq=False, repr=False, frozen=frozen, kw_only=kw_only)

        return make if cls is None else make(cls)


@cache
def _compared_names(cls: type) -> tuple[str, ...]:
    """The names of the fields that count when two values of a class are compared."""
    fields: tuple[dataclasses.Field[Any], ...] = dataclasses.fields(cls)
    return tuple(field.name for field in fields if field.compare)


def _compared(value: Any) -> tuple[Any, ...]:
    return tuple([getattr(value, name) for name in _compared_names(value.__class__)])


def _equal(self: Any, other: object) -> bool:
    if other.__class__ is not self.__class__:
        return NotImplemented  # type: ignore[no-any-return]
    return _compared(self) == _compared(other)


def _hash(self: Any) -> int:
    return hash(_compared(self))


@recursive_repr()
def _show(self: Any) -> str:
    shown = (f"{one.name}={getattr(self, one.name)!r}" for one in dataclasses.fields(self))
    return f"{type(self).__qualname__}({', '.join(shown)})"
