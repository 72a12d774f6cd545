"""The state of a launch: configurations, environment, event handlers."""

from __future__ import annotations

import heapq
import itertools
import os
from collections import deque
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from wsgen.isolation.child import copy_environment, set_environment
from wsgen.launching.record import RECORD, caller, locate
from wsgen.model.plan import LAUNCH_FILE

if TYPE_CHECKING:
    from _collections_abc import dict_items
    from collections.abc import Iterable, Iterator, Mapping

    from launch.base import BaseEventHandler, Event, Substitution
    from wsgen.launching.record import Location


PROCESS_TIME = 0.001  # s
NEVER = float("inf")
# More than any launch needs; a handler that starts what it waits for would go on for ever.
MOST_EVENTS = 20_000


class Timeline:
    """The events to come."""

    def __init__(self) -> None:
        self.now = 0.0  # s since the launch
        self.cause = "launch"  # of what happens at this moment
        self._order = itertools.count()
        self._events = 0
        self._coming: list[tuple[float, int, Event]] = []

    def post(self, event: Event, *, delay: float = 0.0, is_simulated: bool = False) -> None:
        """Let the event happen after a delay in seconds; `NEVER` means last of all.

        Virtual time is both that of the launch and that of a simulation.
        """
        del is_simulated
        if event.wsgen_cause is None:
            event.wsgen_cause = self.cause
        heapq.heappush(self._coming, (self.now + max(0.0, delay), next(self._order), event))

    def next(self) -> Event | None:
        """Move on to the next event, if there is one.

        Raises:
            RuntimeError: There is no end of events.
        """
        if not self._coming:
            return None
        self._events += 1
        if self._events > MOST_EVENTS:
            raise RuntimeError(
                f"the launch does not come to an end: more than {MOST_EVENTS} events"
            )
        time, _, event = heapq.heappop(self._coming)
        if time != NEVER:
            self.now = time
        RECORD.is_ending |= time == NEVER
        self.cause = event.wsgen_cause or "launch"
        return event

    def clear(self) -> None:
        """Drop what was to come, as a shutdown does."""
        self._coming.clear()


class _Locals:
    """Read-only attribute access to the locals."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self.__dict__["_values"] = values

    def __getattr__(self, name: str) -> Any:
        values = self.__dict__["_values"]
        if name not in values:
            raise AttributeError(
                f"context.locals does not contain attribute '{name}', it contains: "
                f"[{', '.join(values)}]"
            )
        return values[name]

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"can't set attribute '{name}', locals are read-only")


class _Configurations(dict[str, Any]):
    """Launch configurations; notes which ones are read, and who has set each."""

    def __init__(self, values: Mapping[str, Any] = MappingProxyType({})) -> None:
        super().__init__(values)
        self.setters: dict[str, tuple[str, Location | None]] = {}

    def __setitem__(self, name: str, value: Any) -> None:
        self.setters[name] = (LAUNCH_FILE, caller())
        super().__setitem__(name, value)

    def set(self, name: str, value: Any, setter: str, location: Location | None) -> None:
        """Set one, with who has set it and where that is written."""
        self.setters[name] = (setter, location)
        super().__setitem__(name, value)

    def copy_unread(self) -> _Configurations:
        """A copy, for a scope."""
        copied = _Configurations(self.unread())
        copied.setters = dict(self.setters)
        return copied

    def __getitem__(self, name: str) -> Any:
        RECORD.argument_use.read.add(name)
        return super().__getitem__(name)

    def __contains__(self, name: object) -> bool:
        RECORD.argument_use.read.add(str(name))
        return super().__contains__(name)

    def get(self, name: str, default: Any = None) -> Any:
        RECORD.argument_use.read.add(name)
        return super().get(name, default)

    def __iter__(self) -> Iterator[str]:
        RECORD.argument_use.read.update(super().__iter__())
        return super().__iter__()

    def items(self) -> dict_items[str, Any]:
        RECORD.argument_use.read.update(super().__iter__())
        return super().items()

    def unread(self) -> dict[str, Any]:
        """A copy, for what is none of the user's reading."""
        return {name: super(_Configurations, self).__getitem__(name) for name in super().__iter__()}


