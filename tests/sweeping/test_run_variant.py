"""A run says what `wsgen validate` says, and measures what the columns promise."""

from __future__ import annotations

import json
import math
import os
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from kind_workspaces import copy_workspace
from simulation.robots import GROUND, PLATE, G, body, single
from sweeping.blueprints import blueprint, prepared, variant
from wsgen.diagnostics import Severity
from wsgen.isolation.codec import decode, encode
from wsgen.isolation.result import Died
from wsgen.model.robot import Box
from wsgen.model.sweep import Row, Variant
from wsgen.model.transform import Pose
from wsgen.packages.workspace.layout import workspace_around
from wsgen.pipeline.requests import ValidateRequest
from wsgen.pipeline.validate import validate
from wsgen.simulation.run import ENGINE_DIED, missing_engines
from wsgen.sweeping.robot_subjects import open_subject
from wsgen.sweeping.run_variant import can_run, columns, row_of_death, row_without_run, run_variant
from wsgen.sweeping.subject import SubjectRequest

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.outcome import PackageOutcome
    from wsgen.sweeping.run_variant import Blueprint

ENGINES = [name for name in ("bullet", "dart", "mujoco") if not missing_engines([name])]


def run(made: Blueprint, engine: str = "bullet", seconds: float = 1.0, **values: float) -> Row:
    return run_variant(made, variant(0, **values), seconds, engine)


def figure(row: Row, name: str) -> float:
    found = row.figures[name]
    assert isinstance(found, float)
    return found


def test_what_stands_passes_and_fills_its_columns() -> None:
    row = run(blueprint())
    assert (row.number, row.passed, row.codes, row.diagnostic) == (0, True, (), None)
    assert list(row.figures) == [one.name for one in columns(blueprint())]
    assert row.figures["seconds"] == 1.0
    assert row.figures["settled_after"] is not None
    assert figure(row, "rest_z") == pytest.approx(0.05, abs=1e-3)
    assert figure(row, "drift") < 1e-3


def test_a_row_is_the_same_as_json() -> None:
    row = run(blueprint(), world__slope=0.1)
    assert decode(json.loads(encode(row)), Row) == row


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(("slope", "slides"), [(0.25, False), (0.35, True)])
def test_a_body_slides_where_the_slope_is_steeper_than_its_friction(
    engine: str, slope: float, slides: bool
) -> None:
    row = run(blueprint(), engine, world__slope=slope, world__friction=0.3)  # atan(0.3) = 0.29
    assert (figure(row, "drift") > 0.02) == slides
    if slides:
        expected = G * (math.sin(slope) - 0.3 * math.cos(slope)) / 2  # m, after a second
        assert figure(row, "rest_x") == pytest.approx(expected, rel=0.1)
        assert row.codes == ("SPN058",)
        assert row.diagnostic is not None
        assert row.diagnostic.startswith("SPN058 keeps-moving: The robot does not come to rest")
    assert figure(row, "tilt") < 0.01  # from the normal of the ground


@pytest.mark.parametrize("engine", ENGINES)
def test_a_push_moves_the_robot_as_long_as_it_lasts(engine: str) -> None:
    made = blueprint()
    pushed = {"push.force": 10.0, "push.direction": math.pi / 2, "push.seconds": 0.2}
    row = run_variant(
        made, Variant(number=0, values={"world.friction": 0.2, **pushed}), 3.0, engine
    )
    acceleration, friction = 10.0 / 2.0, 0.2 * G
    speed = (acceleration - friction) * 0.2
    way = speed * 0.2 / 2 + speed**2 / 2 / friction
    assert figure(row, "highest_speed") == pytest.approx(speed, rel=0.1)
    assert figure(row, "rest_y") == pytest.approx(way, rel=0.1)
    assert abs(figure(row, "rest_x")) < 0.01
    assert figure(row, "settled_after") == pytest.approx(1.2 + speed / friction, abs=0.1)
    assert row.passed  # a push is no energy that the robot gains by itself


def test_a_push_does_not_last_beyond_the_end() -> None:
    row = run(blueprint(), push__force=1.0, push__seconds=100.0)
    assert row.passed


