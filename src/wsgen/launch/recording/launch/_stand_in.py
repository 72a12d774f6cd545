"""What is known of launch files whose packages are not here."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from launch.actions import DeclareLaunchArgument
from launch.launch_description import LaunchDescription

if TYPE_CHECKING:
    from wsgen.launch.known_packages import StandInFile


def describe(stand_in: StandInFile) -> LaunchDescription:
    """A description that declares the arguments of the launch file, and does nothing else."""
    defaults = stand_in.arguments(os.environ.get("ROS_DISTRO", ""))
    return LaunchDescription(
        [DeclareLaunchArgument(name, default_value=value) for name, value in defaults.items()]
    )
