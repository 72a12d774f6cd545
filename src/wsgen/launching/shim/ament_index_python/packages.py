"""Where a package is installed."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

from ament_index_python.resources import get_resources, has_resource
from ament_index_python.search_paths import get_search_paths

if TYPE_CHECKING:
    from collections.abc import Callable

# Set by the worker that evaluates a launch file: the prefix to give for a package, given the one
# that has it, None where it is not installed.
find_prefix: Callable[[str, str | None], str | None] = lambda _name, prefix: prefix  # noqa: E731  replaced as a whole


class PackageNotFoundError(KeyError):
    """A package that is not installed."""


def get_packages_with_prefixes() -> dict[str, str]:
    """All packages and where they are installed."""
    return get_resources("packages")


def get_package_prefix(package_name: str) -> str:
    """The prefix of a package; PackageNotFoundError or ValueError where there is none."""
    if re.fullmatch(r"[a-zA-Z0-9][a-zA-Z0-9_-]+", package_name, re.ASCII) is None:
        raise ValueError(f"'{package_name}' is not a valid package name")
    prefix = find_prefix(package_name, has_resource("packages", package_name))
    if prefix is None:
        error = PackageNotFoundError(
            f"package '{package_name}' not found, searching: {get_search_paths()}"
        )
        error.name = package_name  # type: ignore[attr-defined]  # for who explains it
        raise error
    return prefix


def get_package_share_directory(
    package_name: str,
    print_warning: bool = True,  # noqa: FBT001, FBT002  as the original
) -> str:
    """The share folder of a package."""
    del print_warning
    return os.path.join(get_package_prefix(package_name), "share", package_name)


def get_package_share_path(
    package_name: str,
    print_warning: bool = True,  # noqa: FBT001, FBT002  as the original
) -> Path:
    """The share folder of a package as a path."""
    del print_warning
    return Path(get_package_share_directory(package_name))
