"""Read from a plan which simulator it starts, and in which world."""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.launching.commands import (
    commands_without_shell,
    split,
    started_launch_files,
    started_programs,
)
from wsgen.launching.explain_missing import or_unused_action
from wsgen.model.target import CLASSIC, SIM
from wsgen.model.world import Simulator

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import Include, LaunchPlan, Process


NO_SIMULATOR = Rule(
    code="SPN001",
    name="no-simulator",
    severity=Severity.WARNING,
    severity_varies="an error if an action that starts one is created but not added",
    summary="The launch file starts no simulator.",
    what="Looks for the launch files and programs of Gazebo Classic and Gazebo Sim among what the "
    "launch file includes and starts.",
    why="The spawner waits for the service of a simulator that something else must start. The "
    "robot is simulated in an empty world with a ground plane.",
    example="gazebo = IncludeLaunchDescription(...)  # not added to the LaunchDescription",
    instead="launch_description.add_action(gazebo)",
)
_GZ_PACKAGES = ("ros_gz", "ros_ign", "gz_ros2_control", "ign_ros2_control")
_CLASSIC_PACKAGES = ("gazebo_ros", "gazebo_plugins", "gazebo_ros2_control")
PACKAGES_OF_GAZEBO = (*_GZ_PACKAGES, *_CLASSIC_PACKAGES)  # and those whose names start so
WORLD_SUFFIXES = (".sdf", ".world")
# The options of the simulators that take a value as a word of their own.
_WITH_VALUE = frozenset(
    (
        *("-e", "-g", "-p", "-s", "-z", "--force-version", "--gui-client-plugin", "--gui-config"),
        *("--iterations", "--iters", "--model-database", "--params-file", "--physics", "--play"),
        *("--plugin", "--profile", "--record-path", "--record_path", "--seed"),
    )
)


def _of_gazebo(values: Mapping[str, str]) -> Simulator | None:
    if not is_true(values.get("server", "true")):
        return None
    return _classic(values.get("world"), is_headless=not is_true(values.get("gui", "true")))


def _of_gz_arguments(values: Mapping[str, str]) -> Simulator | None:
    return _gz(split(values.get("gz_args") or values.get("ign_args") or ""))


def _of_gz_server(values: Mapping[str, str]) -> Simulator | None:
    return _server(values.get("world_sdf_file"), values.get("world_sdf_string"))


def _server(file: object, text: object) -> Simulator:
    return Simulator(
        kind=SIM,
        world=str(file) if file else None,
        is_headless=True,
        is_world_known=bool(file) or not text,
    )


# Launch file, without what follows its first dot -> the simulator that its arguments mean; by
# package, under all the names that it had.
_GZ_LAUNCH_FILES: dict[str, Callable[[Mapping[str, str]], Simulator | None]] = {
    "gz_sim": _of_gz_arguments,
    "ign_gazebo": _of_gz_arguments,
    "ignition": _of_gz_arguments,
    "gz_server": _of_gz_server,
    "ros_gz_sim": _of_gz_server,
}
_LAUNCH_FILES: dict[str, dict[str, Callable[[Mapping[str, str]], Simulator | None]]] = {
    "gazebo_ros": {
        "gazebo": _of_gazebo,
        "gzserver": lambda values: _classic(values.get("world"), is_headless=True),
    },
    "ros_gz_sim": _GZ_LAUNCH_FILES,
    "ros_ign_gazebo": _GZ_LAUNCH_FILES,
}


def find_simulator(plan: LaunchPlan) -> tuple[Simulator | None, tuple[Diagnostic, ...]]:
    """The simulator that the plan starts; None where it starts none that is known."""
    commands = tuple(commands_without_shell(plan))
    for simulator in _simulators(plan):
        is_known = not plan.is_unknown(simulator.world or "")
        return simulator if is_known else _in_default_world(simulator), commands
    missing = NO_SIMULATOR.at(
        plan.launch_file,
        message="The launch file starts no simulator.",
        hint=_how_to_start(plan),
    )
    kinds = ("IncludeLaunchDescription", "ExecuteProcess")
    unused = or_unused_action(missing, plan, *kinds, names=_names())
    return None, (*commands, unused)


def simulator_kinds(plan: LaunchPlan) -> frozenset[str]:
    """The simulators that the plan starts, "classic" or "gz"."""
    return frozenset(simulator.kind for simulator in _simulators(plan))


