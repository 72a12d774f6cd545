"""The rule about event handlers that wait for what never happens.

In the child process this is imported only where there is something to report.
"""

from __future__ import annotations

import ast
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import Rule, Severity
from wsgen.launching import commands, known_packages
from wsgen.launching.explain_missing import nodes_of
from wsgen.launching.record import RECORD, split_location
from wsgen.launching.spawner_options import CONTROLLER_SPAWNERS, SPAWNER_PROGRAMS
from wsgen.model.plan import STARTS_UNKNOWN
from wsgen.text.suggestions import some_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from launch.base import LaunchDescriptionEntity
    from launch.event_handlers import OnActionEventBase
    from wsgen.model.plan import Process


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

_SPAWNERS = SPAWNER_PROGRAMS | CONTROLLER_SPAWNERS | {"load_controller"}
# They have a window, or a user who ends them, and what follows may clean up.
_ENDED_BY_USERS = frozenset(
    (
        *("gazebo", "gz", "gzclient", "ign", "joint_state_publisher_gui", "rviz2"),
        "teleop_twist_keyboard",
    )
)


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
            _report(
                handler,
                f"waits for the end of `{target.process_name}`, which does not end by itself",
                names,
                "Use OnProcessStart with on_start, or wait for a program that ends, such as a "
                "spawner.",
            )
        elif inside is not None and id(target) not in inside:
            name = _target_name(handler)
            _report(
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


_LIMITS = frozenset(("timeout", "--iterations"))


def _report(handler: OnActionEventBase, what: str, names: Sequence[str], hint: str) -> None:
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
