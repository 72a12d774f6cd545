"""Read from a plan which simulator it starts and which robots it spawns.

The description of a robot comes from a topic, a file, a parameter or a text, as the options of the
spawner say. `spawn_entity.py` (gazebo_ros) reads `-name value` as argparse does, `create`
(ros_gz_sim) as gflags does: `-name value`, `-name=value` or `--name=value`; it takes node
parameters too, which win over the options.
"""

from __future__ import annotations

import ast
import math
import re
import shlex
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.launch.explain_missing import nodes_of, unused_actions
from wsgen.launch.known_packages import SURELY
from wsgen.markup import read_text, without_comments
from wsgen.model.plan import Process
from wsgen.model.transform import Pose
from wsgen.model.world import Simulator, Spawn, SpawnHeight
from wsgen.suggestions import advice, nearest

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from wsgen.model.plan import Include, LaunchPlan


NO_SIMULATOR = Rule(
    code="SPN001",
    name="no-simulator",
    severity=Severity.ERROR,
    summary="The launch file starts no simulator.",
    what="Looks for the launch files and programs of Gazebo Classic and Gazebo Sim among what the "
    "launch file includes and starts.",
    why="The spawner waits for the service of a simulator that never starts.",
    example="gazebo = IncludeLaunchDescription(...)  # not added to the LaunchDescription",
    instead="launch_description.add_action(gazebo)",
)
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
    summary="The launch file spawns no robot.",
    why="The simulator starts without the robot, and nothing can be simulated.",
    example="spawner = Node(package='gazebo_ros', executable='spawn_entity.py', ...)  # not added",
    instead="launch_description.add_action(spawner)",
)
INVALID_SPAWNER_OPTION = Rule(
    code="SPN004",
    name="invalid-spawner-option",
    severity=Severity.ERROR,
    summary="The spawner does not accept its options.",
    what="Reads the arguments of `spawn_entity.py` and `create`, and the parameters of `create`, "
    "as these programs do.",
    why="The spawner ends with an error message, and the robot does not appear.",
    example="arguments=['-topic', 'robot_description']  # of spawn_entity.py",
    instead="arguments=['-topic', 'robot_description', '-entity', 'my_robot']",
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
DATABASE_MODEL = Rule(
    code="SPN006",
    name="database-model",
    severity=Severity.ERROR,
    summary="The spawner takes the model from Gazebo's model database.",
    why="The model is not part of the workspace, so wsgen cannot simulate it; Gazebo looks for it "
    "in its own folders or downloads it.",
    example="arguments=['-database', 'coke_can', '-entity', 'can']",
    instead="arguments=['-file', os.path.join(share, 'models', 'can', 'model.sdf'), "
    "'-entity', 'can']",
)
NO_DESCRIPTION_SOURCE = Rule(
    code="SPN007",
    name="no-description-source",
    severity=Severity.ERROR,
    summary="The spawner reads the robot from its standard input.",
    why="`launch` connects nothing to the standard input of a process, so the spawner waits for "
    "ever.",
    example="arguments=['-stdin', '-entity', 'my_robot']",
    instead="arguments=['-topic', 'robot_description', '-entity', 'my_robot']",
)
UNPUBLISHED_DESCRIPTION = Rule(
    code="SPN008",
    name="unpublished-description",
    severity=Severity.ERROR,
    summary="No `robot_state_publisher` publishes the topic that the spawner reads.",
    what="Compares the topic of the spawner with those of every `robot_state_publisher`, with "
    "namespaces and remappings.",
    why="The spawner waits for the topic for ever, and the robot does not appear.",
    example="arguments=['-topic', 'robot', '-entity', 'my_robot']",
    instead="arguments=['-topic', 'robot_description', '-entity', 'my_robot']",
)
PUBLISHER_WITHOUT_DESCRIPTION = Rule(
    code="SPN009",
    name="publisher-without-description",
    severity=Severity.ERROR,
    summary="`robot_state_publisher` has no parameter `robot_description`.",
    why="`robot_state_publisher` ends with an error, and the spawner waits for the topic for ever.",
    example="Node(package='robot_state_publisher', executable='robot_state_publisher')",
    instead="Node(package='robot_state_publisher', executable='robot_state_publisher',\n"
    "     parameters=[{'robot_description': text}])",
)
MISSING_SPAWN_PARAMETER = Rule(
    code="SPN010",
    name="missing-spawn-parameter",
    severity=Severity.ERROR,
    summary="The spawner reads the robot from a parameter that is not set.",
    why="The spawner finds no description and ends with an error.",
    example="Node(package='ros_gz_sim', executable='create',\n"
    "     arguments=['-param', 'robot_description'])",
    instead="Node(package='ros_gz_sim', executable='create',\n"
    "     arguments=['-param', 'robot_description'],\n"
    "     parameters=[{'robot_description': text}])",
)
DESCRIPTION_NOT_TEXT = Rule(
    code="SPN011",
    name="description-not-text",
    severity=Severity.ERROR,
    summary="The robot description is not the text of a URDF or SDF.",
    why="`robot_state_publisher` and the spawners parse the value as XML, and end with an error "
    "for a path or an empty text.",
    example="parameters=[{'robot_description': os.path.join(share, 'model', 'robot.xacro')}]",
    instead="parameters=[{'robot_description': ParameterValue(\n"
    "    Command(['xacro ', path]), value_type=str)}]",
)
UNREADABLE_SPAWN_FILE = Rule(
    code="SPN012",
    name="unreadable-spawn-file",
    severity=Severity.ERROR,
    summary="The file to spawn cannot be read.",
    why="The spawner, or `robot_state_publisher`, ends with an error, and no robot appears.",
    example="install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})",
    instead="install(DIRECTORY launch model DESTINATION share/${PROJECT_NAME})",
)
_POSE = ("x", "y", "z", "R", "P", "Y")


class Options(NamedTuple):
    """What a spawner takes."""

    with_value: frozenset[str]
    flags: frozenset[str]
    sources: tuple[str, ...]  # exactly one of these says what is spawned
    entity: str  # the option that names the model
    default_entity: str  # its value where it may be left out; empty where it may not
    reads_parameters: bool


SPAWN_ENTITY = Options(
    with_value=frozenset(
        (
            "file",
            "topic",
            "database",
            "entity",
            "reference_frame",
            "gazebo_namespace",
            "robot_namespace",
            "timeout",
            "spawn_service_timeout",
            "wait",
            *_POSE,
        )
    ),
    flags=frozenset(("stdin", "unpause", "package_to_model", "b")),
    sources=("file", "topic", "database", "stdin"),
    entity="entity",
    default_entity="",
    reads_parameters=False,
)
CREATE = Options(
    with_value=frozenset(
        ("world", "file", "param", "string", "topic", "name", "allow_renaming", *_POSE)
    ),
    flags=frozenset(("allow_renaming",)),
    sources=("file", "param", "string", "topic"),
    entity="name",
    default_entity="robot",
    reads_parameters=True,
)


class Read(NamedTuple):
    """Options without their dashes, and the errors in them: message and hint."""

    values: Mapping[str, str]
    errors: list[tuple[str, str]]


def read_options_of(process: Process, options: Options) -> Read:
    """The options of a spawner, from its arguments and, where it reads them, its parameters."""
    values, errors = _read_words(process, options)
    if errors:  # what is lacking may follow from them
        return Read(values, errors)
    if options.reads_parameters:
        known = options.with_value | options.flags
        values.update(
            {
                name: str(value)
                for name, value in process.parameters.items()
                if name in known and value != ""
            }
        )
    given = [name for name in options.sources if name in values]
    all_sources = ", ".join(f"-{name}" for name in options.sources)
    if len(given) != 1:
        found = " and ".join(f"-{name}" for name in given) or "none of them"
        errors.append(
            (
                f"{process.executable} needs exactly one of {all_sources}, and is given {found}.",
                "Usually it is '-topic', 'robot_description'.",
            )
        )
    if not values.get(options.entity) and not options.default_entity:
        errors.append(
            (
                f"{process.executable} is not given -{options.entity}, the name of the model.",
                f"Add '-{options.entity}', 'NAME' to its arguments.",
            )
        )
    return Read(values, errors)


def _read_words(process: Process, options: Options) -> tuple[dict[str, str], list[tuple[str, str]]]:
    values: dict[str, str] = {}
    errors: list[tuple[str, str]] = []
    words = list(process.arguments)
    while words:
        word = words.pop(0)
        if word == "--ros-args":
            break
        name, has_value, value = word.lstrip("-").partition("=")
        if not word.startswith("-") or name not in options.with_value | options.flags:
            errors.append(_unknown(process, word, options))
            if word.startswith("-") and not has_value and words and words[0][:1] != "-":
                words.pop(0)  # its value
        elif has_value:
            values[name] = value
        elif name in options.flags and not (
            name in options.with_value and words and words[0] in {"true", "false"}
        ):
            values[name] = "true"
        elif words:
            values[name] = words.pop(0)
        else:
            errors.append(
                (f"{word} of {process.executable} has no value.", f"Add it: {word} VALUE.")
            )
    return values, errors


def _unknown(process: Process, word: str, options: Options) -> tuple[str, str]:
    if " " in word.strip():
        return (
            f"'{word}' is one argument of {process.executable}, which does not know it.",
            "Write each option and each value as a separate item of `arguments`.",
        )
    names = [f"-{name}" for name in sorted(options.with_value | options.flags)]
    return (
        f"{process.executable} does not know '{word}'.",
        advice(word, names, f"It knows {' '.join(names)}."),
    )


def split(line: str) -> list[str]:
    """The words of a command line; what cannot be split counts as one word."""
    try:
        return shlex.split(line)
    except ValueError:
        return [line]


def _report(rule: Rule, process: Process, message: str, hint: str) -> Diagnostic:
    """At the line of the launch file that describes the process."""
    return rule.at(process.file, process.line, process.executable, message=message, hint=hint)


def _or_unused_action(
    missing: Diagnostic, plan: LaunchPlan, *kinds: str, names: Collection[str]
) -> Diagnostic:
    """What is reported as missing; or the action that was created for it and never added.

    `kinds` are the classes of such actions; `names` the programs, launch files and packages of
    which they name one.
    """
    for action in unused_actions(plan.evaluated_files, kinds):
        if not action.words.isdisjoint(names):
            return replace(
                missing,
                message=f"{missing.message.rstrip('.')}: `{action.name}` is created and not added "
                "to the LaunchDescription.",
                file=action.file,
                line=action.line,
                element=action.name,
                hint=f"Add it to the LaunchDescription that is returned: add_action({action.name})"
                ".",
            )
    return missing


PUBLISHER = "robot_state_publisher"
PARAMETER = "robot_description"


def find_description(
    plan: LaunchPlan, spawner: Process, options: Mapping[str, str]
) -> tuple[str, Path | None] | Diagnostic:
    """The text of the robot and the file it is in, where that is known."""
    if "topic" in options:
        return _from_topic(plan, spawner, options["topic"])
    if "file" in options:
        return _from_file(plan, spawner, options["file"])
    if "string" in options:
        return options["string"], spawner.description_file
    if "param" in options:
        return _from_parameter(spawner, options["param"])
    if "database" in options:
        return _report(
            DATABASE_MODEL,
            spawner,
            f"-database {options['database']} takes a model from Gazebo's own folders, which "
            "wsgen does not have.",
            "Use -file with the model's file, or -topic robot_description.",
        )
    return _report(
        NO_DESCRIPTION_SOURCE,
        spawner,
        f"{spawner.executable} reads the robot from standard input, and nothing writes to it.",
        "Use '-topic', 'robot_description' instead of -stdin.",
    )


def resolve(topic: str, process: Process) -> str:
    """The absolute name of a topic as a process means it, remappings included."""
    absolute = _absolute(topic, process)
    for source, target in process.remappings:
        if _absolute(source, process) == absolute:
            return _absolute(target, process)
    return absolute


def _absolute(topic: str, process: Process) -> str:
    if topic.startswith("/"):
        return topic
    if topic.startswith("~/"):
        name = process.name or process.executable or ""
        return f"{process.namespace.rstrip('/')}/{name}{topic[1:]}"
    return f"{process.namespace.rstrip('/')}/{topic}"


def _from_topic(
    plan: LaunchPlan, spawner: Process, topic: str
) -> tuple[str, Path | None] | Diagnostic:
    wanted = resolve(topic, spawner)
    published: dict[str, Process] = {}
    for process in plan.processes:
        if process.executable == PUBLISHER:
            published.setdefault(resolve(PARAMETER, process), process)
    if wanted in published:
        return _published(plan, published[wanted])
    others = ", ".join(published) or "nothing, as it starts no robot_state_publisher"
    missing = _report(
        UNPUBLISHED_DESCRIPTION,
        spawner,
        f"{spawner.executable} waits for the topic {wanted}, and no robot_state_publisher "
        f"publishes it; the launch file publishes {others}.",
        advice(
            wanted,
            published,
            "Start robot_state_publisher in the same namespace, with the parameter "
            "robot_description, or correct -topic.",
        ),
    )
    return missing if published else _or_unused_action(missing, plan, "Node", names={PUBLISHER})


def _published(plan: LaunchPlan, publisher: Process) -> tuple[str, Path | None] | Diagnostic:
    """The text of a publisher: its parameter, or the file that is its argument."""
    if PARAMETER not in publisher.parameters and publisher.arguments:
        return _from_file(plan, publisher, publisher.arguments[0])
    if PARAMETER not in publisher.parameters:
        misspelled = nearest(PARAMETER, publisher.parameters, cutoff=SURELY)
        return _report(
            PUBLISHER_WITHOUT_DESCRIPTION,
            publisher,
            "robot_state_publisher is not given the parameter robot_description"
            + (f" but `{misspelled}`." if misspelled else "."),
            f"Rename `{misspelled}` to `robot_description`."
            if misspelled
            else "Add parameters=[{'robot_description': ...}] to the Node.",
        )
    return _text(publisher, publisher.parameters[PARAMETER])


def _from_parameter(spawner: Process, name: str) -> tuple[str, Path | None] | Diagnostic:
    if name not in spawner.parameters:
        return _report(
            MISSING_SPAWN_PARAMETER,
            spawner,
            f"{spawner.executable} reads the parameter '{name}', which it is not given.",
            f"Add parameters=[{{'{name}': ...}}] to the Node, or use -topic robot_description.",
        )
    return _text(spawner, spawner.parameters[name])


def _text(process: Process, value: Any) -> tuple[str, Path | None] | Diagnostic:
    if isinstance(value, str) and value.lstrip().startswith("<"):
        return value, process.description_file
    if isinstance(value, str) and not value.strip():
        what = "is empty"
    else:
        what = f"is not the text of a robot: '{str(value)[:60]}'"
    return _report(
        DESCRIPTION_NOT_TEXT,
        process,
        f"The robot_description {what}.",
        "Give it the text of the URDF, not its path: "
        "ParameterValue(Command(['xacro ', path]), value_type=str).",
    )


def _from_file(
    plan: LaunchPlan, process: Process, path: str
) -> tuple[str, Path | None] | Diagnostic:
    written = str(Path(path).absolute())
    if written in plan.written:
        return plan.written[written], Path(plan.written_from.get(written, path))
    if path.lstrip().startswith("<"):
        return path, process.description_file
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "it is not text in UTF-8"
        return _report(
            UNREADABLE_SPAWN_FILE,
            process,
            f"The file to spawn cannot be read: '{path}': {reason}.",
            "Check the path, and that CMakeLists.txt installs its folder.",
        )
    return text, Path(path)


# Executable -> the options it takes; by package, because names repeat.
_SPAWNERS = {
    ("gazebo_ros", "spawn_entity.py"): SPAWN_ENTITY,
    ("ros_gz_sim", "create"): CREATE,
    ("ros_ign_gazebo", "create"): CREATE,
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
    missing = NO_SIMULATOR.at(
        plan.launch_file,
        message="The launch file starts no simulator.",
        hint="Include gazebo.launch.py of gazebo_ros, or gz_sim.launch.py of ros_gz_sim.",
    )
    kinds = ("IncludeLaunchDescription", "ExecuteProcess")
    return None, (_or_unused_action(missing, plan, *kinds, names=_SIMULATOR_NAMES),)


def find_spawns(plan: LaunchPlan) -> tuple[tuple[Spawn, ...], tuple[Diagnostic, ...]]:
    """The robots that the plan spawns, and why others would not appear."""
    spawns: list[Spawn] = []
    diagnostics: list[Diagnostic] = []
    for process in (*plan.processes, *_included_spawners(plan)):
        key = (process.package or "", process.executable or "")
        if key in _SPAWNERS:
            spawn, found = _read_spawn(plan, process, _SPAWNERS[key])
            diagnostics += found
            if spawn is not None:
                spawns.append(spawn)
        elif process.package == "gazebo_ros" and process.executable in _SPAWNERS_OF_ROS_1:
            diagnostics.append(
                _report(
                    ROS_1_SPAWNER,
                    process,
                    f"'{process.executable}' is the spawner of ROS 1.",
                    "In ROS 2 it is executable='spawn_entity.py', with -entity instead of -model.",
                )
            )
    if not spawns and not diagnostics:
        missing = NO_ROBOT.at(
            plan.launch_file,
            message="The launch file spawns no robot.",
            hint=_how_to_spawn(plan),
        )
        names = {executable for _, executable in _SPAWNERS} | _SPAWNING_LAUNCH_FILES
        diagnostics.append(
            _or_unused_action(missing, plan, "Node", "IncludeLaunchDescription", names=names)
        )
    return tuple(spawns), tuple(diagnostics)


def names_spawner(file: Path, launch_files: Collection[str]) -> bool:
    """Whether a launch file that cannot be evaluated names a spawner, or one of `launch_files`."""
    names = {executable for _, executable in _SPAWNERS} | _SPAWNING_LAUNCH_FILES | {*launch_files}
    texts = [
        node.value
        for node in nodes_of(file)
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    ]
    if not texts:
        texts = re.findall(r"[^\s\"'=<>:,\[\]]+", without_comments(read_text(file) or ""))
    return any(text.rpartition("/")[2] in names for text in texts)


def _how_to_spawn(plan: LaunchPlan) -> str:
    """The spawner of the simulator that is started, and what can be done without one."""
    simulator, _ = find_simulator(plan)
    hint = (
        "Give a launch file that starts a simulator and a spawner."
        if simulator is None
        else _HOW_TO_SPAWN[simulator.kind]
    )
    robots = (process.description_file for process in plan.processes)
    robot = next((file for file in robots if file is not None), None)
    if robot is None:
        return hint
    return f"{hint} To simulate the robot alone: wsgen validate {shlex.quote(str(robot))}"


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
        return Simulator(kind="classic", world=values.get("world") or None, is_headless=headless)
    if key == ("gazebo_ros", "gzserver.launch.py"):
        return Simulator(kind="classic", world=values.get("world") or None, is_headless=True)
    if key in {("ros_gz_sim", "gz_sim.launch.py"), ("ros_ign_gazebo", "ign_gazebo.launch.py")}:
        return _gz(split(values.get("gz_args") or values.get("ign_args") or ""))
    if key in {("ros_gz_sim", "gz_server.launch.py"), ("ros_gz_sim", "ros_gz_sim.launch.py")}:
        return Simulator(kind="gz", world=values.get("world_sdf_file") or None, is_headless=True)
    return None


def _started_simulator(process: Process) -> Simulator | None:
    if process.package == "ros_gz_sim" and process.executable in _GZ_SERVERS:
        world = process.parameters.get("world_sdf_file")
        return Simulator(kind="gz", world=world or None, is_headless=True)
    words = process.command or (process.executable or "", *process.arguments)
    if len(words) == 1:
        words = tuple(split(words[0]))
    if not words:
        return None
    program = words[0].rpartition("/")[2]
    if program in {"gazebo", "gzserver"}:
        worlds = [word for word in words[1:] if word.endswith((".world", ".sdf"))]
        return Simulator(
            kind="classic",
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
    return Simulator(kind="gz", world=worlds[0] if worlds else None, is_headless="-s" in words)


def _read_spawn(
    plan: LaunchPlan, process: Process, options: Options
) -> tuple[Spawn | None, list[Diagnostic]]:
    read = read_options_of(process, options)
    errors = [_report(INVALID_SPAWNER_OPTION, process, text, hint) for text, hint in read.errors]
    pose, invalid = _pose(read.values)
    errors += [
        _report(
            INVALID_SPAWN_POSE,
            process,
            f"-{name} of the spawner is '{value}', which is not a finite number.",
            "Give meters for -x -y -z and radians for -R -P -Y.",
        )
        for name, value in invalid
    ]
    if not any(source in read.values for source in options.sources):
        return None, errors
    description = find_description(plan, process, read.values)
    if isinstance(description, Diagnostic):
        return None, [*errors, description]
    if errors:
        return None, errors
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
    """The pose that the options say, and the options that are not numbers."""
    numbers: dict[str, float] = {}
    invalid = []
    for name in ("x", "y", "z", "R", "P", "Y"):
        value = values.get(name, "0")
        try:
            numbers[name] = float(value)
        except ValueError:
            numbers[name] = math.nan
        if not math.isfinite(numbers[name]):
            invalid.append((name, value))
    xyz = (numbers["x"], numbers["y"], numbers["z"])
    return Pose(xyz=xyz, rpy=(numbers["R"], numbers["P"], numbers["Y"])), invalid


def _is_true(text: str) -> bool:
    return text.strip().lower() in {"true", "1"}
