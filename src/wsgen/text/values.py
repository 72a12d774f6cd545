"""Classes and patterns that are cheaper to define than those of the standard library.

`dataclasses` compiles nine methods for each frozen class, which takes half a millisecond that every
command pays for every class that it loads. Here all classes share those that compare, hash, show
and refuse changes, and a class has its `__init__` compiled when the first object is made: half of
the classes that a command loads it does not use. Of Python 3.11, the 114 of `wsgen check` take 8 ms
instead of 70, a sixth of the command; of `wsgen validate` it is a tenth.

A `lazy_pattern` is compiled when it is first used.
"""

from __future__ import annotations

import dataclasses
import re
from functools import cache
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:
    from collections.abc import Iterator
    from dataclasses import dataclass as dataclass  # noqa: PLC0414, TID251  type checkers know it

    lazy_pattern = re.compile
else:

    def lazy_pattern(pattern: str | bytes, flags: int = 0) -> Any:
        """As `re.compile`; what is wrong with a pattern is raised when it is first used."""
        return _LazyPattern(pattern, flags)

    def dataclass(
        cls: type | None = None, /, *, frozen: bool = False, kw_only: bool = False
    ) -> Any:
        """As `dataclasses.dataclass`, with the options that wsgen uses."""

        def make(cls: type) -> type:
            shared = {
                "__init__": _init_of(cls),
                "__eq__": _equal,
                "__repr__": _show,
                "__hash__": _hash if frozen else None,
                **({"__setattr__": _refuse, "__delattr__": _refuse} if frozen else {}),
            }
            for name, method in shared.items():
                if name not in cls.__dict__:
                    setattr(cls, name, method)
            made = dataclasses.dataclass  # noqa: TID251  what this is made of
            return made(cls, init=False, eq=False, repr=False, kw_only=kw_only)

        return make if cls is None else make(cls)


def _init_of(cls: Any) -> Any:
    """An `__init__` that puts the compiled one in its place when it is called."""

    def initialize(self: Any, *arguments: Any, **keywords: Any) -> None:
        cls.__init__ = _compile_init(cls)
        cls.__init__(self, *arguments, **keywords)

    return initialize


def _compile_init(cls: type) -> Any:
    """An `__init__` with a parameter for each field, in the order of the standard library."""
    fields: tuple[dataclasses.Field[Any], ...] = dataclasses.fields(cls)
    given = [field for field in fields if field.init]
    by_place = [_parameter(field) for field in given if not field.kw_only]
    by_name = [_parameter(field) for field in given if field.kw_only]
    lines = [
        f"def __init__({', '.join(['_self', *by_place, *(['*', *by_name] if by_name else [])])}):",
        "    _values = _self.__dict__",  # faster than to set attributes, which a class may refuse
        *_assignments(fields),
    ]
    if hasattr(cls, "__post_init__"):
        lines.append("    _self.__post_init__()")
    names: dict[str, Any] = {"_missing": dataclasses.MISSING}
    for field in fields:
        names[f"_default_{field.name}"] = field.default
        names[f"_make_{field.name}"] = field.default_factory
    exec("\n".join(lines), names)  # noqa: S102  as `dataclasses` does
    made = names["__init__"]
    made.__qualname__ = f"{cls.__qualname__}.__init__"
    return made


def _parameter(field: dataclasses.Field[Any]) -> str:
    if field.default is not dataclasses.MISSING:
        return f"{field.name}=_default_{field.name}"
    return field.name if field.default_factory is dataclasses.MISSING else f"{field.name}=_missing"


def _assignments(fields: tuple[dataclasses.Field[Any], ...]) -> Iterator[str]:
    for field in fields:
        name, value = field.name, field.name
        if field.default_factory is not dataclasses.MISSING:
            value = f"_make_{name}()"
            if field.init:
                value += f" if {name} is _missing else {name}"
        elif not field.init:
            continue  # `__post_init__` sets it, or the class has the default
        yield f"    _values[{name!r}] = {value}"


def _refuse(self: Any, name: str, *_value: object) -> NoReturn:
    raise dataclasses.FrozenInstanceError(f"cannot change {name!r} of a {type(self).__name__}")


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


_OF_PATTERNS = (
    *("pattern", "flags", "groups", "groupindex", "scanner", "search", "match", "fullmatch"),
    *("split", "findall", "finditer", "sub", "subn"),
)


class _Pattern:
    """Has the attributes of a pattern as its own."""


class _LazyPattern(_Pattern):
    def __init__(self, pattern: str | bytes, flags: int) -> None:
        self._given = pattern, flags

    def __getattr__(self, name: str) -> Any:
        if name not in _OF_PATTERNS:
            raise AttributeError(f"a pattern has no attribute {name!r}")
        made: Any = re.compile(*self._given)
        vars(self).update({one: getattr(made, one) for one in _OF_PATTERNS})
        # Who asks for an attribute of a class with `__getattr__` waits twice as long.
        self.__class__ = _Pattern  # type: ignore[assignment]
        return getattr(made, name)
