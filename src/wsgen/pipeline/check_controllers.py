"""Compare the robots of a package with the parameters that Gazebo's plugin gives to controllers."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wsgen import yamlfile
from wsgen.launch.commands import has_gaps
from wsgen.launch.other_places import find_in_package
from wsgen.rules.controller_joints import (
    Controlled,
    check_controllers,
    drive_sections,
    missing_controller_file,
)
from wsgen.rules.controllers import started_controllers
from wsgen.rules.drives import check_drive_controller
from wsgen.rules.ros2_control import control_plugins
from wsgen.xacro.source import place_in_source

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.package import ShareOf
    from wsgen.model.plan import LaunchPlan
    from wsgen.model.robot import Robot


def check_controlled(
    robots: Iterable[tuple[Robot, Path | None]], plans: Iterable[LaunchPlan], share_of: ShareOf
) -> Iterator[Diagnostic]:
    """Check the files of parameters that the plugins of the robots name.

    `robots` are those of a package, as written, with the files that describe them, which may
    include others.
    """
    started: set[str] = set()
    surely: set[str] = set()  # whatever is given
    for plan in plans:
        names = set(started_controllers(plan))
        started |= names
        if not has_gaps(plan):
            surely |= names
    # A robot may have parts that only some launch files give it.
    of_file: dict[Path, list[Robot]] = {}
    for robot, file in robots:
        for plugin in control_plugins(robot.gazebo):
            for text in plugin.values.get("parameters", ()):
                path = Path(text)
                if not path.is_absolute() or "$" in text:
                    continue
                if path not in of_file and not path.is_file():
                    folder = path.parent
                    beside = [one.name for one in folder.iterdir()] if folder.is_dir() else []
                    missing = missing_controller_file(
                        plugin, path, beside, file, find_in_package(text, share_of)
                    )
                    yield from place_in_source([missing], text="", file=file, share_of=share_of)
                of_file.setdefault(path, []).append(robot)
    for path, users in of_file.items():
        content = yamlfile.load_parameters(path)
        if isinstance(content, yamlfile.Value):
            yield from _check_file(path, content, users, started, surely)


def _check_file(
    path: Path, content: yamlfile.Value, users: list[Robot], started: set[str], surely: set[str]
) -> Iterator[Diagnostic]:
    controlled = Controlled(
        joints=[joint for robot in users for joint in robot.joints],
        controls=[system for robot in users for system in robot.controls],
        started=started,
        of_parts=started - surely,
    )
    yield from check_controllers(content, controlled, path)
    # Of several robots, nobody knows which one has the wheels.
    for name, values in drive_sections(content) if len(users) == 1 else ():
        yield from check_drive_controller(users[0], name, values, path)
