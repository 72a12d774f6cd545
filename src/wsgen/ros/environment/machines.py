"""Machines for which PyPI has ROS."""

from __future__ import annotations

import sys

from wsgen.errors import NotFoundError

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
