"""The rules about mistakes with which a launch starts: arguments, parameters or handlers in vain.

In the child process this is imported only where there is something to report.
"""

from __future__ import annotations

import ast
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import Rule, Severity
from wsgen.launching import commands, known_packages
from wsgen.launching.explain_missing import nodes_of
from wsgen.launching.known_packages import find_in_package, in_python
from wsgen.launching.record import RECORD, split_location
from wsgen.launching.spawner_options import CONTROLLER_SPAWNERS, SPAWNER_PROGRAMS
from wsgen.model.plan import STARTS_UNKNOWN
from wsgen.text.files import read_whole
from wsgen.text.suggestions import advice, nearest, some_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from launch.base import LaunchDescriptionEntity
    from launch.event_handlers import OnActionEventBase
    from wsgen.diagnostics import Diagnostic
    from wsgen.launching.record import Location
    from wsgen.model.plan import Process


DESCRIPTION_AS_YAML = Rule(
    code="LCH016",
    name="description-as-yaml",
    severity=Severity.INFO,
    summary="A robot description is parsed as YAML.",
    what="Looks at a `robot_description` that is a substitution, such as `Command`, without "
    "`ParameterValue`.",
    why="`launch_ros` parses the value of such a parameter as YAML. Its line breaks are "
    "folded, and a `: ` or ` #` anywhere in the robot, for example in a comment, stops the launch.",
    example="Node(..., parameters=[{'robot_description': Command(['xacro ', path])}])",
    instead="Node(..., parameters=[{'robot_description': ParameterValue(\n"
    "    Command(['xacro ', path]), value_type=str)}])",
)
PARAMETER_FILE_MISSING = Rule(
    code="LCH019",
    name="parameter-file-missing",
    severity=Severity.WARNING,
    summary="A parameter file cannot be read.",
    why="`ros2 launch` prints a warning and starts the node without these parameters.",
    example="Node(..., parameters=[os.path.join(share, 'config', 'no_such_file.yaml')])",
    instead="# CMakeLists.txt\ninstall(DIRECTORY config DESTINATION share/${PROJECT_NAME})",
)
UNUSED_ARGUMENT = Rule(
    code="LCH033",
    name="unused-argument",
    severity=Severity.WARNING,
    summary="No launch file declares or reads a launch argument that is given.",
    why="`ros2 launch` ignores the argument without a message, so that a misspelled name goes "
    "unnoticed. Nothing is reported where the argument may be read unseen, for example by a "
    "package that is not installed.",
    example="ros2 launch my_robot gazebo_model.launch.py wrld:=office.world",
    instead="ros2 launch my_robot gazebo_model.launch.py world:=office.world",
)
UNUSED_INCLUDE_ARGUMENT = Rule(
    code="LCH034",
    name="unused-include-argument",
    severity=Severity.WARNING,
    severity_varies="an error where Gazebo then lacks a world that a robot needs",
    summary="An included launch file does not declare or read an argument that it is given.",
    why="`ros2 launch` ignores the argument without a message, so that a misspelled name goes "
    "unnoticed.",
    example="IncludeLaunchDescription(source, launch_arguments={'wrld': path}.items())",
    instead="IncludeLaunchDescription(source, launch_arguments={'world': path}.items())",
)
UNUSED_XACRO_ARGUMENT = Rule(
    code="LCH035",
    name="unused-xacro-argument",
    severity=Severity.WARNING,
    summary="The xacro file does not use an argument that it is given.",
    what="Compares the arguments of the xacro command, or the mappings of "
    "`xacro.process_file()`, with the names that the xacro file and its includes ask for.",
    why="`xacro` ignores the argument without a message, so that a misspelled name goes unnoticed.",
    example="Command(['xacro ', path, ' lenght:=0.5'])",
    instead="Command(['xacro ', path, ' length:=0.5'])",
)

