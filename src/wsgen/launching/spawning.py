"""Read from a plan which robots it spawns.

A robot is spawned by a program of Gazebo, by a call of the service that these programs call, or by
a program of somebody's own, which is assumed to spawn the robot description.
"""

from __future__ import annotations

import ast
import itertools
import math
import re
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import Diagnostic, Rule, Severity, has_errors
from wsgen.launching.commands import (
    SPAWNING_REQUESTS,
    read_request,
    started_launch_files,
    started_programs,
)
from wsgen.launching.descriptions import (
    Description,
    find_description,
    published_descriptions,
    read_published,
    read_spawned_file,
    report_at,
)
from wsgen.launching.explain_missing import nodes_of, or_unused_action
from wsgen.launching.simulators import find_simulator, kind_of_project
from wsgen.launching.spawner_options import (
    INVALID_SPAWNER_OPTION,
    POSE,
    SPAWNER_PROGRAMS,
    SPAWNERS,
    Options,
    read_options,
)
from wsgen.model.plan import Process
from wsgen.model.transform import Pose, rotation_of_quaternion, rpy_of_rotation
from wsgen.model.world import Spawn, SpawnHeight
from wsgen.ros import ros1
from wsgen.ros.names import released_packages
from wsgen.text.markup import read_text, without_comments
from wsgen.text.xmltree import Malformed, parse

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Mapping

    from wsgen.model.plan import LaunchPlan


ROS_1_SPAWNER = Rule(
    code="SPN002",
    name="ros-1-spawner",
    severity=Severity.ERROR,
    summary="The launch file uses the spawner of ROS 1.",
    why="`gazebo_ros` of ROS 2 does not install `spawn_model`, so that the launch stops.",
    example="Node(package='gazebo_ros', executable='spawn_model',\n"
    "     arguments=['-topic', 'robot_description', '-model', 'my_robot'])",
    instead="Node(package='gazebo_ros', executable='spawn_entity.py',\n"
    "     arguments=['-topic', 'robot_description', '-entity', 'my_robot'])",
)
NO_ROBOT = Rule(
    code="SPN003",
    name="no-robot",
    severity=Severity.ERROR,
    severity_varies="a note where nodes run, which may spawn one: `wsgen launch --run`, "
    "the fixture `live`",
    summary="The launch file spawns no robot.",
    what="Looks for spawners among what the launch file includes and starts, and for models with "
    "movable joints in the world.",
    why="The simulator starts without the robot, and nothing can be simulated.",
    example="spawner = Node(package='gazebo_ros', executable='spawn_entity.py', ...)  # not added",
    instead="launch_description.add_action(spawner)",
)
INVALID_SPAWN_POSE = Rule(
    code="SPN005",
    name="invalid-spawn-pose",
    severity=Severity.ERROR,
    summary="A coordinate of the spawn pose is not a finite number.",
    why="The spawner refuses the value, or puts the robot where the physics engine cannot "
    "simulate it.",
    example="arguments=['-topic', 'robot_description', '-entity', 'my_robot', '-z', 'high']",
    instead="arguments=['-topic', 'robot_description', '-entity', 'my_robot', '-z', '0.5']",
)
ASSUMED_SPAWNER = Rule(
    code="SPN092",
    name="assumed-spawner",
    severity=Severity.INFO,
    summary="A program of the workspace is assumed to spawn the robot.",
    what="Looks, where no spawner of Gazebo is started, for a program of a package that is not "
    "released, beside a simulator and a robot description. Without a simulator, its name must "
    "contain `spawn`, or its Python source must use the service `SpawnEntity`.",
    why="`wsgen` does not know what the program does: the robot is simulated on the ground, at the "
    "origin.",
    example="Node(package='my_robot', executable='spawn_robot.py')",
    instead="Node(package='gazebo_ros', executable='spawn_entity.py',\n"
    "     arguments=['-topic', 'robot_description', '-entity', 'my_robot'])",
)

