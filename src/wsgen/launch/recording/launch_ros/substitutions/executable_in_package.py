"""A program of a package."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from ament_index_python.packages import get_package_prefix
from launch.substitution import Substitution
from launch.substitutions.substitution_failure import SubstitutionFailure
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions
from wsgen.launch import known_packages
from wsgen.launch.record import RECORD

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType


class ExecutableInPackage(Substitution):
    """The path of a program below `lib/PACKAGE` of the prefix that has the package."""

    def __init__(self, executable: SomeSubstitutionsType, package: SomeSubstitutionsType) -> None:
        self.__executable = normalize_to_list_of_substitutions(executable)
        self.__package = normalize_to_list_of_substitutions(package)

    @property
    def executable(self) -> list[Substitution]:
        """The program."""
        return self.__executable

    @property
    def package(self) -> list[Substitution]:
        """The package."""
        return self.__package

    def perform(self, context: LaunchContext) -> str:
        """The path; not looked for where the package itself is not here."""
        executable = perform_substitutions(context, self.__executable)
        package = perform_substitutions(context, self.__package)
        if RECORD.is_unknown(package) or RECORD.is_unknown(executable):
            return executable
        prefix = get_package_prefix(package)
        folder = os.path.join(prefix, "lib", package)
        path = os.path.join(folder, executable)
        is_stand_in = prefix == known_packages.prefix() and not os.path.isdir(folder)
        if not is_stand_in and not os.access(path, os.X_OK):
            raise SubstitutionFailure(
                f"executable '{executable}' not found on the libexec directory '{folder}'"
            )
        return path
