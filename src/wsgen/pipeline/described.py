"""A robot description becomes the robot that Gazebo would simulate."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.checks.judge import judge_robot
from wsgen.description.lump import lump
from wsgen.description.mesh_files import inspect_meshes
from wsgen.description.meshes import find_meshes
from wsgen.description.reader import MISSPELT, read_urdf
from wsgen.description.solids import build_solids
from wsgen.description.source import place_in_source
from wsgen.description.spelling import meant_element
from wsgen.diagnostics import Severity, has_errors
from wsgen.model.pose import IDENTITY, Pose

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.protocol import Run
    from wsgen.model.plan import SpawnHeight
    from wsgen.model.robot import Robot

REFUSED_BY_GAZEBO_SIM = frozenset(("ROB034",))  # and perhaps not by Gazebo Classic
OLD_SDFORMAT = frozenset(("ROB079", "ROB080"))  # what only its older versions do
FORTRESS = frozenset(("humble", "iron"))  # distributions with a Gazebo Sim that may have such
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
    height: SpawnHeight | None = None  # where a launch file gives that of the spawn pose
    on_the_ground: bool = False  # as low as it can stand, instead of at the height of that pose
    is_scenery: bool = False  # a model of the world around the robots that are tried
    may_move: bool = False  # a thing of a world that is tried: that it rolls or tips is no fault
    diagnostics: tuple[Diagnostic, ...] = ()  # about its description, as they have been reported


def describe(  # noqa: PLR0913  most have defaults
    text: str | bytes,
    *,
    file: Path | None,
    workshop: Workshop,
    entity: str | None = None,
    spawn_pose: Pose = IDENTITY,
    on_the_ground: bool = False,
    generation: str | None = None,
    distro: str | None = None,
) -> tuple[Described | None, tuple[Diagnostic, ...]]:
    """Read, complete and lump the robot of a URDF text; None where there is no robot to try.

    `file` is what the text comes from or was expanded from, and what the diagnostics name, with
    places in what a person edits; bytes are those of the file itself. The robot is called
    `entity`, or as its description calls it, and is for the simulator of that `generation` in that
    ROS 2 distribution, where they are known.
    """
    written, found = read_urdf(text, file=file)
    described = None
    if written is not None:
        lumped, more = _as_in_gazebo(written, file, workshop)
        found, more = _at_the_misspelling(found, more)
        judged = judge_robot(written, file, generation=generation)
        found = _first_of_each_inertial((*found, *more, *judged))
        found = tuple(_for_simulator(found, generation, distro))
        described = Described(
            entity=entity or written.name,
            written=written,
            lumped=lumped,
            is_sound=not has_errors(found),
            spawn_pose=spawn_pose,
            on_the_ground=on_the_ground,
        )
    if not isinstance(text, bytes):  # those are of the file itself, where every line is its own
        found = place_in_source(found, text=text, file=file, share_of=workshop.share_of)
    return described and replace(described, diagnostics=found), found


def _at_the_misspelling(
    found: Sequence[Diagnostic], more: Iterable[Diagnostic]
) -> tuple[tuple[Diagnostic, ...], tuple[Diagnostic, ...]]:
    """Both, with what Gazebo refuses for a misspelt <inertial> told as an error about that."""
    told, left = list(found), []
    for error in more:
        places = (
            place
            for place, cause in enumerate(told)
            if error.severity is Severity.ERROR
            and cause.code in MISSPELT
            and _is_in_inertial(cause.element or "", error.element or "")
        )
        place = next(places, None)
        if place is None:
            left.append(error)
        else:
            cause = told[place]
            what = cause.message.partition(": ")[0]
            message = f"{what}: {error.message}"
            told[place] = replace(cause, severity=Severity.ERROR, message=message)
    return tuple(told), tuple(left)


def _is_in_inertial(element: str, link: str) -> bool:
    """Whether the path of an element is one in what is, or must be, the <inertial> of a link."""
    tag = element.removeprefix(f"{link}/").partition("/")[0] if link else element
    return tag != element and meant_element(tag, ("inertial",)) is not None


def _for_simulator(
    diagnostics: Iterable[Diagnostic], generation: str | None, distro: str | None
) -> Iterator[Diagnostic]:
    """The findings as they hold for a simulator: what it refuses is an error."""
    has_old_sdformat = generation != "gz" or distro in {None, *FORTRESS}
    for found in diagnostics:
        if generation == "gz" and found.code in REFUSED_BY_GAZEBO_SIM:
            yield replace(found, severity=Severity.ERROR)
        elif has_old_sdformat or found.code not in OLD_SDFORMAT:
            yield found


def _first_of_each_inertial(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """One finding about each <inertial>: those behind it come from the same numbers."""
    kept: list[Diagnostic] = []
    told: set[str] = set()
    for found in diagnostics:
        link, inertial, _ = (found.element or "").partition("/inertial")
        if not inertial or link not in told:
            kept.append(found)
        told |= {link} if inertial else set()
    return tuple(kept)


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
