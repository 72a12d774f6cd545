"""Expand a xacro file in a child process, and say what is wrong where it cannot be."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.isolation import parent
from wsgen.isolation.outcome import Died, Limits

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.isolation.parent import Run


TASK = "wsgen.xacro.expansion:expand_for_parent"
LIMITS = Limits(seconds=30.0, memory=2 * 2**30)


def expand_file(
    file: Path,
    arguments: Mapping[str, str],
    *,
    environment: Mapping[str, str],
    run: Run = parent.run,
) -> tuple[str | None, tuple[Diagnostic, ...]]:
    """The URDF that a xacro file expands to with these arguments; None where it does not.

    A xacro file may hold expressions that never end, and its expressions are Python: it is expanded
    in a child process with limits.
    """
    outcome = run(
        TASK,
        str(file.absolute()),
        dict(arguments),
        limits=LIMITS,
        environment=environment,
        folder=file.parent,
    )
    if isinstance(outcome, Died):
        return None, (
            _fault(
                file,
                {
                    "message": f"Expanding the file {outcome.reason}",
                    "hint": outcome.hint("Look for an expression or a macro that never ends."),
                },
            ),
        )
    if outcome.value["code"] != 0:
        fault = outcome.value["fault"] or {"message": outcome.value["stderr"].strip()}
        return None, (_fault(file, fault),)
    return str(outcome.value["stdout"]), tuple(
        Diagnostic(
            code="LCH035",
            severity=Severity.WARNING,
            message=unused["message"],
            file=file,
            element=unused["name"],
            hint=unused["hint"],
        )
        for unused in outcome.value["unused"]
    )


def _fault(file: Path, fault: Mapping[str, Any]) -> Diagnostic:
    where = fault.get("file")
    message = str(fault["message"]).rstrip(".")
    if "AMENT_PREFIX_PATH" in message:
        fault = {**fault, "hint": "Build and source a workspace with the packages of $(find …)."}
        message = "a package of $(find …) was not found: no workspace is sourced"
    return Diagnostic(
        code="ROB071",
        severity=Severity.ERROR,
        message=f"xacro cannot expand the file: {message}.",
        file=Path(os.fspath(where)) if where else file,
        line=fault.get("line"),
        element=fault.get("element"),
        hint=fault.get("hint") or "Arguments of the file are given with --arg name:=value.",
    )
