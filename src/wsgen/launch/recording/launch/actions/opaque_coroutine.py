"""A coroutine of the user."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch.event import Event
from wsgen.launch.record import RECORD

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterable, Mapping

    from launch.launch_context import LaunchContext

LONGEST_WAIT = 1.0  # s of real time, for what never comes because nothing runs


class OpaqueCoroutine(Action):
    """Runs after what is being done; it sleeps in virtual time, which is not long."""

    def __init__(
        self,
        *,
        coroutine: Callable[..., Awaitable[Any]],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        ignore_context: bool = False,
        **left_over_kwargs: Any,
    ) -> None:
        super().__init__(**left_over_kwargs)
        import asyncio  # what launch files seldom need

        if not asyncio.iscoroutinefunction(coroutine):
            raise TypeError(
                f"OpaqueCoroutine expected a coroutine function for 'coroutine', got '{coroutine}'"
            )
        self.__coroutine = coroutine
        self.__args = () if args is None else tuple(args)
        self.__kwargs = {} if kwargs is None else dict(kwargs)
        self.__ignore_context = ignore_context

    def execute(self, context: LaunchContext) -> None:
        """Let it run later."""
        context.timeline.post(_Turn(self))

    def run(self, context: LaunchContext) -> None:
        """Run it to its end; what it gives back is nobody's."""
        import asyncio

        first = () if self.__ignore_context else (context,)
        sleep = asyncio.sleep
        asyncio.sleep = lambda _delay, result=None: sleep(0, result)
        try:
            asyncio.run(
                asyncio.wait_for(
                    self.__coroutine(*first, *self.__args, **self.__kwargs), LONGEST_WAIT
                )
            )
        except (asyncio.TimeoutError, TimeoutError):
            RECORD.note_unresolved(
                "OpaqueCoroutine", "it waits for what only a launch brings", self.wsgen_location
            )
        finally:
            asyncio.sleep = sleep

    def _executed(self, context: LaunchContext) -> None:
        """It is complete when it has run."""


class _Turn(Event):
    """It is the coroutine's turn."""

    def __init__(self, action: OpaqueCoroutine) -> None:
        self.action = action

    def wsgen_happen(self, context: LaunchContext) -> None:
        """Run it."""
        self.action.run(context)
        self.action.announce_completion(context)
