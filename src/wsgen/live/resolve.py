"""What is really started in the place of a process of a launch file, and in which environment.

In the place of launch files of Gazebo's packages, which are not installed, it is what those of
gazebo_ros_pkgs (ros2) and ros_gz (jazzy) start.
"""

from __future__ import annotations

import logging
import os
import shlex
import shutil
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.errors import EXIT_MISSING, RequestError
from wsgen.launching import commands, known_packages
from wsgen.launching.package_lookup import NOT_COMPILED
from wsgen.launching.simulators import is_true
from wsgen.live.asked_nodes import LAUNCH_NODE
from wsgen.live.journal import OTHER, SIMULATOR, SPAWNER, STANDARD
from wsgen.live.replacements import SPAWNERS, BuiltIn, LeftOut, find_replacement
from wsgen.ros.environment.environment import DISCOVERY_VARIABLES
from wsgen.ros.environment.processes import module_command
from wsgen.simulation.live_runs import DOMAIN, FOLDER_VARIABLE
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from wsgen.launching.live import Start
    from wsgen.live.replacements import Replaced
    from wsgen.live.request import ServiceRequest
    from wsgen.model.plan import Include, Process


FOLDER = "bin"  # in the folder of the run
COMMANDS = ("run", "topic", "node")  # that wsgen has, too


def write_ros2(live_folder: Path, python: Path) -> Path:
    """Write it; gives the folder that belongs on the PATH."""
    folder = live_folder / FOLDER
    folder.mkdir()
    program = folder / "ros2"
    command = shlex.join(module_command(python, "wsgen"))
    program.write_text(
        f"""#!/bin/sh
case "$1" in
  {"|".join(COMMANDS)}) exec {command} "$@" ;;
esac
echo "ros2 $1 is not installed: wsgen has {", ".join(COMMANDS)}. Source a ROS that has it." >&2
exit {EXIT_MISSING}
""",
        encoding="utf-8",
    )
    program.chmod(0o755)
    return folder


MIDDLEWARE = "RMW_IMPLEMENTATION"  # of which the ROS of PyPI has one
FORKED = "wsgen.live.nodes."  # modules that can be
_PATHS = ("AMENT_PREFIX_PATH", "LD_LIBRARY_PATH", "PATH", "PYTHONPATH")


@dataclass(frozen=True, kw_only=True)
class Forked:
    """A program of wsgen, as it can be forked."""

    module: str
    words: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Resolved:
    """What is really started."""

    command: tuple[str, ...]
    shown: tuple[str, ...]  # as `ros2 launch` would have started it
    is_shell: bool = False
    is_ours: bool = False
    forked: Forked | None = None  # as which it may be forked, too
    is_simulator: bool = False
    is_spawner: bool = False  # it brings a robot or a controller, and ends
    is_standard: bool = False  # of ROS: where none is sourced, it is replaced or left out

    @property
    def role(self) -> str:
        """As the journal has it."""
        if self.is_simulator:
            return SIMULATOR
        if self.is_spawner:
            return SPAWNER
        return STANDARD if self.is_ours or self.is_standard else OTHER


