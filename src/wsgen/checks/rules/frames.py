"""The rules about frames that configurations of RViz, Nav2 and others name."""

from __future__ import annotations

import itertools
import re
from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.launching.commands import started_programs
from wsgen.text.suggestions import did_you_mean, nearest
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan
    from wsgen.model.robot import Robot


UNPUBLISHED_FRAME = Rule(
    code="LCH085",
    name="unpublished-frame",
    severity=Severity.WARNING,
    summary="A configuration names a frame that looks like a misspelled link of the robot.",
    what="Compares the fixed frame of RViz, and the base frames of Nav2, localization, SLAM and "
    "controllers, with the links of the robots of the package. Frames that something may publish, "
    "such as `odom`, are not reported.",
    why="The frame has no transform: RViz shows an error instead of the robot, and Nav2 waits "
    "forever.",
    example="# the robot has the link `base_link`\namcl:\n  ros__parameters:\n"
    "    base_frame_id: baselink",
    instead="amcl:\n  ros__parameters:\n    base_frame_id: base_link",
)

_PARAMETER = lazy_pattern(
    r"^[ \t]*-?[ \t]*(robot_base_frame|base_frame_id|base_frame|base_link_frame)[ \t]*:[ \t]*"
    r"([\"']?)/?([A-Za-z_][\w-]*)\2[ \t]*(?:#.*)?\r?$",
    re.MULTILINE,
)
_FIXED_FRAME = lazy_pattern(
    r"^[ \t]*(Fixed Frame)[ \t]*:[ \t]*([\"']?)/?([A-Za-z_][\w-]*)\2[ \t]*\r?$", re.MULTILINE
)
_CONVENTIONAL = frozenset(("base_link", "base_footprint"))  # as ROS calls the base of a robot
SURELY = 0.8  # so alike two names are, as difflib counts, that one is the other misspelled
_OF_FRAME = lazy_pattern(r"(?:^|_)frame(?:_|$)|[fF]rame")


def known_frames(robots: Iterable[Robot], plans: Iterable[LaunchPlan]) -> frozenset[str] | None:
    """The links of robots, and the frames that their plugins and launch files publish.

    None where the frames have a prefix, or nothing is known of them.
    """
    frames: set[str] = set()
    for robot in robots:
        frames.update(link.name for link in robot.links)
        for tag in robot.gazebo:
            frames.update(tag.frames)
            values = (texts for plugin in tag.plugins for texts in plugin.values.values())
            frames.update(text.strip("/") for texts in values for text in texts)
    if not frames:
        return None
    for plan in plans:
        for node in started_programs(plan):
            if node.parameters.get("frame_prefix"):
                return None
            if node.executable == "static_transform_publisher":
                frames.update(node.arguments)
            # What a node is to publish exists.
            frames.update(
                str(value).strip("/")
                for name, value in node.parameters.items()
                if _OF_FRAME.search(name) and not _PARAMETER.match(f"{name}: x")
            )
    return frozenset(frames)


def frames_without_links(
    file: Path, text: str, links: Collection[str], known: Collection[str]
) -> Iterator[Diagnostic]:
    """Report the base frames and the fixed frame of a file that no link has.

    Args:
        file: A configuration of RViz, or a file of parameters.
        text: Its content.
        links: Those of the robots.
        known: All frames that are known, these among them.
    """
    is_rviz = file.suffix == ".rviz"
    for found in (_FIXED_FRAME if is_rviz else _PARAMETER).finditer(text):
        frame = found[3]
        if frame in known:
            continue
        near = nearest(frame, links, cutoff=SURELY)
        if near is None and is_rviz and frame in _CONVENTIONAL:
            near = next(iter(sorted(_CONVENTIONAL & set(links))), None)
        if near is not None:
            yield UNPUBLISHED_FRAME.at(
                file,
                text.count("\n", 0, found.start(3)) + 1,
                found[1],
                message=f"`{found[1]}` names the link `{frame}`, which the robot does not have.",
                hint=did_you_mean(near),
            )


def links_of(robots: Iterable[Robot]) -> frozenset[str]:
    """The names of all links of robots."""
    names = ([link.name for link in robot.links] for robot in robots)
    return frozenset(itertools.chain.from_iterable(names))
