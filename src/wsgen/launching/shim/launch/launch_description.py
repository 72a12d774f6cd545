"""A launch description, where it comes from, and how it is played."""

from __future__ import annotations

import os
from collections.abc import Iterable
from functools import partial
from typing import TYPE_CHECKING, Any

from launch._utilities import normalize_to_list_of_substitutions, perform_substitutions
from launch.base import LaunchDescriptionEntity
from launch.launch_context import LaunchContext
from wsgen.launching import known_packages
from wsgen.launching.record import RECORD, caller, locate

if TYPE_CHECKING:
    from collections.abc import Callable

    from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
    from launch.base import Event, SomeSubstitutionsType, Substitution
    from wsgen.launching.known_packages import LaunchFileShim

    Declared = tuple[DeclareLaunchArgument, tuple[IncludeLaunchDescription, ...]]


class LaunchDescription(LaunchDescriptionEntity):
    """What a launch file gives."""

    def __init__(
        self,
        initial_list_of_entities: Iterable[LaunchDescriptionEntity] | None = None,
        *,
        deprecated_reason: str | None = None,
    ) -> None:
        self.entities = [] if initial_list_of_entities is None else list(initial_list_of_entities)
        self.deprecated_reason = deprecated_reason

    @property
    def deprecated(self) -> bool:
        """Whether a reason was given not to use it any more."""
        return self.deprecated_reason is not None

    def visit(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Give the entities."""
        del context
        return self.entities

    def describe_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """The entities."""
        return self.entities

    def add_entity(self, entity: LaunchDescriptionEntity) -> None:
        """Append an entity."""
        self.entities.append(entity)

    def add_action(self, action: LaunchDescriptionEntity) -> None:
        """Append an action."""
        self.add_entity(action)

    def get_launch_arguments(
        self,
        conditional_inclusion: bool = False,  # noqa: FBT001, FBT002  as the original
    ) -> list[DeclareLaunchArgument]:
        """The arguments that it and what it includes declare, each name once."""
        return [
            argument
            for argument, _ in self.get_launch_arguments_with_include_launch_description_actions(
                conditional_inclusion
            )
        ]

    def get_launch_arguments_with_include_launch_description_actions(
        self,
        conditional_inclusion: bool = False,  # noqa: FBT001, FBT002  as the original
    ) -> list[Declared]:
        """The declared arguments, each with the includes that lie between."""
        return list(_Declarations().find(self.entities, (), conditional_inclusion).values())


class _Declarations:
    """Finds the arguments that entities, and those inside of them, declare."""

    def __init__(self) -> None:
        from launch.actions import (  # once for all entities: it takes as long as one of them
            DeclareLaunchArgument,
            IncludeLaunchDescription,
            ResetLaunchConfigurations,
        )

        self._declares = DeclareLaunchArgument
        self._includes = IncludeLaunchDescription
        self._resets = ResetLaunchConfigurations
        self._found: dict[str, Declared] = {}  # the first of each name

    def find(
        self,
        entities: Iterable[LaunchDescriptionEntity],
        includes: tuple[IncludeLaunchDescription, ...],
        conditional: bool,  # noqa: FBT001  handed through
    ) -> dict[str, Declared]:
        """Those of the entities too; all by name."""
        for entity in entities:
            if isinstance(entity, self._declares):
                entity.conditionally_included = entity.conditionally_included or conditional
                self._found.setdefault(entity.name, (entity, includes))
                if type(entity) is self._declares:
                    continue  # nothing is in it
            if isinstance(entity, self._resets):
                break
            path = (*includes, entity) if isinstance(entity, self._includes) else includes
            self.find(entity.describe_sub_entities(), path, conditional)
            for _, group in entity.describe_conditional_sub_entities():
                self.find(group, path, conditional=True)
        return self._found


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
        self.method = method
        if launch_description is None:
            RECORD.argument_use.not_run.add(self)

    def try_get_launch_description_without_context(self) -> LaunchDescription | None:
        """The description, where finding it takes no configuration of the launch."""
        if self.__launch_description is None:
            try:
                self.__launch_description = self._load(
                    perform_substitutions(LaunchContext(), self.__location)
                )
            except Exception:  # noqa: BLE001  foreign code; reported when it is really included
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

    def _load(self, location: str) -> LaunchDescription:
        RECORD.argument_use.not_run.discard(self)
        shim = known_packages.shim_of(os.path.normpath(location))
        if shim is not None:
            RECORD.argument_use.is_unknown |= not shim.has_known_arguments
            return _shim_description(shim)
        if RECORD.is_unknown(location):
            RECORD.argument_use.is_unknown = True
            return LaunchDescription()
        return self._get_launch_description(location)

    def _get_launch_description(self, location: str) -> LaunchDescription:
        """The description that a file gives."""
        raise NotImplementedError(location)


def _shim_description(shim: LaunchFileShim) -> LaunchDescription:
    """What is known of a launch file whose package is not installed: its arguments."""
    from launch.actions import DeclareLaunchArgument

    defaults = shim.arguments(os.environ.get("ROS_DISTRO", ""))
    RECORD.made_at = (caller(),)  # the same for all
    try:
        return LaunchDescription(
            [DeclareLaunchArgument(name, default_value=value) for name, value in defaults.items()]
        )
    finally:
        RECORD.made_at = None


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
        self.context = LaunchContext(argv=argv, noninteractive=noninteractive)
        self.__descriptions: list[LaunchDescription] = []

    def include_launch_description(self, launch_description: LaunchDescription) -> None:
        """Play the description too."""
        self.__descriptions.append(launch_description)

    def emit_event(self, event: Event) -> None:
        """Let the event happen."""
        self.context.emit_event_sync(event)

    def shutdown(self, force_sync: bool = False) -> None:  # noqa: FBT001, FBT002  as the original
        """It has come to its end already."""

    def run(self, *, shutdown_when_idle: bool = True) -> int:
        """Play them; the exit code of a launch that went well."""
        del shutdown_when_idle
        descriptions, self.__descriptions = self.__descriptions, []
        play(LaunchDescription(descriptions), self.context)
        return 0

    async def run_async(self, *, shutdown_when_idle: bool = True) -> int:
        """Same, for coroutines."""
        return self.run(shutdown_when_idle=shutdown_when_idle)


def play(entity: LaunchDescriptionEntity, context: LaunchContext) -> None:
    """Visit the entity and everything that events, timers and exits bring about."""
    visit(entity, context)
    play_on(context)


def play_on(context: LaunchContext) -> None:
    """Let all events happen that are to come, and what they bring about."""
    while (event := context.timeline.next()) is not None:
        _handle(event, context)


def visit(entity: LaunchDescriptionEntity, context: LaunchContext) -> None:
    """Visit an entity and, depth first, what comes of it."""
    location = getattr(entity, "wsgen_location", None)
    RECORD.visited = location or RECORD.visited
    try:
        following = entity.visit(context)
        if following is not None:
            for sub_entity in following:
                visit(sub_entity, context)
    except Exception as error:
        locate(error, location)
        if not RECORD.ends_branch(error):
            raise
        entity.wsgen_give_up(context)


def _handle(event: Event, context: LaunchContext) -> None:
    handlers = context.event_handlers_matching(event)
    _within_locals(event.wsgen_happen, event, context)
    for handler in handlers:
        try:
            _within_locals(partial(handler.handle, event), event, context)
        except Exception as error:  # noqa: PERF203  says which handler it was
            locate(error, getattr(handler, "wsgen_location", None))
            if not RECORD.ends_branch(error):
                raise


def _within_locals(
    give_entities: Callable[[LaunchContext], Any], event: Event, context: LaunchContext
) -> None:
    """Visit what the function gives; locals that are set meanwhile end with it."""
    context._push_locals()  # noqa: SLF001  the launch service is a friend of the context
    context.extend_locals({"event": event})
    try:
        entities = give_entities(context)
        if entities is not None:
            for entity in entities if isinstance(entities, Iterable) else [entities]:
                visit(entity, context)
    finally:
        context._pop_locals()  # noqa: SLF001  same
