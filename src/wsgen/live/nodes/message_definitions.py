"""The definition of a message with those of all messages in it, as one text.

Files with recorded messages have it beside them, so that programs without ROS can read them. The
format is that of rosbag2 and of MCAP's encoding `ros2msg`: the text of the .msg file, then for each
message in it a line of `=`, a line `MSG: package/Name` and its text.
Source: https://mcap.dev/spec/registry, "ros2msg".

Of an action, the feedback is on a topic. Its messages have no file: they are made of the .action
file (ros2/rosidl, rosidl_parser/rosidl_parser/definition.py, class Action).
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path


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
        for used in _messages_in(texts[package, name]):
            message = _split(used, package)
            if message not in texts:
                texts[message] = _read(*message, share_of)
                waiting.append(message)
    (_, first), *others = texts.items()
    return "\n".join(
        [first, *(f"{SEPARATOR}\nMSG: {'/'.join(message)}\n{text}" for message, text in others)]
    )


def _messages_in(text: str) -> Iterator[str]:
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
