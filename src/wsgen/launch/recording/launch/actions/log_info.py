"""Messages of the launch."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType


class LogInfo(Action):
    """A message; it is performed, because that can fail, and told to nobody."""

    def __init__(self, *, msg: SomeSubstitutionsType, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.__msg = normalize_to_list_of_substitutions(msg)

    @property
    def msg(self) -> Any:
        """The message."""
        return self.__msg

    def execute(self, context: LaunchContext) -> None:
        """Perform the message."""
        perform_substitutions(context, self.__msg)


class Log(LogInfo):
    """A message of a level."""

    def __init__(
        self, *, msg: SomeSubstitutionsType, level: SomeSubstitutionsType, **kwargs: Any
    ) -> None:
        super().__init__(msg=msg, **kwargs)
        self.level = normalize_to_list_of_substitutions(level)


class LogDebug(LogInfo):
    """A message for developers."""


class LogWarning(LogInfo):
    """A warning."""


class LogError(LogInfo):
    """An error message."""