# Launch files of ros_gz_sim that start `create` with their arguments as its parameters.
_SPAWNING_LAUNCH_FILES = {"gz_spawn_model.launch.py", "ros_gz_spawn_model.launch.py"}
_PARAMETERS_OF_ARGUMENTS = {"entity_name": "name", "model_string": "string"}
_HOW_TO_SPAWN = {
    "classic": "Add a Node with package='gazebo_ros', executable='spawn_entity.py' and "
    "arguments=['-topic', 'robot_description', '-entity', NAME].",
    "gz": "Add a Node with package='ros_gz_sim', executable='create' and "
    "arguments=['-topic', 'robot_description', '-name', NAME].",
}
_FILE_FIELD = "sdf_filename"
_PROGRAMS_WITHOUT_ROBOT = frozenset(
    ("colcon", "gazebo", "gz", "gzclient", "gzserver", "ign", "killall", "pkill", "rviz2", "ros2")
)
_ROBOT_SUFFIXES = (".urdf", ".sdf")

Found = tuple["Spawn | None", list[Diagnostic]]


def find_spawns(plan: LaunchPlan) -> tuple[tuple[Spawn, ...], tuple[Diagnostic, ...]]:
    """The robots that spawners of Gazebo spawn, and why others would not appear."""
    spawns: list[Spawn] = []
    diagnostics: list[Diagnostic] = []
    for program in (*started_programs(plan), *_included_spawners(plan)):
        spawn, found = _read_spawn(plan, program)
        diagnostics += found
        if spawn is not None:
            spawns.append(spawn)
    return tuple(spawns), tuple(diagnostics)


def names_spawner(file: Path, launch_files: Collection[str]) -> bool:
    """Whether a launch file that cannot be evaluated names what spawns, or one of `launch_files`.

    What spawns are spawners and the packages of Gazebo that have them and the simulator.
    """
    packages, executables = zip(*SPAWNERS, strict=True)
    names = {*packages, *executables, *_SPAWNING_LAUNCH_FILES, *launch_files}
    texts = [
        node.value
        for node in nodes_of(file)
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    ]
    if not texts:
        texts = re.findall(r"[^\s\"'=<>:,\[\]]+", without_comments(read_text(file) or ""))
    return any(not names.isdisjoint(re.split(r"[/()]", text)) for text in texts)


def assume_spawn(
    plan: LaunchPlan, calls_service: Callable[[Process], bool] = lambda _: False
) -> tuple[Spawn | None, Diagnostic]:
    """The robot that a spawner of somebody's own may spawn, where nothing else does.

    With it comes the diagnostic that says so, or that no robot is spawned. `calls_service` says
    whether the source of a program uses the service that spawns.
    """
    missing = NO_ROBOT.at(
        plan.launch_file,
        message="The launch file spawns no robot.",
        hint=_how_to_spawn(plan),
    )
    names = SPAWNER_PROGRAMS | _SPAWNING_LAUNCH_FILES
    unused = or_unused_action(missing, plan, "Node", "IncludeLaunchDescription", names=names)
    if unused != missing:
        return None, unused
    own = [program for program in started_programs(plan) if _is_own(program)]
    named = [
        program
        for program in own
        if "spawn" in (program.executable or "").lower() or calls_service(program)
    ]
    if find_simulator(plan)[0] is None:
        own = named
    for program in (*named, *own):
        description = _what_it_may_spawn(plan, program)
        if description is not None:
            spawn = Spawn(
                entity=_name_of_model(description.text) or program.executable or "robot",
                description=description.text,
                description_file=description.file,
                process=program,
                is_assumed=True,
            )
            return spawn, report_at(
                ASSUMED_SPAWNER,
                program,
                f"No spawner of Gazebo is started: '{program.executable}' is assumed to spawn the "
                f"robot `{spawn.entity}`, which is simulated on the ground at the origin.",
                "No change is needed. With a spawner of Gazebo, its pose is simulated too.",
            )
    return None, missing


def _is_own(program: Process) -> bool:
    """Whether a program is of somebody's own: a script, or of a package that is not released."""
    if program.package is not None:
        return program.package not in released_packages()
    return program.executable not in _PROGRAMS_WITHOUT_ROBOT


