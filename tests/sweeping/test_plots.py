"""The plots of a sweep: what is drawn, as a picture and as a page."""

import builtins
import hashlib
import io
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import html5lib
import numpy as np
import pytest
from PIL import Image

from chromium import Chromium, needs_chromium, open_chromium
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
from wsgen.errors import NotFoundError, RequestError
from wsgen.model.sweep import Column
from wsgen.reporting import page_data
from wsgen.reporting.sweep_plot import check_plot, render_plot, render_sweep_page
from wsgen.sweeping.chart import Chart, make_chart
from wsgen.sweeping.plots import draw_png
from wsgen.sweeping.summary import Summary, summarize
from wsgen.sweeping.table import TableData

SURFACES = ("ice", "wood, polished", "Grüße $x^2$", "<b>a very</b> long name of a surface indeed")


def over_one(count: int, *, is_random: bool = False) -> TableData:
    chance = np.random.default_rng(1)
    slope = chance.uniform(0, 0.6, count) if is_random else np.linspace(0, 0.6, count)
    passed = slope + is_random * chance.normal(0, 0.05, count) < 0.41
    tilt = np.where(passed, slope, 1.5)
    drift = np.where(passed, 0.001, slope)
    drift[0] = np.nan
    return make_table({SLOPE: slope, TILT: tilt, DRIFT: drift}, passed)


def over_a_text() -> TableData:
    chance = np.random.default_rng(2)
    index = chance.integers(0, 4, 200)
    surface = [SURFACES[one] for one in index]
    return make_table({SURFACE: surface, TILT: chance.uniform(size=200)}, index > 0)


def over_a_grid() -> TableData:
    slope, friction = (
        one.ravel() for one in np.meshgrid(np.linspace(0, 0.6, 13), np.linspace(0.1, 1, 9))
    )
    return make_table({SLOPE: slope, FRICTION: friction}, np.tan(slope) < friction)


def over_two(count: int) -> TableData:
    chance = np.random.default_rng(3)
    slope, mass = chance.uniform(0, 0.6, count), np.exp(chance.uniform(-3, 3, count))
    return make_table({SLOPE: slope, MASS: mass}, np.tan(slope) < mass)


def over_five(count: int) -> TableData:
    chance = np.random.default_rng(4)
    slope, friction = chance.uniform(0, 0.6, count), chance.uniform(0, 1, count)
    values = {
        SLOPE: slope,
        MASS: np.exp(chance.uniform(-3, 3, count)),
        FRICTION: friction,
        SURFACE: [SURFACES[one] for one in chance.integers(0, 4, count)],
        WHEELS: chance.integers(3, 7, count),
        SEALED: chance.integers(0, 2, count),
    }
    return make_table(values, np.tan(slope) < friction)


TABLES: dict[str, Callable[[], TableData]] = {
    "a grid over one parameter": lambda: over_one(31),
    "samples of one parameter": lambda: over_one(400, is_random=True),
    "one text": over_a_text,
    "a grid over two parameters": over_a_grid,
    "samples of two parameters": lambda: over_two(300),
    "many samples of two parameters": lambda: over_two(100_000),
    "six parameters": lambda: over_five(200),
}
ARGUMENTS = [pytest.param(make(), id=name) for name, make in TABLES.items()]


def chart_of(data: TableData) -> tuple[Chart, Summary]:
    summary = summarize(data)
    return make_chart(data, summary, "rover_description"), summary


# ---- What is drawn.


def test_curves_over_one_parameter() -> None:
    chart, _ = chart_of(over_one(31))
    assert chart.title == "rover_description: 67.7 % of 31 runs passed"
    assert chart.subtitle == ("world.slope: passes below 0.410 ± 0.010 rad (23.49 ± 0.57 degrees)")
    share, tilt, drift = chart.panels
    assert [panel.x.label for panel in chart.panels] == ["world.slope, rad"] * 3
    assert [panel.y.label for panel in chart.panels] == ["passed, %", "tilt, rad", "drift, m"]
    assert share.line_y == (100.0,) * 21 + (0.0,) * 10
    assert share.line_low == ()  # a run each
    (mark,) = share.marks
    assert (mark.low, mark.high) == pytest.approx((0.4, 0.42))
    assert tilt.marks == share.marks
    assert sum(len(points.x) for points in tilt.points) == 31
    assert sum(len(points.x) for points in drift.points) == 30  # one was not measured
    runs = sorted(run for points in tilt.points for run in points.runs)
    assert runs == [*range(31)]
    assert [(group.name, group.runs) for group in chart.groups] == [
        ("passed", 21),
        ("SPN059 tips-over", 7),
        ("SPN056 falls-without-end", 3),
    ]


@pytest.mark.slow
def test_a_fine_grid_has_the_result_of_each_run() -> None:
    chart, _ = chart_of(over_one(301))
    assert chart.panels[0].line_low == ()
    assert set(chart.panels[0].line_y) == {0.0, 100.0}
    assert len(chart.panels[0].line_x) == 301


