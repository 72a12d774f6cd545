"""Messages: their values, given by a user, their definitions as one text, and how often they come.

A user hears which field does not take which value. Rates are computed and printed as
`ros2 topic hz` does.

Files with recorded messages have the definition of a message with those of all messages in it, so
that programs without ROS can read them. The format is that of rosbag2 and of the encoding `ros2msg`
of MCAP: the text of the .msg file, then for each message in it a line of `=`, a line
`MSG: package/Name` and its text. Source: https://mcap.dev/spec/registry, "ros2msg".

Of an action, the feedback is on a topic. Its messages have no file: they are made of the .action
file (ros2/rosidl, rosidl_parser/rosidl_parser/definition.py, class Action).
"""

from __future__ import annotations

import importlib
import math
import re
from collections import deque
from typing import TYPE_CHECKING, Any

from wsgen.text.suggestions import ask_for_nearest

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Mapping
    from pathlib import Path


class WrongFieldError(Exception):
    """A message has no such field, or it takes no such value; the text is message and hint."""


def fill(
    message: Any,
    values: Mapping[str, Any],
    set_fields: Callable[..., Any],
    type_name: str,
) -> Any:
    """Set the fields of a message; gives what `set_fields` gives.

    Args:
        message: Of ROS, as its constructor makes it.
        values: By name of the field, nested as fields are.
        set_fields: Sets them: `rosidl_runtime_py.set_message_fields`.
        type_name: As the user has written it.

    Raises:
        WrongFieldError: A field is unknown, or does not take the value.
    """
    _check_names(message, values, type_name, type_name)
    try:
        return set_fields(message, values)
    except Exception as error:  # noqa: BLE001  of messages, which check their values by assertions
        refused = _refused(type(message), values, set_fields)
        if refused is None:
            raise WrongFieldError(f"{type_name} does not take these values: {error}.") from None
        field, value, kind, why = refused
        raise WrongFieldError(
            f"The field `{field}` of {type_name} does not take {value!r}.\n"
            f"Its type is `{kind}`: {why.rstrip('.')}."
        ) from None


def _check_names(
    message: Any, values: Mapping[Any, Any], type_name: str, kind: str, before: str = ""
) -> None:
    """Refuse names that are no fields, also in messages of the message.

    Args:
        message: Whose names are checked.
        values: For it.
        type_name: The type of the whole message.
        kind: The type of this one.
        before: Its place in the whole message, `a.b`; empty: it is the whole.
    """
    known = message.get_fields_and_field_types()
    for name, value in values.items():
        if name not in known:  # YAML has numbers for names, too
            of = f"`{before}` of {type_name}" if before else type_name
            raise WrongFieldError(
                f"{of} has no field `{name}`.\n"
                f"{_blank_after_colon(str(name), known) or ask_for_nearest(str(name), known)}"
                f"Fields of {kind}: {', '.join(known) or 'none'}."
            )
        for place, inner, inner_kind, inner_values in _messages_in(message, name, value):
            where = f"{before}.{place}" if before else place
            _check_names(inner, inner_values, type_name, inner_kind, where)


def _blank_after_colon(name: str, known: Collection[str]) -> str:
    """What to write where YAML has taken `{x:0.5}` for a name without a value."""
    field, colon, value = name.partition(":")
    return f"Write `{field}: {value}`, with a blank. " if colon and field in known else ""


def _refused(
    kind: type, values: Mapping[str, Any], set_fields: Callable[..., Any]
) -> tuple[str, Any, str, str] | None:
    """The first field that does not take its value alone: its place, value, type, and why.

    None: each does.
    """
    for name, value in values.items():
        try:
            set_fields(kind(), {name: value})
        except Exception as error:  # noqa: BLE001, PERF203  as in `fill`
            message: Any = kind()
            for place, inner, _inner_kind, inner_values in _messages_in(message, name, value):
                found = _refused(type(inner), inner_values, set_fields)
                if found is not None:
                    field, refused_value, its_kind, why = found
                    return f"{place}.{field}", refused_value, its_kind, why
            why = next(iter(str(error).splitlines()), "") or type(error).__name__
            return name, value, str(message.get_fields_and_field_types()[name]), why
    return None


def _messages_in(
    message: Any, name: str, value: Any
) -> Iterator[tuple[str, Any, str, Mapping[Any, Any]]]:
    """The messages that a value of a field describes: place, an empty one, its type, its values."""
    kind = str(message.get_fields_and_field_types()[name])
    inner = getattr(message, name)
    if isinstance(value, dict) and hasattr(inner, "get_fields_and_field_types"):
        yield name, inner, kind, value
    elif isinstance(value, list) and isinstance(inner, list):
        of_elements = _class_of_elements(message, name)
        if of_elements is not None:
            element_kind = kind.removeprefix("sequence<").partition(",")[0].partition("[")[0]
            for number, one in enumerate(value):
                if isinstance(one, dict):
                    yield f"{name}[{number}]", of_elements(), element_kind.rstrip(">"), one


