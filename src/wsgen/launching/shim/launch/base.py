"""What all entities, events and substitutions are made from."""

from __future__ import annotations

from collections.abc import Iterable
from os import PathLike
from typing import TYPE_CHECKING, Any

from wsgen.launching.record import RECORD, caller

if TYPE_CHECKING:
    from collections.abc import Callable

    from launch.frontend.parser import Entity
    from launch.launch_context import LaunchContext


class Located:
    """Base of entities and substitutions; also of those that users write."""

    wsgen_location: tuple[str, int] | None

    def __new__(cls, *_arguments: Any, **_keywords: Any) -> Any:
        """Remember the line; in `__new__` because users forget `super().__init__()`."""
        made = object.__new__(cls)
        made.wsgen_location = caller()
        return made


class LaunchDescriptionEntity(Located):
    """Something that is visited: an action or a description."""

    def visit(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Do what it is for, and give what is to be visited next."""
        raise NotImplementedError

    def describe(self) -> str:
        """A line about it."""
        return self.__repr__()

    def describe_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """The entities that a visit certainly gives."""
        return []

    def describe_conditional_sub_entities(
        self,
    ) -> list[tuple[str, Iterable[LaunchDescriptionEntity]]]:
        """The entities that it may give later, each group with its condition in words."""
        return []

    def wsgen_give_up(self, context: LaunchContext) -> None:
        """Leave behind what others rely on, where a visit failed that ends only itself."""

    def get_asyncio_future(self) -> Any:
        """Nothing waits here: time is virtual."""
        return None


class Action(LaunchDescriptionEntity):
    """Base of all actions, also of those that users write."""

    wsgen_is_visited = False

    def __init__(self, *, condition: Condition | None = None) -> None:
        self.__condition = condition

    @property
    def condition(self) -> Condition | None:
        """What decides whether it is executed."""
        return self.__condition

    @classmethod
    def parse(cls, entity: Entity, parser: Any, ignore: Iterable[str] = ()) -> tuple[Any, Any]:
        """Itself and its keywords, from an element of XML or YAML."""
        del parser
        from launch.frontend.actions import keywords_of

        return cls, keywords_of(cls, entity, ignore)

    def describe(self) -> str:
        """Itself in words."""
        return f"Action({self.__repr__()})"

    def get_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """The entities that executing it gives, where they are known before."""
        return []

    def describe_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """What a visit certainly gives."""
        return self.get_sub_entities() if self.condition is None else []

    def describe_conditional_sub_entities(
        self,
    ) -> list[tuple[str, Iterable[LaunchDescriptionEntity]]]:
        """What it gives if its condition holds."""
        if self.condition is None:
            return []
        return [(f"{self.condition.describe()} is True", self.get_sub_entities())]

    def visit(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Execute it if its condition holds, and emit the event that it is complete."""
        self.wsgen_is_visited = True
        if self.__condition is not None and not self.__condition.evaluate(context):
            RECORD.skipped.append(self)
            return None
        try:
            return self.execute(context)
        finally:
            self._executed(context)

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Do it; what comes back is visited next."""

    def _executed(self, context: LaunchContext) -> None:
        """Most actions are complete as soon as they were executed."""
        self.announce_completion(context)

    def announce_completion(self, context: LaunchContext) -> None:
        """Emit the event that the action is complete."""
        if context.has_event_handlers:
            from launch._events import ExecutionComplete

            context.emit_event_sync(ExecutionComplete(action=self))


class Condition(Located):
    """A predicate on the context; its last answer is kept, as in the original."""

    def __init__(self, *, predicate: Callable[[LaunchContext], bool] | None = None) -> None:
        self._predicate = predicate
        self._last: bool | None = None

    def evaluate(self, context: LaunchContext) -> bool:
        """Whether it holds now."""
        if self._predicate is None:
            raise NotImplementedError("a Condition needs a predicate")
        self._last = self._predicate(context)
        return self._last

    def describe(self) -> str:
        """Itself in words."""
        return f"{type(self).__name__}({self._predicate})"


class Event:
    """Base of all events, also of those that users write."""

    name = "launch.Event"
    wsgen_cause: str | None = None  # what to name as the reason for what it starts
    wsgen_is_void = False  # it need not happen any more

    def wsgen_happen(self, context: LaunchContext) -> Any:
        """What the event brings about by itself, before its handlers are asked."""


class BaseEventHandler(Located):
    """Decides which events it handles; with `handle_once` only the first."""

    wsgen_is_handled = False

    def __init__(self, *, matcher: Callable[[Event], bool], handle_once: bool = False) -> None:
        self.__matcher = matcher
        self.handle_once = handle_once

    @property
    def handler_description(self) -> str:
        """What it does, in words."""
        return "<unknown>"

    def matches(self, event: Event) -> bool:
        """Whether it handles this event."""
        return self.__matcher(event)

    def describe(self) -> tuple[str, list[LaunchDescriptionEntity]]:
        """Itself in words, and what it is known to bring about."""
        return type(self).__name__, []

    def handle(self, event: Event, context: LaunchContext) -> Any:
        """Handle the event; what comes back is visited."""
        del event
        self.wsgen_is_handled = True
        if self.handle_once:
            context.unregister_event_handler(self)


class EventHandler(BaseEventHandler):
    """Brings about the entities it was given."""

    def __init__(
        self,
        *,
        matcher: Callable[[Event], bool],
        entities: LaunchDescriptionEntity | Iterable[LaunchDescriptionEntity] | None = None,
        handle_once: bool = False,
    ) -> None:
        super().__init__(matcher=matcher, handle_once=handle_once)
        self.__entities = entities

    @property
    def entities(self) -> Any:
        """What is visited when the event happens."""
        return self.__entities

    def describe(self) -> tuple[str, list[LaunchDescriptionEntity]]:
        """Itself in words, and its entities."""
        text, entities = super().describe()
        if self.__entities is not None:
            entities.extend(
                self.__entities if isinstance(self.__entities, (list, tuple)) else [self.__entities]  # type: ignore[list-item]  # one entity
            )
        return text, entities

    def handle(self, event: Event, context: LaunchContext) -> Any:
        """Give the entities."""
        super().handle(event, context)
        return self.__entities


class Substitution(Located):
    """Base of all substitutions, also of those that users write."""

    def perform(self, context: LaunchContext) -> str:
        """The text, given the state of the launch at this moment."""
        raise NotImplementedError

    def describe(self) -> str:
        """Itself in words."""
        return self.__repr__()

    def __truediv__(self, other: Any) -> Substitution:
        """Path joining, as newer releases allow."""
        from launch.substitutions import PathJoinSubstitution

        return PathJoinSubstitution([self, other])


SomeActionsType = Action | Iterable[Action]
SomeActionsType_types_tuple = (Action, Iterable)


SomeEntitiesType = LaunchDescriptionEntity | Iterable[LaunchDescriptionEntity]
SomeEntitiesType_types_tuple = (LaunchDescriptionEntity, Iterable)


SomeSubstitutionsType = str | PathLike[str] | Substitution | Iterable[str | Substitution]
SomeSubstitutionsType_types_tuple = (str, Substitution, Iterable)


class InvalidLaunchFileError(Exception):
    """Nothing could read the launch file."""


class TextSubstitution(Substitution):
    """Stands for its text."""

    def __init__(self, *, text: str) -> None:
        if not isinstance(text, str):
            raise TypeError(f"TextSubstitution expected Text object got '{type(text)}' instead.")
        self.text = text

    def describe(self) -> str:
        """The text in quotes."""
        return f"'{self.text}'"

    def perform(self, context: LaunchContext) -> str:
        """The text."""
        del context
        return self.text


class SubstitutionFailure(RuntimeError):  # noqa: N818  the name is the original's
    """Performing a substitution failed."""
