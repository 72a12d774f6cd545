"""What is drawn of a table, for a picture and for a page alike: numbers, labels and groups of runs.

One parameter: the share that passes and the main figures over it. Two: a map. More: parallel
coordinates. Of many runs, some are drawn, always the same ones, or cells with their share.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsgen.errors import RequestError
from wsgen.sweeping.borders import is_over_decades
from wsgen.sweeping.summary import describe_parameter, unit_of, write_share
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsgen.sweeping.summary import ParameterSummary, Summary
    from wsgen.sweeping.table import Series, TableData

    Numbers = NDArray[np.float64]


MOST_GROUPS = 4  # rules that have a color; other failures share one
MOST_POINTS = 3000  # in a panel
MOST_LINES = 800  # in parallel coordinates
MOST_AXES = 12
MOST_FIGURES = 3
NOTICEABLE = 1e-3  # m, rad, s and their speeds; by less figures vary without a reason
MOST_CELLS = 120  # of a grid along an axis that is drawn cell by cell
BINNED_CELLS = 40  # along an axis, of many runs
BINS = 24  # of the share over a parameter with many values
MOST_VALUES = 60  # of a parameter of which each has its share
MOST_LABELS = 14  # of a text along an axis
LONGEST_LABEL = 24  # characters
GOLDEN = (math.sqrt(5) - 1) / 2  # multiples of it fill an interval evenly
# The figures that say most, after those of behaviors.
FIGURES = ("tilt", "drift", "settled_after", "highest_joint_speed", "rest_z")
# Figures that vary by less are noise: rad, s; others see NOTICEABLE.
LEAST_SPREADS = {"tilt": 0.002, "settled_after": 0.01}


@dataclass(frozen=True, kw_only=True)
class Axis:
    """An axis of a panel, or of parallel coordinates."""

    label: str  # with its unit
    low: float
    high: float
    is_log: bool = False
    is_text: bool = False  # or a boolean
    ticks: tuple[tuple[float, str], ...] = ()  # of texts and few integers; empty: those of numbers


@dataclass(frozen=True, kw_only=True)
class Group:
    """Runs with the same result; they share a color and a symbol."""

    name: str  # "passed", or the rule
    number: int  # 0: passed; then the rules, the most frequent one first; the last: all others
    runs: int


@dataclass(frozen=True, kw_only=True)
class Points:
    """Runs of a group: their places in a panel."""

    group: int  # number
    x: tuple[float, ...]
    y: tuple[float, ...]
    runs: tuple[int, ...]  # their numbers


@dataclass(frozen=True, kw_only=True)
class Mark:
    """A border on the x axis, with its interval."""

    at: float
    low: float
    high: float


@dataclass(frozen=True, kw_only=True)
class Panel:
    """A plot of two axes."""

    x: Axis
    y: Axis
    points: tuple[Points, ...] = ()
    # A line with the lower and upper end of an interval at each of its points; empty: none.
    line_x: tuple[float, ...] = ()
    line_y: tuple[float, ...] = ()
    line_low: tuple[float, ...] = ()
    line_high: tuple[float, ...] = ()
    is_bars: bool = False  # the line is drawn as bars
    marks: tuple[Mark, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Cells:
    """A map of cells; either each has the group of its run, or the share that passes."""

    x: Axis
    y: Axis
    x_edges: tuple[float, ...]
    y_edges: tuple[float, ...]
    x_values: tuple[float, ...] = ()  # where the marks of its runs are
    y_values: tuple[float, ...] = ()
    groups: tuple[tuple[int, ...], ...] = ()  # a row of cells for each y; -1: no run
    shares: tuple[tuple[float | None, ...], ...] = ()  # likewise, in percent


@dataclass(frozen=True, kw_only=True)
class Lines:
    """Runs of a group in parallel coordinates: their places on each axis, from 0 to 1."""

    group: int
    places: tuple[tuple[float | None, ...], ...]  # of each run one on each axis


@dataclass(frozen=True, kw_only=True)
class Chart:
    """All that is drawn."""

    title: str
    subtitle: str
    note: str  # what is not drawn; empty: nothing
    groups: tuple[Group, ...]
    panels: tuple[Panel, ...] = ()
    cells: Cells | None = None
    axes: tuple[Axis, ...] = ()  # of parallel coordinates
    lines: tuple[Lines, ...] = ()


def make_chart(data: TableData, summary: Summary, subject: str) -> Chart:
    """Choose what is drawn of a table.

    Args:
        data: The table.
        summary: Its summary.
        subject: The name of the package or file.

    Raises:
        RequestError: No run is done, or none has a parameter.
    """
    by_name = {one.column.name: one for one in data.parameters}
    varying = [by_name[one.column.name] for one in summary.parameters] or [*data.parameters[:1]]
    if not data.count or not varying:
        raise RequestError(
            "Cannot draw a plot: " + ("no run is done." if varying else "no parameter varies."),
            hint="Run the sweep again, and wait until some runs are done."
            if varying
            else "Give a parameter several values with --over or --random.",
        )
    groups, group_of = _groups(data, summary)
    of = "" if summary.done == summary.runs else f" of {summary.runs:,}"
    title = (
        f"{subject}: {write_share(summary.passed, summary.done)} of "
        f"{summary.done:,}{of} run{'s' if summary.done > 1 or of else ''} passed"
    )
    if len(varying) == 1:
        return _curves(data, summary, varying[0], (groups, group_of), title)
    names = " and ".join(one.column.name for one in varying)
    if len(varying) == 2:  # noqa: PLR2004
        return _map(data, varying, (groups, group_of), (title, f"over {names}"))
    return _parallel(data, varying, (groups, group_of), title)


def _groups(data: TableData, summary: Summary) -> tuple[tuple[Group, ...], NDArray[np.int64]]:
    """Return the groups, and the number of that of each run."""
    shown = summary.codes[:MOST_GROUPS]
    number_of = {one.code: number for number, one in enumerate(shown, 1)}
    other = len(shown) + 1
    of_set = np.array(
        [
            min((number_of[code] for code in codes if code in number_of), default=other)
            for codes in data.code_sets
        ]
        or [other],
        dtype=np.int64,
    )
    group_of = np.where(data.passed, 0, of_set[data.code_set])
    counts = np.bincount(group_of, minlength=other + 1)
    names = ["passed", *(f"{one.code} {one.name}".rstrip() for one in shown), "other failures"]
    if other == 1:
        names[1] = "failed"
    groups = tuple(
        Group(name=name, number=number, runs=int(counts[number]))
        for number, name in enumerate(names)
        if counts[number]
    )
    return groups, group_of


def _axis(series: Series, numbers: Numbers) -> Axis:
    label = _label(series)
    if series.texts:
        order = _text_order(series)
        count = len(order)
        every = max(1, math.ceil(count / MOST_LABELS))
        ticks = tuple((float(place), _clip(text)) for place, text in enumerate(order))[::every]
        return Axis(label=label, low=-0.5, high=count - 0.5, is_text=True, ticks=ticks)
    known = numbers[np.isfinite(numbers)]
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
    if series.column.kind == "boolean":
        return Axis(
            label=label, low=-0.5, high=1.5, is_text=True, ticks=((0.0, "false"), (1.0, "true"))
        )
    different = np.unique(known)
    if (
        series.column.kind == "integer"
        and len(different) <= MOST_LABELS
        and not is_over_decades(known)
    ):
        return Axis(
            label=label,
            low=low - (low == high),
            high=high + (low == high),
            ticks=tuple((float(value), f"{value:.0f}") for value in different),
        )
    if low == high:
        margin = abs(low) / 10 or 1.0
        return Axis(label=label, low=low - margin, high=high + margin)
    return Axis(label=label, low=low, high=high, is_log=is_over_decades(known))


def _label(series: Series) -> str:
    unit = unit_of(series.column)
    return f"{series.column.name}, {unit}" if unit else series.column.name


def _text_order(series: Series) -> list[str]:
    return sorted(series.texts)


def _places(series: Series) -> Numbers:
    """Return the numbers of a series; of texts, their places in alphabetical order."""
    if not series.texts:
        return series.numbers
    place_of = {text: place for place, text in enumerate(_text_order(series))}
    places = np.array([place_of[text] for text in series.texts], dtype=np.float64)
    return places[series.numbers.astype(np.int64)]


def _spread_out(places: Numbers, series: Series) -> Numbers:
    """Return places at which runs with one text or boolean do not hide each other."""
    is_text = bool(series.texts) or series.column.kind == "boolean"
    known = places[np.isfinite(places)]
    if not is_text and (series.column.kind != "integer" or len(np.unique(known)) > MOST_LABELS):
        return places
    width = 0.4 if is_text else 0.2
    return places + width * (np.arange(len(places)) * GOLDEN % 1.0 - 0.5)


def _clip(text: str) -> str:
    line = " ".join(text.split()) or '""'
    return line if len(line) <= LONGEST_LABEL else f"{line[: LONGEST_LABEL - 1]}…"


def _some(count: int, most: int) -> NDArray[np.int64]:
    """Return the indices of some runs, the same ones for the same table."""
    if count <= most:
        return np.arange(count)
    return np.sort(np.random.default_rng(0).choice(count, most, replace=False))


def _points(
    x: Numbers, y: Numbers, group_of: NDArray[np.int64], numbers: NDArray[np.int64]
) -> tuple[Points, ...]:
    known = np.isfinite(x) & np.isfinite(y)
    chosen = [(int(number), known & (group_of == number)) for number in np.unique(group_of[known])]
    return tuple(
        Points(
            group=number,
            x=tuple(x[these].tolist()),
            y=tuple(y[these].tolist()),
            runs=tuple(numbers[these].tolist()),
        )
        for number, these in chosen
    )


# ---- One parameter.


def _curves(
    data: TableData,
    summary: Summary,
    series: Series,
    grouped: tuple[tuple[Group, ...], NDArray[np.int64]],
    title: str,
) -> Chart:
    groups, group_of = grouped
    x = _places(series)
    axis = _axis(series, x)
    parameter = summary.parameters[0] if summary.parameters else None
    marks = _marks(parameter)
    shown = _spread_out(x, series)
    chosen = _some(data.count, MOST_POINTS)
    dependence = parameter.dependence if parameter is not None else None
    is_certain = dependence is not None and dependence.is_certain
    panels = [_share_panel(x, data.passed, axis, marks, is_joined=not is_certain)]
    for figure in _main_figures(data):
        y = _axis(figure, figure.numbers)
        panels.append(
            Panel(
                x=axis,
                y=Axis(label=y.label, low=y.low, high=y.high),
                points=_points(
                    shown[chosen], figure.numbers[chosen], group_of[chosen], data.numbers[chosen]
                ),
                marks=marks,
            )
        )
    subtitle = f"over {series.column.name}"
    if parameter is not None and parameter.dependence is not None:
        subtitle = f"{series.column.name}: {describe_parameter(parameter)[0]}"
    return Chart(
        title=title,
        subtitle=subtitle,
        note=_shown_note(len(chosen), data.count) if len(panels) > 1 else "",
        groups=groups if len(panels) > 1 else (),
        panels=tuple(panels),
    )


def _marks(parameter: ParameterSummary | None) -> tuple[Mark, ...]:
    if parameter is None or parameter.dependence is None:
        return ()
    return tuple(
        Mark(at=one.at, low=one.low, high=one.high) for one in parameter.dependence.borders
    )


def _share_panel(
    x: Numbers,
    passed: NDArray[np.bool_],
    axis: Axis,
    marks: tuple[Mark, ...],
    *,
    is_joined: bool,
) -> Panel:
    """The share of each value; of many values that of neighboring ones, if they may be joined."""
    known = np.isfinite(x)
    x, passed = x[known], passed[known]
    values, index = np.unique(x, return_inverse=True)
    if len(values) > (MOST_VALUES if is_joined else MOST_POINTS) and not axis.is_text:
        edges = np.unique(np.quantile(x, np.linspace(0, 1, BINS + 1)))
        index = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
    runs: Numbers = np.bincount(index).astype(np.float64)
    passes: Numbers = np.bincount(index, weights=passed).astype(np.float64)
    middles = np.bincount(index, weights=x) / np.maximum(runs, 1)
    kept = runs > 0
    runs, passes, middles = runs[kept], passes[kept], middles[kept]
    low, high = _wilson(passes, runs)
    has_interval = bool((runs > 1).any())
    return Panel(
        x=axis,
        y=Axis(label="passed, %", low=0.0, high=100.0),
        line_x=tuple(middles.tolist()),
        line_y=tuple((100.0 * passes / runs).tolist()),
        line_low=tuple((100.0 * low).tolist()) if has_interval else (),
        line_high=tuple((100.0 * high).tolist()) if has_interval else (),
        is_bars=axis.is_text,
        marks=marks,
    )


def _wilson(passes: Numbers, runs: Numbers) -> tuple[Numbers, Numbers]:
    """Wilson's interval of 95 % for a share (J. Am. Stat. Assoc. 22, 1927)."""
    z = 1.96
    share = passes / runs
    center = (share + z * z / (2 * runs)) / (1 + z * z / runs)
    half = z / (1 + z * z / runs) * np.sqrt(share * (1 - share) / runs + z * z / (4 * runs**2))
    return np.minimum(center - half, share), np.maximum(center + half, share)


