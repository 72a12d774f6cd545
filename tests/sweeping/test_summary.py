"""The summary of a sweep: its values, its lines and its JSON."""

import json

import numpy as np
import pytest

from sweeping.tables import (
    DRIFT,
    FRICTION,
    MASS,
    SEALED,
    SLOPE,
    SURFACE,
    TILT,
    WHEELS,
    make_table,
)
from wsgen.model.sweep import Column
from wsgen.sweeping.borders import Border
from wsgen.sweeping.summary import (
    render_summary,
    summarize,
    summary_as_json,
    unit_of,
    write_border,
    write_share,
    write_uncertain,
)

GRID = np.linspace(0.0, 0.6, 31)


def test_a_grid_over_one_parameter() -> None:
    table = make_table({SLOPE: GRID, TILT: GRID}, GRID < 0.41)
    assert [*render_summary(summarize(table))] == [
        "31 runs: 21 passed (67.7 %)",
        "",
        "what fails",
        "  SPN059 tips-over             7  70.0 % of those that fail, first in run 21",
        "    the robot `rover` tips over",
        "  SPN056 falls-without-end     3  30.0 % of those that fail, first in run 22",
        "    it falls",
        "  SPN085 position-not-reached  3  30.0 % of those that fail, first in run 23",
        "    too far",
        "",
        "what it depends on",
        "  world.slope  passes below 0.410 ± 0.010 rad (23.49 ± 0.57 degrees)",
    ]


def test_two_borders() -> None:
    one = [*render_summary(summarize(make_table({FRICTION: GRID}, (GRID > 0.09) & (GRID < 0.41))))]
    assert one[-1] == "  world.friction  passes from 0.090 ± 0.010 to 0.410 ± 0.010"
    other = [*render_summary(summarize(make_table({MASS: GRID}, (GRID < 0.09) | (GRID > 0.41))))]
    assert other[-1] == "  arm_mass  fails from 0.090 ± 0.010 kg to 0.410 ± 0.010 kg"


def test_several_parameters() -> None:
    chance = np.random.default_rng(7)
    slope, mass = chance.uniform(0, 0.6, 400), chance.uniform(1, 3, 400)
    surface = np.array(["wood", "ice", 'a "b"'])[chance.integers(0, 3, 400)]
    values = {
        SLOPE: slope,
        MASS: mass,
        SURFACE: surface.tolist(),
        SEALED: chance.integers(0, 2, 400),
        WHEELS: 3 + chance.integers(0, 2, 400),
    }
    passed = (slope < 0.4) & (surface != "ice")
    summary = summarize(make_table(values, passed, runs=1000))
    lines = [*render_summary(summary)]
    assert lines[0] == f"400 of 1,000 runs: {passed.sum()} passed ({passed.mean() * 100:.1f} %)"
    first = lines.index("what it depends on") + 1
    assert lines[first].startswith("  world.slope  passes mostly below 0.")
    assert lines[first].endswith(" % below, 0 % above")
    assert lines[first + 1] == (
        f"  arm_mass     no border from {mass.min():.4g} to {mass.max():.4g} kg: "
        "alone it does not explain which runs pass"
    )
    ice = int((surface == "ice").sum())
    assert lines[first + 3] == f"               ice    0 % passed (0 of {ice})"
    assert [line.split()[0] for line in lines[first + 5 : first + 7]] == ["sealed", "true"]
    assert [line.split()[0] for line in lines[first + 7 :]] == ["wheels", "4"]
    slope_summary = summary.parameters[0]
    assert slope_summary.dependence is not None
    (border,) = slope_summary.dependence.borders
    assert border.low < 0.4 < border.high
    shares = summary.parameters[2].shares
    assert [share.value for share in shares] == ['a "b"', "ice", "wood"]
    assert sum(share.runs for share in shares) == 400
    assert sum(share.passed for share in shares) == passed.sum()


def test_each_rule_has_its_border() -> None:
    sets: tuple[tuple[str, ...], ...] = ((), ("SPN058", "SPN059"), ("SPN059",))
    numbers = np.select([GRID < 0.1, GRID < 0.41], [1, 0], 2)
    passed = numbers == 0
    summary = summarize(make_table({SLOPE: GRID}, passed, code_set=numbers, code_sets=sets))
    lines = [*render_summary(summary)]
    first = lines.index("what it depends on") + 1
    assert lines[first].startswith("  world.slope  passes from ")
    assert lines[first + 1].startswith("               SPN059 tips-over passes from 0.")
    assert lines[first + 2].startswith("               SPN058 keeps-moving passes above 0.")
    (parameter,) = summary_as_json(summary)["parameters"]
    assert [one["code"] for one in parameter["rules"]] == ["SPN059", "SPN058"]
    assert [len(one["borders"]) for one in parameter["rules"]] == [2, 1]
    assert "SPN" not in parameter["summary"]
    # Rules that fail the same runs have the border of all.
    numbers = np.where(GRID > 0.3, 1, 0)
    summary = summarize(make_table({SLOPE: GRID}, GRID <= 0.3, code_set=numbers, code_sets=sets))
    assert summary.parameters[0].rules == ()


