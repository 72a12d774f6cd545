"""`wsgen sweep --plot FILE`: a picture or a page, by the suffix of the file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.errors import RequestError
from wsgen.reporting.plotly_library import require_plotly
from wsgen.reporting.sweep_page import render_sweep_page
from wsgen.sweeping.chart import make_chart
from wsgen.sweeping.plots import draw_png, require_matplotlib

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.sweeping.summary import Summary
    from wsgen.sweeping.table_data import TableData


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