class LaunchContext:
    """What entities see of the launch while they are visited."""

    def __init__(self, *, argv: Iterable[str] | None = None, noninteractive: bool = False) -> None:
        self.argv = [] if argv is None else argv
        self.noninteractive = noninteractive
        self.is_shutdown = False
        self.asyncio_loop = None
        self.timeline = Timeline() if RECORD.live is None else RECORD.live.make_timeline()
        self._event_handlers: deque[BaseEventHandler] = deque()
        self._globals: dict[str, Any] = {}
        self._locals: dict[str, Any] = {}
        self._locals_stack: list[dict[str, Any]] = []
        self.launch_configurations = _Configurations()
        self._configurations_stack: list[_Configurations] = []
        self._environment_stack: list[dict[str, str]] = []
        self._environment_at_start = copy_environment()

    @property
    def environment(self) -> dict[str, str]:
        """The environment as it is now."""
        return os.environ  # type: ignore[return-value]  # a mutable mapping of strings all the same

    @property
    def locals(self) -> Any:
        """Locals by attribute."""
        return _Locals(self.get_locals_as_dict())

    def get_locals_as_dict(self) -> dict[str, Any]:
        """Globals overlaid with locals."""
        return {**self._globals, **self._locals}

    def extend_globals(self, extensions: Mapping[str, Any]) -> None:
        """Add locals for good."""
        self._globals.update(extensions)

    def extend_locals(self, extensions: Mapping[str, Any]) -> None:
        """Add locals until the event that is handled now is done with."""
        self._locals.update(extensions)

    def perform_substitution(self, substitution: Substitution) -> str:
        """The text of a substitution now."""
        try:
            return substitution.perform(self)
        except Exception as error:
            locate(error, getattr(substitution, "wsgen_location", None))
            raise

    @property
    def has_event_handlers(self) -> bool:
        """Whether anything waits for an event."""
        return bool(self._event_handlers)

    def would_handle_event(self, event: Event) -> bool:
        """Whether some handler waits for this event."""
        return any(handler.matches(event) for handler in self._event_handlers)

    def register_event_handler(
        self,
        event_handler: BaseEventHandler,
        append: bool = False,  # noqa: FBT001, FBT002  as the original
    ) -> None:
        """The handler registered last is asked first, unless it is appended."""
        if RECORD.live is None:
            RECORD.handlers.append(event_handler)
        if append:
            self._event_handlers.append(event_handler)
        else:
            self._event_handlers.appendleft(event_handler)

    def unregister_event_handler(self, event_handler: BaseEventHandler) -> None:
        """Ask this handler no more."""
        self._event_handlers.remove(event_handler)

    def event_handlers_matching(self, event: Event) -> list[BaseEventHandler]:
        """Handlers of an event, in the order in which they are asked."""
        return [handler for handler in tuple(self._event_handlers) if handler.matches(event)]

    def emit_event_sync(self, event: Event) -> None:
        """Let an event happen after what is being done."""
        self.timeline.post(event)

    async def emit_event(self, event: Event) -> None:
        """Same, for coroutines."""
        self.timeline.post(event)

    def shut_down(self, event: Event) -> None:
        """End the launch: what was to come is dropped, then the event happens."""
        if RECORD.live is not None:  # what runs is yet to end
            self.timeline.post(event)
            return
        RECORD.is_cut_short |= not RECORD.is_ending
        self.is_shutdown = RECORD.is_ending = True
        self.timeline.clear()
        self.timeline.post(event)

    def add_completion_future(self, completion_future: object) -> None:
        """Nothing waits for futures here."""

    def _push_locals(self) -> None:
        self._locals_stack.append(dict(self._locals))

    def _pop_locals(self) -> None:
        if not self._locals_stack:
            raise RuntimeError("locals stack unexpectedly empty")
        self._locals = self._locals_stack.pop()

    def _push_launch_configurations(self) -> None:
        self._configurations_stack.append(self.launch_configurations.copy_unread())

    def _resume_launch_configurations(self, configurations: _Configurations) -> None:
        """Begin a scope with the configurations of another moment."""
        self._configurations_stack.append(self.launch_configurations)
        self.launch_configurations = configurations

    def _pop_launch_configurations(self) -> None:
        if not self._configurations_stack:
            raise RuntimeError("launch_configurations stack unexpectedly empty")
        self.launch_configurations = self._configurations_stack.pop()

    def _push_environment(self) -> None:
        self._environment_stack.append(copy_environment())

    def _pop_environment(self) -> None:
        if not self._environment_stack:
            raise RuntimeError("environment stack unexpectedly empty")
        self._replace_environment(self._environment_stack.pop())

    def _reset_environment(self) -> None:
        self._replace_environment(self._environment_at_start)

    @staticmethod
    def _replace_environment(variables: Mapping[str, str]) -> None:
        set_environment(variables)


def local_of(name: str) -> str:
    """The local that holds the value of a loop's variable."""
    return f"for_each_{name}"
