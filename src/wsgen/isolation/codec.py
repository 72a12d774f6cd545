"""Dataclasses as JSON and back, for what a child process answers.

Nothing that foreign code touched is unpickled: a child writes its answer as JSON, and the parent
makes of it what the type hints say. A named tuple becomes a list, a dataclass an object with its
fields and its name, so that a union says which of its members it holds. The module of either
imports the types of its fields when it is loaded, not for type checkers alone.
"""

from __future__ import annotations

import functools
import json
import types
from collections.abc import Mapping, Sequence
from contextlib import suppress
from enum import Enum
from pathlib import PurePath
from typing import Any, Literal, TypeVar, Union, cast, get_args, get_origin, get_type_hints

T = TypeVar("T")

NAME = "$type"  # the key of a dataclass's name; no field can be called so
UNIONS = (Union, types.UnionType)
SEQUENCES = (list, Sequence)
MAPPINGS = (dict, Mapping)
PLAIN = (str, int, float, bool, types.NoneType)  # what JSON has, too


def encode(value: object) -> str:
    """A value as JSON: numbers, texts, sequences, mappings, enumerations, paths, dataclasses.

    Raises:
        TypeError: There is something else in it.
    """
    return json.dumps(value, default=_encode_object)


def _encode_object(value: object) -> Any:
    # Without the module `dataclasses`, which a child that does not use it need not load.
    fields = getattr(value, "__dataclass_fields__", None)
    if fields is not None and not isinstance(value, type):
        return {NAME: type(value).__name__, **{name: getattr(value, name) for name in fields}}
    if isinstance(value, PurePath):
        return str(value)
    raise TypeError(f"A {type(value).__name__} cannot be written as JSON.")


def decode(value: Any, kind: type[T]) -> T:
    """What `encode` was given, of what JSON gives back.

    Args:
        value: The JSON value.
        kind: Its type: that of a field of a dataclass, or a dataclass. `type[T]` is for type
            checkers; unions and `tuple[X, ...]` are possible, too.

    Raises:
        TypeError: It is something else.
    """
    return cast("T", _decode(value, kind))


def _decode(value: Any, kind: Any) -> Any:
    if type(value) is kind:
        return value  # most are: plans have thousands of texts and numbers
    origin, arguments = _parts(kind)
    if origin is not None:
        return _decode_generic(value, kind, origin, arguments)
    if hasattr(kind, "__dataclass_fields__"):
        return _decode_fields(value, kind)
    if hasattr(kind, "_fields"):  # a named tuple
        hints = _hints(kind)
        _check(isinstance(value, list) and len(value) == len(hints), value, kind)
        return kind(*map(_decode, value, hints.values()))
    return value if kind is Any else _decode_plain(value, types.NoneType if kind is None else kind)


@functools.cache
def _parts(kind: Any) -> tuple[Any, tuple[Any, ...]]:
    """What a type is generic in, and its arguments."""
    return get_origin(kind), get_args(kind)


def _decode_plain(value: Any, kind: type) -> Any:
    if issubclass(kind, Enum | PurePath):
        return kind(value)
    if kind is float and isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    _check(isinstance(value, kind) and isinstance(value, bool) == (kind is bool), value, kind)
    return value


def _decode_generic(value: Any, kind: Any, origin: Any, arguments: tuple[Any, ...]) -> Any:
    if origin in UNIONS:
        return _decode_member(value, kind, arguments)
    if origin is Literal:
        _check(value in arguments, value, kind)
        return value
    if origin in MAPPINGS:
        _check(isinstance(value, dict), value, kind)
        of_key, of_value = arguments
        return {_decode(key, of_key): _decode(inner, of_value) for key, inner in value.items()}
    _check(isinstance(value, list), value, kind)
    if origin in SEQUENCES:
        return [_decode(inner, arguments[0]) for inner in value]
    _check(origin is tuple, value, kind)
    if len(arguments) > 1 and arguments[1] is ...:
        return tuple(_decode(inner, arguments[0]) for inner in value)
    _check(len(arguments) == len(value), value, kind)
    return tuple(_decode(inner, one) for inner, one in zip(value, arguments, strict=True))


def _decode_member(value: Any, kind: Any, members: tuple[Any, ...]) -> Any:
    if type(value) in members:
        return value
    if isinstance(value, dict) and NAME in value:
        for member in members:
            if getattr(member, "__name__", "") == value[NAME]:
                return _decode(value, member)
    for member in members:
        with suppress(TypeError, ValueError):  # ValueError: no such member of an enumeration
            return _decode(value, member)
    raise TypeError(_mismatch(value, kind))


def _decode_fields(value: Any, kind: type) -> Any:
    _check(isinstance(value, dict) and value.get(NAME) == kind.__name__, value, kind)
    hints, plain = _hints(kind), _plain_types(kind)
    _check(value.keys() - {NAME} <= hints.keys(), value, kind)
    return kind(
        **{
            name: one if type(one) in plain[name] else _decode(one, hints[name])
            for name, one in value.items()
            if name != NAME
        }
    )


@functools.cache
def _plain_types(kind: type) -> dict[str, tuple[Any, ...]]:
    """The types of the values that the fields of a dataclass take as they are, by field.

    That spares most values a call: plans have thousands of texts and numbers.
    """
    return {
        name: tuple(one for one in _members(hint) if one in PLAIN)
        for name, hint in _hints(kind).items()
    }


def _members(kind: Any) -> tuple[Any, ...]:
    origin, arguments = _parts(kind)
    return arguments if origin in UNIONS else (kind,)


@functools.cache
def _hints(kind: type) -> dict[str, Any]:
    return get_type_hints(kind)


def _check(fits: bool, value: object, kind: object) -> None:  # noqa: FBT001  it is a condition
    if not fits:
        raise TypeError(_mismatch(value, kind))


def _mismatch(value: object, kind: object) -> str:
    return f"A child answered {repr(value)[:200]} where {kind} was expected."
