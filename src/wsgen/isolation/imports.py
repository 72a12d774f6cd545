"""Import modules, in a child: one that is compiled for another machine may crash."""

from __future__ import annotations

import importlib


def import_modules(names: list[str]) -> None:
    """Import the modules.

    Raises:
        ImportError: one cannot be imported.
    """
    for name in names:
        importlib.import_module(name)
