"""Evaluate a launch file in this process; only ever called in a child process.

The launch file is a program and is run as one. The shim stands in the place of the real `launch`,
`launch_ros` and `ament_index_python`, so that it starts nothing. Python modules of packages that
are not installed can be imported all the same: what a launch file takes from them is unknown, see
`launch._unknown`. A module that is neither known nor declared in package.xml
stays an ImportError.
"""

from __future__ import annotations

import ast
import builtins
import functools
import importlib
import io
import os
import sys
import traceback
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import has_errors
from wsgen.isolation.child import copy_environment, scratch_folder, set_environment
from wsgen.launching import known_packages, package_lookup, written_files
from wsgen.launching.record import RECORD, ForkError, NotPlainError, caller, callers
from wsgen.model.plan import ABSENT_MODULE, LaunchArgument, LaunchPlan
from wsgen.ros.names import rosdep_keys

if TYPE_CHECKING:
    import logging
    from collections.abc import Callable, Mapping, Sequence

    from launch.actions import IncludeLaunchDescription
    from launch.launch_context import LaunchContext
    from wsgen.launching.live import Live
    from wsgen.launching.record import CommandRunner
    from wsgen.model.plan import LaunchRequest

    Explainer = Callable[[BaseException], "dict[str, Any] | None"]


_SHIM = os.path.join(os.path.dirname(__file__), "shim")
_ROS_PACKAGES = os.path.join(os.path.dirname(__file__), "ros_packages")
_DESCRIPTIONS = (".urdf", ".xacro", ".sdf", ".xml")
FIRST_IMPORTED = ("ament_index_python.packages", "launch")  # every evaluation uses them
OFTEN_IMPORTED = (
    *("ament_index_python.packages", "launch", "launch.actions", "launch.conditions"),
    *("launch.event_handlers", "launch.launch_description_sources", "launch.substitutions"),
    *("launch_ros.actions", "launch_ros.parameter_descriptions", "launch_ros.substitutions"),
    *("xacro.substitution_args", "xml.dom.expatbuilder", "yaml"),
)
_SHIM_PACKAGES = ("launch", "launch_ros", "launch_xml", "launch_yaml", "ament_index_python")
_OS = ("<frozen os>", os.__file__)  # in which os.getenv() is
MESSAGES = ("_msgs", "_interfaces", "_srvs")


def _logger() -> logging.Logger:
    """That of a launch that is started; an evaluation does not load it."""
    import logging

    return logging.getLogger("launch")


def evaluate(
    request: LaunchRequest, *, run_xacro: CommandRunner, explain_xacro: Explainer
) -> LaunchPlan:
    """What the launch file would start, and the diagnostics about it.

    With `only_arguments` it is loaded and asked for its arguments, as `ros2 launch --show-args`
    does, and not played: their defaults are described in words. `run_xacro` gives the outcome of a
    command line that begins with `xacro`; `explain_xacro` says what an exception of
    xacro is about; None for others.
    """
    launch_file = str(request.launch_file)
    RECORD.package = request.package
    RECORD.run_xacro = run_xacro
    RECORD.with_origins = request.with_origins
    _install()
    _take_answers(request.answers)
    RECORD.environment = copy_environment()
    _note_unset_variables()
    RECORD.ends_branch = lambda error: _ends_branch(error, launch_file, explain_xacro)
    is_complete = False
    if request.with_origins:
        from wsgen.launching.origins import files_read  # what it imports is not what is evaluated
    _watch_once()
    try:
        if request.only_arguments:
            _ask_for_arguments(launch_file)
        else:
            _play(launch_file, request.arguments)
            _report_unused_arguments(launch_file, request.arguments)
            _report_vain_handlers()
            package_lookup.report(launch_file)
        is_complete = True
    except NotPlainError:
        pass  # it is evaluated again
    except BaseException as error:  # noqa: BLE001  foreign code
        from wsgen.launching.explain import explain

        RECORD.report(explain(error, launch_file, explain_xacro(error)))
    if RECORD.unused_xacro_arguments:
        from wsgen.launching.launch_warnings import report_unused_xacro_arguments

        report_unused_xacro_arguments(RECORD.unused_xacro_arguments)
    RECORD.find_description_files()
    read = tuple(files_read()) if request.with_origins else ()
    written_files.remove_copies()
    return LaunchPlan(
        package=request.package,
        launch_file=request.launch_file,
        arguments=tuple(RECORD.arguments.values()),
        processes=tuple(RECORD.processes),
        includes=tuple(RECORD.includes),
        lookups=package_lookup.lookups(),
        environment=RECORD.changed_environment(),
        written=RECORD.written,
        written_from=RECORD.written_from,
        unresolved=tuple(RECORD.unresolved),
        diagnostics=tuple(RECORD.diagnostics),
        files=read,
        unanswered=RECORD.unanswered,
        is_complete=is_complete,
    )


