"""What is wrong with a process of a plan."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.launch.syntax import loose_actions

if TYPE_CHECKING:
    from collections.abc import Collection

    from wsgen.model.plan import LaunchPlan, Process


def fault(code: str, process: Process, message: str, hint: str) -> Diagnostic:
    """An error at the line of the launch file that describes the process."""
    return Diagnostic(
        code=code,
        severity=Severity.ERROR,
        message=message,
        file=process.file,
        line=process.line,
        element=process.executable,
        hint=hint,
    )


def or_loose(
    missing: Diagnostic, plan: LaunchPlan, *kinds: str, names: Collection[str]
) -> Diagnostic:
    """What is reported as missing; or the action that was created for it and never added.

    `kinds` are the classes of such actions; `names` the programs, launch files and packages of
    which they name one.
    """
    for action in loose_actions(plan.evaluated_files, kinds):
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
