"""Read from a plan which simulator it starts and which robots it puts into it."""

from __future__ import annotations

import math
import shlex
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.launch import spawn_arguments
from wsgen.launch.descriptions import find_description
from wsgen.launch.faults import fault, or_loose
from wsgen.model.plan import Process, Simulator, Spawn, SpawnHeight
from wsgen.model.pose import Pose

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from wsgen.model.plan import Include, LaunchPlan

# Executable -> the options it takes; by package, because names repeat.
_SPAWNERS = {
    ("gazebo_ros", "spawn_entity.py"): spawn_arguments.SPAWN_ENTITY,
    ("ros_gz_sim", "create"): spawn_arguments.CREATE,
    ("ros_ign_gazebo", "create"): spawn_arguments.CREATE,
}
# Launch files of ros_gz_sim that start `create` with their arguments as its parameters.
_SPAWNING_LAUNCH_FILES = {"gz_spawn_model.launch.py", "ros_gz_spawn_model.launch.py"}
_PARAMETERS_OF_ARGUMENTS = {"entity_name": "name", "model_string": "string"}
_GZ_SERVERS = {"gzserver", "ros_gz_sim::GzServer"}  # a program, and a node of a container
# What an action names that starts a simulator: a launch file or a program.
_SIMULATOR_NAMES = frozenset(
    (
        *("gazebo.launch.py", "gzserver.launch.py", "gz_sim.launch.py", "ign_gazebo.launch.py"),
        *("gz_server.launch.py", "ros_gz_sim.launch.py"),
        *("gazebo", "gzserver", "gz", "ign"),
    )
)
_HOW_TO_SPAWN = {
    "classic": "Add a Node with package='gazebo_ros', executable='spawn_entity.py' and "
    "arguments=['-topic', 'robot_description', '-entity', NAME].",
    "gz": "Add a Node with package='ros_gz_sim', executable='create' and "
    "arguments=['-topic', 'robot_description', '-name', NAME].",
}
_SPAWNERS_OF_ROS_1 = {"spawn_model", "spawn_urdf", "urdf_spawner"}


def find_simulator(plan: LaunchPlan) -> tuple[Simulator | None, tuple[Diagnostic, ...]]:
    """The simulator that the plan starts; None where it starts none that is known."""
    for include in plan.includes:
        simulator = _included_simulator(include)
        if simulator is not None:
            return simulator, ()
    for process in plan.processes:
        simulator = _started_simulator(process)
        if simulator is not None:
            return simulator, ()
    missing = Diagnostic(
        code="SPN001",
        severity=Severity.ERROR,
        message="The launch file starts no simulator.",
        file=plan.launch_file,
        hint="Include gazebo.launch.py of gazebo_ros, or gz_sim.launch.py of ros_gz_sim.",
    )
    kinds = ("IncludeLaunchDescription", "ExecuteProcess")
    return None, (or_loose(missing, plan, *kinds, names=_SIMULATOR_NAMES),)


def find_spawns(plan: LaunchPlan) -> tuple[tuple[Spawn, ...], tuple[Diagnostic, ...]]:
    """The robots that the plan spawns, and what is wrong with those that it would not."""
    spawns: list[Spawn] = []
    diagnostics: list[Diagnostic] = []
    for process in (*plan.processes, *_included_spawners(plan)):
        key = (process.package or "", process.executable or "")
        if key in _SPAWNERS:
            spawn, wrong = _read_spawn(plan, process, _SPAWNERS[key])
            diagnostics += wrong
            if spawn is not None:
                spawns.append(spawn)
        elif process.package == "gazebo_ros" and process.executable in _SPAWNERS_OF_ROS_1:
            diagnostics.append(
                fault(
                    "SPN002",
                    process,
                    f"'{process.executable}' is the spawner of ROS 1.",
                    "In ROS 2 it is executable='spawn_entity.py', with -entity instead of -model.",
                )
            )
    if not spawns and not diagnostics:
        missing = Diagnostic(
            code="SPN003",
            severity=Severity.ERROR,
            message="The launch file spawns no robot.",
            file=plan.launch_file,
            hint=_how_to_spawn(plan),
        )
        names = {executable for _, executable in _SPAWNERS} | _SPAWNING_LAUNCH_FILES
        diagnostics.append(or_loose(missing, plan, "Node", "IncludeLaunchDescription", names=names))
    return tuple(spawns), tuple(diagnostics)


def _how_to_spawn(plan: LaunchPlan) -> str:
    """The spawner of the simulator that is started, and what can be done without one."""
    simulator, _ = find_simulator(plan)
    hint = (
        "Give a launch file that starts a simulator and a spawner."
        if simulator is None
        else _HOW_TO_SPAWN[simulator.generation]
    )
    robots = (process.description_file for process in plan.processes)
    robot = next((file for file in robots if file is not None), None)
    if robot is None:
        return hint
    return f"{hint} Without one, the robot is tried by: wsgen validate {shlex.quote(str(robot))}"


def _included_spawners(plan: LaunchPlan) -> Iterator[Process]:
    """The spawners that launch files would start which were not evaluated."""
    for include in plan.includes:
        if include.package == "ros_gz_sim" and include.file.name in _SPAWNING_LAUNCH_FILES:
            given = include.configurations or include.arguments
            parameters = {_PARAMETERS_OF_ARGUMENTS.get(name, name): given[name] for name in given}
            yield Process(
                package="ros_gz_sim",
                executable="create",
                parameters=parameters,
                file=plan.launch_file,
            )


