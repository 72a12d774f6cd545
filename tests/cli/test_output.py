"""The lines of diagnostics."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import click
import pytest

from wsgen.cli.output import render_diagnostics, render_outcome, render_tree
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.behavior import BehaviorOutcome, Drive
from wsgen.model.outcome import (
    EngineOutcome,
    NotValidated,
    Outcome,
    PackageOutcome,
    Rest,
    RobotOutcome,
    Simulated,
)
from wsgen.model.plan import LaunchArgument, LaunchPlan
from wsgen.model.transform import Pose


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


def test_notes_about_a_robot_that_passes_are_for_v() -> None:
    about_robot = diagnostic(Severity.INFO, name="its-root")
    about_run = diagnostic(Severity.INFO, code="WLD061", name="no-world")
    warning = diagnostic(Severity.WARNING, name="heavy")
    passed = PackageOutcome(
        package="p", share=None, launch_file=None, diagnostics=(about_robot, about_run, warning)
    )
    failed = replace(passed, diagnostics=(about_robot, diagnostic(Severity.ERROR)))

    def shown(outcome: PackageOutcome, *, verbose: bool = False) -> str:
        lines = render_outcome(Outcome(packages=(outcome,)), verbose=verbose)
        return click.unstyle("\n".join(lines))

    assert "its-root" not in shown(passed)
    assert "-v shows 1 note about the robot." in shown(passed)
    assert "no-world" in shown(passed)
    assert "heavy" in shown(passed)
    assert "its-root" in shown(passed, verbose=True)
    assert "-v shows" not in shown(passed, verbose=True)
    assert "its-root" in shown(failed)  # it may say why


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
        NotValidated(package="p", launch_file=Path(name), reason="no") for name in ("a", "b\n::x")
    ]
    messages = NotValidated(package="m", reason="spawns no robot")
    outcome = Outcome(packages=(), not_validated=(*robots, *failing, messages))
    assert [click.unstyle(line) for line in render_outcome(outcome)] == [
        "no launch file spawns a robot: nothing was simulated",
        "",
        "not validated",
        "  r0, r1, r2, r3: spawns no robot",
        "   try: wsgen validate 0.urdf 1.urdf 2.urdf  # or one of 1 more",
        "  p a, b ::x: no",
        "  m: spawns no robot",
    ]


def in_engine(name: str, *, z: float = 0.25, passed: bool = True, **rest: Any) -> EngineOutcome:
    return EngineOutcome(
        engine=name,
        simulated=Simulated(engine=name, links=1, movable_joints=0, mass=1.0),
        rest=Rest(pose_in_world=Pose((0.0, 0.0, z)), settled_after=0.5, speed=0.0, **rest),
        passed=passed,
        codes=frozenset(["SPN059"] if not passed or z < 0.2 else []),  # tips-over
    )


def table_of(
    *engines: EngineOutcome, behaviors: tuple[BehaviorOutcome, ...] = (), quiet: bool = False
) -> list[str]:
    robot = RobotOutcome(
        entity="r",
        spawn_pose=Pose((0.0, 0.0, 0.255)),
        links=2,
        joints=1,
        movable_joints=0,
        mass=1.0,
        engines=engines,
        behaviors=behaviors,
        passed=all(one.passed for one in engines),
    )
    package = PackageOutcome(package="p", share=None, launch_file=None, robots=(robot,))
    lines = render_outcome(Outcome(packages=(package,)), quiet=quiet)
    return [" ".join(click.unstyle(line).split()) for line in lines[2:]]


def test_a_robot_has_a_row_for_each_engine() -> None:
    head, _, *rows = table_of(
        in_engine("bullet"), in_engine("mujoco", z=0.1, tilt=1.0), EngineOutcome(engine="dart")
    )
    assert head == "robot engine mass, kg at the end, m tilt, degrees result"
    assert rows == [
        "r PyBullet 1.000 0.00 0.00 0.250 0.0 stands after 0.5 s",
        "r MuJoCo 1.000 0.00 0.00 0.100 57.3 tips over",
        "r DART - - - not simulated",
    ]
    assert table_of(in_engine("bullet"), in_engine("dart", passed=False), quiet=True) == [
        "r PyBullet 1.000 0.00 0.00 0.250 0.0 stands after 0.5 s",
        "r DART 1.000 0.00 0.00 0.250 0.0 fails",
    ]


def test_one_engine_has_no_column() -> None:
    head, _, row = table_of(in_engine("dart"))
    assert head == "robot mass, kg movable spawned at, m at the end, m result"
    assert row == "r 1.000 0 of 1 0.00 0.00 0.255 0.00 0.00 0.250 stands after 0.5 s"
    (row,) = table_of(quiet=True)
    assert row == "r - 0 of 1 0.00 0.00 0.255 - not simulated"


def test_a_behavior_has_a_line_for_each_engine() -> None:
    def drives(x: float, *, passed: bool = True) -> tuple[BehaviorOutcome, ...]:
        return (
            BehaviorOutcome(name="drives", task=Drive(x=1.0), passed=passed, moved=(x, 0.0, 0.0)),
        )

    far, near = drives(0.98), drives(0.4, passed=False)
    each = (
        replace(in_engine("mujoco"), behaviors=far),
        replace(in_engine("dart", passed=False), behaviors=near),
    )
    assert table_of(*each, behaviors=drives(0.98, passed=False))[-2:] == [
        "ok drives, MuJoCo: 0.98 m ahead, 0.00 m to the left, turned by 0.00 rad",
        "failed drives, DART: 0.40 m ahead, 0.00 m to the left, turned by 0.00 rad",
    ]
    assert table_of(each[0], behaviors=far)[-1] == (
        "ok drives: 0.98 m ahead, 0.00 m to the left, turned by 0.00 rad"
    )


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
