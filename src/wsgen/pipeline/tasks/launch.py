"""The child process that evaluates a launch file."""

from __future__ import annotations

import gc
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.descriptions.xacro import expansion
from wsgen.descriptions.xacro.result import Expansion
from wsgen.isolation.child import set_environment
from wsgen.launching import worker
from wsgen.launching.expansions import Expansions
from wsgen.launching.plain import EVALUATE, EXPAND
from wsgen.launching.record import RECORD, CommandOutcome

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from wsgen.descriptions.xacro.result import ExpansionRequest
    from wsgen.isolation.channel import Endpoint
    from wsgen.model.plan import LaunchPlan, LaunchRequest


def warm_up() -> None:
    """Import what tasks would import one by one; a fork server calls it before it forks."""
    worker.load_shim()
    expansion.warm_up()


def evaluate_launch(request: LaunchRequest) -> LaunchPlan:
    """Evaluate a launch file, with the real xacro for its xacro commands."""
    watch = expansion.Watch(RECORD.note_text, RECORD.note_unused_xacro_arguments)
    plan = worker.evaluate(request, run_xacro=run_xacro, explain_xacro=expansion.explain_error)
    return replace(plan, seconds_in_xacro=watch.seconds)


def serve_plain_launches(endpoint: Endpoint) -> None:
    """Evaluate launch files that leave nothing behind, one after the other, until it is closed."""
    from wsgen.isolation.channel import serve  # noqa: PLC0415  other children start without it

    worker.load_shim(worker.FIRST_IMPORTED)  # the rest when a launch file asks for it
    watch = expansion.Watch(RECORD.note_text, RECORD.note_unused_xacro_arguments)
    run_kept = Expansions(run_xacro).run
    gc.freeze()  # the collector need not look at what is imported

    def evaluate(request: LaunchRequest, environment: Mapping[str, str]) -> LaunchPlan | None:
        gc.collect(1)  # documents of the one before it, whose nodes hold each other
        watch.seconds = 0.0
        expansion.reset()
        plan = worker.evaluate_plain(
            request, environment, run_xacro=run_kept, explain_xacro=expansion.explain_error
        )
        return plan and replace(plan, seconds_in_xacro=watch.seconds)

    serve(endpoint, {EVALUATE: evaluate, EXPAND: _expand})


def _expand(
    request: ExpansionRequest, environment: Mapping[str, str], folder: str
) -> Expansion | None:
    """Expand a xacro file in a folder; None where that fails."""
    before = Path.cwd()
    RECORD.forget()
    set_environment(environment)
    os.chdir(folder)
    try:
        answer = expansion.expand_for_parent(request)
    finally:
        os.chdir(before)
    return answer if isinstance(answer, Expansion) else None


def run_xacro(words: Sequence[str]) -> CommandOutcome:
    """The outcome of a command line that begins with `xacro`."""
    result = expansion.run_command(words)
    return CommandOutcome(result.stdout, result.stderr, result.code, result.error, result.unused)