def _what_it_may_spawn(plan: LaunchPlan, program: Process) -> Description | None:
    """The robot file that a program is given, else the robot description of the plan."""
    given = [*program.arguments, *map(str, program.parameters.values())]
    files = [text for text in given if text.endswith(_ROBOT_SUFFIXES) and Path(text).is_file()]
    texts = [text for text in given if text.lstrip().startswith(("<robot", "<sdf", "<?xml"))]
    for text in (*files, *texts):
        found = read_spawned_file(plan, program, text)
        if isinstance(found, Description):
            return found
    for publisher in published_descriptions(plan).values():
        found = read_published(plan, publisher)
        if isinstance(found, Description):
            return found
    return None


def _name_of_model(text: str) -> str | None:
    """The name that a URDF or SDF has for its model, which Gazebo takes if it is given no other."""
    root = parse(text)
    if isinstance(root, Malformed):
        return None
    model = root.find("model") if root.tag == "sdf" else root
    return None if model is None else model.get("name")


def _how_to_spawn(plan: LaunchPlan) -> str:
    """The spawner of the simulator that is started, and what can be done without one."""
    simulator, _ = find_simulator(plan)
    kind = kind_of_project(plan) if simulator is None else simulator.kind
    hint = _HOW_TO_SPAWN.get(
        kind or "", "Give a launch file that starts a simulator and a spawner."
    )
    robots = (process.description_file for process in plan.processes)
    robot = next((file for file in robots if file is not None), None)
    if robot is None:
        return hint
    return f"{hint} To simulate the robot alone: wsgen validate {shlex.quote(str(robot))}"


def _included_spawners(plan: LaunchPlan) -> Iterator[Process]:
    """The spawners that launch files would start which were not evaluated."""
    for include in started_launch_files(plan):
        if include.package == "ros_gz_sim" and include.file.name in _SPAWNING_LAUNCH_FILES:
            given = include.configurations or include.arguments
            parameters = {_PARAMETERS_OF_ARGUMENTS.get(name, name): given[name] for name in given}
            yield Process(
                package="ros_gz_sim",
                executable="create",
                parameters=parameters,
                file=plan.launch_file,
            )


def _read_spawn(plan: LaunchPlan, program: Process) -> Found:
    """What a program spawns, if it is a spawner."""
    options = SPAWNERS.get((program.package or "", program.executable or ""))
    if options is not None:
        return _read_spawner(plan, program, options)
    request = _request_of(program)
    if request is not None:
        return _read_service_call(plan, program, *request)
    if program.package == "gazebo_ros" and program.executable in ros1.SPAWNERS:
        return None, [
            report_at(
                ROS_1_SPAWNER,
                program,
                f"'{program.executable}' is the spawner of ROS 1.",
                "In ROS 2 it is executable='spawn_entity.py', with -entity instead of -model.",
            )
        ]
    return None, []


def _read_spawner(plan: LaunchPlan, program: Process, options: Options) -> Found:
    read = read_options(program, options)
    pose, invalid = _pose(plan, program, read.values)
    found = [*read.diagnostics, *invalid]
    sources = [source for source in options.sources if source in read.values]
    if not sources or (options.is_strict and len(sources) > 1):
        return None, found
    description = find_description(plan, program, read.values)
    entity = read.values.get(options.entity, "")
    if plan.is_unknown(entity):
        entity = ""
    return _spawn(
        program, entity, pose, description, found, _height(plan, program, read.values.get("z"))
    )


def _spawn(  # noqa: PLR0913, PLR0917  what makes it
    program: Process,
    entity: str,
    pose: Pose,
    description: Description | Diagnostic,
    found: list[Diagnostic],
    height: SpawnHeight,
) -> Found:
    if isinstance(description, Diagnostic):
        return None, [*found, description]
    if has_errors(found):
        return None, found
    return (
        Spawn(
            entity=entity or _name_of_model(description.text) or "robot",
            description=description.text,
            description_file=description.file,
            model_uri=description.model_uri,
            pose_in_world=pose,
            process=program,
            height=height,
        ),
        found,
    )


def _request_of(program: Process) -> tuple[str, str] | None:
    """The type and the text of the request by which a command line has Gazebo spawn something."""
    words = program.arguments
    if program.executable == "ros2" and words[:2] == ("service", "call"):
        named = [word.rpartition("/")[2] for word in words[3:4]]
        request = " ".join(words[4:])
    elif program.executable in {"gz", "ign"} and words[:1] == ("service",):
        options = dict(itertools.pairwise(words))
        named = [options.get("--reqtype", "").rpartition(".")[2]]
        request = options.get("--req", "")
    else:
        return None
    return (named[0], request) if named and named[0] in SPAWNING_REQUESTS else None


