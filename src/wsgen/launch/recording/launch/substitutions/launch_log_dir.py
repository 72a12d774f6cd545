"""Where the launch would write its logs."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from launch.substitution import Substitution

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class LaunchLogDir(Substitution):
    """The folder above the real one, whose name has the time of the launch in it."""

    def describe(self) -> str:
        """Itself in words."""
        return "LaunchLogDir()"

    def perform(self, context: LaunchContext) -> str:
        """The folder."""
        del context
        return os.environ.get("ROS_LOG_DIR") or os.path.join(
            os.environ.get("ROS_HOME") or os.path.expanduser("~/.ros"), "log"
        )