NO_ACTION = Rule(
    code="LCH065",
    name="no-action-on-exit",
    severity=Severity.WARNING,
    summary="The value of `on_exit` is not an action.",
    why="When the process ends, `launch` stops everything with an AttributeError. "
    "`launch.events.Shutdown` is an event; the action of that name is in `launch.actions`.",
    example="from launch.events import Shutdown\n\nNode(..., on_exit=Shutdown())",
    instead="from launch.actions import Shutdown\n\nNode(..., on_exit=Shutdown())",
)
VAIN_HANDLER = Rule(
    code="LCH102",
    name="handler-without-event",
    severity=Severity.WARNING,
    severity_varies="an error where the handler would start a spawner of robots or controllers",
    summary="An event handler waits for an event that never happens.",
    what="Looks for handlers of an action that is in no LaunchDescription, and for handlers of the "
    "exit of a program that does not end by itself, such as `robot_state_publisher`, which start "
    "something. Whether a program of a user ends is not known.",
    why="What the handler starts never starts, and `ros2 launch` prints no message.",
    example="RegisterEventHandler(OnProcessExit(target_action=robot_state_publisher,\n"
    "                                   on_exit=[spawn_robot]))",
    instead="RegisterEventHandler(OnProcessStart(target_action=robot_state_publisher,\n"
    "                                    on_start=[spawn_robot]))",
)

_LIMITS = frozenset(("timeout", "--iterations"))
_SPAWNERS = SPAWNER_PROGRAMS | CONTROLLER_SPAWNERS | {"load_controller"}
# They have a window, or a user who ends them, and what follows may clean up.
_ENDED_BY_USERS = frozenset(
    (
        *("gazebo", "gz", "gzclient", "ign", "joint_state_publisher_gui", "rviz2"),
        "teleop_twist_keyboard",
    )
)


def report_unused_arguments(
    launch_file: str, given: Sequence[str], of_includes: Sequence[tuple[str, Location, bool]]
) -> None:
    """Report launch arguments that nobody declares or reads.

    `given` are those of the command line; `of_includes` the names that includes give, with the
    line of the include and whether the included file belongs to a package that is not installed.
    """
    for file in RECORD.launch_files:
        if b"argv" in read_whole(Path(file)):
            return  # it may look for its arguments in the command line
    declared = list(RECORD.argument_use.declared)
    for name in given:
        _report(
            UNUSED_ARGUMENT,
            (launch_file, None),
            name,
            f"The launch argument `{name}` has no effect: no launch file declares or reads it.",
            advice(
                name,
                declared,
                f"Remove it, or declare it: DeclareLaunchArgument('{name}', default_value=...).",
            ),
        )
    for name, location, is_shim in of_includes:
        # A launch file that is not installed may take more arguments in another release.
        if is_shim and nearest(name, declared, cutoff=known_packages.SURELY) is None:
            continue
        _report(
            UNUSED_INCLUDE_ARGUMENT,
            location,
            name,
            f"The launch argument `{name}` has no effect: the included launch file does not "
            "declare or read it.",
            advice(name, declared, "Remove it from launch_arguments."),
        )


def report_unused_xacro_arguments(
    unused: Sequence[tuple[Mapping[str, str], Location | None]],
) -> None:
    """Report the arguments that a launch file gives to xacro and no xacro file uses."""
    for argument, location in unused:
        _report(
            UNUSED_XACRO_ARGUMENT,
            location,
            argument["name"],
            argument["message"],
            argument["hint"],
        )


