"""A launch file: for RViz, for the simulator, or one that includes others."""

from __future__ import annotations

import re
from collections.abc import Sequence  # noqa: TC003  a NamedTuple
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.manifests import top_of
from wsgen.errors import NotFoundError, RequestError
from wsgen.model.target import CLASSIC
from wsgen.packages.workspace.layout import BUILD_MARKERS, LAUNCH_FILES
from wsgen.porting.adding.addition import MANIFEST
from wsgen.porting.adding.installing import share
from wsgen.porting.adding.robots import (
    bridge_files,
    read_robot,
    required_file,
    robot_file,
    spawn_height,
)
from wsgen.porting.adding.types import check_name
from wsgen.porting.adding.worlds import add_world, worlds_of
from wsgen.porting.manifests import search_models
from wsgen.text.files import list_files
from wsgen.text.suggestions import ask_for_nearest

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.porting.adding.addition import Addition

RVIZ, SIMULATOR = "rviz", "simulator"


class LaunchOptions(NamedTuple):
    """What is asked for."""

    purpose: str | None = None  # RVIZ or SIMULATOR; None: it includes others
    includes: Sequence[str] = ()  # [PACKAGE/]FILE
    robot: str | None = None  # a file of the package; None: the only one
    world: str | None = None


def add_launch(addition: Addition, name: str, options: LaunchOptions) -> None:
    """Add a launch file.

    Raises:
        RequestError: A name cannot be, or it is not clear which robot is meant.
        NotFoundError: A file or package does not exist.
    """
    stem = name.removesuffix(".py").removesuffix(".launch")
    check_name("launch file", stem)
    path = f"launch/{stem}.launch.py"
    if (options.purpose is None) == (not options.includes):
        raise RequestError(
            "It is not said what the launch file is for.",
            hint="Give one of --rviz, --simulator and --include [PACKAGE/]FILE.",
        )
    if options.includes:
        included = [_included(addition, one) for one in options.includes]
        file = addition.create(path, "include.launch.py", included=included)
        packages = ["launch", "launch_ros", *(package for _, package, _ in included)]
    else:
        robot = robot_file(addition, options.robot)
        share(addition, robot)
        packages = ["launch", "launch_ros", "robot_state_publisher", "xacro"]
        if options.purpose == RVIZ:
            file = _for_rviz(addition, path, robot)
            packages += ["joint_state_publisher_gui", "rviz2"]
        else:
            _find_models(addition, robot)
            file = _for_simulator(addition, path, robot, options.world)
            programs = addition.target.programs
            packages += [programs["package"], *filter(None, [programs.get("bridge_package")])]
    addition.depend("exec_depend", *packages)
    share(addition, file, "*launch.[pxy][yma]*")


def _parts(addition: Addition, file: Path) -> str:
    """The path of a file as arguments of PathJoinSubstitution."""
    return ", ".join(f"'{part}'" for part in file.relative_to(addition.folder).parts)


def _for_rviz(addition: Addition, path: str, robot: Path) -> Path:
    settings = sorted(list_files(addition.folder, (".rviz",), markers=BUILD_MARKERS))
    for one in settings[:1]:
        share(addition, one)
    return addition.create(
        path,
        "rviz.launch.py",
        model=_parts(addition, robot),
        settings=_parts(addition, settings[0]) if settings else "",
    )


def _find_models(addition: Addition, robot: Path) -> None:
    """Have Gazebo find meshes by `package://` and `model://`."""
    text, _ = read_robot(addition, robot)
    if re.search(rf"(?:package|model)://{re.escape(addition.name)}/", text):
        manifest = addition.require(addition.folder / MANIFEST)
        addition.edit(manifest.file, search_models(manifest, top_of(manifest)[1]))


def _for_simulator(addition: Addition, path: str, robot: Path, given: str | None) -> Path:
    worlds = [required_file(addition, given)] if given else worlds_of(addition)
    world = worlds[0] if worlds else add_world(addition, "empty_world")
    share(addition, world)
    bridge = bridge_files(addition)
    if addition.target.simulator != CLASSIC:
        rows = bridge[0] if bridge else addition.create("config/bridge.yaml", "bridge.yaml")
        share(addition, rows)
        bridge = [rows]
    return addition.create(
        path,
        "simulator.launch.py",
        model=_parts(addition, robot),
        world=_parts(addition, world),
        height=spawn_height(addition, robot),
        bridge_file=_parts(addition, bridge[0]) if bridge else "",
    )


def _included(addition: Addition, given: str) -> tuple[str, str, str]:
    """A name for it, its package, and its path there as arguments of PathJoinSubstitution.

    Raises:
        NotFoundError: The launch file does not exist, as far as it is known.
    """
    package, slash, file = given.rpartition("/")
    package = package.partition("/")[0] if slash else addition.name
    own = addition.workspace.get(package)
    name = re.sub(r"\W+", "_", re.sub(r"[._]?launch\.\w+$", "", file)) or "included"
    if own is None:
        return name, package, f"'launch', '{file}'"
    files = {one.name: one for one in list_files(own.path, LAUNCH_FILES, markers=BUILD_MARKERS)}
    found = files.get(file)
    if found is None:
        raise NotFoundError(
            f"The package {package} has no launch file {file}.",
            hint=f"{ask_for_nearest(file, files)}Its launch files: "
            f"{', '.join(sorted(files)) or '-'}.",
        )
    parts = ", ".join(f"'{part}'" for part in found.relative_to(own.path).parts)
    return name, package, parts
