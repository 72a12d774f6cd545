"""Warnings that a package allows in its `wsgen.toml`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.rules.catalogue import all_rules, find_rule
from wsgen.suggestions import did_you_mean, nearest

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

UNKNOWN_RULE_ALLOWED = Rule(
    code="PKG061",
    name="unknown-rule-allowed",
    severity=Severity.WARNING,
    summary="`wsgen.toml` allows a rule that does not exist.",
    what="Compares the names in `allow` of `wsgen.toml` with all rules.",
    why="A misspelled name allows nothing.",
    example='[validate]\nallow = ["masless-root"]',
    instead='[validate]\nallow = ["massless-root"]',
)


def without_allowed(
    diagnostics: Iterable[Diagnostic], allow: Sequence[str]
) -> tuple[Diagnostic, ...]:
    """The diagnostics without those whose rule is allowed by name or code; errors always stay."""
    return tuple(
        found
        for found in diagnostics
        if found.severity is Severity.ERROR or not {found.name, found.code} & set(allow)
    )


def unknown_rule_allowed(allow: Iterable[str], file: Path) -> Iterator[Diagnostic]:
    """Report the names in `allow` that no rule has."""
    for name in allow:
        rule = find_rule(name)
        if rule is None or name not in {rule.name, rule.code}:
            near = nearest(name, [rule.name for rule in all_rules()])
            yield UNKNOWN_RULE_ALLOWED.at(
                file,
                element="validate.allow",
                message=f"The allowed rule {name!r} does not exist.",
                hint=did_you_mean(near) if near else "`wsgen rule` lists the names.",
            )