class Resolver:
    """Knows for one launch what stands in the place of which program.

    Args:
        request: What the launch service is given.
        log_folder: That of the processes' logs, if they have one.
        simulator_folder: The folder of the live run whose simulator spawners ask.
    """

    def __init__(
        self, request: ServiceRequest, *, log_folder: Path | None, simulator_folder: Path
    ) -> None:
        self._request = request
        self._log_folder = log_folder
        self._simulator_folder = simulator_folder
        self._reported: set[str] = set()
        self._ros2: Path | None = None  # the folder of a `ros2`

    def write_programs(self) -> None:
        """Write the programs that processes find beside those of the workspace."""
        if not self._request.is_sourced:
            self._ros2 = write_ros2(self._request.folder, self._request.python)

    def resolve(self, start: Start) -> Resolved | LeftOut | None:
        """What is started in the place of a process; None: the launch file is played here, too."""
        programs = commands.programs(start.process)
        if any(commands.nested_launch(program) for program in programs):
            return None
        if start.prefix and shutil.which(start.prefix[0]) is None:
            return LeftOut(why=f"{start.prefix[0]}, which is to run it, is not installed")
        only = programs[0] if len(programs) == 1 else None
        found = None if only is None else self._stand_of(only, start)
        if found is None:
            found = self._node(start) if is_node(start) else self._command(start, only)
            if isinstance(found, Resolved) and only is not None:
                is_standard = self._replacement(only, start, is_sourced=False) is not None
                found = replace(found, is_standard=is_standard)
        return found

    def _stand_of(self, program: Process, start: Start) -> Resolved | LeftOut | None:
        """What stands in the place of a program, if anything does."""
        found = self._replacement(program, start, is_sourced=self._request.is_sourced)
        if found is None:
            return None
        if isinstance(found.replacement, LeftOut):
            return found.replacement
        return self._built_in(found.replacement, found.arguments, start)

    @staticmethod
    def _replacement(program: Process, start: Start, *, is_sourced: bool) -> Replaced | None:
        arguments = start.words if is_node(start) else program.arguments
        name = program.executable or ""
        return find_replacement(program.package, name, tuple(arguments), is_sourced=is_sourced)

    def _command(self, start: Start, only: Process | None) -> Resolved | LeftOut:
        """A command line, which may be that of one program."""
        if only is not None and only.package is not None:
            return self._ros2_run(only, start)
        shown = (*start.prefix, *start.words)
        command = shown if start.is_shell else self._with_interpreter(shown)
        return Resolved(command=command, shown=shown, is_shell=start.is_shell)

    def _node(self, start: Start) -> Resolved | LeftOut:
        """A program of a package, or one by its path."""
        path = start.path if start.package else start.executable
        if path is None:
            return LeftOut(why=NOT_COMPILED)
        missing = self._why_missing(start.package, path)
        if missing is not None:
            return missing
        command = (*start.prefix, *self._with_interpreter((path, *start.words)))
        return Resolved(command=command, shown=(*start.prefix, path, *start.words))

    def _built_in(self, program: BuiltIn, arguments: tuple[str, ...], start: Start) -> Resolved:
        # Its path on a machine with ROS is none of this one.
        name = [Path(start.path).name] if start.path else []
        shown = (*start.prefix, *name, *start.words)
        words = arguments if program.keeps_arguments else _ros_arguments(arguments)
        command_line = module_command(
            self._request.python, program.module, *program.arguments, *words
        )
        command = (*start.prefix, *command_line)
        if program.note:
            self._notify(f"{Path(start.path or start.executable or '').name}: {program.note}")
        is_simulator = program.module.endswith(".simulator")
        is_forked = program.module.startswith(FORKED) and not start.prefix
        return Resolved(
            command=command,
            shown=shown,
            is_ours=True,
            forked=Forked(module=program.module, words=(*program.arguments, *words))
            if is_forked
            else None,
            is_simulator=is_simulator,
            is_spawner=program.module in SPAWNERS,
        )

    def launch_node(self) -> Resolved:
        """What asks nodes for the launch."""
        command = module_command(self._request.python, LAUNCH_NODE)
        return Resolved(
            command=command,
            shown=("launch_ros",),
            is_ours=True,
            forked=Forked(module=LAUNCH_NODE, words=()),
        )

    def _ros2_run(self, program: Process, start: Start) -> Resolved | LeftOut:
        """What `ros2 run` starts; with a sourced ROS that itself."""
        if self._request.is_sourced:
            return Resolved(command=start.words, shown=start.words, is_shell=start.is_shell)
        package, executable = program.package or "", program.executable or ""
        variables = self.environment_of(os.environ)
        for prefix in variables.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
            path = str(Path(prefix, "lib", package, executable))
            if os.access(path, os.X_OK):
                command = self._with_interpreter((path, *program.arguments))
                return Resolved(command=command, shown=start.words)
        return LeftOut(why=f"no package {package} with this program is installed")

    def _why_missing(self, package: str | None, path: str) -> LeftOut | None:
        """Why a program cannot be started, if it cannot."""
        if package is None or Path(path).exists():
            return None
        if path.startswith(known_packages.prefix()):
            return LeftOut(
                why=f"the package {package} is not installed; with ROS 2 installed and sourced it "
                "runs"
            )
        return LeftOut(why=f"{package} is not built; run `wsgen build`", is_mistake=True)

    def _with_interpreter(self, command: tuple[str, ...]) -> tuple[str, ...]:
        """A command whose Python is the one that ROS's libraries are for."""
        if self._request.is_sourced or not command:
            return command
        program, *rest = command
        if program in {"python", "python3"}:
            return (str(self._request.python), *rest)
        if Path(program).is_absolute() and _is_python_script(program):
            return (str(self._request.python), *command)
        return command

    def environment_of(self, wanted: Mapping[str, str]) -> dict[str, str]:
        """The environment of a process: what the launch file wants, and what ROS needs."""
        found = dict(wanted)
        before = self._request.environment
        for name, value in self._request.variables.items():
            own = found.get(name)
            if own is None or own == before.get(name):
                found[name] = value
            elif name == MIDDLEWARE and not self._request.is_sourced:
                found[name] = value
                if own != value:
                    self._notify(f"{own} is not on PyPI: nodes use {value}")
            elif name in _PATHS:  # the launch file has added to it
                found[name] = os.pathsep.join([own, value])
        if not self._request.is_sourced:
            found["PATH"] = self._with_programs(found.get("PATH", os.defpath))
        if self._request.is_watched:
            self._keep_apart(found)
        found[FOLDER_VARIABLE] = str(self._simulator_folder)
        found.setdefault("PYTHONUNBUFFERED", "1")
        if self._request.is_colored:
            found.setdefault("RCUTILS_COLORIZED_OUTPUT", "1")
        if self._log_folder is not None:
            found.setdefault("ROS_LOG_DIR", str(self._log_folder))
        return found

    def _keep_apart(self, variables: dict[str, str]) -> None:
        """Keep a process of a session in its domain, whatever the launch file sets.

        In the domain that a launch file names, parallel tests would hear each other.
        """
        own = {**self._request.environment, **self._request.variables}
        for name in (DOMAIN, *DISCOVERY_VARIABLES):
            wanted = variables.pop(name, None)
            if name in own:
                variables[name] = own[name]
            if wanted not in {None, own.get(name)}:
                self._notify(
                    f"{name}={wanted} of the launch file is left out: tests are kept apart"
                )

    def _with_programs(self, path: str) -> str:
        """A PATH with what is beside the interpreter of nodes, and `ros2`."""
        folders = [str(self._request.python.parent), path]
        if self._ros2 is not None:
            folders.insert(0, str(self._ros2))
        return os.pathsep.join(folders)

    def _notify(self, text: str) -> None:
        """Say something once."""
        if text not in self._reported:
            self._reported.add(text)
            logging.getLogger("launch").info("%s", text)


