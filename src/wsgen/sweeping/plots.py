"""A chart as a picture (PNG): the one place that imports matplotlib."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

from wsgen.errors import NotFoundError
from wsgen.sweeping.chart import ticks_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.sweeping.chart import Axis, Cells, Chart, Group, Panel

# Okabe and Ito's colors, which color-blind people distinguish, and a symbol each: of what passed,
# of four rules, and of all others.
COLORS = ("#0072b2", "#d55e00", "#e69f00", "#a94f86", "#00795a", "#555d66")
SYMBOLS = ("o", "X", "^", "s", "D", "P")
TEXT, MUTED, LINE, SHADE = "#1b2027", "#56606c", "#d5dbe3", "#e2eefc"
DPI = 150
FEW_CELLS = 45  # along an axis: each has its symbol


def require_matplotlib() -> None:
    """Check that it is installed.

    Raises:
        NotFoundError: It is not; the hint says how to install it.
    """
    _figure_class()


def _figure_class() -> Any:
    try:
        from matplotlib.figure import Figure  # noqa: PLC0415  an extra, and half a second
    except ImportError:
        raise NotFoundError(
            "matplotlib, which draws plots as PNG, is not installed.",
            hint="Install it: pip install 'wsgen[sweep]'",
        ) from None
    return Figure


def draw_png(chart: Chart) -> bytes:
    """Draw a chart; the same chart gives the same bytes.

    Raises:
        NotFoundError: matplotlib is not installed.
    """
    make = _figure_class()
    rows = max(1, len(chart.panels))
    height = 6.4 if rows == 1 else 2.1 + 2.15 * rows
    width = 9.0 if not chart.axes else max(9.0, 1.55 * len(chart.axes) + 2.5)
    figure = make(figsize=(width, height), dpi=DPI, layout="constrained", facecolor="white")
    _heading(figure, chart)
    if chart.axes:
        _draw_parallel(figure.subplots(), chart)
    elif chart.cells is not None:
        _draw_cells(figure, figure.subplots(), chart.cells, chart.groups)
    else:
        axes = figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0]
        for number, (plot, panel) in enumerate(zip(axes, chart.panels, strict=True)):
            _draw_panel(plot, panel, is_alone=rows == 1)
            if rows > 1:  # long names fit above a plot, not beside it
                plot.set_ylabel("")
                plot.set_title(_plain(panel.y.label), loc="left", fontsize=10, color=TEXT)
            if number < rows - 1:
                plot.set_xlabel("")
    _legend(figure, chart)
    stream = io.BytesIO()
    figure.savefig(stream, format="png", metadata={"Software": None})
    return stream.getvalue()


def _plain(text: str) -> str:
    """A text without matplotlib's own markup: a dollar begins a formula."""
    return text.replace("$", r"\$")


def _heading(figure: Any, chart: Chart) -> None:
    """Title and subtitle above the plots, at the same distance in pictures of any height."""
    height = figure.get_figheight()
    figure.get_layout_engine().set(rect=(0.01, 0, 0.98, 1 - 0.75 / height))
    for text, inches, more in (
        (chart.title, 0.28, {"fontsize": 14, "fontweight": "bold", "color": TEXT}),
        ("; ".join(filter(None, (chart.subtitle, chart.note))), 0.56, {"color": MUTED}),
    ):
        figure.text(0.02, 1 - inches / height, _plain(text), ha="left", va="center", **more)


def _legend(figure: Any, chart: Chart) -> None:
    from matplotlib.lines import Line2D  # noqa: PLC0415
    from matplotlib.patches import Patch  # noqa: PLC0415

    handles: list[Any] = [
        Line2D(
            [],
            [],
            color=COLORS[group.number],
            marker=SYMBOLS[group.number],
            linestyle="-" if chart.axes else "",
            markersize=7,
            label=_plain(f"{group.name} ({group.runs:,})"),
        )
        for group in chart.groups
    ]
    if any(panel.marks for panel in chart.panels):
        handles += [
            Line2D([], [], color=TEXT, linestyle="--", label="border"),
            Patch(facecolor=SHADE, edgecolor=LINE, label="interval of the border"),
        ]
    if any(panel.line_low for panel in chart.panels):
        handles.append(Line2D([], [], color=MUTED, linewidth=1, label="interval of 95 %"))
    if handles:
        figure.legend(
            handles=handles,
            loc="outside lower center",
            ncols=min(len(handles), 3),
            frameon=False,
            fontsize=9,
        )


def _style(plot: Any) -> None:
    plot.set_axisbelow(True)
    plot.grid(color=LINE, linewidth=0.6)
    plot.tick_params(colors=TEXT, labelsize=9)
    for side in ("top", "right"):
        plot.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        plot.spines[side].set_color(MUTED)


def _scale(plot: Any, axis: Axis, name: str, *, margin: float = 0.0) -> None:
    """Set label, range, scale and ticks of an axis of a plot."""
    getattr(plot, f"set_{name}label")(_plain(axis.label), fontsize=10, color=TEXT)
    low, high = axis.low, axis.high
    if axis.is_log:
        getattr(plot, f"set_{name}scale")("log")
        low, high = low / (high / low) ** margin, high * (high / low) ** margin
    else:
        low, high = low - margin * (high - low), high + margin * (high - low)
    getattr(plot, f"set_{name}lim")(low, high)
    if axis.ticks:
        places, labels = zip(*axis.ticks, strict=True)
        is_long = name == "x" and sum(map(len, labels)) > 70  # noqa: PLR2004
        more = {"rotation": 35, "ha": "right"} if is_long else {}
        getattr(plot, f"set_{name}ticks")(places, [_plain(text) for text in labels], **more)


