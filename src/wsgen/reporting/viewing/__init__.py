"""Robots in a browser: what is shown, the page that shows it, and files that are watched."""

from __future__ import annotations

from importlib.util import find_spec

LIBRARY = "viser"
INSTALL = "pip install 'wsgen[view]'"


def is_viewer_installed() -> bool:
    """Whether robots can be shown in a browser."""
    return find_spec(LIBRARY) is not None
