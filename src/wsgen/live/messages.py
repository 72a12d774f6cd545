"""Which messages a live run needs: those that the workspace names, and those of plugins."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.pipeline.reached_packages import WORDS, texts_below
from wsgen.simulation.live_scene import SCENE_FILE
from wsgen.workspace.layout import find_packages

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.pipeline.plan_launch import SelectedLaunchFile


# Of files that name messages which processes without a compiler use: Python, package.xml, bridges.
SUFFIXES = frozenset((".py", ".xml", ".yaml", ".yml", ""))
ENDINGS = (b"_msgs", b"_interfaces", b"_srvs")

_CONTROL = frozenset(("control_msgs", "controller_manager_msgs"))
# Part of the file name of a plugin -> the packages of the messages that it speaks.
PLUGINS: dict[str, frozenset[str]] = {
    "ros2_control.so": _CONTROL,
    "ros2_control-system": _CONTROL,
    "gazebo_ros_bumper": frozenset(("gazebo_msgs",)),
}


def messages_of(selected: SelectedLaunchFile) -> frozenset[str]:
    """The packages of messages that files of the workspace name, declared or not."""
    workspace = selected.workspace
    packages = find_packages(workspace) if workspace else ()
    return frozenset(
        word.decode()
        for package in packages
        for file, text in texts_below(package.path)
        if file.suffix in SUFFIXES
        for word in set(WORDS.findall(text))
        if word.endswith(ENDINGS)
    )


def messages_of_plugins(live_folder: Path) -> frozenset[str]:
    """The packages of messages that plugins of the robots of a live run need."""
    file = live_folder / SCENE_FILE
    scene = file.read_text(encoding="utf-8") if file.is_file() else ""
    found = (messages for plugin, messages in PLUGINS.items() if plugin in scene)
    return frozenset[str]().union(*found)
