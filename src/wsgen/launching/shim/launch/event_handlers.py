"""All event handlers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from launch._events import ExecutionComplete, ProcessExited, ProcessIO, ProcessStarted, Shutdown
from launch._finder import show_public_names
from launch.actions import ExecuteLocal
from launch.base import Action, BaseEventHandler, LaunchDescriptionEntity
from wsgen.launching.record import RECORD, caller

if TYPE_CHECKING:
    from launch.base import Event
    from launch.launch_context import LaunchContext


class OnActionEventBase(BaseEventHandler):
    """Waits for events of one action, of the actions that a matcher accepts, or of all."""

    def __init__(
        self,
        *,
        action_matcher: Any,
        on_event: Any,
        target_event_cls: type[Event],
        target_action_cls: type[Action],
        **kwargs: Any,
    ) -> None:
        # What is not known may be an action; it is no matcher, though it can be called.
        is_action = isinstance(action_matcher, target_action_cls) or hasattr(
            action_matcher, "wsgen_is_unknown"
        )
        if not is_action and action_matcher is not None and not callable(action_matcher):
            raise TypeError(
                f"action_matcher must be an '{target_action_cls.__name__}' instance or a callable"
            )

        def matches(event: Event) -> bool:
            if not isinstance(event, target_event_cls):
                return False
            action = event.action  # type: ignore[attr-defined]  # all events of actions have one
            if callable(action_matcher) and not is_action:
                return bool(action_matcher(action))
            return action_matcher is None or action is action_matcher

        super().__init__(matcher=matches, **kwargs)
        self._on_event = on_event
        self._event = target_event_cls
        self.wsgen_actions = [] if callable(on_event) else _entities(on_event)
        self.wsgen_origin = caller() or RECORD.visited
        is_known = is_action and not hasattr(action_matcher, "wsgen_is_unknown")
        self.wsgen_target: Action | None = action_matcher if is_known else None

    @property
    def wsgen_waits_in_vain(self) -> bool:
        """Whether, after the launch was played, the event of its one action never happens."""
        target = self.wsgen_target
        if target is None or target.wsgen_is_visited:
            return self._event in _OF_ENDS and getattr(target, "wsgen_endless", None) is not None
        return True

    def handle(self, event: Event, context: LaunchContext) -> Any:
        """Give the actions, or what the function gives."""
        super().handle(event, context)
        if isinstance(event, ProcessExited) and self.wsgen_actions:
            (first, *_) = self.wsgen_actions
            if not isinstance(first, LaunchDescriptionEntity) and RECORD.live is None:
                # The launch fails when the process ends, and as long as it runs it does not.
                from wsgen.launching.launch_warnings import report_no_action

                report_no_action(first, self.wsgen_origin)
                return None
        return self.wsgen_actions or self._function()(event, context)

    def describe(self) -> tuple[str, list[LaunchDescriptionEntity]]:
        """Itself in words, and its actions."""
        text, actions = super().describe()
        if not self.wsgen_actions:
            self._function()
        actions.extend(self.wsgen_actions)
        return text, actions

    def _function(self) -> Any:
        if not callable(self._on_event):
            # The original fails here too, before anything is started.
            raise AttributeError(  # noqa: TRY004  its type is that of the original
                f"'{type(self).__name__}' was given no actions: the list is empty"
            )
        return self._on_event


def _entities(on_event: Any) -> list[LaunchDescriptionEntity]:
    if not isinstance(on_event, Iterable):
        return [on_event]
    entities = list(on_event)
    for entity in entities:
        if not isinstance(entity, LaunchDescriptionEntity):
            raise TypeError(
                "expected all items in 'on_event' iterable to be of type "
                f"'LaunchDescriptionEntity' but got '{type(entity)}'"
            )
    return entities


class OnExecutionComplete(OnActionEventBase):
    """What is done when an action is done; without a target, any action."""

    def __init__(self, *, target_action: Any = None, on_completion: Any, **kwargs: Any) -> None:
        super().__init__(
            action_matcher=target_action,
            on_event=on_completion,
            target_event_cls=ExecutionComplete,
            target_action_cls=Action,
            **kwargs,
        )


class OnProcessExit(OnActionEventBase):
    """What is done when a process ends; without a target, any process."""

    def __init__(self, *, target_action: Any = None, on_exit: Any, **kwargs: Any) -> None:
        super().__init__(
            action_matcher=target_action,
            on_event=on_exit,
            target_event_cls=ProcessExited,
            target_action_cls=ExecuteLocal,
            **kwargs,
        )


class OnProcessIO(OnActionEventBase):
    """What is done about what a process writes; unresolved in a plan, for which nothing runs."""

    def __init__(
        self,
        *,
        target_action: Any = None,
        on_stdin: Any = None,
        on_stdout: Any = None,
        on_stderr: Any = None,
        **kwargs: Any,
    ) -> None:
        functions = (on_stdin, on_stdout, on_stderr)

        def handle(event: ProcessIO, _context: LaunchContext) -> Any:
            function = functions[event.fd]
            return None if function is None else function(event)

        super().__init__(
            action_matcher=target_action,
            on_event=handle,
            target_event_cls=ProcessIO,
            target_action_cls=ExecuteLocal,
            **kwargs,
        )
        if RECORD.live is None:
            RECORD.note_unresolved(
                "OnProcessIO", "what a process writes is known only when it runs", caller()
            )


class OnProcessStart(OnActionEventBase):
    """What is done when a process starts; without a target, any process."""

    def __init__(self, *, target_action: Any = None, on_start: Any, **kwargs: Any) -> None:
        super().__init__(
            action_matcher=target_action,
            on_event=on_start,
            target_event_cls=ProcessStarted,
            target_action_cls=ExecuteLocal,
            **kwargs,
        )


class OnIncludeLaunchDescription(BaseEventHandler):
    """Waits for requests that only a running launch service gets."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(matcher=lambda _event: False, **kwargs)


class OnShutdown(BaseEventHandler):
    """What is done when the launch ends."""

    def __init__(self, *, on_shutdown: Any, **kwargs: Any) -> None:
        super().__init__(matcher=lambda event: isinstance(event, Shutdown), **kwargs)
        self.__on_shutdown = on_shutdown

    def handle(self, event: Event, context: LaunchContext) -> Any:
        """Give the actions, or what the function gives."""
        super().handle(event, context)
        if callable(self.__on_shutdown):
            return self.__on_shutdown(event, context)
        return self.__on_shutdown


_OF_ENDS = (ExecutionComplete, ProcessExited)

show_public_names(__name__)
