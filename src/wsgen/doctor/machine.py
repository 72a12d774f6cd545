"""Look at a machine: its system, programs and Python modules.

Compiled modules are imported in a child process: one that is built for another machine may crash,
and the system may lack a library that one needs. A `Machine` holds all that is looked at, so that
tests can make one up.
"""

from __future__ import annotations

import importlib.util
import os
import platform
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.building.toolchain import find_toolchain
from wsgen.errors import NotFoundError, NotReadableError
from wsgen.isolation import parent
from wsgen.isolation.result import Died
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from wsgen.building.toolchain import Toolchain


OS_RELEASE = ("etc/os-release", "usr/lib/os-release")  # the first that exists
DRAWING_TASK = "wsgen.rendering.renderer:draw_a_box"
IMPORTING_TASK = "wsgen.isolation.child:import_modules"
SYSTEMS = {"linux": "Linux", "darwin": "macOS", "win32": "Windows"}


class Requirement(NamedTuple):
    """Something that wsgen or ROS requires, and whether a machine has it."""

    name: str
    is_met: bool
    text: str  # what the machine has; or that it is missing, and its purpose
    is_required: bool = False  # by wsgen's own commands
    fix: str = ""  # the command that fixes it


@dataclass(frozen=True, kw_only=True)
class Machine:
    """A machine to look at."""

    environment: Mapping[str, str]
    build_environment: Mapping[str, str]  # that colcon would be given
    toolchain: Toolchain | None  # that colcon would use
    root: Path  # of the file system
    system: str  # as sys.platform
    architecture: str  # as platform.machine()
    python: tuple[int, int]  # that runs wsgen
    interpreter: str  # its path
    which: Callable[[str, str], str | None]  # name of a program, PATH -> its path
    has_module: Callable[[str], bool]  # name of a Python module at the top level
    why_not_loaded: Callable[[str], str | None]  # why a module cannot be imported; None if it can
    why_no_picture: Callable[[], str | None]  # why nothing can be drawn; None if it can

    @property
    def system_name(self) -> str:
        """The kind of system, for people."""
        return SYSTEMS.get(self.system, self.system)

    def find(self, *programs: str, for_build: bool = False) -> str | None:
        """Find the path of the first of these programs that exists."""
        variables = self.build_environment if for_build else self.environment
        path = variables.get("PATH", "")
        return next(filter(None, (self.which(name, path) for name in programs)), None)


def here(environment: Mapping[str, str]) -> Machine:
    """Return this machine, with these variables."""
    try:
        toolchain = find_toolchain(environment)
    except NotFoundError:
        toolchain = None
    return Machine(
        environment=environment,
        build_environment=toolchain.environment(environment) if toolchain else environment,
        toolchain=toolchain,
        root=Path("/"),
        system=sys.platform,
        architecture=platform.machine(),
        python=sys.version_info[:2],
        interpreter=sys.executable,
        which=_which,
        has_module=_has_module,
        why_not_loaded=_why_not_loaded,
        why_no_picture=_why_no_picture,
    )


def read_os_release(root: Path) -> dict[str, str]:
    """Read the settings of /etc/os-release, by the specification of freedesktop.org.

    Raises:
        OSError: it is missing, or cannot be read.
    """
    for name in OS_RELEASE:
        file = root / name
        if file.exists():
            break
    lines = file.read_text(encoding="utf-8", errors="replace").splitlines()
    settings = (line.partition("=") for line in lines if not line.lstrip().startswith("#"))
    return {key.strip(): value.strip().strip("\"'") for key, equals, value in settings if equals}


def names_in_apt(root: Path, hosts: tuple[str, ...]) -> bool:
    """Whether apt gets packages from one of these hosts; unreadable files are skipped."""
    folder = root / "etc" / "apt"
    files = [folder / "sources.list"]
    for pattern in ("*.list", "*.sources"):
        files += sorted((folder / "sources.list.d").glob(pattern))
    for file in files:
        try:
            text = file.read_text(encoding="utf-8", errors="replace")
        except OSError:
            continue
        lines = (line for line in text.splitlines() if not line.lstrip().startswith("#"))
        if any(host in line for line in lines for host in hosts):
            return True
    return False


def ros_prefixes(machine: Machine, distro: str) -> list[Path]:
    """List the folders with packages of a distribution: what is sourced, then /opt/ros."""
    sourced = machine.environment.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return [*map(Path, filter(None, sourced)), machine.root / "opt" / "ros" / distro]


def _which(program: str, path: str) -> str | None:
    return shutil.which(program, path=path)


def _why_not_loaded(module: str) -> str | None:
    """Import a module in a child process; return why it failed, to follow its name."""
    return _why_not_done(IMPORTING_TASK, [module])[1]


def _why_no_picture() -> str | None:
    """Draw a small picture in a child process; return why it failed, to follow "the renderer"."""
    drawn, problem = _why_not_done(DRAWING_TASK)
    return problem if drawn or problem else "draws nothing"


def _why_not_done(task: str, *arguments: object) -> tuple[Any, str | None]:
    """Return the answer of a child process, and why it has none."""
    try:
        outcome = parent.run(task, *arguments)
    except NotReadableError as error:
        return None, f"was not started: {error.message}"
    return (None, outcome.reason) if isinstance(outcome, Died) else (outcome.value, None)


def _has_module(name: str) -> bool:
    try:
        return importlib.util.find_spec(name) is not None
    except (ImportError, ValueError):
        return False
