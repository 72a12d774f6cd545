"""Which packages of messages a live run needs: of the workspace, its robots and its bridges."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.launch import commands
from wsgen.pipeline.reached_packages import WORDS, texts_below

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from wsgen.model.devices import Devices
    from wsgen.model.plan import LaunchPlan, Process
    from wsgen.workspace.layout import PackageFolder

ENDINGS = (b"_msgs", b"_interfaces", b"_srvs")
# Of files that name messages for processes which are not compiled: Python, package.xml, YAML.
SUFFIXES = frozenset((".py", ".xml", ".yaml", ".yml", ""))
OF_CONTROL = ("control_msgs", "controller_manager_msgs")
CONTROL = "ros2_control"  # in the file names of plugins
CONTROL_PROGRAMS = frozenset(("spawner", "spawner.py", "unspawner", "ros2_control_node"))
# Kinds of sensors whose messages only a package of Gazebo has.
OF_GAZEBO = frozenset(("altimeter", "contact"))
GAZEBO = {"classic": "gazebo_msgs", "gz": "ros_gz_interfaces"}
_TYPE = re.compile(r"\b([a-z]\w*)/(?:msg|srv|action)/\w+")
LARGEST = 1 << 20  # bytes of the file of a bridge


def messages_of_packages(packages: Iterable[PackageFolder]) -> frozenset[str]:
    """Those that packages of the workspace name in files for Python nodes, declared or not."""
    return frozenset(
        word.decode()
        for package in packages
        for file, text in texts_below(package.path)
        if file.suffix in SUFFIXES
        for word in set(WORDS.findall(text))
        if word.endswith(ENDINGS)
    )


def messages_of_devices(devices: Iterable[Devices], simulator: str) -> frozenset[str]:
    """Those that sensors and plugins publish or take."""
    return frozenset(name for one in devices for name in _of_devices(one, simulator))


def _of_devices(devices: Devices, simulator: str) -> Iterator[str]:
    files = (plugin.attributes.get("filename", "") for plugin in devices.plugins)
    if devices.ros2_control or any(CONTROL in file for file in files):
        yield from OF_CONTROL
    if any(sensor.kind in OF_GAZEBO for sensor in devices.sensors):
        yield GAZEBO[simulator]


def messages_of_plan(plan: LaunchPlan) -> frozenset[str]:
    """Those that controllers are managed with, and that processes name on their command lines."""
    return frozenset(name for process in plan.processes for name in _of_process(process))


def _of_process(process: Process) -> Iterator[str]:
    for program in commands.programs(process):
        is_of_ros2 = program.executable == "ros2" and program.arguments[:1] == ("control",)
        if program.executable in CONTROL_PROGRAMS or is_of_ros2:
            yield from OF_CONTROL
        for word in program.arguments:
            yield from _TYPE.findall(word)
        file = program.parameters.get("config_file")
        if isinstance(file, str):
            with suppress(OSError, UnicodeDecodeError):
                if Path(file).stat().st_size < LARGEST:
                    yield from _TYPE.findall(Path(file).read_text(encoding="utf-8"))
