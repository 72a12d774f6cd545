"""The robot of a package, as its file describes it."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from wsgen.checks.rules.entities import lowest_point
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.descriptions.xacro.reader import expand_file
from wsgen.errors import NotFoundError, RequestError
from wsgen.isolation.parent import make_scratch
from wsgen.model.transform import IDENTITY
from wsgen.packages.source_shares import serve_sources
from wsgen.packages.workspace.layout import BUILD_MARKERS
from wsgen.packages.workspace.robot_files import find_robot_files
from wsgen.text.files import list_files, read_or_empty
from wsgen.text.suggestions import ask_for_nearest

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.robot import Robot
    from wsgen.porting.adding.addition import Addition

_CLEARANCE = 0.005  # m, so that nothing touches the ground


def required_file(addition: Addition, given: str) -> Path:
    """A file of the package that is given by its path below it.

    Raises:
        NotFoundError: It does not exist.
    """
    file = addition.folder / given
    if not file.is_file():
        known = [
            one.relative_to(addition.folder).as_posix()
            for one in list_files(addition.folder, (file.suffix,), markers=BUILD_MARKERS)
        ]
        raise NotFoundError(
            f"{file} does not exist.",
            hint=f"{ask_for_nearest(given, known)}Give the path of a file below {addition.folder}.",
        )
    return file


def robot_file(addition: Addition, given: str | None) -> Path:
    """The file of the robot that is meant: a whole one, which no other file includes.

    Raises:
        NotFoundError: It does not exist.
        RequestError: Several may be meant.
    """
    if given is not None:
        return required_file(addition, given)
    robots = find_robot_files(addition.folder)
    if not robots:
        raise NotFoundError(
            f"{addition.name} has no robot: no .urdf or .xacro with <robot name=…> is in it.",
            hint="Name one with --robot FILE, or the package that has it with --to.",
        )
    if len(robots) > 1:
        names = [one.relative_to(addition.folder).as_posix() for one in robots]
        raise RequestError(
            f"{addition.name} has several robots.",
            hint=f"Choose one: --robot {' | '.join(names[:6])}",
        )
    return robots[0]


def read_robot(addition: Addition, file: Path) -> tuple[str, Robot | None]:
    """The text of a robot, expanded if it is xacro, and what it describes; None if it fails."""
    with make_scratch(in_memory=True) as scratch:
        sources = {one.name: one.path for one in addition.workspace.values()}
        environment = serve_sources(sources, scratch, os.environ)
        text = read_or_empty(file)
        if file.suffix != ".urdf" or "xacro" in text:
            text = expand_file(file, {}, environment=environment)[0] or ""
    return text, read_urdf(text, file=file)[0] if text else None


def spawn_height(addition: Addition, file: Path) -> str:
    """How high a robot is spawned so that its lowest part does not touch the ground; m."""
    _, robot = read_robot(addition, file)
    lowest = None if robot is None else lowest_point(lump(robot)[0], IDENTITY)
    height = 0.0 if lowest is None else max(0.0, _CLEARANCE - lowest)
    return f"{height:.3f}".rstrip("0").ljust(3, "0")


def bridge_files(addition: Addition) -> list[Path]:
    """The files with the topics of a bridge."""
    files = list_files(addition.folder, (".yaml", ".yml"), markers=BUILD_MARKERS)
    return sorted(one for one in files if "gz_topic_name" in read_or_empty(one))