def _main_figures(data: TableData) -> list[Series]:
    """The figures that vary by more than the noise of engines, those of behaviors first."""
    numeric = {
        one.column.name: one
        for one in data.figures
        if one.column.kind in {"number", "integer"} and _spread(one.numbers) > _noise(one)
    }
    of_behaviors = [name for name in numeric if name.startswith("behavior.")]
    last = {name: name.rpartition(".")[2] for name in numeric}
    known = [name for wanted in FIGURES for name in numeric if last[name] == wanted]
    order = dict.fromkeys((*of_behaviors[:2], *known, *of_behaviors, *numeric))
    return [numeric[name] for name in [*order][:MOST_FIGURES]]


def _noise(figure: Series) -> float:
    return LEAST_SPREADS.get(figure.column.name.rpartition(".")[2], NOTICEABLE)


def _spread(numbers: Numbers) -> float:
    known = numbers[np.isfinite(numbers)]
    return float(np.ptp(known)) if len(known) else 0.0


def _shown_note(shown: int, count: int) -> str:
    return "" if shown == count else f"{shown:,} of {count:,} runs are drawn"


# ---- Two parameters.


def _map(
    data: TableData,
    varying: Sequence[Series],
    grouped: tuple[tuple[Group, ...], NDArray[np.int64]],
    texts: tuple[str, str],
) -> Chart:
    groups, group_of = grouped
    title, subtitle = texts
    first, second = varying
    x, y = _places(first), _places(second)
    axes = _axis(first, x), _axis(second, y)
    columns, x_index = np.unique(x, return_inverse=True)
    rows, y_index = np.unique(y, return_inverse=True)
    is_grid = (
        max(len(columns), len(rows)) <= MOST_CELLS
        and data.count > len(columns) * len(rows) // 2
        and len(np.unique(y_index * len(columns) + x_index)) == data.count
        and bool(np.isfinite(columns).all() and np.isfinite(rows).all())
    )
    if is_grid:
        cells = np.full((len(rows), len(columns)), -1)
        cells[y_index, x_index] = group_of
        x_edges, y_edges = (
            _edges(values, axis) for values, axis in zip((columns, rows), axes, strict=True)
        )
        drawn = Cells(
            x=_framed(axes[0], x_edges),
            y=_framed(axes[1], y_edges),
            x_edges=x_edges,
            y_edges=y_edges,
            x_values=tuple(columns.tolist()),
            y_values=tuple(rows.tolist()),
            groups=tuple(tuple(row) for row in cells.tolist()),
        )
        return Chart(title=title, subtitle=subtitle, note="", groups=groups, cells=drawn)
    if data.count <= MOST_POINTS:
        points = _points(_spread_out(x, first), _spread_out(y, second), group_of, data.numbers)
        panel = Panel(x=axes[0], y=axes[1], points=points)
        return Chart(title=title, subtitle=subtitle, note="", groups=groups, panels=(panel,))
    x_edges, y_edges = (
        _even_edges(values, axis) for values, axis in zip((x, y), axes, strict=True)
    )
    runs, _, _ = np.histogram2d(y, x, bins=[np.array(y_edges), np.array(x_edges)])
    passes, _, _ = np.histogram2d(
        y, x, bins=[np.array(y_edges), np.array(x_edges)], weights=data.passed.astype(np.float64)
    )
    shares = tuple(
        tuple(
            100.0 * good / all_ if all_ else None
            for good, all_ in zip(good_row, all_row, strict=True)
        )
        for good_row, all_row in zip(passes.tolist(), runs.tolist(), strict=True)
    )
    drawn = Cells(
        x=_framed(axes[0], x_edges),
        y=_framed(axes[1], y_edges),
        x_edges=x_edges,
        y_edges=y_edges,
        shares=shares,
    )
    note = f"{data.count:,} runs in {len(x_edges) - 1} by {len(y_edges) - 1} cells"
    return Chart(title=title, subtitle=subtitle, note=note, groups=(), cells=drawn)