def _draw_panel(plot: Any, panel: Panel, *, is_alone: bool) -> None:
    _style(plot)
    for mark in panel.marks:
        plot.axvspan(mark.low, mark.high, color=SHADE, zorder=0)
        plot.axvline(mark.at, color=TEXT, linestyle="--", linewidth=1.2, zorder=1)
    if panel.is_bars:
        plot.bar(panel.line_x, panel.line_y, width=0.6, color=COLORS[0])
    elif panel.line_x:
        plot.plot(panel.line_x, panel.line_y, color=COLORS[0], marker="o", markersize=4)
    if panel.line_low:
        below = [y - low for y, low in zip(panel.line_y, panel.line_low, strict=True)]
        above = [high - y for y, high in zip(panel.line_y, panel.line_high, strict=True)]
        plot.errorbar(
            panel.line_x, panel.line_y, yerr=[below, above], fmt="none", ecolor=MUTED, capsize=2
        )
    count = sum(len(points.x) for points in panel.points)
    size = 42 if count < 400 and is_alone else 20 if count < 1200 else 9  # noqa: PLR2004
    for points in panel.points:
        plot.scatter(
            points.x,
            points.y,
            s=size,
            color=COLORS[points.group],
            marker=SYMBOLS[points.group],
            linewidths=0.4,
            edgecolors="white",
            alpha=0.85,
        )
    _scale(plot, panel.x, "x", margin=0.02)
    _scale(plot, panel.y, "y", margin=0.05)


def _draw_cells(figure: Any, plot: Any, cells: Cells, groups: Sequence[Group]) -> None:
    from matplotlib.colors import BoundaryNorm, ListedColormap  # noqa: PLC0415

    _style(plot)
    plot.grid(visible=False)
    if cells.shares:
        shares = [[float("nan") if one is None else one for one in row] for row in cells.shares]
        mesh = plot.pcolormesh(
            cells.x_edges, cells.y_edges, shares, cmap="cividis", vmin=0, vmax=100
        )
        bar = figure.colorbar(mesh, ax=plot, label="passed, %")
        bar.outline.set_visible(False)
    else:
        pale = ListedColormap([_pale(color) for color in COLORS])
        norm = BoundaryNorm([-0.5 + number for number in range(len(COLORS) + 1)], len(COLORS))
        numbers = [[float("nan") if one < 0 else one for one in row] for row in cells.groups]
        plot.pcolormesh(
            cells.x_edges,
            cells.y_edges,
            numbers,
            cmap=pale,
            norm=norm,
            edgecolors="white",
            linewidth=0.4,
        )
        xs, ys = cells.x_values, cells.y_values
        largest = max(len(xs), len(ys))
        size = min(90.0, (260.0 / largest) ** 2 / 6) if largest <= FEW_CELLS else 0.0
        for group in groups if size else ():
            places = [
                (x, y)
                for y, row in zip(ys, cells.groups, strict=True)
                for x, number in zip(xs, row, strict=True)
                if number == group.number
            ]
            plot.scatter(
                *zip(*places, strict=True),
                s=size,
                color=COLORS[group.number],
                marker=SYMBOLS[group.number],
                linewidths=0,
            )
    _scale(plot, cells.x, "x")
    _scale(plot, cells.y, "y")


def _pale(color: str) -> str:
    """A color on white, a third of it opaque."""
    parts = (int(color[at : at + 2], 16) for at in (1, 3, 5))
    return "#" + "".join(f"{round(255 - (255 - part) * 0.35):02x}" for part in parts)


def _draw_parallel(plot: Any, chart: Chart) -> None:
    from matplotlib.collections import LineCollection  # noqa: PLC0415

    count = sum(len(lines.places) for lines in chart.lines)
    opacity = max(0.12, min(0.8, 60 / max(count, 1)))
    for order, lines in enumerate(chart.lines):
        segments = [
            [(x, float("nan") if y is None else y) for x, y in enumerate(run)]
            for run in lines.places
        ]
        plot.add_collection(
            LineCollection(
                segments,
                colors=COLORS[lines.group],
                alpha=opacity,
                linewidths=1.0,
                zorder=1 + order / 10,
            )
        )
    for x, axis in enumerate(chart.axes):
        plot.axvline(x, color=TEXT, linewidth=1.0, zorder=3)
        for y, text in ticks_of(axis):
            plot.annotate(
                _plain(text),
                (x, y),
                xytext=(4, 0),
                textcoords="offset points",
                va="center",
                fontsize=8,
                color=TEXT,
                zorder=4,
                bbox={"boxstyle": "round,pad=0.1", "facecolor": "white", "alpha": 0.75, "lw": 0},
            )
    labels = [_plain(_wrapped(axis.label)) for axis in chart.axes]
    plot.set_xticks(range(len(chart.axes)), labels, fontsize=9, color=TEXT)
    plot.tick_params(axis="x", length=0, pad=8)
    plot.set_yticks([])
    plot.set_xlim(-0.08, len(chart.axes) - 0.72)
    plot.set_ylim(-0.04, 1.04)
    for side in ("top", "right", "left", "bottom"):
        plot.spines[side].set_visible(False)


def _wrapped(label: str) -> str:
    """A label in lines that are not wider than the distance of two axes."""
    most = 16
    lines = [""]
    for part in label.replace("_", "_\0").replace(".", ".\0").replace(" ", " \0").split("\0"):
        if lines[-1] and len(lines[-1]) + len(part.rstrip()) > most:
            lines.append("")
        lines[-1] += part
    return "\n".join(line.rstrip() for line in lines)
