"""The files by which packages announce themselves."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from ament_index_python.search_paths import get_search_paths

_INDEX = os.path.join("share", "ament_index", "resource_index")


def get_resource(resource_type: str, resource_name: str) -> tuple[str, str]:
    """Content of the marker and the prefix it lies in; LookupError where there is none."""
    prefix = has_resource(resource_type, resource_name)
    if not prefix:
        raise LookupError(
            f"Could not find the resource '{resource_name}' of type '{resource_type}'"
        )
    marker = Path(prefix, _INDEX, resource_type, resource_name)
    return marker.read_text(encoding="utf-8"), prefix


def get_resources(resource_type: str) -> dict[str, str]:
    """Names and prefixes of all resources of a type."""
    found: dict[str, str] = {}
    for prefix in get_search_paths():
        with suppress(OSError):
            for marker in os.scandir(os.path.join(prefix, _INDEX, resource_type)):
                if marker.is_file() and not marker.name.startswith("."):
                    found.setdefault(marker.name, prefix)
    return found


def get_resource_types() -> set[str]:
    """All types there are."""
    return {
        folder.name
        for prefix in get_search_paths()
        if Path(prefix, _INDEX).is_dir()
        for folder in Path(prefix, _INDEX).iterdir()
        if folder.is_dir() and not folder.name.startswith(".")
    }


def has_resource(resource_type: str, resource_name: str) -> str | None:
    """The prefix that has the resource, if any has."""
    for prefix in get_search_paths():
        if os.path.isfile(os.path.join(prefix, _INDEX, resource_type, resource_name)):
            return prefix
    return None
