"""The rules about the world that a launch file names: whether it is there."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.descriptions.sdf.lookup import EMPTY_WORLDS, gazebo_worlds, world_names
from wsgen.diagnostics import Rule, Severity
from wsgen.launching.explain_missing import (
    absolute_part,
    first_missing,
    first_missing_path,
    glued_package,
    where_written,
)
from wsgen.launching.known_packages import find_in_package, in_python, package_of
from wsgen.text.suggestions import MOST_LISTED, advice

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan
    from wsgen.packages.workspace.overlay import Overlay


MISSING_WORLD = Rule(
    code="WLD001",
    name="missing-world",
    severity=Severity.ERROR,
    summary="The world file that the launch file names does not exist.",
    why="The simulator stops, or starts without the world.",
    example="# launch file\nworld = os.path.join(share, 'worlds', 'office.world')\n\n"
    "# CMakeLists.txt\ninstall(DIRECTORY launch DESTINATION share/${PROJECT_NAME})",
    instead="# CMakeLists.txt\ninstall(DIRECTORY launch worlds DESTINATION share/${PROJECT_NAME})",
)


def missing_world(plan: LaunchPlan, file: Path, overlay: Overlay) -> Diagnostic:
    """Report the path of a world that does not exist, at the line that writes it."""
    absolute = absolute_part(str(file), plan.evaluated_files)
    if absolute is not None:
        return MISSING_WORLD.at(
            Path(absolute.file),
            absolute.line,
            absolute.text,
            message=f"The world file '{file}' does not exist: {absolute.message}",
            hint=absolute.hint,
        )
    glued = glued_package(str(file))
    if glued is not None:
        return MISSING_WORLD.at(
            *_where(plan, str(file), str(file).rpartition(glued)[2]),
            message=f"The world file '{file}' does not exist: '/' is missing after the share "
            f"folder of {glued}.",
            hint=f"Write os.path.join(get_package_share_directory('{glued}'), ...).",
        )
    missing, beside = first_missing(str(file))
    worlds = [name for name in beside if name.endswith((".sdf", ".world"))]
    otherwise = (
        "Add its folder to an install(DIRECTORY ...) rule of CMakeLists.txt, then run "
        "`wsgen build`."
    )
    if missing == file.name:  # its folder is installed
        named = f": {', '.join(sorted(worlds)[:MOST_LISTED])}" if worlds else ""
        otherwise = f"Create and install it, or use an existing world{named}."
    # What is validated does not use the packages that are tried here: no look_up().
    place = find_in_package(str(file), overlay.share)
    return MISSING_WORLD.at(
        *_where(plan, str(file), missing),
        missing,
        message=f"The world file '{file}' does not exist.",
        hint=f"Look it up in the share folder of its package: {in_python(place)}."
        if place
        else advice(
            missing,
            beside,
            otherwise
            if package_of(str(file))
            else "Check the path. A file that a package installs is found on every machine: "
            "get_package_share_directory('PACKAGE').",
        ),
    )


def is_folder_reported(file: Path, diagnostics: Iterable[Diagnostic]) -> bool:
    """Whether an error is about another file in the folder whose lack makes this one missing."""
    missing = first_missing_path(file)
    return missing != file and any(
        found.severity is Severity.ERROR and Path(found.element or "").is_relative_to(missing)
        for found in diagnostics
    )


UNKNOWN_WORLD = Rule(
    code="WLD008",
    name="unknown-world",
    severity=Severity.WARNING,
    summary="The world file is not found here; Gazebo may install it.",
    why="The simulation uses an empty world with a ground plane instead. If Gazebo has no world of "
    "this name either, it stops.",
    example="launch_arguments={'gz_args': 'my_wrold.sdf'}.items()",
    instead="launch_arguments={'gz_args': os.path.join(share, 'worlds', 'my_world.sdf')}.items()",
)


def unknown_world(plan: LaunchPlan, name: str, environment: Mapping[str, str]) -> Diagnostic:
    """Report the name of a world that is not found; Gazebo may have it."""
    return UNKNOWN_WORLD.at(
        *_where(plan, name),
        name,
        message=f"The world file {name} is not found here. Gazebo finds it if it is installed with "
        "Gazebo; the simulation uses a ground plane instead.",
        hint=advice(
            name,
            [*gazebo_worlds(), *world_names(environment)],
            "Use the path of a world file that the package installs.",
        ),
    )


WORLD_NOT_HERE = Rule(
    code="WLD061",
    name="world-not-here",
    severity=Severity.INFO,
    summary="The world belongs to Gazebo, or to a ROS package that is not installed here.",
    why="The simulation of wsgen has only a ground plane: the models of the world are missing.",
    example="launch_arguments={'gz_args': 'shapes.sdf'}.items()",
    instead="launch_arguments={'gz_args': os.path.join(share, 'worlds', 'shapes.sdf')}.items()",
)


def world_not_here(plan: LaunchPlan, name: str) -> Iterator[Diagnostic]:
    """Report a world that only Gazebo or another package has, unless that is empty."""
    if Path(name).name not in EMPTY_WORLDS:
        yield WORLD_NOT_HERE.at(
            *_where(plan, name),
            name,
            message=f"The world {name} is not installed here: the simulation uses a ground plane "
            "instead.",
            hint="No action is needed for Gazebo. To simulate the world here, install the package "
            "that has it.",
        )


def _where(plan: LaunchPlan, *texts: str) -> tuple[Path, int | None]:
    """The launch file and the line that write the first of the texts that one of them writes."""
    found = (where_written(text, plan.evaluated_files) for text in texts)
    written, line = next(filter(None, found), (plan.launch_file, None))
    return Path(written), line
