"""TOML files; the one place that knows where the parser of this Python is."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from pathlib import Path


def load(file: Path) -> dict[str, Any]:
    """The document of a file.

    Raises:
        OSError: the file cannot be read.
        ValueError: it is no TOML, or not UTF-8; the message says where.
    """
    document: dict[str, Any] = tomllib.loads(file.read_text(encoding="utf-8"))
    return document
