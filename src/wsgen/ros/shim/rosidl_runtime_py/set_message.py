"""A message filled from a dictionary (ros2/rosidl_runtime_py, set_message.py)."""

from __future__ import annotations

import array
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable


def set_message_fields(
    msg: Any,
    values: dict[str, Any],
    expand_header_auto: bool = False,
    expand_time_now: bool = False,
) -> list[Callable[[Any], None]]:
    """Set fields by name; returns what sets the fields that were given as `auto` or `now`.

    Each function of the result takes the builtin_interfaces/Time of publishing.

    Raises:
        AttributeError: A message has no such field.
        TypeError, ValueError: A value is not one of its field.
    """
    if not isinstance(values, dict):
        raise TypeError(
            f"Value '{values}' is expected to be a dictionary but is a {type(values).__name__}"
        )
    stamps: list[Callable[[Any], None]] = []
    for name, value in values.items():
        field = getattr(msg, name)
        if value == "auto" and expand_header_auto and _is(field, "std_msgs", "Header"):
            stamps.append(_setter(field, "stamp"))
        elif value == "now" and expand_time_now and _is(field, "builtin_interfaces", "Time"):
            stamps.append(_setter(msg, name))
        elif hasattr(field, "get_fields_and_field_types"):
            stamps += set_message_fields(field, value or {}, expand_header_auto, expand_time_now)
        else:
            setattr(msg, name, _converted(msg, name, field, value))
    return stamps


def _converted(msg: Any, name: str, field: Any, value: Any) -> Any:
    """The value as the field has it."""
    if isinstance(field, array.array):
        return array.array(field.typecode, value)
    if isinstance(field, np.ndarray):
        return np.array(value, dtype=field.dtype)
    if isinstance(field, list):
        kind = getattr(_kinds(msg)[name], "value_type", None)
        if not isinstance(value, list):
            raise TypeError(f"'{name}' is a list, not a {type(value).__name__}")
        if hasattr(kind, "namespaces"):
            return [_message(kind, one) for one in value]
        return value
    if isinstance(field, bytes):
        return bytes(value, "utf-8") if isinstance(value, str) else bytes(value)
    if isinstance(field, bool):
        if not isinstance(value, bool):
            raise TypeError(f"'{name}' is true or false, not {value!r}")
        return value
    return type(field)(value)


def _message(kind: Any, values: Any) -> Any:
    from rosidl_runtime_py.utilities import get_interface

    message = get_interface("/".join([*kind.namespaces, kind.name]))()
    set_message_fields(message, values)
    return message


def _kinds(msg: Any) -> dict[str, Any]:
    return dict(zip(msg.get_fields_and_field_types(), msg.SLOT_TYPES, strict=True))


def _is(field: Any, package: str, name: str) -> bool:
    kind = type(field)
    return kind.__name__ == name and kind.__module__.startswith(f"{package}.")


def _setter(msg: Any, name: str) -> Callable[[Any], None]:
    def set_it(stamp: Any) -> None:
        setattr(msg, name, stamp)

    return set_it