def kind_of_project(plan: LaunchPlan) -> str | None:
    """The simulator that the packages belong to which the plan uses."""
    packages = [include.package or "" for include in plan.includes]
    packages += [process.package or "" for process in started_programs(plan)]
    if any(package.startswith(_GZ_PACKAGES) for package in packages):
        return SIM
    return CLASSIC if any(package.startswith(_CLASSIC_PACKAGES) for package in packages) else None


def _simulators(plan: LaunchPlan) -> Iterator[Simulator]:
    started = (
        *(_included(include) for include in started_launch_files(plan)),
        *(_started(program) for program in started_programs(plan)),
    )
    return (simulator for simulator in started if simulator is not None)


def _included(include: Include) -> Simulator | None:
    files = _LAUNCH_FILES.get(include.package or "", {})
    read = files.get(include.file.name.partition(".")[0])
    return None if read is None else read(include.configurations or include.arguments)


def _started(program: Process) -> Simulator | None:
    """The simulator that a program is, whatever package starts it."""
    name = program.executable or ""
    if program.package in {"ros_gz_sim", "ros_ign_gazebo"} and name in _GZ_SERVERS:
        given = program.parameters
        return _server(
            given.get("world_sdf_file") or _world(program.arguments), given.get("world_sdf_string")
        )
    if name in _CLASSIC_PROGRAMS and program.package in {None, "gazebo_ros"}:
        return _classic(_world(program.arguments), is_headless=name == "gzserver")
    if name in _GZ_PROGRAMS and program.package is None:
        words = [part for word in program.arguments for part in _parts(word)]
        return _gz(words[1:]) if words[:1] in [["sim"], ["gazebo"]] else None
    return None


def _parts(word: str) -> list[str]:
    """The words of one that holds several options: `sim -r`."""
    return word.split() if word.startswith(("-", "sim ", "gazebo ")) else [word]


_GZ_SERVERS = frozenset(("gzserver", "ros_gz_sim::GzServer"))  # the latter is in a container
_CLASSIC_PROGRAMS = frozenset(("gazebo", "gzserver"))
_GZ_PROGRAMS = frozenset(("gz", "ign"))


def _names() -> set[str]:
    """What an action names that starts a simulator: a launch file or a program."""
    stems = (stem for files in _LAUNCH_FILES.values() for stem in files)
    return {*(f"{stem}.launch.py" for stem in stems), *_CLASSIC_PROGRAMS, *_GZ_PROGRAMS}


def _classic(world: str | None, *, is_headless: bool) -> Simulator:
    return Simulator(kind=CLASSIC, world=world or None, is_headless=is_headless)


def _gz(words: Sequence[str]) -> Simulator | None:
    """The simulator from the words of `gz_args`; None for a window without a server."""
    if "-g" in words:
        return None
    with_files = [word for word in words if word != "-s"]  # of Gazebo Classic it takes a plugin
    return Simulator(kind=SIM, world=_world(with_files), is_headless="-s" in words)


def _world(words: Iterable[str]) -> str | None:
    """The world that a command line names: a file by its suffix, or a path."""
    named: list[str] = []
    takes_value = False
    for word in words:
        if word == "--ros-args":
            break
        if not takes_value and not word.startswith("-"):
            named.append(word)
        takes_value = word in _WITH_VALUE
    files = [word for word in named if word.endswith((*WORLD_SUFFIXES, ".model"))]
    paths = [word for word in named if "/" in word and not PurePath(word).suffix]
    return next(iter((*files, *paths)), None)


def _in_default_world(simulator: Simulator) -> Simulator:
    return Simulator(
        kind=simulator.kind,
        world=None,
        is_headless=simulator.is_headless,
        is_world_known=False,
    )


def _how_to_start(plan: LaunchPlan) -> str:
    classic, gz = "gazebo.launch.py of gazebo_ros", "gz_sim.launch.py of ros_gz_sim"
    which = {CLASSIC: classic, SIM: gz}.get(kind_of_project(plan) or "", f"{classic}, or {gz}")
    return f"Start a simulator before it, or include {which}."


def is_true(text: str) -> bool:
    """Whether a launch file of Gazebo takes the value of an argument for true."""
    return text.strip().lower() in {"true", "1"}
