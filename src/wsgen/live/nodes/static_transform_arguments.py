"""The command line of static_transform_publisher, in its new and its old style.

What is accepted and refused, in which words, is that of geometry2's
tf2_ros/src/static_transform_broadcaster_program.cpp.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.model.transform import quaternion_of_rpy

if TYPE_CHECKING:
    from collections.abc import Sequence

NUMBERS = ("x", "y", "z", "qx", "qy", "qz", "qw", "roll", "pitch", "yaw")
FRAMES = ("frame-id", "child-frame-id")
# What C++'s std::stod reads: a number at the beginning, whatever follows.
NUMBER = re.compile(r"\s*[+-]?(?:(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?|inf|nan)", re.IGNORECASE)

USAGE = """\
usage: static_transform_publisher [--x X] [--y Y] [--z Z] [--qx QX] [--qy QY] [--qz QZ] [--qw QW] \
[--roll ROLL] [--pitch PITCH] [--yaw YAW] --frame-id FRAME_ID --child-frame-id CHILD_FRAME_ID

Publishes a transform that holds at all times; without options it is the identity.

  --frame-id FRAME_ID              the parent frame (required)
  --child-frame-id CHILD_FRAME_ID  the child frame (required)
  --x X, --y Y, --z Z              translation, in meters
  --roll, --pitch, --yaw           rotation, in radians about fixed axes
  --qx, --qy, --qz, --qw           or rotation as a quaternion
"""


class StaticTransform(NamedTuple):
    """What is to be published."""

    frame: str
    child: str
    xyz: tuple[float, float, float]  # m
    xyzw: tuple[float, float, float, float]


class ArgumentsError(Exception):
    """The arguments are wrong; the message is that of the original."""


OLD_STYLE_WARNING = "Old-style arguments are deprecated; see --help for new-style arguments"


def parse_arguments(arguments: Sequence[str]) -> tuple[StaticTransform | None, bool]:
    """The transform that arguments (without the program) name, and whether they are old-style.

    The transform is None where they ask for help.

    Raises:
        ArgumentsError: They are wrong.
    """
    options, rest = _split(arguments)
    if "help" in options:
        return None, False
    turns = [name for name in ("roll", "pitch", "yaw") if name in options]
    quaternion = [name for name in ("qx", "qy", "qz", "qw") if name in options]
    if turns and quaternion:
        raise ArgumentsError("Cannot specify both quaternion and Euler rotations")
    is_old = len(rest) in {8, 9}
    if is_old:
        if set(options) - {"roll", "pitch", "yaw"}:
            raise ArgumentsError("Cannot specify both new-style (flags) and old-style (arguments)")
        names = NUMBERS[:3] + (("yaw", "pitch", "roll") if len(rest) == 8 else NUMBERS[3:7])  # noqa: PLR2004
        options = dict(zip((*names, *FRAMES), rest, strict=True))
        turns = ["yaw"] if len(rest) == 8 else []  # noqa: PLR2004
    elif rest:
        raise ArgumentsError("Extra unparsed arguments on command-line")
    values = {name: _number(name, options[name]) for name in NUMBERS if name in options}
    for name, words in zip(FRAMES, ("Frame id", "Child frame id"), strict=True):
        if not options.get(name):
            raise ArgumentsError(f"{words} must not be empty")
    x, y, z, roll, pitch, yaw, qx, qy, qz = (
        values.get(name, 0.0) for name in ("x", "y", "z", "roll", "pitch", "yaw", "qx", "qy", "qz")
    )
    return StaticTransform(
        frame=options["frame-id"],
        child=options["child-frame-id"],
        xyz=(x, y, z),
        xyzw=quaternion_of_rpy((roll, pitch, yaw))
        if turns
        else (qx, qy, qz, values.get("qw", 1.0)),
    ), is_old


def _split(arguments: Sequence[str]) -> tuple[dict[str, str], list[str]]:
    """The options by name, and what is none."""
    options: dict[str, str] = {}
    rest: list[str] = []
    words = iter(arguments)
    for word in words:
        name = word.removeprefix("--")
        if word in {"-h", "--help"}:
            options["help"] = ""
        elif word.startswith("--") and name in (*NUMBERS, *FRAMES):
            value = next(words, None)
            if value is None:
                raise ArgumentsError(f"Not enough arguments for {word}")
            if name in NUMBERS:
                _number(word, value)
            options[name] = value
        else:
            rest.append(word)
    return options, rest


def _number(name: str, text: str) -> float:
    found = NUMBER.match(text)
    if found is None:
        raise ArgumentsError(f"Failed to parse {name} argument as float")
    return float(found[0])