def report_no_action(given: object, location: Location | None) -> None:
    """Report what `on_exit` of a process is given and `launch` cannot execute."""
    import launch.actions
    from wsgen.launching.explain_missing import nodes_of

    name = type(given).__name__
    file, line = location or ("", 0)
    lines = [
        keyword.value.lineno
        for node in nodes_of(file)
        if isinstance(node, ast.Call) and node.lineno <= line <= (node.end_lineno or line)
        for keyword in node.keywords
        if keyword.arg == "on_exit"
    ]
    _report(
        NO_ACTION,
        (file, min(lines, default=line)) if location else None,
        "on_exit",
        f"`on_exit` is given {name} of {type(given).__module__.replace('._', '.')}, which is not "
        "an action: when the process ends, `launch` stops with an AttributeError.",
        f"Import {name} from launch.actions, or write on_exit=[EmitEvent(event={name}())]."
        if hasattr(launch.actions, name)
        else "Write an action, or a list of actions.",
    )


def report_description_as_yaml(location: Location | None) -> None:
    """Report a robot description that is parsed as YAML."""
    in_python = "Wrap it: ParameterValue(Command([...]), value_type=str), from "
    in_python += "launch_ros.parameter_descriptions."
    as_text = {".xml": 'Add type="str" to the <param>.', ".yaml": "Add type: str to the param."}
    _report(
        DESCRIPTION_AS_YAML,
        location,
        "robot_description",
        "robot_description is parsed as YAML: this works for this robot, but a ': ' or ' #' in "
        "it, for example in a comment, would stop the launch.",
        as_text.get(Path(location[0]).suffix if location else "", in_python),
    )


def report_parameter_file(path: Path, location: Location | None) -> None:
    """Report a parameter file that cannot be read; one that is not on this machine is unknown."""
    if known_packages.is_in_shim(str(path)):
        RECORD.note_unresolved(str(path), "the package is not installed", location)
        return
    if "<robot" in str(path):
        _report(
            PARAMETER_FILE_MISSING,
            location,
            "robot_description",
            "The parameters of the node have the text of a robot in the place of a file; the node "
            "starts without it.",
            "Give the parameter its name: {'robot_description': ...}.",
        )
        return
    place = find_in_package(str(path))
    _report(
        PARAMETER_FILE_MISSING,
        location,
        None,
        f"The parameter file '{path}' cannot be read; the node starts without it.",
        f"Look it up in the share folder of its package: {in_python(place)}."
        if place
        else "Check the path, and that CMakeLists.txt installs the folder: "
        "install(DIRECTORY config DESTINATION share/${PROJECT_NAME}).",
    )


def _report(
    rule: Rule,
    location: Location | tuple[str, None] | None,
    element: str | None,
    message: str,
    hint: str,
) -> None:
    file, line = location or (None, None)
    diagnostic: Diagnostic = rule.at(
        None if file is None else Path(file), line, element, message=message, hint=hint
    )
    RECORD.diagnostics.append(diagnostic)


def report_vain_handlers(handlers: Iterable[Any]) -> None:
    """Report those handlers of actions, which wait in vain, that are wrong in the first place.

    Nothing is said where the launch ends early, or an action may be in what was not evaluated.
    """
    if RECORD.is_cut_short:
        return
    inside = _never_visited()
    for handler in handlers:
        target = handler.wsgen_target
        if target.wsgen_is_visited:
            cause = f"exit of {target.process_name}"
            started = [one for one in RECORD.processes if one.starts == cause]
            names = [name for one in started for name in _names_of(one)]
            if not _waits_for_endless(target.wsgen_endless, started):
                continue
            _report_handler(
                handler,
                f"waits for the end of `{target.process_name}`, which does not end by itself",
                names,
                "Use OnProcessStart with on_start, or wait for a program that ends, such as a "
                "spawner.",
            )
        elif inside is not None and id(target) not in inside:
            name = _target_name(handler)
            _report_handler(
                handler,
                f"waits for {f'`{name}`' if name else 'an action'}, which is not in the "
                "LaunchDescription and never starts",
                [name for one in handler.wsgen_actions for name in _written_names(one)],
                f"Add {f'`{name}`' if name else 'the action'} to the LaunchDescription, or wait "
                "for an action that is in it.",
            )


