"""Evaluate launch files without ROS, in child processes.

Starting a process for a launch file takes longer than most evaluations. A plain one leaves nothing
behind in its process (`launching/plain.py`), so that the next one can be evaluated there, as can
xacro files. What is not plain, what fails, and what the child dies of, is evaluated in a process of
its own.
"""

from __future__ import annotations

import os
import sys
import threading
from contextlib import AbstractContextManager, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity, has_errors
from wsgen.isolation import parent
from wsgen.isolation.channel import Channel
from wsgen.isolation.codec import decode
from wsgen.isolation.result import DEFAULT_LIMITS, Answered, Died, Limits
from wsgen.launching.plain import EVALUATE, EXPAND, MOST_BYTES, is_plain
from wsgen.model.plan import LaunchPlan, LaunchRequest
from wsgen.packages.source_shares import name_sources
from wsgen.text.files import read_regular
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from types import TracebackType

    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.parent import Run


TAKES_TOO_LONG = Rule(
    code="LCH012",
    name="launch-takes-too-long",
    severity=Severity.ERROR,
    summary="The evaluation of the launch file does not end in time.",
    what="Limits the evaluation to 30 s of CPU time and 300 s of wall-clock time.",
    why="`ros2 launch` would hang in the launch file and start nothing.",
    example="while not os.path.exists(path):\n    pass",
    instead="RegisterEventHandler(OnProcessExit(target_action=converter, on_exit=[spawner]))",
)
PROCESS_DIES = Rule(
    code="LCH013",
    name="launch-crashes",
    severity=Severity.ERROR,
    summary="The process that evaluates the launch file ends without an answer.",
    what="Looks for crashes, and for more than 64 MB of output or 2 GiB of memory.",
    why="`ros2 launch` runs the same code in its own process, and would end in the same way.",
    example="os._exit(3)",
    instead="raise RuntimeError('The model has no meshes.')",
)
TASK = "wsgen.pipeline.tasks.launch:evaluate_launch"
LIMITS = Limits(seconds=30.0, memory=2 * 2**30)


def evaluate(  # noqa: PLR0913  all but two have defaults
    launch_file: Path,
    *,
    package: str | None,
    arguments: Mapping[str, str],
    environment: Mapping[str, str],
    answers: Callable[[], Sequence[str]] = tuple,
    only_arguments: bool = False,
    with_origins: bool = False,
    limits: Limits = LIMITS,
    task: str = TASK,
    run: Run = parent.run,
) -> LaunchPlan:
    """What the launch file would start if `ros2 launch` played it with these arguments.

    A launch file is a program, and evaluating it runs it: in a child process, with these limits,
    and nothing it describes is started. `environment` is that of the sourced workspace. With
    `only_arguments` it is loaded and not played, and the plan holds the arguments that it and
    what it includes declare, their defaults in the words of `ros2 launch --show-args`. With
    `with_origins` it says where everything is written, and which files were read. `answers` is
    called only if the launch file asks for input; it is then evaluated again, with them. `task`
    names the function that the child calls, and `run` starts it. Mistakes in the launch file, or
    in what it includes, are diagnostics of the plan; nothing is raised for them.
    """
    request = LaunchRequest(
        launch_file=launch_file.absolute(),
        package=package,
        arguments=dict(arguments),
        only_arguments=only_arguments,
        with_origins=with_origins,
    )

    def play(request: LaunchRequest, unset: Mapping[str, Diagnostic]) -> LaunchPlan:
        variables = {**_complete(environment), **dict.fromkeys(unset, "")}
        outcome = run(task, request, limits=limits, environment=variables)
        if isinstance(outcome, Died):
            return LaunchPlan(
                package=package,
                launch_file=launch_file,
                diagnostics=(_death(outcome, launch_file),),
                is_complete=False,
            )
        answer = name_sources(outcome.value, environment)
        decoded = decode(answer, LaunchPlan)
        # The folder of the links to sources has another name each time.
        files = tuple(sorted(decoded.files, key=lambda file: file.path))
        return replace(decoded, launch_file=launch_file, files=files)

    unset: dict[str, Diagnostic] = {}
    plan = play(request, unset)
    given = tuple(answers()) if plan.unanswered else ()
    if given:
        request = replace(request, answers=given)
        plan = play(request, unset)
    while has_errors(plan.diagnostics):
        more = _unset_search_paths(plan)
        if more.keys() <= unset.keys():
            break
        unset.update(more)
        plan = play(request, unset)
    return replace(plan, diagnostics=(*unset.values(), *plan.diagnostics)) if unset else plan


_SEARCH_PATH = lazy_pattern(r"(?:GZ|IGN|IGNITION|GAZEBO)_(?:\w+_)?PATH|SDF_PATH")  # of Gazebo


def _unset_search_paths(plan: LaunchPlan) -> dict[str, Diagnostic]:
    """The search paths of Gazebo that the launch file needs and that are not set."""
    from wsgen.launching.explain import VARIABLE_NOT_SET

    found = {}
    for one in plan.diagnostics:
        name = one.element or ""
        if one.code == VARIABLE_NOT_SET.code and _SEARCH_PATH.fullmatch(name):
            message = (
                f"The launch file adds to {name}, which is not set: `ros2 launch` stops here, "
                "unless the variable is set elsewhere. wsgen takes it as empty."
            )
            action = f"AppendEnvironmentVariable('{name}', FOLDER)"
            if one.file is not None and one.file.suffix == ".xml":
                action = f'<append_env name="{name}" value="FOLDER"/>'
            hint = f"Write {action}, which works without a value."
            found[name] = replace(one, message=message, hint=hint, severity=Severity.WARNING)
    return found


