"""Helpers that users call too: what `launch.utilities` and its `type_utils` show."""

from __future__ import annotations

import inspect
import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, get_args, get_origin

from launch.base import LaunchDescriptionEntity, Substitution, TextSubstitution
from wsgen.launching.record import RECORD, UnknownText
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from launch.base import SomeSubstitutionsType
    from launch.launch_context import LaunchContext


# What the value of a parameter can be, and lists of it.
SCALAR_TYPES = (int, float, bool, str)


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


def normalize_optional(subs: SomeSubstitutionsType | None) -> list[Substitution] | None:
    """Likewise; None stays None."""
    return None if subs is None else normalize_to_list_of_substitutions(subs)


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
    texts = [
        # Most are plain texts, which cannot fail.
        sub.text if type(sub) is TextSubstitution else context.perform_substitution(sub)
        for sub in subs
    ]
    return RECORD.mark("".join(texts))


def is_substitution(x: Any) -> bool:
    """Whether it is a substitution, or texts and substitutions with at least one of these."""
    if isinstance(x, Substitution):
        return True
    if isinstance(x, (str, dict)) or not isinstance(x, Iterable):
        return False
    items = list(x)
    return all(isinstance(item, (Substitution, str)) for item in items) and any(
        isinstance(item, Substitution) for item in items
    )


def normalize_typed_substitution(value: Any, data_type: Any) -> Any:
    """A value, a list of substitutions, or a list in which each item is one of both."""
    if isinstance(value, UnknownText):
        return value
    if isinstance(value, SCALAR_TYPES):
        if data_type is not None and not isinstance(value, data_type):
            raise TypeError(f"value='{value}' is not an instance of {data_type}")
        return value
    if is_substitution(value):
        return normalize_to_list_of_substitutions(value)
    if not isinstance(value, Iterable):
        raise TypeError(
            "value should be either a scalar, a substitutions, or a mixed list of scalars and "
            f"substitutions. Got `value={value}` of type `{type(value)}`."
        )
    return [_normalize_item(item) for item in value]


def _normalize_item(item: Any) -> Any:
    if is_substitution(item):
        return normalize_to_list_of_substitutions(item)
    if isinstance(item, SCALAR_TYPES):
        return item
    raise TypeError(
        "value must be a scalar, a substitution or a list of these. "
        f"Got `item={item}` of type `{type(item)}`."
    )


def perform_typed_substitution(context: LaunchContext, value: Any, data_type: Any) -> Any:
    """The value of what `normalize_typed_substitution` gave, as the wanted type."""
    if isinstance(value, list) and value and isinstance(value[0], Substitution):
        return read_as(perform_substitutions(context, value), data_type)
    if isinstance(value, list):
        item_type = get_args(data_type)[0] if get_origin(data_type) is list else None
        return [
            read_as(perform_substitutions(context, item), item_type)
            if isinstance(item, list)
            else item
            for item in value
        ]
    return value


# The distributions whose launch has not got what it learned in 2025.
BEFORE_HUMBLE = ("dashing", "eloquent", "foxy", "galactic")
BEFORE_JAZZY = (*BEFORE_HUMBLE, "humble", "iron")
_TRUTHS = {"true": True, "false": False}
_NUMBER = lazy_pattern(r"-?(?:0|[1-9][0-9]*)(\.[0-9]+)?")


def read_plain_yaml(text: str) -> bool | float | None:
    """What YAML reads in a text that is surely a truth value or a number; None for any other."""
    if text in _TRUTHS:
        return _TRUTHS[text]
    number = _NUMBER.fullmatch(text)
    if number is None:
        return None
    return float(text) if number[1] else int(text)


def read_as(text: str, data_type: Any) -> Any:
    """The value that a text stands for; ValueError where it is not of that type.

    An empty text stays one where no type is given, though YAML reads nothing in it.
    """
    if data_type is str or (data_type is None and not text) or RECORD.is_unknown(text):
        return text
    if data_type in {int, float}:
        return data_type(text)
    value = read_plain_yaml(text)
    if value is None:
        import yaml  # takes longer to import than most launch files need altogether

        try:
            value = yaml.safe_load(text)
        except yaml.YAMLError as error:
            raise ValueError(f"Failed to convert '{text}' using yaml rules: {error}") from error
    if data_type is None and (isinstance(value, SCALAR_TYPES) or _is_uniform(value)):
        return value
    if data_type is bool and isinstance(value, bool):
        return value
    if get_origin(data_type) is list and isinstance(value, list):
        (item_type,) = get_args(data_type)
        if all(isinstance(item, item_type) for item in value):
            return value
    raise ValueError(f"Cannot convert value '{text}' to '{data_type}'")


def _is_uniform(value: Any) -> bool:
    return (
        isinstance(value, list)
        and len({type(item) for item in value}) <= 1
        and all(isinstance(item, SCALAR_TYPES) for item in value)
    )