@pytest.mark.parametrize("engine", ENGINES)
def test_what_falls_on_a_slope_falls(engine: str) -> None:
    void = blueprint(world=replace(GROUND, has_ground_plane=False))
    row = run(void, engine, world__slope=0.5)
    assert row.codes == ("SPN056",)  # falls-without-end
    assert figure(row, "rest_z") == pytest.approx(0.05 - G * math.cos(0.5) / 2, rel=0.01)


def test_masses_and_gravity_are_those_of_the_variant() -> None:
    row = run(blueprint(), seconds=0.5, robot__mass_scale=5.0, spawn__z=1.05, world__gravity=1.62)
    assert figure(row, "highest_speed") == pytest.approx(0.81, rel=0.02)


def test_several_robots_have_their_names_before_their_figures() -> None:
    plate = single(body(PLATE))
    two = blueprint(prepared(plate, "left"), prepared(plate, "right", Pose((0.0, 2.0, 0.0501))))
    row = run(two)
    assert figure(row, "right.rest_y") == pytest.approx(2.0, abs=1e-3)
    assert list(row.figures) == [one.name for one in columns(two)]
    assert {one.name.partition(".")[0] for one in columns(two)} == {"left", "right"}


def test_what_cannot_be_simulated_is_a_row_with_its_reason() -> None:
    error = ENGINE_DIED.at(None, message="It is not there.")
    assert error.severity is Severity.ERROR
    nothing = replace(blueprint(world=None), diagnostics=(error,))
    assert not can_run(nothing)
    row = row_without_run(nothing, variant(7))
    assert row == Row(
        number=7,
        passed=False,
        codes=("SPN031",),
        diagnostic="SPN031 engine-died: It is not there.",
    )
    assert run(nothing) == replace(row, number=0)


def test_what_ends_the_engine_is_reported_as_by_validate() -> None:
    death = Died(reason="crashed (SIGSEGV)", step="loading the robot `plate`", output="")
    row = row_of_death(blueprint(), variant(3), 1.0, "bullet", death)
    assert (row.number, row.passed, row.codes, dict(row.figures)) == (3, False, ("SPN031",), {})
    assert row.diagnostic == (
        "SPN031 engine-died: The physics engine (PyBullet) crashed (SIGSEGV) while loading the "
        "robot `plate`."
    )


def test_numbers_that_are_not_finite_are_left_out() -> None:
    tiny = single(body(Box(size=(1e-3, 1e-3, 1e-3)), mass=1e-300, moment=1e-320))
    for engine in ENGINES:
        row = run(blueprint(prepared(tiny)), engine, push__force=1e9)
        numbers = [one for one in row.figures.values() if isinstance(one, float)]
        assert all(map(math.isfinite, numbers))
        json.loads(encode(row), parse_constant=pytest.fail)


def as_validate_says(outcome: PackageOutcome) -> tuple[bool, list[str], str | None]:
    errors = [one for one in outcome.diagnostics if one.severity is Severity.ERROR]
    return (
        outcome.passed,
        sorted({one.code for one in outcome.diagnostics if one.severity is not Severity.INFO}),
        f"{errors[0].code} {errors[0].name}: {errors[0].message}" if errors else None,
    )


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["ball_caster", "robot_in_world", "spawn_by_include"])
def test_it_says_what_validate_says(kind: str, tmp_path: Path) -> None:
    root = copy_workspace(kind, tmp_path).root
    workspace = workspace_around(root / "src")
    assert workspace is not None
    environment = {name: os.environ[name] for name in ("PATH", "HOME")}
    outcome = validate(workspace, ValidateRequest(), environment=environment)
    (validated,) = outcome.packages
    assert validated.package is not None
    request = SubjectRequest(package=validated.package, workspace=workspace)
    with open_subject(request, environment=environment) as subject:
        made = subject.prepare({})
        row = run(made, seconds=3.0)
    assert (row.passed, list(row.codes), row.diagnostic) == as_validate_says(validated)
    for robot in validated.robots:
        assert robot.rest is not None
        prefix = f"{robot.entity}." if len(validated.robots) > 1 else ""
        pose = [row.figures[f"{prefix}rest_{axis}"] for axis in "xyz"]
        assert pose == list(robot.rest.pose_in_world.xyz)
        assert row.figures[f"{prefix}tilt"] == robot.rest.tilt
        for behavior in robot.behaviors:
            assert row.figures[f"behavior.{behavior.name}.passed"] is behavior.passed
