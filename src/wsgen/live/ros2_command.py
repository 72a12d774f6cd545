"""The `ros2` that scripts and nodes of a live run find on their PATH where no ROS is installed."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

from wsgen.errors import EXIT_MISSING
from wsgen.ros.environment.processes import module_command

if TYPE_CHECKING:
    from pathlib import Path

FOLDER = "bin"  # in the folder of the run
COMMANDS = ("run", "topic", "node")  # that wsgen has, too


def write_ros2(live_folder: Path, python: Path) -> Path:
    """Write it; gives the folder that belongs on the PATH."""
    folder = live_folder / FOLDER
    folder.mkdir()
    program = folder / "ros2"
    command = shlex.join(module_command(python, "wsgen"))
    program.write_text(
        f"""#!/bin/sh
case "$1" in
  {"|".join(COMMANDS)}) exec {command} "$@" ;;
esac
echo "ros2 $1 is not installed: wsgen has {", ".join(COMMANDS)}. Source a ROS that has it." >&2
exit {EXIT_MISSING}
""",
        encoding="utf-8",
    )
    program.chmod(0o755)
    return folder
