"""Actions in a scope of their own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch.actions.pop_environment import PopEnvironment
from launch.actions.pop_launch_configurations import PopLaunchConfigurations
from launch.actions.push_environment import PushEnvironment
from launch.actions.push_launch_configurations import PushLaunchConfigurations
from launch.actions.reset_environment import ResetEnvironment
from launch.actions.reset_launch_configurations import ResetLaunchConfigurations
from launch.actions.set_launch_configuration import SetLaunchConfiguration

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from launch.launch_context import LaunchContext
    from launch.launch_description_entity import LaunchDescriptionEntity


class GroupAction(Action):
    """Its actions; with `scoped`, what they set ends with them.

    Timers and event handlers of the group run after its scope has ended, as in the original.
    """

    def __init__(
        self,
        actions: Iterable[LaunchDescriptionEntity],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: Mapping[Any, Any] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.__actions = list(actions)
        self.__scoped = scoped
        self.__forwarding = forwarding
        self.__launch_configurations = launch_configurations or {}
        self.__sub_entities: list[LaunchDescriptionEntity] | None = None

    def get_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """The actions, with what makes the scope around them."""
        if self.__sub_entities is None:
            settings = [
                SetLaunchConfiguration(name, value)
                for name, value in self.__launch_configurations.items()
            ]
            inside: list[LaunchDescriptionEntity] = [*settings, *self.__actions]
            if self.__scoped and not self.__forwarding:
                inside = [
                    ResetEnvironment(),
                    ResetLaunchConfigurations(self.__launch_configurations),
                    *self.__actions,
                ]
            if self.__scoped:
                inside = [
                    PushLaunchConfigurations(),
                    PushEnvironment(),
                    *inside,
                    PopEnvironment(),
                    PopLaunchConfigurations(),
                ]
            self.__sub_entities = inside
        return self.__sub_entities

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity]:
        """Give the actions in their scope."""
        del context
        return self.get_sub_entities()
