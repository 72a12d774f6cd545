"""What porting makes of a file: edits in its text, and what they leave to the author."""

from __future__ import annotations

from collections.abc import Iterable  # noqa: TC003  a NamedTuple
from pathlib import Path  # noqa: TC003  a NamedTuple
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from wsgen.checks.fixes.source import Edit


class Unported(NamedTuple):
    """What has no counterpart, or is computed: it stays as it is, or goes, and is listed."""

    file: Path
    line: int  # 1-based
    what: str  # a sentence: what it is, or did
    advice: str  # a sentence: what the author may do
    is_note: bool = False  # robots do what they did without it


class BridgeRow(NamedTuple):
    """A topic that a bridge converts; placeholders (`porter`) stand for names of its robot."""

    gz_topic: str
    gz_type: str  # without `gz.msgs.`
    ros_type: str  # with `/msg/`
    direction: str  # as the bridge writes it: `[` to ROS, `]` to Gazebo
    ros_topic: str  # absolute


class Effort(NamedTuple):
    """How strong a plugin makes the joints of wheels that another file, or a macro, has."""

    joints: frozenset[str]
    torque: str  # N m, as it is written
    left: Unported  # what to list where the joints are not found


class FilePort(NamedTuple):
    """What becomes of a file."""

    edits: tuple[Edit, ...] = ()
    unported: tuple[Unported, ...] = ()
    packages: frozenset[str] = frozenset()  # of ROS, that the file now needs
    systems: frozenset[str] = frozenset()  # of Gazebo Sim, that its world must load (class names)
    files: frozenset[str] = frozenset()  # that the package must now have, below its folder
    worlds: frozenset[str] = frozenset()  # the arguments of a launch file that are worlds
    efforts: tuple[Effort, ...] = ()
    services: frozenset[BridgeRow] = frozenset()  # of worlds, that programs call
    frames: frozenset[str] = frozenset()  # of sensors that named none


def joined(ports: Iterable[FilePort]) -> FilePort:
    """What several parts make of one file."""
    listed = list(ports)
    return FilePort(
        edits=tuple(edit for one in listed for edit in one.edits),
        unported=tuple(found for one in listed for found in one.unported),
        packages=frozenset().union(*(one.packages for one in listed)),
        systems=frozenset().union(*(one.systems for one in listed)),
        files=frozenset().union(*(one.files for one in listed)),
        worlds=frozenset().union(*(one.worlds for one in listed)),
        services=frozenset().union(*(one.services for one in listed)),
        frames=frozenset().union(*(one.frames for one in listed)),
        efforts=tuple(found for one in listed for found in one.efforts),
    )
