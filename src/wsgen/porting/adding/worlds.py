"""A world for the simulator of a package."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.gazebo.sensors import SYSTEM_OF_SENSOR
from wsgen.gazebo.systems import DEFAULT_SYSTEMS, plugin_of
from wsgen.packages.workspace.layout import BUILD_MARKERS
from wsgen.porting.adding.installing import share
from wsgen.porting.adding.types import check_name
from wsgen.text.files import list_files, read_or_empty

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.porting.adding.addition import Addition

_SENSOR = re.compile(r"<sensor\b[^>]*\btype\s*=\s*[\"'](\w+)")
_RENDERED = "Sensors"
_SUFFIXES = (".world", ".sdf")
_MODELS = (".urdf", ".xacro", ".gazebo", ".sdf", ".world")


def worlds_of(addition: Addition) -> list[Path]:
    """The worlds of a package."""
    files = list_files(addition.folder, _SUFFIXES, markers=BUILD_MARKERS)
    return sorted(one for one in files if re.search(r"<world\b", read_or_empty(one)))


def add_world(addition: Addition, name: str) -> Path:
    """Add a world with a sun, a ground, and the systems that the sensors of the package need.

    Raises:
        RequestError: The name cannot be.
    """
    stem = re.sub(r"\.(?:world|sdf)\Z", "", name)
    check_name("world", stem)
    worlds = worlds_of(addition)
    folder = worlds[-1].parent.relative_to(addition.folder).as_posix() if worlds else "worlds"
    suffix = worlds[-1].suffix if worlds else ".world"
    path = f"{folder}/{stem}{suffix}" if folder != "." else f"{stem}{suffix}"
    file = addition.create(path, "world", world=stem, systems=_systems(addition))
    share(addition, file, f"*{suffix}")
    return file


def _systems(addition: Addition) -> list[str]:
    """What a world loads beside the usual systems."""
    texts = map(read_or_empty, list_files(addition.folder, _MODELS, markers=BUILD_MARKERS))
    kinds = {kind for text in texts for kind in _SENSOR.findall(text)}
    needed = {SYSTEM_OF_SENSOR[kind] for kind in kinds if kind in SYSTEM_OF_SENSOR}
    return [system_element(one) for one in sorted(needed - {*DEFAULT_SYSTEMS})]


def system_element(system: str) -> str:
    """The element that loads a system; what renders names the engine that does."""
    element = plugin_of(system)
    if system != _RENDERED:
        return element
    start = element.removesuffix("/>")
    return f"{start}><render_engine>ogre2</render_engine></plugin>"
