"""The lines of diagnostics."""

from pathlib import Path

import click

from wsgen.cli.output import render_diagnostics
from wsgen.diagnostics import Diagnostic, Severity


def diagnostic(severity: Severity, code: str = "ROB052", name: str = "a-rule") -> Diagnostic:
    return Diagnostic(code=code, name=name, severity=severity, message="Say it.")


def plain(*diagnostics: Diagnostic, most_alike: int | None = None) -> list[str]:
    return [click.unstyle(line) for line in render_diagnostics(diagnostics, most_alike=most_alike)]


def test_errors_come_first_with_name_place_and_hint() -> None:
    error = Diagnostic(
        code="ROB001",
        name="its-rule",
        severity=Severity.ERROR,
        message="Message.",
        file=Path("robot.urdf"),
        line=3,
        element="link base",
        hint="Do it.",
    )
    assert plain(diagnostic(Severity.INFO), error) == [
        "error[ROB001] its-rule: Message.",
        "    at: robot.urdf:3  link base",
        "   try: Do it.",
        "info[ROB052] a-rule: Say it.",
    ]


def test_errors_are_all_shown_and_the_others_counted_without_them() -> None:
    errors = [diagnostic(Severity.ERROR)] * 3
    warnings = [diagnostic(Severity.WARNING)] * 4
    lines = plain(*warnings, *errors, most_alike=2)
    assert [line.split("[")[0] for line in lines] == ["error"] * 3 + ["warning"] * 2 + [
        "and 2 more of a-rule: -v shows all"
    ]
    assert len(plain(*warnings, most_alike=None)) == 4
