"""Compare the robots of a package with the parameters that Gazebo's plugin gives to controllers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.checks.rules.controller_joints import (
    Controlled,
    check_controllers,
    drive_sections,
    missing_controller_file,
)
from wsgen.checks.rules.controllers import started_controllers
from wsgen.checks.rules.drives import check_drive_controller
from wsgen.checks.rules.ros2_control import ControlFacts, control_plugins, control_without_plugin
from wsgen.descriptions.xacro.source import place_in_source
from wsgen.diagnostics import Severity
from wsgen.launching.commands import has_gaps
from wsgen.launching.known_packages import find_in_package
from wsgen.text import yamlfile

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

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
    started, surely = _started(plans)
    robots = list(robots)
    for robot, file in robots if started else ():
        found = without_plugin(robot, file)
        yield from place_in_source(found, text="", file=file, share_of=share_of)
    of_file: dict[Path, list[tuple[Robot, Path | None]]] = {}
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
                of_file.setdefault(path, []).append((robot, file))
    for path, users in of_file.items():
        content = yamlfile.load_parameters(path)
        if isinstance(content, yamlfile.Value):
            described = [robot for robot, _ in users]
            yield from _check_file(path, content, described, started, surely)
            yield from _check_drives(path, content, users, share_of)


def _started(plans: Iterable[LaunchPlan]) -> tuple[set[str], set[str]]:
    """The controllers that are started, and those that surely are, whatever is given.

    A robot may have parts that only some launch files give it.
    """
    started: set[str] = set()
    surely: set[str] = set()
    for plan in plans:
        names = set(started_controllers(plan))
        started |= names
        if not has_gaps(plan):
            surely |= names
    return started, surely


def _check_drives(
    path: Path,
    content: yamlfile.Value,
    users: Sequence[tuple[Robot, Path | None]],
    share_of: ShareOf,
) -> Iterator[Diagnostic]:
    robot, file = users[0]
    # Of several robots, nobody knows which one has the wheels.
    for name, values in drive_sections(content) if len(users) == 1 else ():
        for found in check_drive_controller(robot, name, values, path, file):
            if found.file == file:
                yield from place_in_source([found], text="", file=file, share_of=share_of)
            else:
                yield found


def without_plugin(robot: Robot, file: Path | None) -> Iterator[Diagnostic]:
    """Report the hardware of a robot that nothing loads, although its controllers are started."""
    facts = ControlFacts(
        controls=robot.controls, joints=robot.joints, plugins=control_plugins(robot.gazebo)
    )
    for found in control_without_plugin(facts, file):
        yield replace(found, severity=Severity.ERROR)


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
