"""The lines of diagnostics."""

from pathlib import Path

import click
import pytest

from wsgen.cli.output import render_diagnostics, render_outcome, render_tree
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.outcome import NotValidated, Outcome, PackageOutcome
from wsgen.model.plan import LaunchArgument, LaunchPlan


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


def test_a_summary_says_why_each_failed() -> None:
    failed = PackageOutcome(
        package="p",
        share=None,
        launch_file=Path("sim.launch.py"),
        diagnostics=(diagnostic(Severity.WARNING), diagnostic(Severity.ERROR)),
    )
    lines = [click.unstyle(line) for line in render_outcome(Outcome(packages=(failed, failed)))]
    assert lines[-3:] == ["0 passed, 2 failed:", *["  p  sim.launch.py: Say it."] * 2]


def test_what_is_not_validated_is_said_once_for_each_reason() -> None:
    robots = [
        NotValidated(package=f"r{n}", reason="spawns no robot", robot_files=(Path(f"{n}.urdf"),))
        for n in range(4)
    ]
    failing = [
        NotValidated(package="p", launch_file=Path(name), reason="no") for name in ("a", "b")
    ]
    messages = NotValidated(package="m", reason="spawns no robot")
    outcome = Outcome(packages=(), not_validated=(*robots, *failing, messages))
    assert [click.unstyle(line) for line in render_outcome(outcome)] == [
        "no launch file spawns a robot: nothing was simulated",
        "",
        "not validated",
        "  r0, r1, r2, r3: spawns no robot",
        "   try: wsgen validate 0.urdf 1.urdf 2.urdf  # or one of 1 more",
        "  p a, b: no",
        "  m: spawns no robot",
    ]


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        ("{here}/install/a.world", "install/a.world"),
        ('-r -v 4 "{here}/install/a.world"', '-r -v 4 "install/a.world"'),
        ("x{here}/install/a.world", "x{here}/install/a.world"),
        ("<robot>" * 200, ("<robot>" * 200)[:999] + "…"),
    ],
)
def test_values_of_arguments_have_short_paths_and_end_somewhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, value: str, shown: str
) -> None:
    monkeypatch.chdir(tmp_path)
    value, shown = (text.replace("{here}", str(tmp_path)) for text in (value, shown))
    monkeypatch.setattr("wsgen.cli.output.MOST_CHARACTERS", 1000)
    argument = LaunchArgument(name="world", default=None, value=value)
    plan = LaunchPlan(package=None, launch_file=tmp_path / "a.launch.py", arguments=(argument,))
    assert f"  world:={shown}  (given)" in [click.unstyle(line) for line in render_tree(plan)]
