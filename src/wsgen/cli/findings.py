"""Diagnostics -> lines that a person reads."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.checks.catalogue import RULES
from wsgen.cli.words import short_path
from wsgen.diagnostics import Severity

if TYPE_CHECKING:
    from collections.abc import Iterable

    from wsgen.diagnostics import Diagnostic

COLORS = {Severity.ERROR: "red", Severity.WARNING: "yellow", Severity.INFO: "blue"}
ORDER = tuple(COLORS)
NAMES = {rule.code: rule.name for rule in RULES}


def render_findings(diagnostics: Iterable[Diagnostic]) -> list[str]:
    """Errors first; of each the place, what is wrong, and what to do."""
    lines: list[str] = []
    for finding in sorted(diagnostics, key=lambda found: ORDER.index(found.severity)):
        kind = f"{finding.severity.value}[{finding.code}]"
        label = click.style(kind, fg=COLORS[finding.severity])
        lines.append(f"{label} {NAMES[finding.code]}: {finding.message}")
        place = _place(finding)
        if place:
            lines.append(f"    at: {place}")
        if finding.hint:
            lines.append(f"   try: {finding.hint}")
    return lines


def _place(finding: Diagnostic) -> str:
    parts = []
    if finding.file is not None:
        short = short_path(finding.file)
        parts.append(short if finding.line is None else f"{short}:{finding.line}")
    if finding.element:
        parts.append(finding.element)
    return "  ".join(parts)