def test_an_interval_with_a_longer_side() -> None:
    border = Border(at=0.31, low=0.22, high=0.56, passes_below=True)
    assert write_border(border, "kg") == "0.31 kg (from 0.22 to 0.56)"
    assert write_border(border, "rad") == (
        "0.31 rad (from 0.22 to 0.56), 18 degrees (from 13 to 32)"
    )


def test_a_parameter_that_does_not_vary_is_left_out() -> None:
    table = make_table({SLOPE: GRID, MASS: np.full(31, 2.0)}, GRID < 0.41)
    summary = summarize(table)
    assert [one.column.name for one in summary.parameters] == ["world.slope"]
    assert summary.parameters[0].dependence is not None
    assert summary.parameters[0].dependence.is_certain


def test_many_values_of_a_text() -> None:
    names = [f"surface {number % 30:02d}" for number in range(300)]
    passed = [number % 30 < number // 10 for number in range(300)]
    lines = [*render_summary(summarize(make_table({SURFACE: names}, passed)))]
    lines = lines[lines.index("what it depends on") + 1 :]
    assert len(lines) == 9
    assert "… 22 more values lie in between" in lines[4]
    assert "surface 29  0 % passed (0 of 10)" in lines[0]


def test_a_text_of_several_lines_stays_on_one() -> None:
    table = make_table({SURFACE: ["a\nb", "", "x" * 200]}, [True, False, True])
    lines = [*render_summary(summarize(table))]
    assert all("\n" not in line and len(line) < 120 for line in lines)
    assert any(" a b " in line for line in lines)
    assert any('""' in line for line in lines)


def test_nothing_is_done_and_everything_passes() -> None:
    assert [*render_summary(summarize(make_table({SLOPE: []}, [], runs=5)))] == [
        "0 of 5 runs: 0 passed"
    ]
    assert [*render_summary(summarize(make_table({SLOPE: [0.1]}, [True])))] == [
        "1 run: 1 passed (100 %)"
    ]
    assert [*render_summary(summarize(make_table({SLOPE: GRID}, GRID > -1)))] == [
        "31 runs: 31 passed (100 %)",
        "",
        "what it depends on",
        "  world.slope  no border from 0 to 0.6 rad: every run passes",
    ]


def test_warnings_count_where_no_error_is_known() -> None:
    codes = ((), ("SPN062",), ("SPN062", "XYZ999"))
    table = make_table({SLOPE: GRID}, GRID < 0.41, code_sets=codes)
    summary = summarize(table)
    assert [(one.code, one.name, one.runs) for one in summary.codes] == [
        ("SPN062", "joint-beyond-limit", 5),
        ("XYZ999", "", 5),
    ]


def test_codes_of_runs_that_pass_do_not_count() -> None:
    table = make_table({SLOPE: GRID}, np.ones(31, bool), code_set=np.ones(31, int))
    assert summarize(table).codes == ()


def test_as_json() -> None:
    table = make_table({SLOPE: GRID, DRIFT: GRID}, GRID < 0.41)
    value = json.loads(json.dumps(summary_as_json(summarize(table)), allow_nan=False))
    assert (value["runs"], value["done"], value["passed"]) == (31, 31, 21)
    assert value["failures"][0] == {
        "code": "SPN059",
        "name": "tips-over",
        "runs": 7,
        "first_run": 21,
        "example": "SPN059: the robot `rover` tips over",
    }
    (parameter,) = value["parameters"]
    assert parameter["name"] == "world.slope"
    assert parameter["unit"] == "rad"
    assert (parameter["lowest"], parameter["highest"]) == (0.0, 0.6)
    assert parameter["is_certain"] is True
    assert parameter["summary"].startswith("passes below 0.410 ± 0.010 rad")
    (border,) = parameter["borders"]
    assert border["passes"] == "below"
    assert border["low"] < border["at"] < border["high"]
    assert parameter["shares"] == []


@pytest.mark.parametrize(
    ("numbers", "expected"),
    [
        ((0.4349, 0.4241, 0.4457), "0.435 ± 0.011"),
        ((1234.5, 1200.0, 1269.0), "1234 ± 34"),
        ((0.0, -0.5, 0.5), "0.00 ± 0.50"),
        ((2.0, 1.9, 3.0), "2.0 (from 1.9 to 3.0)"),
        ((1e-12, 0.9e-12, 1.1e-12), "1e-12 ± 1e-13"),
        ((5.0, 5.0, 5.0), "5.000000 ± 0.000000"),
    ],
)
def test_a_number_and_its_uncertainty(numbers: tuple[float, float, float], expected: str) -> None:
    assert write_uncertain(*numbers) == expected


@pytest.mark.parametrize(
    ("part", "whole", "expected"),
    [(0, 10, "0 %"), (10, 10, "100 %"), (1, 100_000, "0.1 %"), (99_999, 100_000, "99.9 %")],
)
def test_shares(part: int, whole: int, expected: str) -> None:
    assert write_share(part, whole) == expected


@pytest.mark.parametrize(
    ("meaning", "unit"),
    [
        ("rad, between what was up and up", "rad"),
        ("m", "m"),
        ("m/s², of the world", "m/s²"),
        ("rad/s or m/s, of the joint", "rad/s"),
        ("s; likewise", "s"),
        ("mass of the arm", ""),
        ("small", ""),
        ("", ""),
    ],
)
def test_units(meaning: str, unit: str) -> None:
    assert unit_of(Column(name="x", kind="number", meaning=meaning)) == unit
