"""Messages as YAML, CSV and dictionaries (ros2/rosidl_runtime_py, convert.py)."""

from __future__ import annotations

import array
import sys
from collections import OrderedDict
from typing import Any

import numpy as np
import yaml

SEQUENCES = (list, tuple, array.array, np.ndarray)
NUMBERS = (bool, int, float)


class _Dumper(yaml.Dumper):
    """Writes dictionaries in their order."""


_Dumper.add_representer(
    OrderedDict,
    lambda dumper, data: dumper.represent_mapping("tag:yaml.org,2002:map", data.items()),
)


def message_to_yaml(
    msg: Any,
    *,
    truncate_length: int | None = None,
    no_arr: bool = False,
    no_str: bool = False,
    flow_style: bool = False,
) -> str:
    """A message as YAML; what is longer than `truncate_length` ends with `...`."""
    fields = message_to_ordereddict(
        msg, truncate_length=truncate_length, no_arr=no_arr, no_str=no_str
    )
    return yaml.dump(
        fields,
        Dumper=_Dumper,
        allow_unicode=True,
        width=sys.maxsize,
        default_flow_style=flow_style,
    )


def message_to_csv(
    msg: Any,
    *,
    truncate_length: int | None = None,
    no_arr: bool = False,
    no_str: bool = False,
) -> str:
    """The values of a message and of those in it, separated by commas."""

    def text_of(value: Any, kind: Any = None) -> str:
        if isinstance(value, SEQUENCES):
            if no_arr and kind is not None:
                return _abbreviated(value, kind)
            cut = truncate_length is not None and len(value) > truncate_length
            texts = [text_of(one) for one in value[:truncate_length]]
            return ",".join([*texts, *(["..."] if cut else [])])
        if isinstance(value, (*NUMBERS, np.number)):
            return str(value)
        if isinstance(value, (str, bytes)):
            if no_str and isinstance(value, str):
                return f"<string length: <{len(value)}>>"
            return str(_cut(value, truncate_length))
        return ",".join(text_of(one, kind) for _, one, kind in _fields(value))

    return text_of(msg)


def message_to_ordereddict(
    msg: Any,
    *,
    truncate_length: int | None = None,
    no_arr: bool = False,
    no_str: bool = False,
) -> OrderedDict[str, Any]:
    """The fields of a message in their order, down to numbers and texts."""

    def plain(value: Any, kind: Any = None) -> Any:
        if isinstance(value, bytes):
            return "".join(map(chr, value[:truncate_length])) + (
                "..." if truncate_length is not None and len(value) > truncate_length else ""
            )
        if isinstance(value, str):
            if no_str:
                return f"<string length: <{len(value)}>>"
            return _cut(value, truncate_length)
        if isinstance(value, SEQUENCES):
            if no_arr and kind is not None:
                return _abbreviated(value, kind)
            cut = truncate_length is not None and len(value) > truncate_length
            return [
                *(plain(one) for one in value[:truncate_length]),
                *(["..."] if cut else []),
            ]
        if isinstance(value, np.number):
            return value.item()
        if isinstance(value, NUMBERS):
            return value
        return OrderedDict((name, plain(one, kind)) for name, one, kind in _fields(value))

    fields: OrderedDict[str, Any] = plain(msg)
    return fields


def get_message_slot_types(msg: Any) -> OrderedDict[str, Any]:
    """The types of the fields of a message."""
    return OrderedDict(zip(msg.get_fields_and_field_types(), msg.SLOT_TYPES, strict=True))


def _fields(msg: Any) -> list[tuple[str, Any, Any]]:
    return [(name, getattr(msg, name), kind) for name, kind in get_message_slot_types(msg).items()]


def _cut(value: Any, length: int | None) -> Any:
    if length is None or len(value) <= length:
        return value
    return value[:length] + (b"..." if isinstance(value, bytes) else "...")


def _abbreviated(value: Any, kind: Any) -> str:
    """What stands for an array that is not shown."""
    name = _type_name(kind.value_type)
    if hasattr(kind, "size"):
        return f"<array type: {name}[{kind.size}]>"
    if hasattr(kind, "maximum_size"):
        return f"<sequence type: {name}[{kind.maximum_size}], length: {len(value)}>"
    return f"<sequence type: {name}, length: {len(value)}>"


def _type_name(kind: Any) -> str:
    if hasattr(kind, "typename"):
        return str(kind.typename)
    if hasattr(kind, "namespaced_name"):
        return "/".join(kind.namespaced_name())
    if hasattr(kind, "name"):
        return str(kind.name)
    return "wstring" if "WString" in type(kind).__name__ else "string"
