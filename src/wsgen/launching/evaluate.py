"""Evaluate launch files without ROS, in child processes.

Starting a process for a launch file takes longer than most evaluations. A plain one leaves nothing
behind in its process (`launching/plain.py`), so that the next one can be evaluated there, as can
xacro files. What is not plain, what fails, and what the child dies of, is evaluated in a process of
its own.

What fails for want of an argument is evaluated with values that the launch file says that the
argument may have: its choices and the values in quotes in its description, what conditions compare
it with, and truth values for what a condition reads. A default of `true` that an expression of
Python reads should have been `True`.
"""

from __future__ import annotations

import ast
import itertools
import os
import sys
import threading
from contextlib import AbstractContextManager, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import Rule, Severity, has_errors
from wsgen.isolation import parent
from wsgen.isolation.channel import Channel
from wsgen.isolation.codec import decode
from wsgen.isolation.result import DEFAULT_LIMITS, Answered, Died, Limits
from wsgen.launching.explain import ARGUMENT_WITHOUT_VALUE
from wsgen.launching.explain_missing import FILE_NOT_INSTALLED, nodes_of
from wsgen.launching.explain_names import RAISES, REFUSED_BY_LAUNCH, UNDEFINED_NAME
from wsgen.launching.plain import EVALUATE, EXPAND, MOST_BYTES, is_plain
from wsgen.model.plan import LaunchPlan, LaunchRequest
from wsgen.packages.source_shares import name_sources
from wsgen.text.files import read_regular
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from types import TracebackType

    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.parent import Run
    from wsgen.model.plan import LaunchArgument


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
ASSUMED_ARGUMENT = Rule(
    code="LCH092",
    name="assumed-argument",
    severity=Severity.INFO,
    summary="The launch file is evaluated with a launch argument whose value wsgen has chosen.",
    what="Tries, where the launch file fails without it, the values that the launch file names: "
    "choices, values in quotes in the description, and those that conditions compare with.",
    why="`ros2 launch` needs the value on its command line. Another value may start something "
    "else, which is not checked.",
    example="DeclareLaunchArgument('robot', choices=['wheeled', 'tracked'])",
    instead="DeclareLaunchArgument('robot', choices=['wheeled', 'tracked'],\n"
    "                      default_value='wheeled')",
)
MOST_TRIED = 6  # evaluations
_TRUTHS = {"true": "True", "false": "False"}  # of launch -> of Python
_QUOTED = lazy_pattern(r"'([\w.-]+)'|\"([\w.-]+)\"|`([\w.-]+)`")
_COMPARED = lazy_pattern(r"==\s*['\"]+\s*([\w.-]+)|\b([\w.-]+)\s*['\"]+\s*==")
_CONDITIONS = frozenset(("IfCondition", "UnlessCondition"))
_COMPARISONS = frozenset(("LaunchConfigurationEquals", "LaunchConfigurationNotEquals"))


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


def alternatives(
    plan: LaunchPlan,
    given: Mapping[str, str],
    ask_for_arguments: Callable[[], Sequence[LaunchArgument]],
) -> Iterator[dict[str, str]]:
    """The values to try, by argument, for the plan of a launch file that fails for want of them.

    Nothing that is `given` is changed.
    """
    failed = {
        found.code: found.element for found in plan.diagnostics if found.severity is Severity.ERROR
    }
    wanted: dict[str, Sequence[str]] = {}
    if ARGUMENT_WITHOUT_VALUE.code in failed:
        read = _values_in_conditions(plan.launch_file)
        lacking = [one for one in ask_for_arguments() if one.default is None]
        wanted = {one.name: _values(one, read) for one in lacking if one.name not in given}
        if not all(wanted.values()):
            return
    elif failed.get(UNDEFINED_NAME.code) in _TRUTHS:
        wanted = {
            one.name: [_TRUTHS[one.value]]
            for one in plan.arguments
            if one.value in _TRUTHS and one.name not in given
        }
        if wanted:
            yield {name: values[0] for name, values in wanted.items()}
        return
    elif {REFUSED_BY_LAUNCH.code, RAISES.code, FILE_NOT_INSTALLED.code} & failed.keys():
        read = _values_in_conditions(plan.launch_file)
        empty = [one for one in plan.arguments if one.value == "" and one.name not in given]
        wanted = {one.name: values for one in empty if (values := _values(one, read))}
    if wanted:
        rows = itertools.zip_longest(*wanted.values())
        first = [values[0] for values in wanted.values()]
        for row in itertools.islice(rows, MOST_TRIED):
            tried = (value or other for value, other in zip(row, first, strict=True))
            yield dict(zip(wanted, tried, strict=True))


def with_assumed(plan: LaunchPlan, failed: LaunchPlan, values: Mapping[str, str]) -> LaunchPlan:
    """The plan of a launch file with these values, with what is said of them and of the failure."""
    kept = (found for found in failed.diagnostics if found.code != ARGUMENT_WITHOUT_VALUE.code)
    diagnostics = (*kept, _assumed(plan, values), *plan.diagnostics)
    return replace(plan, diagnostics=tuple(dict.fromkeys(diagnostics)))


def _assumed(plan: LaunchPlan, values: Mapping[str, str]) -> Diagnostic:
    words = " ".join(f"{name}:={value}" for name, value in values.items())
    name = next(iter(values))
    return ASSUMED_ARGUMENT.at(
        plan.launch_file,
        None,
        name,
        message=f"The launch file fails without a value for {', '.join(values)}: it is evaluated "
        f"with {words}.",
        hint=f"Declare '{name}' with the default_value that it works with. For wsgen validate, "
        f"--arg {name}:=VALUE gives another one.",
    )


def _values(argument: LaunchArgument, read: Mapping[str, Sequence[str]]) -> list[str]:
    documented = ["".join(groups) for groups in _QUOTED.findall(argument.description)]
    return list(dict.fromkeys((*documented, *read.get(argument.name, ()))))


def _values_in_conditions(file: Path) -> dict[str, list[str]]:
    """The values that the conditions of a launch file have for arguments."""
    nodes: list[Any] = list(nodes_of(file))
    variables = {
        node.targets[0].id: _names_in(node.value, {})
        for node in nodes
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
        if _called(node.value) == "LaunchConfiguration"
    }
    found: dict[str, list[str]] = {}
    for node in nodes:
        kind = _called(node)
        inside: list[Any] = list(ast.walk(node))
        texts = [one.value for one in inside if _is_text(one)]
        if kind in _COMPARISONS:
            names, values = texts[:1], texts[1:2]
        elif kind == "PythonExpression":
            names = _names_in(node, variables)
            compared = _COMPARED.findall("".join(texts))
            values = ["".join(groups) for groups in compared] or [*_TRUTHS.values()]
        elif kind in _CONDITIONS and not any(_called(one) == "PythonExpression" for one in inside):
            names, values = _names_in(node, variables), [*_TRUTHS]
        else:
            continue
        for name in names:
            found.setdefault(name, []).extend(values)
    return found


def _called(node: Any) -> str | None:
    """The name of the function or class that a node calls."""
    return ast.unparse(node.func).rpartition(".")[2] if isinstance(node, ast.Call) else None


def _is_text(node: Any) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def _names_in(node: Any, variables: Mapping[str, Sequence[str]]) -> list[str]:
    """The launch arguments that an expression reads."""
    found: list[str] = []
    inside: list[Any] = list(ast.walk(node))
    for one in inside:
        if _called(one) == "LaunchConfiguration":
            found += [text.value for text in one.args[:1] if _is_text(text)]
        elif isinstance(one, ast.Name):
            found += variables.get(one.id, ())
    return found
