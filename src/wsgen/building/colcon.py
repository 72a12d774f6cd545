"""Check a request, run colcon in a child process, and turn its events into those of wsgen.

Running it in this process would save 40 ms of 490, but colcon is written to run once. It caches
manifests, extensions and the path of CMake in module globals, changes the logging and, when
interrupted, the handling of SIGINT, and uses the environment and the current folder of the process,
which other threads may need. A child can also be ended together with the processes that it starts.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from dataclasses import field
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, NoReturn

from wsgen.building.last_build import INTERRUPTED
from wsgen.errors import NotFoundError, NotReadableError, RequestError
from wsgen.events import OutputLine, StepEnded, StepProgressed, StepStarted, post
from wsgen.isolation.system import end_tree, open_parent_death_pipe
from wsgen.packages.workspace.layout import (
    ignored_package,
    ignored_packages,
    refuse_missing_manifest,
)
from wsgen.text.suggestions import suggest
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence

    from wsgen.events import Listener
    from wsgen.packages.workspace.layout import Inventory, PackageFolder, Workspace


EVENT_HANDLERS = "colcon_core.event_handler"
SILENCED = ("console_start_end", "console_stderr", "summary")  # our events replace them
DISCOVERY_OPTIONS = ("--base-paths", "--paths", "--metas")
SELECTION_OPTION = "--packages-"
OUTPUT_OPTION = "--event-handlers"

# These take a quarter of colcon's own time; without a Python package in the workspace they do
# nothing, and a build does not run tests.
PYTHON_EXTENSIONS = (
    "colcon_core.package_identification.python_setup_py",
    "colcon_core.package_augmentation.python_setup_py",
    "colcon_core.package_augmentation.python",
    "colcon_core.package_augmentation.ros_ament_python",
    "colcon_core.verb.test",
)
BLOCKLIST = "COLCON_EXTENSION_BLOCKLIST"
TOOLCHAIN_EXTENSION = "colcon_core.argument_parser.wsgen"


def build_arguments(
    packages: Sequence[str],
    colcon_arguments: Sequence[str],
    *,
    cmake_arguments: Sequence[str] = (),
    blocked: Collection[str] = (),
) -> list[str]:
    """Make the command line.

    Packages are built with their dependencies in the workspace. Of a repeated option colcon takes
    the last, so no option of the user is repeated. `cmake_arguments` are for CMake, of packages
    for ament_cmake. `blocked` are the extensions that the user has
    blocked; colcon refuses options for them.
    """
    arguments = ["build", *colcon_arguments]
    if cmake_arguments:
        # Not --cmake-args: this option adds to them, also to those of a colcon_defaults.yaml.
        option = "--ament-cmake-args"
        position = arguments.index(option) + 1 if option in arguments else None
        if position is None:
            arguments += [option, *cmake_arguments]
        else:
            arguments[position:position] = cmake_arguments
    if packages:
        arguments += ["--packages-up-to", *packages]
    silenced = [name for name in SILENCED if f"{EVENT_HANDLERS}.{name}" not in blocked]
    if silenced and EVENT_HANDLERS not in blocked and not _uses(colcon_arguments, OUTPUT_OPTION):
        arguments += [OUTPUT_OPTION, *(f"{name}-" for name in silenced)]
    return arguments


def discovers_elsewhere(colcon_arguments: Sequence[str]) -> bool:
    """Whether the arguments make colcon search packages outside the workspace's folders."""
    return _uses(colcon_arguments, *DISCOVERY_OPTIONS)


def selects_packages(colcon_arguments: Sequence[str]) -> bool:
    """Whether the arguments select packages."""
    return _uses(colcon_arguments, SELECTION_OPTION)


def blocked_extensions(environment: Mapping[str, str]) -> list[str]:
    """List the extensions of colcon, and groups of them, that the user has blocked."""
    return [entry for entry in environment.get(BLOCKLIST, "").split(os.pathsep) if entry]


