"""The child process that evaluates a launch file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from wsgen.launch import worker
from wsgen.launch.record import RECORD, CommandOutcome
from wsgen.xacro import expansion

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


def evaluate_launch(
    launch_file: str,
    package: str | None,
    arguments: Mapping[str, str],
    only_arguments: bool,  # noqa: FBT001  tasks are called by position
) -> dict[str, Any]:
    """Evaluate a launch file, with the real xacro for its xacro commands."""
    watch = expansion.Watch(RECORD.note_text, RECORD.note_unused_xacro_arguments)
    plan = worker.evaluate(
        launch_file,
        package,
        arguments,
        run_xacro=_run_xacro,
        find_xacro_fault=expansion.explain_error,
        only_arguments=only_arguments,
    )
    return {**plan, "seconds_in_xacro": watch.seconds}


def _run_xacro(words: Sequence[str]) -> CommandOutcome:
    result = expansion.run_command(words)
    return CommandOutcome(result.stdout, result.stderr, result.code, result.error, result.unused)