def evaluate_plain(
    request: LaunchRequest,
    environment: Mapping[str, str],
    *,
    run_xacro: CommandRunner,
    explain_xacro: Explainer,
) -> LaunchPlan | None:
    """Evaluate a launch file in a process that evaluates others, too, with this environment.

    None comes back where it needs a process of its own: where it, or what it includes, may leave
    something behind (`launch.plain`), and where it fails.
    """
    before = _Process()
    RECORD.forget()
    RECORD.is_shared = True
    RECORD.plain_file = str(request.launch_file)
    known_packages.forget_declared()
    set_environment(environment)
    try:
        plan = evaluate(request, run_xacro=run_xacro, explain_xacro=explain_xacro)
    finally:
        before.restore()
    if RECORD.is_refused or not plan.is_complete or plan.unanswered:
        return None
    return None if has_errors(plan.diagnostics) else plan


class _Process:
    """What an evaluation changes in its process."""

    def __init__(self) -> None:
        from ament_index_python import packages  # of the shim

        self._packages = packages
        self._find_prefix = packages.find_prefix
        self._path = sys.path[:]
        self._finders = sys.meta_path[:]
        self._streams = sys.stdin, sys.stdout, sys.stderr
        self._words = sys.argv
        self._input = builtins.input
        self._folder = os.getcwd()
        self._bytecode = sys.dont_write_bytecode

    def restore(self) -> None:
        """Set it back, but for the environment, which the next one sets."""
        self._packages.find_prefix = self._find_prefix  # xacro files that it expands have another
        sys.path[:] = self._path
        sys.meta_path[:] = self._finders
        sys.stdin, sys.stdout, sys.stderr = self._streams
        sys.argv = self._words
        builtins.input = self._input
        vars(os.environ).pop("get", None)
        os.chdir(self._folder)
        sys.dont_write_bytecode = self._bytecode


def _install(*, for_processes: bool = True) -> None:
    """Put the shim before all other modules, here and in what the launch file starts."""
    sys.dont_write_bytecode = True  # beside the modules of the workspace that it imports
    if not _is_shim_loaded():
        for name in [name for name in sys.modules if name.partition(".")[0] in _SHIM_PACKAGES]:
            del sys.modules[name]
    sys.path.insert(0, _SHIM)
    sys.path.append(_ROS_PACKAGES)
    sys.meta_path.append(_MissingModules())
    if for_processes:
        inherited = os.environ.get("PYTHONPATH")
        os.environ["PYTHONPATH"] = os.pathsep.join([inherited, _SHIM] if inherited else [_SHIM])
    # Where wsgen is installed there is an xacro, for launch files that start it themselves.
    beside = os.path.dirname(sys.executable)
    os.environ["PATH"] = os.pathsep.join([os.environ.get("PATH", os.defpath), beside])
    from ament_index_python import packages

    packages.find_prefix = package_lookup.find_prefix


