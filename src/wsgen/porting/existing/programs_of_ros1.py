"""The command lines of programs of ROS 1, as those of ROS 2 take them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.porting.existing.launch_values import UnsaidError
from wsgen.porting.existing.parameters_of_ros1 import files_in
from wsgen.ros import ros1
from wsgen.text.markup import read_text
from wsgen.text.pythontree import parse as parse_python
from wsgen.text.yamlfile import NotYaml, parse

if TYPE_CHECKING:
    from pathlib import Path

# Without a value, of spawn_model (gazebo_ros).
_FLAGS = frozenset(
    ("urdf", "sdf", "gazebo", "stdin", "unpause", "wait_for_model", "package_to_model", "b")
)
_OF_ROS_1 = re.compile(r"(?m)^\s*(?:import|from)\s+(?:rospy|roslib|actionlib|tf)\b")
_PYTHON = re.compile(r"#!.*\bpython")
_ANGLES = ("--yaw", "--pitch", "--roll")
_QUATERNION = ("--qx", "--qy", "--qz", "--qw")
_PERIOD = 1  # argument: how often tf's static_transform_publisher sends


def written_for_ros_1(folder: Path, program: str) -> str | None:
    """Why a program of a package does not run in ROS 2; None where it may."""
    found = next((one for one in files_in(folder) if one.rpartition("/")[2] == program), None)
    text = None if found is None else read_text(folder / found)
    if text is None:
        return "is compiled from code for ROS 1, or is not there"
    imported = _OF_ROS_1.search(text)
    if imported is not None:
        line = text.count("\n", 0, imported.end()) + 1
        return f"is written for ROS 1 ({found}:{line})"
    if program.endswith(".py") or _PYTHON.match(text) is not None:
        try:
            parse_python(text.encode())
        except SyntaxError as error:
            return f"is not written for Python 3 ({found}:{error.lineno})"
        except (ValueError, RecursionError, MemoryError):
            pass  # who starts it is told
    return None


def spawn_options(words: list[str]) -> dict[str, list[str]]:
    """The options of spawn_model with their values; `-J` has a joint and a position each time."""
    options: dict[str, list[str]] = {}
    pending = list(words)
    while pending:
        word, has_value, value = pending.pop(0).partition("=")
        name = word.lstrip("-")
        if name == word:
            continue
        if not has_value and name not in _FLAGS and pending:
            value = pending.pop(0)
        options.setdefault(name, []).append(value)
        if name == "J" and pending:
            pending.pop(0)
    return options


def transform_arguments(words: list[str], *, is_of_tf: bool) -> list[str]:
    """The arguments of static_transform_publisher, which have names in ROS 2.

    Raises:
        UnsaidError: Their number does not say what they are.
    """
    counts = {3 + len(_ANGLES) + 2: _ANGLES, 3 + len(_QUATERNION) + 2: _QUATERNION}
    count = len(words) - (_PERIOD if is_of_tf and len(words) > min(counts) else 0)
    if count not in counts:
        raise UnsaidError(
            f"static_transform_publisher has {len(words)} arguments: what each of them is, is not "
            "known.",
            "Write them with their names: --x, --y, --z, --yaw, --pitch, --roll, --frame-id and "
            "--child-frame-id.",
        )
    names = ("--x", "--y", "--z", *counts[count], "--frame-id", "--child-frame-id")
    return [
        text
        for name, word in zip(names, words, strict=False)
        for text in (name, word.lstrip("/") if name.endswith("-id") else word)
    ]


def topic_command(words: list[str]) -> list[str] | None:
    """The words of `ros2 topic` for those of rostopic; None where they are not surely the same."""
    if words[:1] in (["echo"], ["hz"], ["bw"]):
        return ["topic", *words] if len(words) == 2 else None  # noqa: PLR2004  with a topic
    options, rest = list[str](), list[str]()
    # rostopic stays, so that a node which comes later gets the message.
    how = ["--times", "1", "--wait-matching-subscriptions", "0"]
    how += ["--qos-durability", "transient_local", "--keep-alive", "1000000"]
    pending = words[1:] if words[:1] == ["pub"] else ["-"]
    while pending:
        word = pending.pop(0)
        if word in {"-r", "--rate"} and pending:
            how = ["--rate", pending.pop(0)]
        elif word in {"-1", "--once"}:
            how = ["--once"]
        elif word.startswith("-") and not re.match(r"-[\d.]", word):
            options.append(word)
        else:
            rest.append(word)
    if {*options} - {"-l", "--latch", "--"} or len(rest) not in {2, 3}:
        return None
    package, separator, name = rest[1].partition("/")
    value = _message(package, name, rest[2] if len(rest) > 2 else "{}")  # noqa: PLR2004
    if value is None or not separator:
        return None
    return ["topic", "pub", *how, rest[0], f"{package}/msg/{name}", value]


def _message(package: str, name: str, text: str) -> str | None:
    """A message as YAML; rostopic also takes the values of its fields in their order."""
    value = parse(text)
    if value is None or isinstance(value, NotYaml):
        return None
    if isinstance(value.content, dict):
        return text
    is_single = package == "std_msgs" and name in ros1.DATA_MESSAGES
    return f"{{data: {text}}}" if is_single and not isinstance(value.content, list) else None
