"""What a package allows in its `wsgen.toml`."""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.rules.catalogue import all_rules

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

UNKNOWN_RULE_ALLOWED = Rule(
    code="PKG061",
    name="unknown-rule-allowed",
    severity=Severity.WARNING,
    summary="wsgen.toml allows a rule that does not exist.",
    what="Compares the names in `allow` of `wsgen.toml` with all rules.",
    why="A misspelled name allows nothing.",
    example='[validate]\nallow = ["masless-root"]',
    instead='[validate]\nallow = ["massless-root"]',
)


def without_allowed(
    diagnostics: Iterable[Diagnostic], allow: Sequence[str]
) -> tuple[Diagnostic, ...]:
    """The diagnostics without those whose rule is allowed by name or code; errors always stay."""
    if not allow:
        return tuple(diagnostics)
    codes = {rule.code for rule in all_rules() if rule.name in allow or rule.code in allow}
    return tuple(
        found
        for found in diagnostics
        if found.severity is Severity.ERROR or found.code not in codes
    )


def unknown_rule_allowed(allow: Iterable[str], file: Path) -> Iterator[Diagnostic]:
    """Report the names in `allow` that no rule has."""
    for name in allow:
        names = [rule.name for rule in all_rules()]
        codes = {rule.code for rule in all_rules()}
        if name not in names and name not in codes:
            near = difflib.get_close_matches(name, names, n=1)
            yield UNKNOWN_RULE_ALLOWED.at(
                file,
                element="validate.allow",
                message=f"There is no rule {name!r} to allow.",
                hint=f"Did you mean {near[0]!r}?" if near else "`wsgen rule` lists the names.",
            )