def is_node(start: Start) -> bool:
    """Whether it is a node, and not a command line."""
    return start.process.command is None


def _ros_arguments(words: Sequence[str]) -> tuple[str, ...]:
    """What follows --ros-args, which a program takes whatever else it is given."""
    if "--ros-args" not in words:
        return ()
    return tuple(words[list(words).index("--ros-args") :])


def _is_python_script(path: str) -> bool:
    """Whether the first line of a program says that Python runs it."""
    try:
        with open(path, "rb") as stream:  # noqa: PTH123  as launch has them, paths are texts
            first = stream.readline(256)
    except OSError:
        return False
    return first.startswith(b"#!") and b"python" in first


def entities_of(include: Include) -> list[Any] | None:
    """What is visited in the place of a launch file; None where it is not known."""
    files = _LAUNCH_FILES.get(include.package or "", {})
    read = files.get(include.file.name.partition(".")[0])
    if read is None:
        return None
    return list(read({**include.arguments, **include.configurations}))


def _process(words: list[str], *, is_required: bool, name: str | None = None) -> Any:
    """A process of a command line; where it is required, its end is that of the launch."""
    from launch.actions import ExecuteProcess, Shutdown  # noqa: PLC0415  the shim's

    on_exit = Shutdown() if is_required else None
    return ExecuteProcess(cmd=words, name=name, output="screen", on_exit=on_exit)


def _node(package: str, executable: str, **keywords: Any) -> Any:
    from launch_ros.actions import Node  # noqa: PLC0415  the shim's

    return Node(package=package, executable=executable, output="screen", **keywords)


