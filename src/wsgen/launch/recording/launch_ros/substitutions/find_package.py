"""Where a package is installed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ament_index_python.packages import get_package_prefix, get_package_share_directory
from launch.substitution import Substitution
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions
from wsgen.launch.record import RECORD

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType


class FindPackage(Substitution):
    """Base: a folder of a package."""

    def __init__(self, package: SomeSubstitutionsType) -> None:
        self.__package = normalize_to_list_of_substitutions(package)

    @property
    def package(self) -> list[Substitution]:
        """The package."""
        return self.__package

    def find(self, package_name: str) -> str:
        """The folder; launch files call this too."""
        raise NotImplementedError(package_name)

    def describe(self) -> str:
        """Itself in words."""
        return f"{type(self).__name__}(pkg={' + '.join(sub.describe() for sub in self.__package)})"

    def perform(self, context: LaunchContext) -> str:
        """The folder."""
        package = perform_substitutions(context, self.__package)
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