def load_shim(names: Sequence[str] = OFTEN_IMPORTED) -> None:
    """Import what nearly every launch file does, ahead of the processes that evaluate one each."""
    sys.path.insert(0, _SHIM)
    for name in names:
        importlib.import_module(name)
    sys.path.remove(_SHIM)


def _is_shim_loaded() -> bool:
    launch = sys.modules.get("launch")
    return launch is not None and (launch.__file__ or "").startswith(_SHIM)


_OWN_VARIABLES = "WSGEN_"  # which wsgen reads while the user's files are evaluated


def _note_unset_variables() -> None:
    """Remember which variables the user's files read without a default that are not set."""
    get = os.environ.get

    def note(name: str, default: Any = None) -> Any:
        value = get(name, default)
        if value is None and not name.startswith(_OWN_VARIABLES):
            reader = next((place for place in callers() if place[0] not in _OS), None)
            if reader is not None and reader[0] in RECORD.launch_files:
                RECORD.unset[name] = reader
        return value

    os.environ.get = note  # type: ignore[assignment,method-assign]  # os.getenv() calls it, too


class _Answers(io.StringIO):
    """Standard input: a line for each answer."""

    def readline(self, size: int | None = -1, /) -> str:  # type: ignore[override]  # of typeshed
        """The next answer; notes that none is left."""
        line = super().readline(-1 if size is None else size)
        RECORD.unanswered |= not line
        return line


def _take_answers(answers: Sequence[str]) -> None:
    """Let the launch file read the answers, and remember what it prints before it asks."""
    sys.stdin = _Answers("".join(f"{answer}\n" for answer in answers))
    ask, folder = builtins.input, scratch_folder()
    printed = 0

    def remember(prompt: object = "", /) -> str:
        nonlocal printed
        sys.stdout.write(str(prompt))
        sys.stdout.flush()
        output = Path(folder, "output").read_bytes() if folder else b""
        RECORD.prompt = output[printed:].decode(errors="replace")
        printed = len(output)
        return ask()

    builtins.input = remember


def _ends_branch(error: Exception, launch_file: str, explain_xacro: Explainer) -> bool:
    """Whether the launch goes on without what raised the exception, which is noted."""
    if hasattr(error, "wsgen_ends_all"):
        return False
    if RECORD.is_ending and isinstance(error, OSError):
        return True  # the files that it removes would be there after a real launch
    from wsgen.launching.explain import OF_A_BRANCH, explain
    from wsgen.launching.explain_missing import uncompiled

    program = uncompiled(error)
    if program is not None:
        RECORD.left_out.append((*program, RECORD.visited))
        return True
    found = explain(error, launch_file, explain_xacro(error))
    if found.code not in OF_A_BRANCH:
        error.wsgen_ends_all = True  # type: ignore[attr-defined]  # what it is raised through asks
        return False
    RECORD.report(found)
    return True


@functools.cache
def _watch_once() -> None:
    sys.addaudithook(_watch)  # which cannot be taken away again


def _watch(event: str, arguments: tuple[Any, ...]) -> None:
    """Remember the descriptions that the launch file reads without xacro; let it not fork.

    Two processes would evaluate it, and which of them answered would be chance. What `subprocess`
    starts is none of this. What the end of the launch would remove is read after the evaluation.
    """
    if RECORD.is_ending and event in ("os.remove", "os.rmdir", "shutil.rmtree"):
        raise PermissionError("nothing is removed, because nothing runs")
    if event in ("os.fork", "os.forkpty"):
        raise ForkError
    # Folders are searched for files to include: <xacro:include filename="parts/*.xacro"/>.
    if event in ("open", "os.scandir") and RECORD.opened_by_xacro is not None:
        RECORD.opened_by_xacro.append(os.path.abspath(str(arguments[0])))
    if event == "compile" and package_lookup.runs_ros2_pkg(arguments[0]):
        package_lookup.answer_ros2_pkg()
    if event == "open":
        if str(arguments[0]).endswith(_DESCRIPTIONS):
            RECORD.opened.append(os.path.abspath(str(arguments[0])))
        if RECORD.with_origins:
            from wsgen.launching.origins import note_opened

            note_opened(*arguments[:3])