def _class_of_elements(message: Any, name: str) -> Any:
    """The class of the messages in a list; None where it has no messages."""
    kinds = dict(zip(message.get_fields_and_field_types(), message.SLOT_TYPES, strict=True))
    kind: Any = getattr(kinds[name], "value_type", None)
    if not hasattr(kind, "namespaces"):
        return None
    return getattr(importlib.import_module(".".join(kind.namespaces)), kind.name)


SEPARATOR = "=" * 80
INTEGERS = frozenset(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64))
PRIMITIVE = {"bool", "byte", "char", "float32", "float64", "string", "wstring", *INTEGERS}
_PART = re.compile(r"^---.*$", re.MULTILINE)  # between goal, result and feedback of an action
_FIELD = re.compile(r"\s*([A-Za-z]\w*(?:/\w+)?(?:/\w+)?)(?:<=\d+)?(?:\[[^\]]*\])?\s+[A-Za-z]")


def definition_of(type_name: str, share_of: Callable[[str], Path]) -> str:
    """The definition of `package/msg/Name`.

    Args:
        type_name: The full name of the message's type.
        share_of: The share folder of a package, by its name.

    Raises:
        LookupError: A package is not installed.
        OSError: It has no such message, or the file cannot be read.
    """
    package, name = _split(type_name, "")
    texts = {(package, name): _read(package, name, share_of)}
    waiting = [(package, name)]
    while waiting:
        package, name = waiting.pop(0)
        for used in _message_types_in(texts[package, name]):
            message = _split(used, package)
            if message not in texts:
                texts[message] = _read(*message, share_of)
                waiting.append(message)
    (_, first), *others = texts.items()
    return "\n".join(
        [first, *(f"{SEPARATOR}\nMSG: {'/'.join(message)}\n{text}" for message, text in others)]
    )


def _message_types_in(text: str) -> Iterator[str]:
    """The types of fields that are messages themselves."""
    for line in text.splitlines():
        found = _FIELD.match(line.partition("#")[0])
        if found and found[1] not in PRIMITIVE:
            yield found[1]


def _split(type_name: str, package: str) -> tuple[str, str]:
    """Package and name; a type without a package is of the package that uses it."""
    first, *_, name = type_name.split("/") if "/" in type_name else (package, type_name)
    return first, name


def _read(package: str, name: str, share_of: Callable[[str], Path]) -> str:
    share = share_of(package)
    action, _, part = name.rpartition("_")
    file = share / "action" / f"{action}.action"
    if part == "FeedbackMessage" and file.is_file():
        return f"unique_identifier_msgs/UUID goal_id\n{package}/{action}_Feedback feedback\n"
    if part == "Feedback" and file.is_file():
        _goal, _result, feedback = _PART.split(file.read_text(encoding="utf-8"))
        return feedback.lstrip()
    return (share / "msg" / f"{name}.msg").read_text(encoding="utf-8")


DEFAULT_WINDOW = 10_000  # messages


class Rates:
    """The times between the messages of one topic, seconds."""

    def __init__(self, window: int = DEFAULT_WINDOW) -> None:
        self._times: deque[float] = deque(maxlen=window)
        self._last: float | None = None
        self._is_new = False

    def take(self, now: float) -> bool:
        """Note a message; False where the time has gone back, and all was forgotten."""
        if self._last is not None and now < self._last:
            self._times.clear()
            self._last = now
            return False
        if self._last is not None:
            self._times.append(now - self._last)
            self._is_new = True
        self._last = now
        return True

    def row(self) -> tuple[str, str, str, str, str] | None:
        """Rate, shortest and longest time, deviation, number; None where nothing is new."""
        if not self._is_new:
            return None
        self._is_new = False
        times = list(self._times)
        mean = sum(times) / len(times)
        deviation = math.sqrt(sum((time - mean) ** 2 for time in times) / len(times))
        return (
            f"{1.0 / mean if mean > 0 else 0.0:.3f}",
            f"{min(times):.3f}",
            f"{max(times):.3f}",
            f"{deviation:.5f}",
            str(len(times)),
        )


HEADER = ("topic", "rate", "min_delta", "max_delta", "std_dev", "window")


def one_topic(row: tuple[str, str, str, str, str]) -> str:
    """The text for a topic that is measured alone."""
    rate, shortest, longest, deviation, window = row
    return (
        f"average rate: {rate}\n\tmin: {shortest}s max: {longest}s std dev: {deviation}s "
        f"window: {window}"
    )


def table(rows: list[tuple[str, ...]]) -> str:
    """The text for several topics, each row with the topic first."""
    widths = [max(map(len, column)) for column in zip(HEADER, *rows, strict=True)]
    lines = [
        "   ".join(text.center(width) for text, width in zip(HEADER, widths, strict=True)),
        "=" * (sum(widths) + 3 * (len(widths) - 1)),
        *(
            "   ".join(text.ljust(width) for text, width in zip(row, widths, strict=True))
            for row in rows
        ),
    ]
    return "\n".join(lines) + "\n"
