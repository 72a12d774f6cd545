"""Finds plotly.js, which draws the plots and 3D views of a page; it comes with PyPI's plotly.

The Python package is never imported: the page takes its JavaScript alone.
"""

from __future__ import annotations

import re
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from wsgen.errors import NotFoundError

SCRIPT = "package_data/plotly.min.js"


class PlotlyLibrary(NamedTuple):
    """A script that defines `Plotly`, under the MIT license; its first lines say so."""

    script: str
    version: str


def _find() -> Path | None:
    spec = find_spec("plotly")
    file = Path(spec.origin).parent / SCRIPT if spec is not None and spec.origin else None
    return file if file is not None and file.is_file() else None


def require_plotly(*, extra: str = "report") -> None:
    """Check that it is installed; `extra` is the one of wsgen that brings it.

    Raises:
        NotFoundError: It is not; the hint says how to install it.
    """
    if _find() is None:
        raise NotFoundError(
            "plotly, which draws the plots of the report, is not installed.",
            hint=f"Install it: pip install 'wsgen[{extra}]'",
        )


def read_plotly(*, extra: str = "report") -> PlotlyLibrary:
    """Read the script; `extra` is the one of wsgen that brings it.

    Raises:
        NotFoundError: It is not installed.
    """
    require_plotly(extra=extra)
    script = (_find() or Path()).read_text(encoding="utf-8")
    found = re.search(r"plotly\.js v([\w.+-]+)", script[:500])
    return PlotlyLibrary(script, found[1] if found else "")
