"""The needs that a package declares, read when one of them is not found."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

if TYPE_CHECKING:
    from collections.abc import Iterable


_NEEDED_TO_RUN = {"depend", "exec_depend", "build_depend", "buildtool_depend", "test_depend"}


def declares(prefixes: Iterable[str], package: str, dependency: str) -> bool:
    """Whether the installed package.xml of a package names another one as a dependency."""
    for prefix in prefixes:
        file = os.path.join(prefix, "share", package, "package.xml")
        if os.path.isfile(file):
            try:
                root = ET.parse(file).getroot()  # noqa: S314  the user's own manifest
            except (ET.ParseError, OSError):
                return False
            return any(
                element.tag in _NEEDED_TO_RUN and (element.text or "").strip() == dependency
                for element in root
            )
    return False
