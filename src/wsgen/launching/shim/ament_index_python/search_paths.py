"""Where packages are installed."""

from __future__ import annotations

import os


def get_search_paths() -> list[str]:
    """The prefixes of AMENT_PREFIX_PATH that exist; OSError where it is not set."""
    value = os.environ.get("AMENT_PREFIX_PATH")
    if not value:
        raise OSError("Environment variable 'AMENT_PREFIX_PATH' is not set or empty")
    return [path for path in value.split(os.pathsep) if path and os.path.exists(path)]
