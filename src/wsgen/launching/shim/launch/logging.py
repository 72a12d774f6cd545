"""Loggers: Python's own, which print nothing here."""

from __future__ import annotations

import logging as _logging
from typing import Any


def get_logger(name: str | None = None) -> _logging.Logger:
    """A logger of that name."""
    return _logging.getLogger(name or "launch")


class _LaunchConfig:
    """Settings that launch files change and that decide nothing here."""

    level = _logging.INFO
    log_dir = ""


launch_config: Any = _LaunchConfig()