def test_noise_is_not_drawn() -> None:
    slope = np.linspace(0, 0.6, 31)
    values = {SLOPE: slope, TILT: slope / 1e5, DRIFT: slope}
    chart, _ = chart_of(make_table(values, slope < 0.41))
    assert [panel.y.label for panel in chart.panels] == ["passed, %", "drift, m"]


@pytest.mark.slow
def test_shares_of_samples_have_intervals() -> None:
    chart, _ = chart_of(over_one(400, is_random=True))
    share = chart.panels[0]
    assert 10 < len(share.line_x) < 30
    for y, low, high in zip(share.line_y, share.line_low, share.line_high, strict=True):
        assert 0 <= low <= y <= high <= 100
        assert high - low > 5


def test_a_text_has_bars_in_alphabetical_order() -> None:
    chart, _ = chart_of(over_a_text())
    share = chart.panels[0]
    assert share.is_bars
    assert [text for _, text in share.x.ticks] == [
        "<b>a very</b> long name…",
        "Grüße $x^2$",
        "ice",
        "wood, polished",
    ]
    assert share.line_y == (100.0, 100.0, 0.0, 100.0)
    assert chart.subtitle == "over surface"


def test_a_map_of_a_grid() -> None:
    chart, _ = chart_of(over_a_grid())
    cells = chart.cells
    assert cells is not None
    assert len(cells.x_edges) == 14
    assert len(cells.y_edges) == 10
    assert np.shape(cells.groups) == (9, 13)
    assert cells.groups[0][0] == 0  # flat ground
    assert cells.groups[0][12] > 0
    assert all(one == 0 for one in cells.groups[8])
    assert chart.subtitle == "over world.slope and world.friction"


def test_a_grid_that_is_not_complete_has_empty_cells() -> None:
    data = over_a_grid()
    slope, friction = (one.numbers[:100] for one in data.parameters)
    chart, _ = chart_of(make_table({SLOPE: slope, FRICTION: friction}, data.passed[:100], runs=117))
    assert chart.cells is not None
    assert sum(row.count(-1) for row in chart.cells.groups) == 4  # of 8 rows of 13
    assert chart.title.endswith(" % of 100 of 117 runs passed")


def test_a_map_of_samples() -> None:
    chart, _ = chart_of(over_two(300))
    (panel,) = chart.panels
    assert sum(len(points.x) for points in panel.points) == 300
    assert not panel.x.is_log
    assert panel.y.is_log  # over decades


@pytest.mark.slow
def test_a_map_of_many_samples_has_cells() -> None:
    chart, _ = chart_of(over_two(100_000))
    assert chart.cells is not None
    shares = np.array(chart.cells.shares, dtype=float)
    assert shares.shape == (40, 40)
    assert np.nanmin(shares) == 0.0
    assert np.nanmax(shares) == 100.0
    assert chart.note == "100,000 runs in 40 by 40 cells"
    assert chart.groups == ()


def test_parallel_coordinates() -> None:
    chart, _ = chart_of(over_five(200))
    assert [axis.label for axis in chart.axes] == [
        "world.slope, rad",
        "arm_mass, kg",
        "world.friction",
        "surface",
        "wheels",
        "sealed",
    ]
    places = np.array([run for lines in chart.lines for run in lines.places], dtype=float)
    assert places.shape == (200, 6)
    assert places[:, :3].min() == 0.0
    assert places[:, :3].max() == 1.0
    assert chart.note == ""


@pytest.mark.slow
def test_of_many_runs_some_are_drawn_and_always_the_same_ones() -> None:
    data = over_five(100_000)
    chart, _ = chart_of(data)
    assert sum(len(lines.places) for lines in chart.lines) == 800
    assert chart.note == "800 of 100,000 runs are drawn"
    assert chart == chart_of(data)[0]
    one, _ = chart_of(over_one(100_000, is_random=True))
    assert sum(len(points.x) for points in one.panels[1].points) == 3000
    assert one.note == "3,000 of 100,000 runs are drawn"


def test_rules_beyond_the_fourth_share_a_color() -> None:
    codes = ((), *((f"XYZ00{number}",) for number in range(7)))
    slope = np.linspace(0, 1, 71)
    chart, _ = chart_of(make_table({SLOPE: slope, TILT: slope}, slope < 0, code_sets=codes))
    assert [group.number for group in chart.groups] == [1, 2, 3, 4, 5]
    assert chart.groups[-1].name == "other failures"
    assert sum(group.runs for group in chart.groups) == 71


@pytest.mark.slow
@pytest.mark.parametrize("passed", [True, False])
def test_all_pass_or_fail_with_one_run_and_without_figures(*, passed: bool) -> None:
    for values in ({SLOPE: [0.1]}, {SURFACE: ["ice"]}, {SEALED: [1]}, {MASS: [np.nan]}):
        chart, summary = chart_of(make_table(values, [passed]))
        assert draw_png(chart).startswith(b"\x89PNG")
        assert render_sweep_page(chart, summary, "rover")