def block_extensions(
    environment: dict[str, str],
    *,
    workspace: Workspace,
    inventory: Inventory,
    colcon_arguments: Sequence[str],
) -> None:
    """Block extensions that colcon does not need: our own, whose work is done.

    Also, in a workspace without Python packages, those for Python; but not if colcon may search
    further than the inventory, because of its arguments or a file of default arguments.
    """
    blocked = [*blocked_extensions(environment), TOOLCHAIN_EXTENSION]
    if not (
        inventory.has_python
        or discovers_elsewhere(colcon_arguments)
        or any(file.exists() for file in _defaults_files(workspace, environment))
    ):
        blocked += PYTHON_EXTENSIONS
    environment[BLOCKLIST] = os.pathsep.join(dict.fromkeys(blocked))


def _defaults_files(workspace: Workspace, environment: Mapping[str, str]) -> tuple[Path, ...]:
    home = Path(environment.get("COLCON_HOME") or Path("~/.colcon").expanduser())
    return (
        workspace.root / "colcon_defaults.yaml",
        Path(environment.get("COLCON_DEFAULTS_FILE") or home / "defaults.yaml"),
    )


def _uses(arguments: Sequence[str], *options: str) -> bool:
    return any(argument.startswith(options) for argument in arguments)


def choose_packages(
    workspace: Workspace,
    inventory: Inventory,
    names: Sequence[str],
    colcon_arguments: Sequence[str],
) -> tuple[PackageFolder, ...]:
    """Return the ROS packages with these names; all if no name is given.

    Raises:
        RequestError: a package is unknown or ignored.
        NotFoundError: the workspace has no package.
    """
    if discovers_elsewhere(colcon_arguments):
        return inventory.packages  # colcon searches elsewhere, too
    if not inventory.packages and not inventory.others:
        refuse_empty(workspace)
    known = {package.name: package for package in inventory.packages}
    for name in names:
        # A package without package.xml may have any name; colcon knows it.
        if name not in known and not inventory.others:
            raise unknown_package(workspace, inventory, name)
    return tuple(package for package in inventory.packages if not names or package.name in names)


def unknown_package(workspace: Workspace, inventory: Inventory, name: str) -> RequestError:
    """Make the error for the name of a package that colcon does not find."""
    ignored = ignored_package(workspace, name)
    if ignored is not None:
        return ignored
    hint = suggest(name, {package.name for package in inventory.packages})
    if os.path.isdir(name):  # noqa: PTH112  a name may hold what no path can
        hint = f"Select packages by name, not by folder; without a name, all are built. {hint}"
    return RequestError(f"{workspace.root} has no package {name}.", hint=hint)


def refuse_empty(workspace: Workspace) -> NoReturn:
    """Stop in a workspace without packages, and explain why it has none.

    Raises:
        NotFoundError: always.
    """
    ignored = next(ignored_packages(workspace), None)
    if ignored is not None:
        folder, marker = ignored
        raise NotFoundError(
            f"{workspace.root} has no package to build: colcon ignores {folder}.",
            hint=f"Remove {marker} to build the package.",
        )
    refuse_missing_manifest([workspace.root])
    raise NotFoundError(
        f"{workspace.root} has no package.",
        hint="Create one: wsgen new PACKAGE",
    )


CHILD = str(Path(__file__).with_name("colcon_child.py"))
SECONDS_TO_STOP = 10.0  # wall-clock, for compilers to clean up


@dataclass(frozen=True, kw_only=True)
class Finished:
    """How colcon ended."""

    returncode: int  # negative: the number of the signal that ended it
    output: str  # what colcon itself printed