# Names of modules that are not installed, of which something is known: package, and who knows it.
_STAND_INS = dict.fromkeys(
    ("MoveItConfigs", "MoveItConfigsBuilder"),
    ("moveit_configs_utils", "wsgen.launching.moveit_configs"),
)


class _MissingModule(ModuleType):
    """Every name in it is unknown."""

    def __getattr__(self, name: str) -> Any:
        if name == "__all__":  # of `from module import *`
            return _names_from_elsewhere()
        if name.startswith("__"):
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        stand_in = _STAND_INS.get(name)
        if stand_in is not None and self.__name__.partition(".")[0] == stand_in[0]:
            return getattr(importlib.import_module(stand_in[1]), name)
        from launch._unknown import Unknown

        return Unknown(f"{self.__name__}.{name}")


def _names_from_elsewhere() -> list[str]:
    """The names that the file which is importing uses, and that nothing else has given it."""
    from wsgen.launching.explain_missing import nodes_of

    frame = sys._getframe(2)  # noqa: SLF001  no stack has to be built for it
    while frame.f_back is not None and "importlib" in frame.f_code.co_filename:
        frame = frame.f_back
    used: set[str] = set()
    bound = {*frame.f_globals, *vars(builtins)}
    for node in nodes_of(frame.f_code.co_filename):
        if isinstance(node, ast.Name):
            (used if isinstance(node.ctx, ast.Load) else bound).add(node.id)
        elif isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            bound.add(node.name)
        elif isinstance(node, ast.arg):
            bound.add(node.arg)
        elif isinstance(node, ast.alias):
            bound.add((node.asname or node.name).partition(".")[0])
    return sorted(used - bound)


