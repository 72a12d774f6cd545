"""A launch file in XML or YAML as a launch description."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from launch.frontend.actions import build
from launch.invalid_launch_file_error import InvalidLaunchFileError
from launch.launch_description import LaunchDescription
from wsgen.launch.record import RECORD, locate

if TYPE_CHECKING:
    from launch.frontend.entity import Entity


class InvalidFrontendLaunchFileError(InvalidLaunchFileError):
    """A launch file that cannot be read as what its name says."""


def get_launch_description_from_frontend_launch_file(launch_file_path: str) -> LaunchDescription:
    """The actions of its elements."""
    path = os.fspath(launch_file_path)
    text = Path(path).read_bytes()
    RECORD.launch_files.append(path)
    try:
        root = _read(text, path)
    except ValueError as wrong:
        message, *line = wrong.args
        error = InvalidFrontendLaunchFileError(str(message))
        locate(error, (path, line[0] if line else 1))
        raise error from None
    if root.type_name != "launch":
        error_root = RuntimeError("Expected 'launch' as root tag")
        locate(error_root, root.location)
        raise error_root
    reason = root.get("deprecated", optional=True)
    return LaunchDescription([build(child) for child in root.children()], deprecated_reason=reason)


def _read(text: bytes, path: str) -> Entity:
    if path.lower().endswith(".xml"):
        from launch.frontend import xml_file

        return xml_file.read(text, path)
    from launch.frontend import yaml_file

    return yaml_file.read(text, path)
