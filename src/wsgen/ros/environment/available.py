"""Which ROS there is for a machine: the one that the user sourced, or PyPI's."""

from __future__ import annotations

import os
import sys
import sysconfig
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError

if TYPE_CHECKING:
    from collections.abc import Mapping


PYTHONS = ((3, 10), (3, 13))  # first and last with wheels
MARKER = ".wsgen"  # in the folder of a ROS that wsgen made: nobody sourced it
SOURCE_HINT = "Source a ROS instead (source /opt/ros/<distro>/setup.bash)."


def why_not(
    system: str = sys.platform,
    machine: str | None = None,
    version: tuple[int, int] = sys.version_info[:2],
    implementation: str = sys.implementation.name,
) -> NotFoundError | None:
    """Return why PyPI has no ROS for a machine, None if it has one.

    Args:
        system: as sys.platform.
        machine: as platform.machine(); None for the running one.
        version: of Python.
        implementation: as sys.implementation.name.
    """
    if machine is None:
        import platform  # noqa: PLC0415  5 ms that wsgen doctor does not pay twice

        machine = platform.machine()
    if system == "win32":
        return NotFoundError(
            "PyPI has no ROS 2 for Windows; all commands that start no node work.",
            hint="Use the Windows Subsystem for Linux (wsl --install), with wsgen in it.",
        )
    if (system, machine) != ("linux", "x86_64"):
        name = {"darwin": "macOS", "linux": "Linux"}.get(system, system)
        return NotFoundError(
            f"PyPI has ROS 2 for Linux on x86_64 alone; this is {name} on {machine}.",
            hint=SOURCE_HINT,
        )
    first, last = PYTHONS
    if implementation != "cpython" or not first <= version <= last:
        running = f"{implementation} {version[0]}.{version[1]}".replace("cpython", "Python")
        return NotFoundError(
            f"PyPI has ROS 2 for Python {first[0]}.{first[1]} to {last[0]}.{last[1]}; "
            f"wsgen runs on {running}.",
            hint=f"Install wsgen[ros] with another Python (python{last[0]}.{last[1]} -m venv "
            f"ros_env; uv tool install --python {last[0]}.{last[1]} 'wsgen[ros]'). {SOURCE_HINT}",
        )
    return None


RCLPY = Path("share", "ament_index", "resource_index", "packages", "rclpy")


def sourced_prefix(environment: Mapping[str, str]) -> Path | None:
    """Return the prefix of rclpy that is sourced; None without one.

    An overlay that was built without ROS sets AMENT_PREFIX_PATH, too, but has no rclpy. PyPI's ROS
    is on it in processes of a live run.
    """
    for entry in environment.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        prefix = Path(entry)
        if entry and (prefix / RCLPY).is_file() and not (prefix / MARKER).exists():
            return prefix
    return None


def check_rclpy(prefix: Path, distro: str, environment: Mapping[str, str]) -> None:
    """Refuse a ROS whose rclpy the interpreter of wsgen cannot import.

    rclpy is compiled for one version of Python. The file is looked up, because importing it takes
    a quarter of a second. ROS of conda (RoboStack) is no entry of PYTHONPATH: wsgen finds its rclpy
    where it is installed in the same environment.

    Raises:
        NotFoundError: rclpy is for another Python, or wsgen does not find it.
    """
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    entries = [*environment.get("PYTHONPATH", "").split(os.pathsep), *sys.path]
    found = [folder for entry in entries if entry and (folder := Path(entry, "rclpy")).is_dir()]
    if not found:
        own = prefix / "bin" / "python"
        hint = f"Source its setup file again: source {prefix}/setup.bash."
        if own.exists():
            hint = f"Install wsgen into its environment: {own} -m pip install wsgen."
        raise NotFoundError(
            f"ROS {distro} is sourced, but neither PYTHONPATH nor the Python of wsgen has its "
            "rclpy.",
            hint=hint,
        )
    modules = [file.name for file in sorted(found[0].glob("_rclpy_pybind11.*"))]
    if modules and f"_rclpy_pybind11{suffix}" not in modules:
        running = f"{sys.version_info.major}.{sys.version_info.minor}"
        wanted = _python_of(modules[0])
        raise NotFoundError(
            f"ROS {distro} in {prefix} is for Python {wanted or 'of another version'}; wsgen runs "
            f"on {running}.",
            hint=f"Install wsgen with that Python (python{wanted or 3} -m venv wsgen_env; "
            f"wsgen_env/bin/pip install wsgen), or start wsgen in a terminal where no ROS is "
            "sourced.",
        )


def _python_of(module: str) -> str | None:
    """The version of Python in the name of a compiled module: 3.12 of x.cpython-312-….so."""
    _, _, rest = module.partition(".cpython-3")
    minor = rest.partition("-")[0]
    return f"3.{minor}" if minor.isdigit() else None
