"""The verb `colcon validate`: `wsgen validate` for each package that colcon selects.

Registered as `colcon_core.verb`, which colcon loads for every command: at the top, this module
imports nothing but what colcon has loaded before. colcon selects the packages, runs the jobs, and
draws their events.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from colcon_core.plugin_system import satisfies_version
from colcon_core.verb import VerbExtensionPoint

if TYPE_CHECKING:
    import argparse


class ValidateVerb(VerbExtensionPoint):  # type: ignore[misc]  # colcon is not typed
    """Validate the robots that a set of packages spawns, with wsgen."""

    def __init__(self) -> None:
        super().__init__()
        satisfies_version(VerbExtensionPoint.EXTENSION_POINT_VERSION, "^1.0")

    def add_arguments(self, *, parser: argparse.ArgumentParser) -> None:
        """Add the options of the verb, and those by which colcon selects and runs."""
        from wsgen.building.colcon_validate import add_arguments  # noqa: PLC0415  see above

        add_arguments(parser)

    def main(self, *, context: Any) -> int:
        """Validate the selected packages; the exit code is not 0 if one fails."""
        from wsgen.building.colcon_validate import validate  # noqa: PLC0415  see above

        return validate(context)
