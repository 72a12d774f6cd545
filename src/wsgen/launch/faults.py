"""What is wrong with a process of a plan."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from wsgen.model.plan import Process


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
