"""The compiler of messages: that of the system, or PyPI's ziglang where there is none.

Ziglang compiles C and C++ where nobody is root.
"""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sysconfig
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError
from wsgen.events import StepEnded, StepProgressed, StepStarted, post
from wsgen.ros.environment.wheels import being_made, cache_folder, download, site_packages, unpack
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from wsgen.events import Listener


C_NAMES = ("cc", "gcc", "clang")
CXX_NAMES = ("c++", "g++", "clang++")
SHOWN_LINES = 3  # of the errors of a compiler


@dataclass(frozen=True, kw_only=True)
class Compiler:
    """Commands that compile C and C++."""

    c: tuple[str, ...]
    cxx: tuple[str, ...]


def system_compiler(environment: Mapping[str, str]) -> Compiler | None:
    """Return the compiler of the system: that of CC and CXX, or of the PATH; None without one."""
    path = environment.get("PATH", os.defpath)

    def command(variable: str, names: Sequence[str]) -> tuple[str, ...]:
        if chosen := environment.get(variable):
            return tuple(shlex.split(chosen))
        found = next((name for name in names if shutil.which(name, path=path)), None)
        return (found,) if found else ()

    c, cxx = command("CC", C_NAMES), command("CXX", CXX_NAMES)
    return Compiler(c=c, cxx=cxx) if c and cxx else None


def python_headers() -> Path:
    """Return the folder of Python.h.

    Raises:
        NotFoundError: Python is installed without it, as Debian and Ubuntu do.
    """
    folder = Path(sysconfig.get_path("include"))
    if not (folder / "Python.h").is_file():
        version = sysconfig.get_python_version()
        raise NotFoundError(
            f"Messages cannot be compiled: Python.h is missing in {folder}.",
            hint=f"Install it: {_headers_command(version)}; or install wsgen with a "
            f"Python that has it (uv tool install --python {version} 'wsgen[ros]').",
        )
    return folder


def _headers_command(version: str) -> str:
    """What installs the headers of the system's Python, by the package manager that is there."""
    commands = {
        "apt-get": f"sudo apt install python{version}-dev",
        "dnf": "sudo dnf install python3-devel",
        "zypper": f"sudo zypper install python{version.replace('.', '')}-devel",
        "apk": "sudo apk add python3-dev",
    }
    return next((commands[name] for name in commands if shutil.which(name)), commands["apt-get"])


def run_all(commands: Sequence[Sequence[str]], *, environment: Mapping[str, str]) -> None:
    """Run commands of a compiler, as many at a time as there are cores.

    Raises:
        NotFoundError: one fails; the message has its first errors.
    """

    def run(command: Sequence[str]) -> None:
        try:
            done = subprocess.run(
                command,
                env=dict(environment),
                stdin=subprocess.DEVNULL,
                capture_output=True,
                text=True,
                errors="replace",
                check=False,
            )
            said, status = done.stderr, done.returncode
        except OSError as error:
            said, status = str(error), 1
        if status != 0:
            lines = [line for line in said.splitlines() if "error" in line] or said.splitlines()
            raise NotFoundError(
                f"{command[0]} does not compile messages: {' '.join(lines[:SHOWN_LINES])}",
                hint="Install another compiler (sudo apt install g++), or name one with CC and "
                "CXX.",
            )

    with ThreadPoolExecutor(max(1, len(os.sched_getaffinity(0)))) as pool:
        for _ in pool.map(run, commands):
            pass


VERSION = "0.13.0"
# What the wheels of ROS are built for; the libraries of this machine are at least as new.
TARGET = ("-target", "x86_64-linux-gnu.2.28")


def make_zig(environment: Mapping[str, str], listener: Listener) -> Compiler:
    """Return the compiler, which is downloaded into the user's cache unless it is there.

    Raises:
        NotFoundError: it cannot be downloaded.
        NotReadableError: the cache cannot be used.
    """
    folder = cache_folder(environment) / f"ziglang-{VERSION}"
    if not folder.exists():
        _bring(folder, environment, listener)
    program = str(site_packages(folder) / "ziglang" / "zig")
    return Compiler(c=(program, "cc", *TARGET), cxx=(program, "c++", *TARGET))


def _bring(target: Path, environment: Mapping[str, str], listener: Listener) -> None:
    step = ("ros", "ziglang")
    started = time.monotonic()
    succeeded = False
    post(
        listener,
        StepStarted(step=step, detail="a compiler, because this machine has none", takes_long=True),
    )

    def progress(detail: str) -> None:
        post(listener, StepProgressed(step=step, detail=detail))

    try:
        with being_made(target, listener, step) as folder:
            if folder is not None:
                wheels = folder / "wheels"
                found = download(
                    [f"ziglang=={VERSION}"],
                    wheels,
                    environment=environment,
                    listener=listener,
                    step=step,
                )
                unpack(found, folder, change=lambda _, content: content, progress=progress)
                shutil.rmtree(wheels)
                (site_packages(folder) / "ziglang" / "zig").chmod(0o755)
        succeeded = True
    finally:
        seconds = time.monotonic() - started
        post(listener, StepEnded(step=step, succeeded=succeeded, seconds=seconds))