def _read_service_call(plan: LaunchPlan, program: Process, kind: str, text: str) -> Found:
    fields = read_request(text) or {}
    numbers = _numbers(fields.get("initial_pose") or fields.get("pose"))
    pose, invalid = _pose_of_request(program, numbers)
    height = SpawnHeight(
        file=program.file,
        line=program.line,
        option="z",
        holder=f"the `position` of the request for {kind}",
        is_given="z" in numbers,
    )
    description = _described_in_request(plan, program, kind, fields)
    return _spawn(program, str(fields.get("name") or ""), pose, description, list(invalid), height)


def _described_in_request(
    plan: LaunchPlan, program: Process, kind: str, fields: Mapping[str, Any]
) -> Description | Diagnostic:
    content = fields.get(SPAWNING_REQUESTS[kind]) or fields.get(_FILE_FIELD)
    if content:
        return read_spawned_file(plan, program, str(content))
    return report_at(
        INVALID_SPAWNER_OPTION,
        program,
        f"The request for {kind} has no field `{SPAWNING_REQUESTS[kind]}`."
        if fields
        else f"The request for {kind} cannot be parsed: a quote in it may end the text too early.",
        "Quote the text of the robot, and write a backslash before each quote inside of it.",
    )


def _numbers(pose: Any) -> dict[str, str]:
    """The texts of position and orientation; `qx` to `qw` are the quaternion."""
    if not isinstance(pose, dict):
        return {}
    position, orientation = pose.get("position"), pose.get("orientation")
    return {
        **(position if isinstance(position, dict) else {}),
        **{
            f"q{name}": text
            for name, text in (orientation if isinstance(orientation, dict) else {}).items()
        },
    }


def _pose_of_request(program: Process, numbers: Mapping[str, str]) -> tuple[Pose, list[Diagnostic]]:
    try:
        x, y, z, qx, qy, qz, qw = (
            float(numbers.get(name, "0")) for name in ("x", "y", "z", "qx", "qy", "qz", "qw")
        )
    except (TypeError, ValueError):
        x = math.nan
    if not math.isfinite(x):
        return Pose(), [
            _invalid(program, name, text) for name, text in numbers.items() if not _is_number(text)
        ]
    length = math.hypot(qx, qy, qz, qw)
    unit = (qx / length, qy / length, qz / length, qw / length) if length else (0.0, 0.0, 0.0, 1.0)
    return Pose(xyz=(x, y, z), rpy=rpy_of_rotation(rotation_of_quaternion(unit))), []


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


def _pose(
    plan: LaunchPlan, program: Process, values: Mapping[str, str]
) -> tuple[Pose, list[Diagnostic]]:
    """The pose that the options say, and the options that are not numbers; 0 for unknown ones."""
    texts = {name: values.get(name, "0") for name in POSE}
    texts |= {name: "0" for name, text in texts.items() if plan.is_unknown(text)}
    invalid = [
        _invalid(program, f"-{name}", text) for name, text in texts.items() if not _is_number(text)
    ]
    if invalid:
        return Pose(), invalid
    x, y, z, roll, pitch, yaw = (float(texts[name]) for name in POSE)
    return Pose(xyz=(x, y, z), rpy=(roll, pitch, yaw)), []


def _is_number(text: Any) -> bool:
    try:
        return math.isfinite(float(text))
    except (TypeError, ValueError):
        return False


def _invalid(program: Process, name: str, value: Any) -> Diagnostic:
    point = str(value).replace(",", ".")
    return report_at(
        INVALID_SPAWN_POSE,
        program,
        f"{name} of the spawner is '{value}', which is not a finite number.",
        f"Write it with a point: {point}"
        if point != value and _is_number(point)
        else "Write each option and each value as a separate item of `arguments`."
        if len(str(value).split()) > 1
        else "Give meters for -x -y -z and radians for -R -P -Y.",
    )
