"""The extension of plain `colcon`: it sets the toolchain, and skips tests that cannot be built.

It also keeps colcon from searching for packages in environments of Python.

The arguments for CMake are those of `wsgen build`, so that neither configures again what the other
one has built. To go on where a package is missing is left to `wsgen build`.

Registered as `colcon_core.argument_parser`, the first group of extensions that colcon calls in
every command, so that `.venv/bin/colcon build` finds CMake, Python and ament_cmake also where the
virtual environment is not activated.
"""

from __future__ import annotations

import importlib
import os
import sys
from glob import glob
from pathlib import Path
from typing import TYPE_CHECKING

from colcon_core.argument_parser import (
    ArgumentParserDecorator,
    ArgumentParserDecoratorExtensionPoint,
)
from colcon_core.logging import colcon_logger
from colcon_core.plugin_system import satisfies_version

from wsgen.building.toolchain import (
    Wheels,
    find_toolchain,
    ignore_python_environments,
    package_prefixes,
    set_package_environments,
    use_toolchain,
)
from wsgen.errors import NotFoundError

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
        """Change the environment of this process; look at the arguments once they are parsed."""
        ignore_python_environments()
        before = dict(os.environ)
        use_toolchain(os.environ)
        set_package_environments(os.environ)
        # colcon has collected the descriptions of the environment variables by now, and with
        # them this module, which looks for CMake when it is imported and never again. What copies
        # its answer, the build tasks, is imported later.
        if CMAKE_MODULE in sys.modules and dict(os.environ) != before:
            importlib.reload(sys.modules[CMAKE_MODULE])
        return _Arguments(parser)


class _Arguments(ArgumentParserDecorator):  # type: ignore[misc]  # colcon is not typed
    """Gives CMake the arguments of `wsgen build`: no tests, if a linter for them is missing."""

    def parse_args(self, *args: object, **kwargs: object) -> argparse.Namespace:
        """Add to the arguments of `colcon build`."""
        parsed: argparse.Namespace = self._parser.parse_args(*args, **kwargs)
        if getattr(parsed, "verb_name", None) == "build":
            _add_cmake_arguments(parsed)
        return parsed


def _add_cmake_arguments(parsed: argparse.Namespace) -> None:
    # Only `colcon build` pays for reading the packages.
    from wsgen.building.left_out import (  # noqa: PLC0415
        WITHOUT_TESTS,
        missing_test_dependencies,
        tests_left_out,
        without_ros_arguments,
    )
    from wsgen.packages.workspace.layout import Workspace, take_inventory  # noqa: PLC0415

    # Without colcon's extensions for CMake or ROS, their arguments do not exist.
    for_cmake = getattr(parsed, "cmake_args", None) or ()
    for_ament = getattr(parsed, "ament_cmake_args", None) or ()
    words = (*for_cmake, *for_ament)
    try:
        toolchain = find_toolchain(os.environ)
    except NotFoundError:
        return
    added: tuple[str, ...] = ()
    if not any("BUILD_TESTING" in word for word in words):
        folders = [*(getattr(parsed, "base_paths", None) or ["."])]
        for pattern in getattr(parsed, "paths", None) or ():  # colcon expands them, too
            folders += glob(pattern)  # noqa: PTH207  patterns may be absolute
        packages = [
            package
            for folder in folders
            for package in take_inventory(Workspace(root=Path(folder).absolute())).packages
        ]
        missing = missing_test_dependencies(
            packages,
            prefixes=package_prefixes(toolchain, os.environ),
            built_here={package.name for package in packages},
        )
        for note in tests_left_out(missing):
            colcon_logger.getChild("wsgen").warning(note.message)
        added = (WITHOUT_TESTS,) if missing else ()
    if isinstance(toolchain, Wheels):
        added += without_ros_arguments(os.environ, words)
    # colcon adds these to the arguments of CMake, wherever those come from.
    parsed.ament_cmake_args = [*added, *for_ament]
