"""What people allow a package to do against a rule: in `wsgen.toml`, or in a comment on the line.

    <link name="tip"/>  <!-- wsgen: allow no-visual: a frame for the gripper -->
    # wsgen: allow unused-launch-argument, LCH034: read by a launch file of the customer

A comment alone on its line is about the line below it.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.text.files import read_regular
from wsgen.text.values import dataclass, lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator


SIZE_LIMIT = 2**20  # bytes; files in which people write comments are smaller
SUFFIXES = (
    *(".py", ".xml", ".yaml", ".yml", ".launch", ".urdf", ".xacro", ".gazebo", ".srdf"),
    *(".sdf", ".world", ".txt", ".cmake", ".cfg", ".toml", ".rviz"),
)
MARK = b"wsgen:"
COMMENT = lazy_pattern(
    r"(?:#|<!--)[ \t]*wsgen:[ \t]*allow[ \t]+(?P<rules>[\w-]+(?:[ \t]*,[ \t]*[\w-]+)*)"
    r"[ \t]*(?::[ \t]*(?P<reason>(?:(?!-->)[^\n])*))?",
)


@dataclass(frozen=True, kw_only=True)
class Allowance:
    """A rule that may be broken, with the reason."""

    rule: str  # name or code, as it is written
    reason: str  # empty: none is given
    file: Path  # where it is written
    line: int | None = None  # 1-based
    patterns: tuple[str, ...] = ()  # of the files in the package that it holds for; none: all
    lines: tuple[int, int] | None = None  # of `file`, first and last; None: it is no comment


def find_reason(value: Any) -> str | None:
    """The reason that a value of [check.allow] gives; None if it is neither a text nor a table."""
    if isinstance(value, dict):
        value = value.get("reason", "") if value.keys() <= {"reason", "files"} else None
    return value.strip() if isinstance(value, str) else None


def find_comments(folder: Path) -> Iterator[Allowance]:
    """The comments in all files of a package."""
    for place, folders, files in os.walk(folder):
        folders[:] = sorted(one for one in folders if not one.startswith("."))
        for name in sorted(files):
            if name.endswith(SUFFIXES):
                yield from read_comments(Path(place, name))


def read_comments(file: Path) -> tuple[Allowance, ...]:
    """The comments of a file that allow something; none if it cannot be read."""
    try:
        data = read_regular(file, SIZE_LIMIT)
    except (OSError, ValueError):
        return ()
    if MARK not in data or len(data) > SIZE_LIMIT:
        return ()
    return tuple(comments_in(data.decode("utf-8", "replace"), file))


def comments_in(text: str, file: Path) -> Iterable[Allowance]:
    """The comments of a text that allow something."""
    for found in COMMENT.finditer(text):
        line = text.count("\n", 0, found.start()) + 1
        for rule in found["rules"].split(","):
            yield Allowance(
                rule=rule.strip(),
                reason=(found["reason"] or "").strip(),
                file=file,
                line=line,
                lines=_lines_of(text, found, line),
            )


def _lines_of(text: str, comment: re.Match[str], line: int) -> tuple[int, int]:
    """The lines that a comment is about: a tag of XML has all of its lines."""
    begin = text.rfind("\n", 0, comment.start()) + 1
    before = text[begin : comment.start()].rstrip()
    if before:
        tag = text.rfind("<", 0, begin + len(before)) if before.endswith(">") else -1
        first = text.count("\n", 0, tag) + 1 if tag >= 0 else line
        return first, line
    stop = text.find("\n", comment.end())
    after = text[comment.end() : stop if stop >= 0 else len(text)].partition("-->")[2]
    if after.strip():
        return line, line
    rest = text[stop + 1 :] if stop >= 0 else ""
    following = re.match(r"(?:[ \t]*(?:#|<!--)[ \t]*wsgen:[^\n]*\n|[ \t\r]*\n)*", rest)
    skipped = following[0].count("\n") if following else 0
    rest = rest[following.end() :] if following else rest
    tag_lines = 0
    if rest.lstrip().startswith("<") and not rest.lstrip().startswith("<!--"):
        tag_lines = rest[: max(rest.find(">"), 0)].count("\n")
    first = line + 1 + skipped
    return first, first + tag_lines
