"""What a package has on purpose is not told again."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.checks.catalogue import RULES
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.suggestions import did_you_mean, nearest

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path


def without_allowed(
    diagnostics: Iterable[Diagnostic], allow: Sequence[str]
) -> tuple[Diagnostic, ...]:
    """The findings without those whose rule is allowed by name or code; errors always stay."""
    codes = {rule.code for rule in RULES if rule.name in allow or rule.code in allow}
    return tuple(
        found
        for found in diagnostics
        if found.severity is Severity.ERROR or found.code not in codes
    )


def unknown_rule_allowed(allow: Iterable[str], file: Path) -> Iterator[Diagnostic]:
    """A package allows a rule that does not exist.

    ## What it does
    Compares the names in `allow` of `wsgen.toml` with the catalogue.

    ## Why is this bad?
    A misspelt name allows nothing.

    ## Use instead
    The name in the catalogue.
    """
    names = [rule.name for rule in RULES]
    codes = {rule.code for rule in RULES}
    for name in allow:
        if name not in names and name not in codes:
            near = nearest(name, names)
            yield Diagnostic(
                code="PKG061",
                severity=Severity.WARNING,
                message=f"There is no rule {name!r} to allow.",
                file=file,
                element="validate.allow",
                hint=did_you_mean(near) if near else "docs/rules.md lists the names.",
            )
