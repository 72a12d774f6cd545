"""ROS from PyPI, in a folder of the user's cache.

Not in the environment of wsgen: `ros-rclpy` brings ros-wheels-bootstrapper there, whose .pth file
executes the interpreter again at every start, so that every command of wsgen would take 50 ms
longer. Here it is left out. Nodes run with wsgen's interpreter, and find ROS by PYTHONPATH and
LD_LIBRARY_PATH.
"""

from __future__ import annotations

import hashlib
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError
from wsgen.events import StepEnded, StepProgressed, StepStarted, post
from wsgen.ros.environment.cache import being_made, cache_folder
from wsgen.ros.environment.machines import MARKER, SOURCE_HINT, why_not
from wsgen.ros.environment.processes import WITHOUT_WORKING_FOLDER
from wsgen.ros.environment.wheels import download, site_packages, unpack

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.events import Listener

DISTRO = "kilted"
REQUIREMENTS = Path(__file__).with_name("pinned") / f"{DISTRO}.txt"
LAYOUT = "1"  # of the folder; one more when it changes
STEP = ("ros",)
CHECK = "import rclpy, rclpy.action; rclpy.init(); rclpy.shutdown()"
# Folders of the machines that the wheels were built on, which CMake would look for. The targets of
# Python and NumPy, which each package adds itself, have those of this machine.
BUILD_FOLDERS = re.compile(rb";?/opt/python/[^;\"\s]*")


def pinned() -> list[str]:
    """List the requirements of the wheels, with their versions."""
    lines = REQUIREMENTS.read_text(encoding="utf-8").splitlines()
    return [line for line in lines if line and not line.startswith("#")]


def private_prefix(environment: Mapping[str, str]) -> Path:
    """Return the folder of ROS, whether it is there or not.

    Raises:
        NotFoundError: there is no ROS for this machine.
        NotReadableError: the cache cannot be used.
    """
    if (reason := why_not()) is not None:
        raise reason
    contents = "\n".join([LAYOUT, *pinned()])
    digest = hashlib.sha256(contents.encode()).hexdigest()[:10]
    tag = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return cache_folder(environment) / f"{DISTRO}-{tag}-{digest}"


def make_private(environment: Mapping[str, str], listener: Listener) -> Path:
    """Make the folder of ROS, unless it is there, and return it.

    Raises:
        NotFoundError: there is no ROS for this machine, or it cannot be downloaded.
        NotReadableError: the cache cannot be used.
    """
    prefix = private_prefix(environment)
    if prefix.exists():
        return prefix
    started = time.monotonic()
    succeeded = False
    post(
        listener,
        StepStarted(step=STEP, detail=f"ROS 2 {DISTRO.capitalize()} from PyPI", takes_long=True),
    )
    try:
        with being_made(prefix, listener, STEP) as folder:
            if folder is not None:
                _fill(folder, environment, listener)
        succeeded = True
    finally:
        seconds = time.monotonic() - started
        post(
            listener,
            StepEnded(step=STEP, succeeded=succeeded, seconds=seconds, detail=str(prefix)),
        )
    return prefix


def library_folders(prefix: Path) -> list[Path]:
    """List the folders of libraries: those of packages, and those that the wheels bundle."""
    return [prefix / "lib", *sorted(site_packages(prefix).glob("ros_*.libs"))]


def _fill(folder: Path, environment: Mapping[str, str], listener: Listener) -> None:
    wheels = folder / "wheels"

    def progress(detail: str) -> None:
        post(listener, StepProgressed(step=STEP, detail=detail))

    found = download(pinned(), wheels, environment=environment, listener=listener, step=STEP)
    unpack(found, folder, change=_without_build_folders, progress=progress)
    shutil.rmtree(wheels)
    (folder / MARKER).touch()
    progress("start it once")
    variables = {
        **environment,
        "PYTHONPATH": str(site_packages(folder)),
        "LD_LIBRARY_PATH": ":".join(map(str, library_folders(folder))),
        "AMENT_PREFIX_PATH": str(folder),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF",
        "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
    }
    run = subprocess.run(
        [sys.executable, "-c", WITHOUT_WORKING_FOLDER + CHECK],
        env=variables,
        capture_output=True,
        text=True,
        errors="replace",
        check=False,
    )
    if run.returncode != 0:
        said = (run.stderr.strip().splitlines() or [f"it ended with {run.returncode}"])[-1]
        raise NotFoundError(
            f"ROS from PyPI does not start on this machine: {said}", hint=SOURCE_HINT
        )


def _without_build_folders(name: str, content: bytes) -> bytes:
    """Remove folders of other machines from a file of CMake."""
    del name
    return BUILD_FOLDERS.sub(b"", content)