def _framed(axis: Axis, edges: tuple[float, ...]) -> Axis:
    return Axis(
        label=axis.label,
        low=edges[0],
        high=edges[-1],
        is_log=axis.is_log,
        is_text=axis.is_text,
        ticks=axis.ticks,
    )


def _edges(values: Numbers, axis: Axis) -> tuple[float, ...]:
    """Return the borders of cells around values: half way between two of them."""
    scale = np.log(values) if axis.is_log else values
    half = np.diff(scale) / 2
    first, last = (half[0], half[-1]) if len(half) else (0.5, 0.5)
    edges = np.concatenate([[scale[0] - first], scale[:-1] + half, [scale[-1] + last]])
    return tuple((np.exp(edges) if axis.is_log else edges).tolist())


def _even_edges(values: Numbers, axis: Axis) -> tuple[float, ...]:
    different = np.unique(values[np.isfinite(values)])
    if len(different) <= BINNED_CELLS:
        return _edges(different, axis)
    if axis.is_log:
        return tuple(np.geomspace(different[0], different[-1], BINNED_CELLS + 1).tolist())
    return tuple(np.linspace(different[0], different[-1], BINNED_CELLS + 1).tolist())


# ---- More parameters.


def _parallel(
    data: TableData,
    varying: Sequence[Series],
    grouped: tuple[tuple[Group, ...], NDArray[np.int64]],
    title: str,
) -> Chart:
    groups, group_of = grouped
    drawn = [*varying[:MOST_AXES]]
    chosen = _some(data.count, MOST_LINES)
    axes = [_axis(one, _places(one)) for one in drawn]
    columns = [
        _relative(_spread_out(_places(one), one)[chosen], axis)
        for one, axis in zip(drawn, axes, strict=True)
    ]
    places = np.stack(columns, axis=1)
    lines = tuple(
        Lines(
            group=int(number),
            places=tuple(
                tuple(place if math.isfinite(place) else None for place in run)
                for run in places[group_of[chosen] == number].tolist()
            ),
        )
        for number in np.unique(group_of[chosen])
    )
    notes = [_shown_note(len(chosen), data.count)]
    if len(drawn) < len(varying):
        notes.append(f"{len(drawn)} of {len(varying)} parameters are drawn")
    return Chart(
        title=title,
        subtitle=f"over {len(varying)} parameters; a line is a run",
        note="; ".join(filter(None, notes)),
        groups=groups,
        axes=tuple(axes),
        lines=lines,
    )


def _relative(numbers: Numbers, axis: Axis) -> Numbers:
    low, high = axis.low, axis.high
    if axis.is_log:
        numbers, low, high = np.log(numbers), math.log(low), math.log(high)
    result: Numbers = (numbers - low) / (high - low)
    return result


def ticks_of(axis: Axis) -> list[tuple[float, str]]:
    """Return where an axis of parallel coordinates has labels, from 0 to 1, and the labels."""
    if axis.ticks:
        span = axis.high - axis.low
        return [((place - axis.low) / span, text) for place, text in axis.ticks]
    parts = np.linspace(0.0, 1.0, 5)
    if axis.is_log:
        values = np.exp(np.log(axis.low) + parts * np.log(axis.high / axis.low))
    else:
        values = axis.low + parts * (axis.high - axis.low)
    return [(float(part), f"{value:.3g}") for part, value in zip(parts, values, strict=True)]
