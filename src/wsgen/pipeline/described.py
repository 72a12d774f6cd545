"""A robot description becomes the robot that Gazebo would simulate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.checks.judge import judge_robot
from wsgen.description.lump import lump
from wsgen.description.meshes import find_meshes
from wsgen.description.reader import read_urdf
from wsgen.description.source import place_in_source
from wsgen.diagnostics import has_errors
from wsgen.model.pose import IDENTITY, Pose

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Robot

ShareOf = Callable[[str], Path | None]  # package name -> its installed share folder


@dataclass(frozen=True, kw_only=True)
class Described:
    """A robot to be spawned, as written and as Gazebo has it."""

    entity: str
    written: Robot
    lumped: Robot
    is_sound: bool = True  # if not, the engine would try another robot than the described one
    spawn_pose: Pose = IDENTITY
    on_the_ground: bool = False  # as low as it can stand, instead of at the height of that pose


def describe(  # noqa: PLR0913  most have defaults
    text: str | bytes,
    *,
    file: Path | None,
    share_of: ShareOf,
    entity: str | None = None,
    spawn_pose: Pose = IDENTITY,
    on_the_ground: bool = False,
    generation: str | None = None,
) -> tuple[Described | None, tuple[Diagnostic, ...]]:
    """Read, complete and lump the robot of a URDF text; None where there is no robot to try.

    `file` is what the text comes from or was expanded from, and what the diagnostics name, with
    places in what a person edits; bytes are those of the file itself. The robot is called
    `entity`, or as its description calls it, and is for the simulator of that `generation`.
    """
    written, found = read_urdf(text, file=file)
    described = None
    if written is not None:
        located, missing = find_meshes(
            written, share_of=share_of, folder=file.parent if file else None, file=file
        )
        lumped, dropped = lump(located, file=file)
        found = (*found, *missing, *dropped, *judge_robot(written, file, generation=generation))
        described = Described(
            entity=entity or written.name,
            written=written,
            lumped=lumped,
            is_sound=not has_errors(found),
            spawn_pose=spawn_pose,
            on_the_ground=on_the_ground,
        )
    if isinstance(text, bytes):  # of the file itself, where every line is its own
        return described, found
    return described, place_in_source(found, text=text, file=file, share_of=share_of)