def test_nothing_to_draw() -> None:
    empty = make_table({SLOPE: []}, [], runs=5)
    with pytest.raises(RequestError, match="no run is done"):
        chart_of(empty)
    with pytest.raises(RequestError, match="no parameter varies"):
        chart_of(make_table({TILT: [0.1]}, [True]))


# ---- As a picture.


@pytest.mark.slow
@pytest.mark.parametrize("data", ARGUMENTS)
def test_pictures(data: TableData) -> None:
    png = draw_png(chart_of(data)[0])
    with Image.open(io.BytesIO(png)) as picture:
        assert min(picture.size) > 600
        pixels = np.asarray(picture.convert("RGB"))
    assert (pixels[0] == 255).all()  # nothing touches the border
    assert (pixels[:, 0] == 255).all()
    assert (pixels[:, -1] == 255).all()
    assert 0.005 < (pixels != 255).any(axis=2).mean() < 0.9
    assert hashlib.sha256(draw_png(chart_of(data)[0])).digest() == hashlib.sha256(png).digest()


@pytest.mark.slow
def test_dollars_are_no_formulas() -> None:
    column = Column(name="a$\\alpha_{$b", kind="text", is_parameter=True)
    chart, _ = chart_of(make_table({column: ["$x$", "$\\frac{$"]}, [True, False]))
    assert draw_png(chart).startswith(b"\x89PNG")


# ---- As a page.


@pytest.mark.slow
@pytest.mark.parametrize("data", ARGUMENTS)
def test_pages_are_valid(data: TableData) -> None:
    chart, summary = chart_of(data)
    page = render_sweep_page(chart, summary, "<i>rover</i>")
    html5lib.HTMLParser(strict=True).parse(page)
    assert page == render_sweep_page(chart, summary, "<i>rover</i>")
    assert "<i>" not in page.partition("<script")[0]
    assert "<b>" not in page.partition("<script")[0]
    assert not re.search(r"""(?:src|href)=["']?(?:https?:)?//""", page.partition("<script")[0])


@pytest.fixture(scope="module")
def chromium() -> Iterator[Chromium]:
    with open_chromium() as browser:
        yield browser


@pytest.mark.slow
@needs_chromium
@pytest.mark.parametrize(
    "name",
    [
        "one text",
        pytest.param("a grid over two parameters", marks=pytest.mark.thorough),
        pytest.param("many samples of two parameters", marks=pytest.mark.thorough),
        "six parameters",
    ],
)
def test_pages_in_a_browser(name: str, chromium: Chromium, tmp_path: Path) -> None:
    file = tmp_path / "sweep.html"
    data = TABLES[name]()
    file.write_bytes(render_plot(file, data, summarize(data), "rover_description"))
    page = chromium.open(file.as_uri())
    page.wait_for("[...document.querySelectorAll('.chart')].every((plot) => plot.dataset.drawn)")
    for width, is_dark in ((1280, False), (400, True)):
        page.resize(width, 900)
        page.prefer(is_dark=is_dark)
        page.wait_for(f"document.documentElement.scrollWidth <= {width}")  # plots are drawn anew
        plots = page.evaluate("document.querySelectorAll('.chart').length")
        assert page.evaluate("document.querySelectorAll('.chart .main-svg').length") >= plots > 0
        shapes = "document.querySelectorAll('.chart .points path, .chart .lines path').length"
        images = "document.querySelectorAll('.chart .heatmaplayer image').length"
        assert page.evaluate(f"{shapes} + {images}") > 0
        texts: list[str] = page.evaluate(
            "[...document.querySelectorAll('.chart text')].map((one) => one.textContent)"
        )
        assert any(text.startswith("<b>a very") for text in texts) == (
            name in {"one text", "six parameters"}
        )
        assert page.console == []
        assert {url.partition(":")[0] for url in page.requests} <= {"file", "data", "blob"}
    page.close()


# ---- The file.


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("plot.svg", r"plot\.svg: the format \.svg is unknown"),
        ("plot", "plot: its name has no suffix"),
    ],
)
def test_unknown_formats(name: str, message: str) -> None:
    with pytest.raises(RequestError, match=message) as raised:
        check_plot(Path(name))
    assert ".png" in raised.value.hint
    assert ".html" in raised.value.hint


@pytest.mark.slow
def test_files() -> None:
    data = over_one(31)
    for name, start in (("plot.png", b"\x89PNG"), ("PLOT.HTML", b"<!DOCTYPE html>")):
        check_plot(Path(name))
        assert render_plot(Path(name), data, summarize(data), "rover").startswith(start)


def test_without_the_libraries(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def refuse(name: str, *arguments: Any, **keywords: Any) -> Any:
        if name.partition(".")[0] == "matplotlib":
            raise ImportError(name)
        return real(name, *arguments, **keywords)

    monkeypatch.setattr(builtins, "__import__", refuse)
    monkeypatch.setattr(page_data, "_find", lambda: None)
    for name in ("plot.png", "plot.html"):
        with pytest.raises(NotFoundError) as raised:
            check_plot(Path(name))
        assert raised.value.hint == "Install it: pip install 'wsgen[sweep]'"