DISTRO_OF_LAUNCHES = "iron"  # where neither the environment nor a target says another one


def _complete(environment: Mapping[str, str]) -> dict[str, str]:
    """The environment with what a login and a sourced ROS always set."""
    prefixes = list(filter(None, environment.get("AMENT_PREFIX_PATH", "").split(os.pathsep)))
    # Below the folder that colcon installs to, each package may have a prefix of its own.
    workspaces = [
        prefix.parent if (prefix / "share" / prefix.name).is_dir() else prefix
        for prefix in map(Path, prefixes)
    ]
    home = environment.get("HOME") or os.path.expanduser("~")
    user = environment.get("USER") or os.path.basename(home) or "user"
    return {
        "HOME": home,
        "USER": user,
        "LOGNAME": user,
        "SHELL": "/bin/bash",
        "LANG": "C.UTF-8",
        "TERM": "xterm",
        "DISPLAY": ":0",
        "LD_LIBRARY_PATH": os.pathsep.join(os.path.join(prefix, "lib") for prefix in prefixes),
        "CMAKE_PREFIX_PATH": os.pathsep.join(prefixes),
        "COLCON_PREFIX_PATH": os.pathsep.join(dict.fromkeys(map(str, workspaces))),
        "ROS_DISTRO": DISTRO_OF_LAUNCHES,
        "ROS_VERSION": "2",
        "ROS_PYTHON_VERSION": "3",
        **environment,
    }


def _death(died: Died, launch_file: Path) -> Diagnostic:
    if died.cause in ("cpu time", "wall-clock time"):
        return TAKES_TOO_LONG.at(
            launch_file,
            message=f"Evaluating the launch file {died.reason}.",
            hint=died.hint("Look for an endless loop; a launch file only describes what to start."),
        )
    return PROCESS_DIES.at(
        launch_file,
        message=f"Evaluating the launch file stopped: it {died.reason}.",
        hint=died.hint(
            f"Its last output: {died.output[-400:]}" if died.output else "It printed nothing."
        ),
    )


SERVE = "wsgen.pipeline.tasks.launch:serve_plain_launches"
TASK_OF_XACRO = "wsgen.descriptions.xacro.expansion:expand_for_parent"
SECONDS = 5.0  # CPU time; what takes longer gets a process, and more time, of its own
# What somebody else imported here is not what a launch file is to meet in a child.
FOREIGN = frozenset(("ament_index_python", "launch", "launch_ros", "xacro"))
MOST_DEATHS = 3  # then each launch file gets a process of its own


class PlainLaunches(AbstractContextManager["PlainLaunches"]):
    """A context manager whose `run` does what the given one does, and plain launch files faster.

    Threads may share it: each has a child. `end` has calls that wait come back.
    """

    def __init__(self, run: Run, *, is_forked: bool = False) -> None:
        """Children are forked from this process where `is_forked`, and where that can be."""
        self._run = run
        self._is_forked = is_forked
        self._children: dict[int, Channel] = {}  # by the threads that use them
        self._lock = threading.Lock()
        self._deaths = 0
        self._has_ended = False

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.end()
        for child in self._children.values():
            child.close()

    def end(self) -> None:
        """End the children; afterwards none is started."""
        with self._lock:
            self._has_ended = True
            for child in self._children.values():
                child.end()

    def run(
        self,
        task: str,
        *arguments: object,
        limits: Limits = DEFAULT_LIMITS,
        environment: Mapping[str, str] | None = None,
        folder: Path | None = None,
    ) -> Answered | Died:
        """Call `module:function` with the arguments in a child; see `parent.run`."""
        outcome = None
        if task == TASK and folder is None:
            (request,) = arguments
            if isinstance(request, LaunchRequest) and _is_plain(request):
                outcome = self._call(EVALUATE, request, parent.complete(environment))
        elif task == TASK_OF_XACRO:
            place = str(Path.cwd() / (folder or ""))
            outcome = self._call(EXPAND, *arguments, parent.complete(environment), place)
        if outcome is not None:
            return outcome
        return self._run(task, *arguments, limits=limits, environment=environment, folder=folder)

    def _call(self, command: str, *arguments: object) -> Answered | None:
        """What the child of this thread answers; None where a process of its own is needed."""
        child = self._child()
        if child is None:
            return None
        outcome = child.call(command, *arguments, seconds=SECONDS)
        if isinstance(outcome, Answered):
            return None if outcome.value is None else outcome
        with self._lock:
            self._deaths += 1
            del self._children[threading.get_ident()]
        child.close()
        return None

    def _child(self) -> Channel | None:
        """The child of this thread."""
        with self._lock:
            if self._has_ended or self._deaths >= MOST_DEATHS:
                return None
            here = threading.get_ident()
            child = self._children.get(here)
            if child is None:
                is_forked = self._is_forked and sys.modules.keys().isdisjoint(FOREIGN)
                child = Channel(SERVE, memory=LIMITS.memory, is_forked=is_forked)
                self._children[here] = child
            return child


def _is_plain(request: LaunchRequest) -> bool:
    if request.answers or request.only_arguments or request.with_origins:
        return False
    if request.launch_file.suffix in {".xml", ".yaml", ".yml"}:
        return True
    with suppress(OSError):
        return is_plain(read_regular(request.launch_file, MOST_BYTES))
    return False