def _included_simulator(include: Include) -> Simulator | None:
    values: Mapping[str, str] = include.configurations or include.arguments
    key = (include.package, include.file.name)
    if key == ("gazebo_ros", "gazebo.launch.py"):
        if not _is_true(values.get("server", "true")):
            return None
        headless = not _is_true(values.get("gui", "true"))
        return Simulator(
            generation="classic", world=values.get("world") or None, is_headless=headless
        )
    if key == ("gazebo_ros", "gzserver.launch.py"):
        return Simulator(generation="classic", world=values.get("world") or None, is_headless=True)
    if key in {("ros_gz_sim", "gz_sim.launch.py"), ("ros_ign_gazebo", "ign_gazebo.launch.py")}:
        return _gz(spawn_arguments.split(values.get("gz_args") or values.get("ign_args") or ""))
    if key in {("ros_gz_sim", "gz_server.launch.py"), ("ros_gz_sim", "ros_gz_sim.launch.py")}:
        return Simulator(
            generation="gz", world=values.get("world_sdf_file") or None, is_headless=True
        )
    return None


def _started_simulator(process: Process) -> Simulator | None:
    if process.package == "ros_gz_sim" and process.executable in _GZ_SERVERS:
        world = process.parameters.get("world_sdf_file")
        return Simulator(generation="gz", world=world or None, is_headless=True)
    words = process.command or (process.executable or "", *process.arguments)
    if len(words) == 1:
        words = tuple(spawn_arguments.split(words[0]))
    if not words:
        return None
    program = words[0].rpartition("/")[2]
    if program in {"gazebo", "gzserver"}:
        worlds = [word for word in words[1:] if word.endswith((".world", ".sdf"))]
        return Simulator(
            generation="classic",
            world=worlds[0] if worlds else None,
            is_headless=program == "gzserver",
        )
    if program in {"gz", "ign"} and words[1:2] in {("sim",), ("gazebo",)}:
        return _gz(words[2:])
    return None


def _gz(words: Sequence[str]) -> Simulator | None:
    """The simulator from the words of `gz_args`; None for a window without a server."""
    if "-g" in words:
        return None
    worlds = [word for word in words if word.endswith((".sdf", ".world"))]
    return Simulator(
        generation="gz", world=worlds[0] if worlds else None, is_headless="-s" in words
    )


def _read_spawn(
    plan: LaunchPlan, process: Process, options: spawn_arguments.Options
) -> tuple[Spawn | None, list[Diagnostic]]:
    read = spawn_arguments.read(process, options)
    wrong = [fault("SPN004", process, text, hint) for text, hint in read.faults]
    pose, bad_numbers = _pose(read.values)
    wrong += [
        fault(
            "SPN005",
            process,
            f"-{name} of the spawner is '{value}', which is no finite number.",
            "Give metres for -x -y -z and radians for -R -P -Y.",
        )
        for name, value in bad_numbers
    ]
    if not any(source in read.values for source in options.sources):
        return None, wrong
    description = find_description(plan, process, read.values)
    if isinstance(description, Diagnostic):
        return None, [*wrong, description]
    if wrong:
        return None, wrong
    text, file = description
    entity = read.values.get(options.entity) or options.default_entity
    return (
        Spawn(
            entity=entity,
            description=text,
            description_file=file,
            pose_in_world=pose,
            process=process,
            height=_height(plan, process, read.values.get("z")),
        ),
        [],
    )


def _height(plan: LaunchPlan, process: Process, value: str | None) -> SpawnHeight:
    """Where the height of a spawner is given, or could be; `value` is the text that it has."""
    is_included = process.line is None  # by a launch file that was not evaluated
    option, holder = "-z", f"the arguments of {process.executable}"
    if is_included:
        option, holder = "z", "the launch_arguments of the include that spawns the robot"
    elif "z" in process.parameters or (process.parameters and not process.arguments):
        option, holder = "z", f"the parameters of {process.executable}"
    if option == "-z":
        names = {
            name
            for before, name in zip(process.arguments, process.configurations[1:], strict=False)
            if before.lstrip("-") == "z"
        }
    else:
        names = {"z"} if value is not None else set()
    declared = (argument.name for argument in plan.arguments if argument.value == value)
    return SpawnHeight(
        file=process.file,
        line=process.line,
        option=option,
        holder=holder,
        is_given=value is not None,
        launch_argument=next((name for name in declared if name in names), None),
    )


def _pose(values: Mapping[str, str]) -> tuple[Pose, list[tuple[str, str]]]:
    """The pose that the options say, and the options that say no number."""
    numbers: dict[str, float] = {}
    wrong = []
    for name in ("x", "y", "z", "R", "P", "Y"):
        value = values.get(name, "0")
        try:
            numbers[name] = float(value)
        except ValueError:
            numbers[name] = math.nan
        if not math.isfinite(numbers[name]):
            wrong.append((name, value))
    xyz = (numbers["x"], numbers["y"], numbers["z"])
    return Pose(xyz=xyz, rpy=(numbers["R"], numbers["P"], numbers["Y"])), wrong


def _is_true(text: str) -> bool:
    return text.strip().lower() in {"true", "1"}
