"""Helpers that users call too."""

from __future__ import annotations

import inspect
import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from launch._finder import show_public_names
from launch.base import LaunchDescriptionEntity, Substitution, TextSubstitution

if TYPE_CHECKING:
    from launch.base import SomeSubstitutionsType
    from launch.launch_context import LaunchContext


def isclassinstance(obj: Any) -> bool:
    """Whether it is an instance and no class."""
    return not inspect.isclass(obj)


def is_a(obj: Any, entity_type: type) -> bool:
    """Whether it is an instance of the type."""
    return isinstance(obj, entity_type)


def is_a_subclass(obj: Any, entity_type: type) -> bool:
    """Whether it is an instance or a subclass of the type."""
    return isinstance(obj, entity_type) or (inspect.isclass(obj) and issubclass(obj, entity_type))


def ensure_argument_type(
    argument: Any, types: Any, argument_name: str, caller: str | None = None
) -> None:
    """Raise TypeError unless the argument is an instance of one of the types."""
    accepted = list(types) if isinstance(types, Iterable) else [types]
    if any(isinstance(argument, one) for one in accepted):
        return
    who = f"'{caller}' " if caller else ""
    error = TypeError(
        f"{who}expected '{argument_name}' to be one of {accepted}, but got '{argument}' "
        f"of type '{type(argument)}'"
    )
    error.wsgen_wrong_type = (argument, accepted, argument_name, caller)  # type: ignore[attr-defined]
    raise error


def normalize_to_list_of_entities(entities: Any) -> list[LaunchDescriptionEntity]:
    """All entities in their order; TypeError for what is none."""
    found: list[LaunchDescriptionEntity] = []
    for entity in entities if isinstance(entities, Iterable) else [entities]:
        if isinstance(entity, LaunchDescriptionEntity):
            found.append(entity)
        elif isinstance(entity, Iterable) and not isinstance(entity, str):
            found.extend(normalize_to_list_of_entities(entity))
        else:
            raise TypeError(
                f"Failed to normalize given item of type '{type(entity)}' to a launch entity."
            )
    return found


def normalize_to_list_of_substitutions(subs: SomeSubstitutionsType) -> list[Substitution]:
    """The substitutions whose texts follow one another without anything in between."""
    if isinstance(subs, (str, os.PathLike, Substitution)):
        return [_normalize(subs)]
    try:
        items = iter(subs)
    except TypeError as error:
        error.wsgen_not_text = (subs,)  # type: ignore[attr-defined]
        raise
    return [_normalize(item) for item in items]


def _normalize(item: Any) -> Substitution:
    if isinstance(item, Substitution):
        return item
    if isinstance(item, (str, os.PathLike)):
        return TextSubstitution(text=os.fspath(item))
    error = TypeError(
        f"Failed to normalize given item of type '{type(item)}', when only 'str' or "
        "'launch.Substitution' were expected."
    )
    error.wsgen_not_text = (item,)  # type: ignore[attr-defined]
    raise error


def perform_substitutions(context: LaunchContext, subs: Iterable[Substitution]) -> str:
    """Their texts in order, joined without anything in between."""
    return "".join([context.perform_substitution(sub) for sub in subs])


show_public_names(__name__)
