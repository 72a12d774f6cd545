"""What a package of ROS 1 has of other robots than the one that is asked for."""

from __future__ import annotations

import re
from fnmatch import fnmatchcase
from pathlib import PurePosixPath
from posixpath import normpath
from typing import TYPE_CHECKING, NamedTuple

from wsgen.porting.existing.launch_port import ENDINGS, is_of_ros_1
from wsgen.porting.ported import Unported
from wsgen.text.markup import read_text, without_comments

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from wsgen.porting.existing.launch_port import Source


_ENDINGS = (".gazebo", ".trans", ".transmission", ".urdf", ".xacro")
_SUBSTITUTED = re.compile(r"\$\([^()]*\)|\$\{[^{}]*\}")
_INCLUDED = re.compile(r"<xacro:include\s[^>]*?filename\s*=\s*[\"']([^\"']+)[\"']")
_SHOWN = 8


class OtherRobots(NamedTuple):
    """Files that are not for the robot."""

    paths: frozenset[str]
    notes: tuple[Unported, ...]


def find_other_robots(source: Source, files: Iterable[str]) -> OtherRobots:
    """Which of the installed files are of other robots: descriptions, and what starts only these.

    A launch file is of the robot if it names its description, or no description of the package;
    with it, all that it names. Descriptions that nothing names are of others, too.
    """
    if not source.robot:
        return OtherRobots(frozenset(), ())
    texts = {path: without_comments(read_text(source.folder / path) or "") for path in _read(files)}
    robots = {one for one, text in texts.items() if one.endswith(_ENDINGS) and "<robot" in text}
    launch = {path for path, text in texts.items() if path not in robots and is_of_ros_1(text)}
    named = {path: _named(path, text, source, texts.keys()) for path, text in texts.items()}
    own = {one for one in robots if one == source.robot or _stem(one) == _stem(source.robot)}
    kept, left = set[str](), dict[str, str]()
    for path in sorted(launch):
        all_named = _closure({path}, named)
        started = {robot for one in all_named & launch for robot in named[one] & robots}
        if started and not own & all_named:
            left[path] = min(started)
        else:
            kept |= all_named
    kept |= source.moved.keys()
    parts = _closure({source.robot}, named)
    left = {path: robot for path, robot in left.items() if path not in kept}
    others = sorted(robots - kept - parts)
    notes = [
        Unported(
            source.folder / path,
            1,
            f"The launch file is for another robot, {robot}.",
            f"Make a package of that one, too: wsgen new NAME --from {source.folder / robot}",
        )
        for path, robot in left.items()
    ]
    if others:
        more = f" and {len(others) - _SHOWN} more" if len(others) > _SHOWN else ""
        what = f"Other descriptions are not of this robot: {', '.join(others[:_SHOWN])}{more}."
        advice = "Make packages of them by wsgen new, or copy what you need."
        notes.append(Unported(source.folder / source.robot, 1, what, advice))
    return OtherRobots(frozenset({*left, *(robots - kept)}), tuple(notes))


def _read(files: Iterable[str]) -> list[str]:
    return [one for one in files if one.endswith((*_ENDINGS, *ENDINGS))]


def _stem(path: str) -> str:
    """The path of a description without its suffixes: a URDF may be what a xacro file became."""
    return path.removesuffix(".xacro").removesuffix(".urdf")


def _named(path: str, text: str, source: Source, files: Iterable[str]) -> set[str]:
    """The files that a launch file or a description names; of computed names, the robot's."""
    own = rf"(?:\$\(find\s+{re.escape(source.old)}\s*\)|package://{re.escape(source.old)})/+"
    names = {normpath(one) for one in re.findall(rf"{own}([^\s\"'<>,;]+)", text)}
    folder = PurePosixPath(path).parent
    names |= {normpath(str(folder / one)) for one in _INCLUDED.findall(text) if "$" not in one}
    names |= {
        source.robot
        for one in names
        if "$" in one and fnmatchcase(source.robot, _SUBSTITUTED.sub("*", one))
    }
    return names & {*files}


def _closure(start: set[str], named: Mapping[str, set[str]]) -> set[str]:
    """What is named by these files, and by those that they name; and they themselves."""
    found, waiting = set[str](), [*start]
    while waiting:
        path = waiting.pop()
        if path not in found:
            found.add(path)
            waiting += named.get(path, ())
    return found
