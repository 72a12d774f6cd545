"""Diagnostics -> lines that a person reads."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import click

from wsgen.checks.catalogue import RULES
from wsgen.cli.words import short_path
from wsgen.diagnostics import Severity

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.diagnostics import Diagnostic

COLORS = {Severity.ERROR: "red", Severity.WARNING: "yellow", Severity.INFO: "blue"}
ORDER = tuple(COLORS)
NAMES = {rule.code: rule.name for rule in RULES}


def render_findings(
    diagnostics: Sequence[Diagnostic], *, most_alike: int | None = None
) -> list[str]:
    """Errors first; of each the place, what is wrong, and what to do.

    Of warnings and informations with one code, `most_alike` are told and the others counted. Errors
    are all told.
    """
    lines: list[str] = []
    told: Counter[str] = Counter()
    for finding in sorted(diagnostics, key=lambda found: ORDER.index(found.severity)):
        told[finding.code] += 1
        is_one_of_many = most_alike is not None and told[finding.code] > most_alike
        if is_one_of_many and finding.severity is not Severity.ERROR:
            continue
        kind = f"{finding.severity.value}[{finding.code}]"
        label = click.style(kind, fg=COLORS[finding.severity])
        lines.append(f"{label} {NAMES[finding.code]}: {finding.message}")
        place = _place(finding)
        if place:
            lines.append(f"    at: {place}")
        if finding.hint:
            lines.append(f"   try: {finding.hint}")
    return lines + _not_told(diagnostics, told, most_alike)


def _not_told(
    diagnostics: Sequence[Diagnostic], told: Counter[str], most_alike: int | None
) -> list[str]:
    severities = {found.code: found.severity for found in diagnostics}
    left = [
        f"{count - most_alike} more of {NAMES[code]}"
        for code, count in told.items()
        if most_alike is not None and count > most_alike and severities[code] is not Severity.ERROR
    ]
    return [f"and {', '.join(left)}: -v shows all"] if left else []


def _place(finding: Diagnostic) -> str:
    parts = []
    if finding.file is not None:
        short = short_path(finding.file)
        parts.append(short if finding.line is None else f"{short}:{finding.line}")
    if finding.element:
        parts.append(finding.element)
    return "  ".join(parts)