class _MissingModules:
    """The last finder: it is asked for what no other one has found."""

    def find_spec(
        self, name: str, _path: Sequence[str] | None = None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find modules of packages that are not installed, and the modules in them."""
        package, _, inside = name.partition(".")
        if inside and not isinstance(sys.modules.get(package), _MissingModule):
            return None  # the package is installed, and has no such module
        location = caller()
        source = None if inside else package_lookup.source_of(package)
        found = source and PathFinder.find_spec(package, [source])
        if found:
            return found
        if not inside and (
            location is None
            or package_lookup.is_of_library(location)
            or not self._is_expected(package)
        ):
            return None
        if not inside:
            RECORD.lookups.setdefault(package, location)
            RECORD.note_unresolved(package, ABSENT_MODULE, location)
            RECORD.argument_use.is_unknown = True
        return ModuleSpec(name, self, is_package=True)  # type: ignore[arg-type]  # all it needs

    @staticmethod
    def _is_expected(package: str) -> bool:
        return (
            package in known_packages.KNOWN_MODULES
            or package.endswith(MESSAGES)
            or known_packages.is_released(package)
            or f"python3-{package}" in rosdep_keys()
            or package_lookup.declares(RECORD.launch_files, package)
        )

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Make an empty module."""
        return _MissingModule(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        """Nothing is in it."""


def _ask_for_arguments(launch_file: str) -> None:
    from launch.launch_context import LaunchContext
    from launch.launch_description_sources import AnyLaunchDescriptionSource

    description = AnyLaunchDescriptionSource(launch_file).get_launch_description(LaunchContext())
    for argument in description.get_launch_arguments():
        default = argument.default_value
        RECORD.arguments[argument.name] = LaunchArgument(
            name=argument.name,
            default=None
            if default is None
            else " + ".join(substitution.describe() for substitution in default),
            value=None,
            description=str(argument.description),
            is_conditional=bool(argument.conditionally_included),
            origin=RECORD.origin(argument.wsgen_location),
        )


def _report_unused_arguments(launch_file: str, arguments: Mapping[str, str]) -> None:
    """Warn of launch arguments that have no effect; a real launch does not mention them."""
    use = RECORD.argument_use
    given = [name for name in arguments if use.is_unused(name)]
    of_includes = [entry for entry in use.given if use.is_unused(entry[0])]
    if given or of_includes:
        from wsgen.launching.launch_warnings import report_unused_arguments

        report_unused_arguments(launch_file, given, of_includes)


def _report_vain_handlers() -> None:
    """Report event handlers that are never called."""
    vain = [one for one in RECORD.handlers if getattr(one, "wsgen_waits_in_vain", False)]
    if vain:
        from wsgen.launching.launch_warnings import report_vain_handlers

        report_vain_handlers(vain)


def _play(launch_file: str, arguments: Mapping[str, str]) -> None:
    """What `ros2 launch` does with a launch file and arguments."""
    from launch.launch_description import play

    play(*_root(launch_file, arguments))


def _root(
    launch_file: str, arguments: Mapping[str, str]
) -> tuple[IncludeLaunchDescription, LaunchContext]:
    """What is played, and the state that it begins with."""
    from launch.actions import IncludeLaunchDescription
    from launch.launch_context import LaunchContext
    from launch.launch_description_sources import AnyLaunchDescriptionSource

    source = AnyLaunchDescriptionSource(launch_file)
    root = IncludeLaunchDescription(source, launch_arguments=tuple(arguments.items()))
    words = [f"{name}:={value}" for name, value in arguments.items()]
    sys.argv = ["ros2", "launch", RECORD.package or "", os.path.basename(launch_file), *words]
    return root, LaunchContext(argv=words)


def play_live(
    request: LaunchRequest, live: Live, *, run_xacro: CommandRunner, explain_xacro: Explainer
) -> bool:
    """Play a launch file in the time that passes, until it is shut down; whether it went well.

    `live` starts what the launch file describes. An exception is reported in the words of
    `ros2 launch`, and shuts it down.
    """
    RECORD.package, RECORD.run_xacro, RECORD.live = request.package, run_xacro, live
    _install(for_processes=False)
    _take_answers(request.answers)
    RECORD.environment = copy_environment()
    launch_file = str(request.launch_file)
    RECORD.ends_branch = lambda error: _is_left_out(error, live)
    from launch._events import Shutdown
    from launch.launch_description import play, play_on

    root, context = _root(launch_file, request.arguments)
    live.begin(context)
    went_well = True

    def survives(play: Callable[[], None]) -> bool:
        try:
            play()
        except Exception as error:  # noqa: BLE001  foreign code
            reason = f"Caught exception in launch (see debug for traceback): {error}"
            logger = _logger()
            logger.debug("%s", traceback.format_exc())
            logger.error("%s", reason)  # noqa: TRY400  its traceback is not for users
            _report_place(error, explain_xacro)
            if not context.is_shutdown:
                context.shut_down(Shutdown(reason=reason))
            return False
        return True

    went_well = survives(lambda: play(root, context))
    is_over = went_well
    while not is_over:
        is_over = survives(lambda: play_on(context))
    return went_well


def _report_place(error: Exception, explain_xacro: Explainer) -> None:
    """Say which line of the user's an exception is about, which `ros2 launch` does not."""
    found = explain_xacro(error)
    location = (
        (found.get("file"), found.get("line")) if found else getattr(error, "wsgen_location", None)
    )
    if location and location[0] and os.path.isfile(location[0]):
        place = ":".join(str(part) for part in location if part is not None)
        _logger().error("%s", f"It was raised at {place}")


def _is_left_out(error: Exception, live: Live) -> bool:
    """Whether the launch goes on without a program that was not compiled, which is named."""
    from wsgen.launching.explain_missing import uncompiled

    program = uncompiled(error)
    if program is None:
        return False
    name, package = program
    live.leave_out(f"{name} of {package}", package_lookup.NOT_COMPILED)
    return True
