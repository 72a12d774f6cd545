"""Fix what a rule would report, from its message and hint alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.checks.fixes.plan import plan_fixes, write_fixes
from wsgen.checks.rules.catalogue import find_rule
from wsgen.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from pathlib import Path


def report(  # noqa: PLR0917
    file: Path, name: str, line: int | None, message: str, hint: str, element: str | None = None
) -> Diagnostic:
    """A diagnostic of the rule with this name."""
    rule = find_rule(name)
    assert rule is not None
    return Diagnostic(
        code=rule.code,
        name=rule.name,
        severity=Severity.ERROR,
        message=message,
        file=file,
        line=line,
        element=element,
        hint=hint,
    )


def fixed(  # noqa: PLR0917
    file: Path,
    name: str,
    line: int | None,
    message: str = "",
    hint: str = "",
    element: str | None = None,
) -> str | None:
    """The text after the fix; None if there is none."""
    plan = plan_fixes([report(file, name, line, message, hint, element)], [file.parent])
    for _ in write_fixes(plan):
        return plan.files[0].file.read_bytes().decode()
    return None