def _waits_for_endless(process: Process, started: Sequence[Process]) -> bool:
    """Whether what is started when a process ends is surely not meant for its end.

    It may clean up, or start again what has crashed.
    """
    (program, *others) = commands.programs(process)
    words = (*(process.command or ()), *process.arguments)
    if others or commands.nested_launch(program) or not _LIMITS.isdisjoint(words):
        return False
    following = [one for outer in started for one in commands.programs(outer)]
    if any(one.executable == program.executable for one in following):
        return False
    known = (name for one in started for name in _names_of(one))
    if any(name in _SPAWNERS or known_packages.runs_for_ever(name) for name in known):
        return True
    return program.executable not in _ENDED_BY_USERS and any(one.package for one in following)


def _report_handler(handler: OnActionEventBase, what: str, names: Sequence[str], hint: str) -> None:
    file, line = split_location(handler.wsgen_origin)
    started = list(dict.fromkeys(f"`{name}`" for name in names))
    follows = f": {some_of(started)} never start{'s' if len(started) == 1 else ''}"
    RECORD.report(
        VAIN_HANDLER.at(
            None if file is None else Path(file),
            line,
            f"{type(handler).__name__} {line}",
            message=f"`{type(handler).__name__}` {what}{follows if started else ''}.",
            hint=hint,
            severity=Severity.ERROR if not _SPAWNERS.isdisjoint(names) else None,
        )
    )


def _never_visited() -> set[int] | None:
    """The actions inside of what did not hold or happen; None where not all of it is known."""
    if RECORD.left_out or any(one.why == STARTS_UNKNOWN for one in RECORD.unresolved):
        return None
    found: set[int] = set()
    pending: list[LaunchDescriptionEntity] = list(RECORD.skipped)
    for handler in RECORD.handlers:
        if not handler.wsgen_is_handled:
            actions = getattr(handler, "wsgen_actions", None)
            pending += handler.describe()[1] if actions is None else actions
            if actions == []:
                return None  # a function says what follows
    while pending:
        entity = pending.pop()
        if id(entity) in found:
            continue
        found.add(id(entity))
        inside = _inside(entity)
        if inside is None:
            return None
        pending += inside
    return found


def _inside(entity: LaunchDescriptionEntity) -> list[LaunchDescriptionEntity] | None:
    """What is in an entity that was not executed; None for what a function gives.

    Another launch file, which is not loaded for this, cannot have an action of this one.
    """
    from launch.actions import IncludeLaunchDescription, OpaqueFunction

    if isinstance(entity, OpaqueFunction):
        return None
    if isinstance(entity, IncludeLaunchDescription):
        return []
    groups = (group for _, group in entity.describe_conditional_sub_entities())
    return [*entity.describe_sub_entities(), *(one for group in groups for one in group)]


def _target_name(handler: OnActionEventBase) -> str | None:
    """The variable that has the action which a handler waits for."""
    file, line = handler.wsgen_origin or ("", 0)
    for node in nodes_of(file):
        if isinstance(node, ast.Call) and node.lineno <= line <= (node.end_lineno or line):
            for keyword in node.keywords:
                if keyword.arg == "target_action" and isinstance(keyword.value, ast.Name):
                    return keyword.value.id
    return None


def _names_of(process: Process) -> Iterator[str]:
    """The programs that a process runs, and the verb of `ros2 control`."""
    for program in commands.programs(process):
        if program.executable:
            yield program.executable
        yield from _SPAWNERS.intersection(program.arguments[:3])


def _written_names(entity: LaunchDescriptionEntity) -> Iterator[str]:
    """The names of programs that an action would start, as far as they are written."""
    from launch.actions import ExecuteProcess

    if not isinstance(entity, ExecuteProcess):
        for inside in _inside(entity) or ():
            yield from _written_names(inside)
        return
    for word in entity.wsgen_program:
        text = "".join(getattr(part, "text", "") for part in word)
        if text:
            yield text.rpartition("/")[2]
            yield from _SPAWNERS.intersection(text.split())
            break