def run_colcon(
    arguments: Sequence[str],
    *,
    folder: Path,
    environment: Mapping[str, str],
    on_event: Callable[[dict[str, Any]], None],
) -> Finished:
    """Run `colcon` with the arguments in the folder, calling back for each event of the build.

    The events are those of `colcon_child`. An interruption (Ctrl-C, or an exception of a signal
    handler) ends colcon and all processes that it started, and is raised again. The end of this
    process ends them, too.
    """
    with tempfile.TemporaryFile() as output, open_parent_death_pipe() as parent_death_pipe:
        path = json.dumps([entry for entry in sys.path if entry])
        try:
            child = subprocess.Popen(
                [sys.executable, "-I", CHILD, path, *arguments],
                stdin=parent_death_pipe,
                stdout=subprocess.PIPE,
                stderr=output,
                cwd=folder,
                env=dict(environment),
                start_new_session=True,  # the group of processes to end
            )
        except OSError as error:
            raise NotReadableError(
                f"colcon could not be started in {folder}: {error.strerror}.",
                hint="Check that you may enter the folder, and that memory is free.",
            ) from error
        with child:  # outermost: its exit waits for the child, which must have ended
            try:
                for line in child.stdout or ():
                    on_event(json.loads(line))
            except KeyboardInterrupt:
                _end(child, signal.SIGINT)
                raise
            except BaseException:
                _end(child, signal.SIGTERM)
                raise
        return Finished(returncode=child.returncode, output=_read(output))


def _end(child: subprocess.Popen[bytes], first: signal.Signals) -> None:
    """Signal the group as a terminal or supervisor would, and kill what does not stop."""
    for number, patience in ((first, SECONDS_TO_STOP), (None, None)):
        end_tree(child.pid, number)
        with suppress(subprocess.TimeoutExpired):
            child.wait(patience)


def _read(output: IO[bytes]) -> str:
    output.seek(0)
    return output.read().decode("utf-8", "replace").strip()


STEP = ("build",)


@dataclass(frozen=True, kw_only=True)
class PackageResult:
    """The outcome of one package."""

    name: str
    outcome: str  # "built", "failed", "interrupted" (because another one failed) or "skipped"
    seconds: float  # wall-clock
    error_output: tuple[str, ...] = ()  # the lines of its programs on standard error, or of errors
    log_folder: Path | None = None  # None if logging is off
    left_out: tuple[str, ...] = ()  # targets and more that could not be compiled without ROS
    needs: tuple[str, ...] = ()  # names of the missing packages that these need


@dataclass
class Progress:
    """Receives the events of `colcon_child`, posts ours, and collects results."""

    listener: Listener | None
    results: list[PackageResult] = field(default_factory=list)
    log_folder: Path | None = None
    colcon_output: list[str] = field(default_factory=list)  # lines on standard error
    _started: dict[str, float] = field(default_factory=dict)  # time.monotonic()
    _error_output: dict[str, list[str]] = field(default_factory=dict)
    _failing: set[str] = field(default_factory=set)

    def __call__(self, event: dict[str, Any]) -> None:
        """Post the event, and keep what the result needs."""
        if event["event"] == "log":
            self.log_folder = None if event["path"] is None else Path(event["path"])
            return
        name: str = event["package"]
        step = (*STEP, name)
        if event["event"] == "started":
            self._started[name] = time.monotonic()
            post(self.listener, StepStarted(step=step))
        elif event["event"] == "progress":
            post(self.listener, StepProgressed(step=step, detail=event["detail"]))
        elif event["event"] == "line":
            is_error = event["is_error_stream"]
            # From here on ninja writes what a failed program wrote to either stream.
            if event["text"].startswith("FAILED: "):
                self._failing.add(name)
            if is_error or name in self._failing:
                self._error_output.setdefault(name, []).append(event["text"])
            post(self.listener, OutputLine(step=step, text=event["text"], is_error_stream=is_error))
        elif event["event"] == "skipped":
            self.results.append(PackageResult(name=name, outcome="skipped", seconds=0.0))
        elif event["event"] == "ended":
            self._end(name, event["result"])

    def _end(self, name: str, returncode: int | str) -> None:
        outcome = {0: "built", INTERRUPTED: "interrupted"}.get(returncode, "failed")
        seconds = time.monotonic() - self._started[name]
        self.results.append(
            PackageResult(
                name=name,
                outcome=outcome,
                seconds=seconds,
                error_output=tuple(self._error_output.get(name, ())),
                log_folder=self.log_folder,
            )
        )
        post(
            self.listener,
            StepEnded(
                step=(*STEP, name),
                succeeded=outcome == "built",
                seconds=seconds,
                detail="" if outcome == "built" else outcome,
            ),
        )
