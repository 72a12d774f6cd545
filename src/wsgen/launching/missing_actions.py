"""What a plan lacks although the launch file creates an action for it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.diagnostics import Severity
from wsgen.launching.explain_missing import unused_actions

if TYPE_CHECKING:
    from collections.abc import Collection

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan


def or_unused_action(
    missing: Diagnostic, plan: LaunchPlan, *kinds: str, names: Collection[str]
) -> Diagnostic:
    """What is reported as missing; or, as an error, the action that was created and never added.

    `kinds` are the classes of such actions; `names` the programs, launch files and packages of
    which they name one.
    """
    for action in unused_actions(plan.evaluated_files, kinds):
        if not action.words.isdisjoint(names):
            return replace(
                missing,
                severity=Severity.ERROR,
                message=f"{missing.message.rstrip('.')}: `{action.name}` is created but not "
                "added to the LaunchDescription.",
                file=action.file,
                line=action.line,
                element=action.name,
                hint=f"Add it to the LaunchDescription that is returned: add_action({action.name})"
                ".",
            )
    return missing
