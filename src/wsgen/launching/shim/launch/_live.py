"""What a process action says about how its process is run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from launch._utilities import (
    normalize_to_list_of_substitutions,
    normalize_typed_substitution,
    perform_substitutions,
    perform_typed_substitution,
)
from launch.conditions import evaluate_condition_expression
from wsgen.launching.live import Start

if TYPE_CHECKING:
    from launch.actions import ExecuteLocal
    from launch.launch_context import LaunchContext
    from wsgen.model.plan import Process


def starting_of(action: ExecuteLocal, context: LaunchContext, process: Process) -> Start:
    """The start of a process that was prepared."""
    given = action.wsgen_running
    is_node = process.command is None
    output = given.get("output", "log")
    if not isinstance(output, Mapping):
        output = perform_substitutions(context, normalize_to_list_of_substitutions(output))
    return Start(
        action=action,
        process=process,
        package=process.package,
        executable=process.executable,
        path=getattr(action, "wsgen_path", None),
        node=getattr(action, "node_name", None) if is_node else None,
        name=_name(action, context) if is_node else process.name,
        prefix=tuple(action.wsgen_prefix),
        words=tuple(action.wsgen_words(process)),
        is_shell=process.is_shell,
        folder=action.wsgen_folder,
        environment=action.wsgen_environment,
        output=output,
        output_format=given.get("output_format"),
        is_cached=bool(given.get("cached_output")),
        emulates_tty=_emulates_tty(given.get("emulate_tty", False), context),
        logs_command=bool(given.get("log_cmd")),
        respawns=_typed(given.get("respawn", False), context, bool),
        respawn_delay=given.get("respawn_delay") or 0.0,
        respawn_max_retries=int(given.get("respawn_max_retries", -1)),
        sigterm_timeout=_seconds(given, "sigterm_timeout", context),
        sigkill_timeout=_seconds(given, "sigkill_timeout", context),
    )


def _name(action: Any, context: LaunchContext) -> str | None:
    """What a node's process is called, by its `exec_name`."""
    name = action.name
    return None if name is None else perform_substitutions(context, name)


def _typed(value: Any, context: LaunchContext, kind: type) -> Any:
    return perform_typed_substitution(context, normalize_typed_substitution(value, kind), kind)


def _seconds(given: Mapping[str, Any], name: str, context: LaunchContext) -> float:
    """A timeout: what the action says, else the launch configuration, else 5 s."""
    value = given.get(name, context.launch_configurations.get(name, "5"))
    if isinstance(value, (int, float)):
        return float(value)
    return float(perform_substitutions(context, normalize_to_list_of_substitutions(value)))


def _emulates_tty(value: Any, context: LaunchContext) -> bool:
    """What the launch configuration says, else the action."""
    text = context.launch_configurations.get("emulate_tty")
    if text is None:
        return bool(_typed(value, context, bool))
    return evaluate_condition_expression(context, normalize_to_list_of_substitutions(text))
