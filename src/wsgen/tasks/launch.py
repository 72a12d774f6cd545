"""The child process that evaluates a launch file."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.launch import worker
from wsgen.launch.record import RECORD, CommandOutcome
from wsgen.xacro import expansion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.model.plan import LaunchPlan, LaunchRequest


def warm_up() -> None:
    """Import what tasks would import one by one; a fork server calls it before it forks."""
    worker.load_shim()


def evaluate_launch(request: LaunchRequest) -> LaunchPlan:
    """Evaluate a launch file, with the real xacro for its xacro commands."""
    watch = expansion.Watch(RECORD.note_text, RECORD.note_unused_xacro_arguments)
    plan = worker.evaluate(request, run_xacro=_run_xacro, explain_xacro=expansion.explain_error)
    return replace(plan, seconds_in_xacro=watch.seconds)


def _run_xacro(words: Sequence[str]) -> CommandOutcome:
    result = expansion.run_command(words)
    return CommandOutcome(result.stdout, result.stderr, result.code, result.error, result.unused)
