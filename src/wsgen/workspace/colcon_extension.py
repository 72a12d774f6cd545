"""What plain `colcon` loads from wsgen: the toolchain, for every command.

Registered as `colcon_core.argument_parser`, the first group of extensions that colcon calls in
every command, so that `.venv/bin/colcon build` finds CMake, Python and ament_cmake also where the
virtual environment is not activated.
"""

from __future__ import annotations

import importlib
import os
import sys
from typing import TYPE_CHECKING

from colcon_core.argument_parser import ArgumentParserDecoratorExtensionPoint
from colcon_core.plugin_system import satisfies_version

from wsgen.workspace.toolchain import use_toolchain

if TYPE_CHECKING:
    import argparse

CMAKE_MODULE = "colcon_cmake.task.cmake"


class ToolchainExtension(ArgumentParserDecoratorExtensionPoint):  # type: ignore[misc]  # untyped
    """Put the toolchain into the environment before colcon looks for it."""

    def __init__(self) -> None:
        super().__init__()
        satisfies_version(ArgumentParserDecoratorExtensionPoint.EXTENSION_POINT_VERSION, "^1.0")

    def decorate_argument_parser(
        self, *, parser: argparse.ArgumentParser
    ) -> argparse.ArgumentParser:
        """Change the environment of this process; the parser stays as it is."""
        before = dict(os.environ)
        use_toolchain(os.environ)
        # colcon has collected the descriptions of the environment variables by now, and with
        # them this module, which looks for CMake when it is imported and never again. What copies
        # its answer, the build tasks, is imported later.
        if CMAKE_MODULE in sys.modules and dict(os.environ) != before:
            importlib.reload(sys.modules[CMAKE_MODULE])
        return parser
