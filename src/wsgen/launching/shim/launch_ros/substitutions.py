"""All substitutions of ROS."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from ament_index_python.packages import get_package_prefix, get_package_share_directory
from launch._finder import show_public_names
from launch._utilities import normalize_to_list_of_substitutions, perform_substitutions
from launch.base import Substitution, SubstitutionFailure
from wsgen.launching import known_packages
from wsgen.launching.record import RECORD
from wsgen.packages.source_shares import is_source

if TYPE_CHECKING:
    from launch.base import SomeSubstitutionsType
    from launch.launch_context import LaunchContext


class ExecutableInPackage(Substitution):
    """The path of a program below `lib/PACKAGE` of the prefix that has the package."""

    def __init__(self, executable: SomeSubstitutionsType, package: SomeSubstitutionsType) -> None:
        self.executable = normalize_to_list_of_substitutions(executable)
        self.package = normalize_to_list_of_substitutions(package)

    def perform(self, context: LaunchContext) -> str:
        """The path; not looked for where the package itself is not installed."""
        executable = perform_substitutions(context, self.executable)
        package = perform_substitutions(context, self.package)
        if RECORD.is_unknown(package) or RECORD.is_unknown(executable):
            return executable
        prefix = get_package_prefix(package)
        folder = os.path.join(prefix, "lib", package)
        path = os.path.join(folder, executable)
        is_shim = prefix == known_packages.prefix() and not os.path.isdir(folder)
        is_missing = (
            known_packages.has_misspelled(package, executable)
            if is_shim or is_source(folder)
            else not os.access(path, os.X_OK)
        )
        if is_missing:
            raise SubstitutionFailure(
                f"executable '{executable}' not found on the libexec directory '{folder}'"
            )
        return path


class FindPackage(Substitution):
    """Base: a folder of a package."""

    def __init__(self, package: SomeSubstitutionsType) -> None:
        self.package = normalize_to_list_of_substitutions(package)

    def find(self, package_name: str) -> str:
        """The folder; launch files call this too."""
        raise NotImplementedError(package_name)

    def describe(self) -> str:
        """Itself in words."""
        return f"{type(self).__name__}(pkg={' + '.join(sub.describe() for sub in self.package)})"

    def perform(self, context: LaunchContext) -> str:
        """The folder."""
        package = perform_substitutions(context, self.package)
        RECORD.visited = self.wsgen_location or RECORD.visited
        return package if RECORD.is_unknown(package) else self.find(package)


class FindPackagePrefix(FindPackage):
    """The prefix that a package is installed in."""

    def find(self, package_name: str) -> str:
        """The prefix."""
        return get_package_prefix(package_name)


class FindPackageShare(FindPackage):
    """The share folder of a package."""

    def find(self, package_name: str) -> str:
        """The share folder."""
        return get_package_share_directory(package_name)


show_public_names(__name__)
