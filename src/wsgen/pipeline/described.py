"""A robot description becomes the robot that Gazebo would simulate."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.checks.judge import judge_robot
from wsgen.description.lump import lump
from wsgen.description.mesh_files import inspect_meshes
from wsgen.description.meshes import find_meshes
from wsgen.description.reader import read_urdf
from wsgen.description.solids import build_solids
from wsgen.description.source import place_in_source
from wsgen.diagnostics import has_errors
from wsgen.model.pose import IDENTITY, Pose

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.protocol import Run
    from wsgen.model.robot import Robot

NAMED = 3  # so many robots are told in a line

ShareOf = Callable[[str], Path | None]  # package name -> its installed share folder


@dataclass(frozen=True, kw_only=True)
class Workshop:
    """What it takes to complete a description."""

    share_of: ShareOf
    folder: Path  # for mesh files that are written anew; there until the trial is over
    run: Run  # starts the child process that reads meshes
    with_colours: bool = False  # also read what meshes look like, for a picture


@dataclass(frozen=True, kw_only=True)
class Described:
    """A robot to be spawned, as written and as Gazebo has it."""

    entity: str
    written: Robot
    lumped: Robot
    is_sound: bool = True  # if not, the engine would try another robot than the described one
    spawn_pose: Pose = IDENTITY
    on_the_ground: bool = False  # as low as it can stand, instead of at the height of that pose
    is_scenery: bool = False  # a model of the world around the robots that are tried
    may_move: bool = False  # a thing of a world that is tried: that it rolls or tips is no fault


def describe(  # noqa: PLR0913  most have defaults
    text: str | bytes,
    *,
    file: Path | None,
    workshop: Workshop,
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
        lumped, more = _as_in_gazebo(written, file, workshop)
        found = (*found, *more, *judge_robot(written, file, generation=generation))
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
    return described, place_in_source(found, text=text, file=file, share_of=workshop.share_of)


def _as_in_gazebo(
    written: Robot, file: Path | None, workshop: Workshop
) -> tuple[Robot, tuple[Diagnostic, ...]]:
    """The robot with its meshes, as Gazebo has it."""
    located, missing = find_meshes(
        written, share_of=workshop.share_of, folder=file.parent if file else None, file=file
    )
    readable, flawed = complete(located, file, workshop)
    lumped, dropped = lump(readable, file=file)
    return lumped, (*missing, *flawed, *dropped)


def name_some(described: Sequence[Described]) -> str:
    """The names of the robots that are tried, of many the first few."""
    names = [robot.entity for robot in described if robot.is_sound and not robot.is_scenery]
    others = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + others


def complete(
    robot: Robot, file: Path | None, workshop: Workshop
) -> tuple[Robot, tuple[Diagnostic, ...]]:
    """The robot with shapes and mesh files that every engine reads as Gazebo does."""
    readable, flawed = inspect_meshes(
        robot,
        file=file,
        folder=workshop.folder,
        run=workshop.run,
        with_colours=workshop.with_colours,
    )
    # Afterwards: these are not a person's meshes, whose slips would be looked for.
    built, wrong = build_solids(readable, file=file, folder=workshop.folder, run=workshop.run)
    return built, (*flawed, *wrong)
