"""What runs a launch; here it plays it, as the evaluation itself does."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.launch_context import LaunchContext
from launch.launch_description import LaunchDescription

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.event import Event


class LaunchService:
    """Plays the descriptions it was given when it is run, and comes back at once."""

    def __init__(
        self,
        *,
        argv: Iterable[str] | None = None,
        noninteractive: bool = False,
        debug: bool = False,
    ) -> None:
        del debug
        self.__context = LaunchContext(argv=argv, noninteractive=noninteractive)
        self.__descriptions: list[LaunchDescription] = []

    @property
    def context(self) -> LaunchContext:
        """The state of its launch."""
        return self.__context

    def include_launch_description(self, launch_description: LaunchDescription) -> None:
        """Play the description too."""
        self.__descriptions.append(launch_description)

    def emit_event(self, event: Event) -> None:
        """Let the event happen."""
        self.__context.emit_event_sync(event)

    def shutdown(self, force_sync: bool = False) -> None:  # noqa: FBT001, FBT002  as the original
        """It has come to its end already."""

    def run(self, *, shutdown_when_idle: bool = True) -> int:
        """Play them; the exit code of a launch that went well."""
        from launch._play import play

        del shutdown_when_idle
        descriptions, self.__descriptions = self.__descriptions, []
        play(LaunchDescription(descriptions), self.__context)
        return 0

    async def run_async(self, *, shutdown_when_idle: bool = True) -> int:
        """Same, for coroutines."""
        return self.run(shutdown_when_idle=shutdown_when_idle)
