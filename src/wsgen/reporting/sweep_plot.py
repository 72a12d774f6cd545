"""`wsgen sweep --plot FILE`: a picture or a page, by the suffix of the file.

The page is one file that loads nothing, the same for the same sweep: its script draws the chart
from the numbers that a picture is drawn from (`sweeping/chart.py`).
"""

from __future__ import annotations

import dataclasses
import json
from typing import TYPE_CHECKING

from wsgen import __version__
from wsgen.errors import RequestError
from wsgen.reporting.html_report import FOLDER, Html, hash_script, mark_code, read_script
from wsgen.reporting.page_data import compress, read_plotly, require_plotly
from wsgen.sweeping.chart import make_chart, ticks_of
from wsgen.sweeping.plots import draw_png, require_matplotlib
from wsgen.sweeping.summary import describe_parameter, write_share
from wsgen.templating.environment import page_environment
from wsgen.text.printable import clean

if TYPE_CHECKING:
    from pathlib import Path
    from typing import Any

    from wsgen.sweeping.chart import Chart
    from wsgen.sweeping.summary import Summary
    from wsgen.sweeping.table import TableData


# The symbols of the groups as the script draws them, in a square from -6 to 6.
SYMBOLS = (
    "M-5,0a5,5 0 1,0 10,0a5,5 0 1,0 -10,0",
    "M0,1.8L3.2,5L5,3.2L1.8,0L5,-3.2L3.2,-5L0,-1.8L-3.2,-5L-5,-3.2L-1.8,0L-5,3.2L-3.2,5Z",
    "M0,-5L5,4L-5,4Z",
    "M-4.5,-4.5H4.5V4.5H-4.5Z",
    "M0,-5.5L5.5,0L0,5.5L-5.5,0Z",
    "M-1.6,-5H1.6V-1.6H5V1.6H1.6V5H-1.6V1.6H-5V-1.6H-1.6Z",
)


def render_sweep_page(chart: Chart, summary: Summary, subject: str) -> str:
    """The page of a sweep.

    Args:
        chart: What is drawn.
        summary: What is said.
        subject: The name of the package or file.

    Raises:
        NotFoundError: plotly is not installed.
    """
    library = read_plotly(extra="sweep")
    script = read_script("sweep.js")
    environment = page_environment(FOLDER, {"marked": mark_code, "share": write_share}, clean)
    if chart.axes:
        headings = ["Parameters of the runs"]
    elif chart.cells is not None:
        headings = [f"{chart.cells.y.label} over {chart.cells.x.label}"]
    else:
        headings = [f"{panel.y.label} over {panel.x.label}" for panel in chart.panels]
    return environment.get_template("sweep.html").render(
        chart=chart,
        summary=summary,
        subject=subject,
        share=write_share(summary.passed, summary.done),
        headings=headings,
        has_marks=any(panel.marks for panel in chart.panels),
        parameters=[(one, describe_parameter(one)) for one in summary.parameters],
        symbols=SYMBOLS,
        version=__version__,
        style=Html((FOLDER / "page.css").read_text(encoding="utf-8")),
        script=Html(script),
        data=compress(json.dumps(_packed(chart), allow_nan=False, separators=(",", ":")).encode()),
        library=compress(library.script.encode()),
        library_version=library.version,
        hashes=[hash_script(script), hash_script(library.script)],
    )


def _packed(chart: Chart) -> dict[str, Any]:
    """The chart for the script, with the labels of parallel axes."""
    value = dataclasses.asdict(chart)
    for axis, one in zip(chart.axes, value["axes"], strict=True):
        one["labels"] = ticks_of(axis)
    cleaned: dict[str, Any] = _clean(value)
    return cleaned


def _clean(value: Any) -> Any:
    if isinstance(value, str):
        return clean(value)
    if isinstance(value, dict):
        return {name: _clean(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [_clean(one) for one in value]
    return value


def check_plot(file: Path) -> None:
    """Check that a plot with this suffix can be drawn; to be asked before the runs.

    Raises:
        RequestError: It is unknown.
        NotFoundError: It needs matplotlib or plotly, which is not installed.
    """
    suffix = file.suffix.lower()
    if suffix == ".png":
        require_matplotlib()
    elif suffix == ".html":
        require_plotly(extra="sweep")
    else:
        raise RequestError(
            f"Cannot draw a plot as {file.name}: "
            + (f"the format {suffix} is unknown." if suffix else "its name has no suffix."),
            hint="Choose a name that ends in .png, for a picture, or in .html, for a page.",
        )


def render_plot(file: Path, data: TableData, summary: Summary, subject: str) -> bytes:
    """Draw what a file with this name has.

    Args:
        file: Its suffix is .png or .html.
        data: The table.
        summary: Its summary.
        subject: The name of the package or file that is swept.

    Raises:
        RequestError: The suffix is unknown, no run is done, or no parameter varies.
        NotFoundError: A library is not installed.
    """
    check_plot(file)
    chart = make_chart(data, summary, subject)
    if file.suffix.lower() == ".png":
        return draw_png(chart)
    return render_sweep_page(chart, summary, subject).encode()
