"""Where a launch description comes from."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from launch.launch_context import LaunchContext
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions
from wsgen.launch import known_packages
from wsgen.launch.record import RECORD

if TYPE_CHECKING:
    from launch.base import SomeSubstitutionsType, Substitution
    from launch.launch_description import LaunchDescription


class LaunchDescriptionSource:
    """A description, or a place that one is loaded from, once, when it is asked for."""

    def __init__(
        self,
        launch_description: LaunchDescription | None = None,
        location: SomeSubstitutionsType = "",
        method: str = "unspecified mechanism from a script",
    ) -> None:
        self.__launch_description = launch_description
        self.__location: list[Substitution] = normalize_to_list_of_substitutions(location)
        self.__expanded_location: str | None = None
        self.__method = method
        if launch_description is None:
            RECORD.argument_use.not_run.add(self)

    def try_get_launch_description_without_context(self) -> LaunchDescription | None:
        """The description, where finding it takes no configuration of the launch."""
        if self.__launch_description is None:
            try:
                self.__launch_description = self._load(
                    perform_substitutions(LaunchContext(), self.__location)
                )
            except Exception:  # noqa: BLE001  foreign code; it is told when it is really included
                return None
        return self.__launch_description

    def get_launch_description(self, context: LaunchContext) -> LaunchDescription:
        """The description."""
        if self.__expanded_location is None:
            self.__expanded_location = perform_substitutions(context, self.__location)
        if self.__launch_description is None:
            self.__launch_description = self._load(self.__expanded_location)
        return self.__launch_description

    @property
    def location(self) -> str:
        """The path, or what is known of it before the launch."""
        if self.__expanded_location is not None:
            return self.__expanded_location
        return " + ".join(sub.describe() for sub in self.__location)

    @property
    def method(self) -> str:
        """How it is loaded, in words."""
        return self.__method

    def _load(self, location: str) -> LaunchDescription:
        RECORD.argument_use.not_run.discard(self)
        stand_in = known_packages.stand_in_of(os.path.normpath(location))
        if stand_in is not None:
            from launch._stand_in import describe

            RECORD.argument_use.is_unknown |= not stand_in.has_known_arguments
            return describe(stand_in)
        if RECORD.is_unknown(location):
            from launch.launch_description import LaunchDescription

            RECORD.argument_use.is_unknown = True
            return LaunchDescription()
        return self._get_launch_description(location)

    def _get_launch_description(self, location: str) -> LaunchDescription:
        """The description that a file gives."""
        raise NotImplementedError(location)
