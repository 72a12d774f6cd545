"""The commands of ROS that a CMakeLists.txt runs: `xacro`, and of `ros2` what needs no ROS.

The scripts in `ros_prefix/bin` call these functions, in processes that CMake, make or ninja start.
"""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

from wsgen.building.package_environment import SOURCE_PREFIX

if TYPE_CHECKING:
    from collections.abc import Sequence

RUN_XACRO = ["run", "xacro", "xacro"]


def run_xacro(arguments: Sequence[str]) -> int:
    """Do what `xacro` does, and return the exit code.

    `$(find ...)` of the package that is built finds its sources, as it is not installed yet. The
    output has the paths that it will be installed to instead.
    """
    from wsgen.descriptions.xacro.expansion import run_command  # noqa: PLC0415  `ros2` needs it seldom

    sources, _, installed = os.environ.get(SOURCE_PREFIX, "").partition(os.pathsep)
    result = run_command(
        ["xacro", *arguments],
        rewrite=lambda text: text.replace(sources, installed) if sources else text,
    )
    sys.stdout.write(result.stdout)
    sys.stderr.write(result.stderr)
    error = result.error or {}
    if error.get("file"):  # for `wsgen.building.causes`: xacro itself names no line
        place = f"{os.path.abspath(error['file'])}:{error.get('line') or ''}"  # noqa: PTH100  links
        sys.stderr.write(f"xacro: {place}: {error['message']}\nxacro: {error.get('hint', '')}\n")
    return result.code


def run_ros2(arguments: Sequence[str]) -> int:
    """Do what `ros2 run xacro xacro` does, and return the exit code; refuse anything else."""
    if [*arguments[:3]] == RUN_XACRO:
        return run_xacro(arguments[3:])
    sys.stderr.write(
        f"error: ros2 {' '.join(arguments)}: ROS is not sourced; without it a build can run "
        f"`ros2 {' '.join(RUN_XACRO)}` alone.\n"
    )
    return 1