def _gazebo(values: Mapping[str, str]) -> Iterator[Any]:
    if is_true(values.get("server", "true")):
        yield from _gzserver(values)
    if is_true(values.get("gui", "true")):
        yield from _gzclient(values)


def _gzserver(values: Mapping[str, str]) -> Iterator[Any]:
    paused = ["--pause"] if is_true(values.get("pause", "false")) else []
    words = ["gzserver", values.get("world", ""), *paused, *_node_parameters(values)]
    yield _process(words, is_required=is_true(values.get("server_required", "false")))


def _node_parameters(values: Mapping[str, str]) -> list[str]:
    """Parameters of Gazebo's nodes, such as `publish_rate`: a file, or among other arguments."""
    file, extra = values.get("params_file", ""), values.get("extra_gazebo_args", "")
    words = ["--ros-args", "--params-file", file, "--"] if file else []
    try:
        return [*words, *shlex.split(extra)]
    except ValueError:  # a quotation mark without its other one
        return [*words, *extra.split()]


def _gzclient(values: Mapping[str, str]) -> Iterator[Any]:
    yield _process(["gzclient"], is_required=is_true(values.get("gui_required", "false")))


def _gz_sim(values: Mapping[str, str]) -> Iterator[Any]:
    name = "gz_args" if values.get("gz_args") else "ign_args"
    text = values.get(name, "")
    try:
        words = shlex.split(text)
    except ValueError:
        raise RequestError(
            f"{name} has a quotation mark without its other one: {text}",
            hint="Write both, or none: the shell that starts Gazebo Sim refuses it, too.",
        ) from None
    is_required = is_true(values.get("on_exit_shutdown", "false"))
    yield _process(["gz", "sim", *words], is_required=is_required, name="gazebo")


def _gz_server(values: Mapping[str, str]) -> Iterator[Any]:
    world = values.get("world_sdf_file", "")
    yield _node("ros_gz_sim", "gzserver", parameters=[{"world_sdf_file": world}])


def _gz_spawn_model(values: Mapping[str, str]) -> Iterator[Any]:
    names = {
        "world": "world",
        "file": "file",
        "model_string": "string",
        "topic": "topic",
        "entity_name": "name",
    }
    parameters: dict[str, Any] = {
        parameter: values.get(argument, "") for argument, parameter in names.items()
    }
    parameters["allow_renaming"] = is_true(values.get("allow_renaming", "false"))
    for axis in ("x", "y", "z", "R", "P", "Y"):
        parameters[axis] = _number(axis, values.get(axis) or "0.0")
    yield _node("ros_gz_sim", "create", parameters=[parameters])


def _number(name: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise RequestError(
            f"{name} is `{text}`, which is not a number.",
            hint="Give meters, and radians for R, P and Y.",
        ) from None


def _bridge(values: Mapping[str, str]) -> Iterator[Any]:
    yield _node(
        "ros_gz_bridge",
        "bridge_node",
        name=values.get("bridge_name") or None,
        namespace=values.get("namespace") or None,
        parameters=[{"config_file": values.get("config_file", "")}],
        respawn=is_true(values.get("use_respawn", "false")),
    )


def _server_and_bridge(values: Mapping[str, str]) -> Iterator[Any]:
    yield from _gz_server(values)
    yield from _bridge(values)


def _model_and_bridge(values: Mapping[str, str]) -> Iterator[Any]:
    yield from _bridge(values)
    yield from _gz_spawn_model(values)


# Package -> launch file, without what follows its first dot -> what it starts.
_LAUNCH_FILES: dict[str, dict[str, Callable[[Mapping[str, str]], Iterator[Any]]]] = {
    "gazebo_ros": {"gazebo": _gazebo, "gzserver": _gzserver, "gzclient": _gzclient},
    "ros_gz_sim": {
        "gz_sim": _gz_sim,
        "gz_server": _gz_server,
        "gz_spawn_model": _gz_spawn_model,
        "ros_gz_sim": _server_and_bridge,
        "ros_gz_spawn_model": _model_and_bridge,
    },
    "ros_gz_bridge": {"ros_gz_bridge": _bridge},
    "ros_ign_gazebo": {"ign_gazebo": _gz_sim},
}
