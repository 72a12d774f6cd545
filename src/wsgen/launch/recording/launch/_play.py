"""Play a launch: visit the description, then let happen what follows from it."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import TYPE_CHECKING, Any

from wsgen.launch.record import locate

if TYPE_CHECKING:
    from collections.abc import Callable

    from launch.event import Event
    from launch.launch_context import LaunchContext
    from launch.launch_description_entity import LaunchDescriptionEntity

# More than any launch needs; a handler that starts what it waits for would go on for ever.
MOST_EVENTS = 20_000


def play(entity: LaunchDescriptionEntity, context: LaunchContext) -> None:
    """Visit the entity and everything that events, timers and exits bring about."""
    visit(entity, context)
    for _ in range(MOST_EVENTS):
        event = context.timeline.next()
        if event is None:
            return
        _handle(event, context)
    raise RuntimeError(f"the launch does not come to an end: more than {MOST_EVENTS} events")


def visit(entity: LaunchDescriptionEntity, context: LaunchContext) -> None:
    """Visit an entity and, depth first, what comes of it."""
    try:
        following = entity.visit(context)
        if following is not None:
            for sub_entity in following:
                visit(sub_entity, context)
    except Exception as error:
        locate(error, getattr(entity, "wsgen_location", None))
        raise


def _handle(event: Event, context: LaunchContext) -> None:
    handlers = context.event_handlers_matching(event)
    _within_locals(event.wsgen_happen, event, context)
    for handler in handlers:
        try:
            _within_locals(partial(handler.handle, event), event, context)
        except Exception as error:  # noqa: PERF203  says which handler it was
            locate(error, getattr(handler, "wsgen_location", None))
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
