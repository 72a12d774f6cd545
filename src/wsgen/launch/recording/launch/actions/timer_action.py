"""Wait before something is done."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch.events.timer_event import TimerEvent
from launch.substitution import Substitution
from launch.utilities.ensure_argument_type_impl import ensure_argument_type
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.launch_description_entity import LaunchDescriptionEntity


class TimerAction(Action):
    """Its actions, after a period of virtual time."""

    def __init__(
        self,
        *,
        period: Any,
        actions: Iterable[LaunchDescriptionEntity],
        cancel_on_shutdown: Any = True,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        ensure_argument_type(
            period, [str, Substitution, Iterable, float, int], "period", "TimerAction"
        )
        ensure_argument_type(actions, Iterable, "actions", "TimerAction")
        self.__period = normalize_to_list_of_substitutions(
            str(period) if isinstance(period, (float, int)) else period
        )
        self.__actions = list(actions)
        self.__locals: dict[str, Any] = {}
        self.__canceled = False
        del cancel_on_shutdown  # a launch that is shut down has nothing to come here

    @property
    def actions(self) -> list[LaunchDescriptionEntity]:
        """What is done."""
        return self.__actions

    @property
    def period(self) -> Any:
        """When."""
        return self.__period

    def cancel(self) -> None:
        """Do nothing when the time comes."""
        self.__canceled = True

    def describe_conditional_sub_entities(
        self,
    ) -> list[tuple[str, Iterable[LaunchDescriptionEntity]]]:
        """What is done when the time comes."""
        return [("the period passes without being canceled", self.__actions)]

    def execute(self, context: LaunchContext) -> None:
        """Set the timer."""
        seconds = float(perform_substitutions(context, self.__period))
        # What the actions find out about the launch file is what it was here.
        self.__locals = context.get_locals_as_dict()
        fires = TimerEvent(timer_action=self)
        fires.wsgen_cause = f"timer {seconds}"
        context.timeline.post(fires, delay=seconds)

    def handle(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Give the actions."""
        if self.__canceled:
            return []
        context.extend_locals(self.__locals)
        self.announce_completion(context)
        return self.__actions

    def _executed(self, context: LaunchContext) -> None:
        """It is complete when the time has come, not when the timer is set."""
