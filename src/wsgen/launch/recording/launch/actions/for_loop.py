"""Entities made once for each of several values."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch.actions.opaque_function import OpaqueFunction
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from launch.launch_context import LaunchContext
    from launch.launch_description_entity import LaunchDescriptionEntity
    from launch.some_substitutions_type import SomeSubstitutionsType

MOST_ITERATIONS = 10_000  # more entities than any launch has


class ForEach(Action):
    """Calls a function with each mapping of a text such as `{name: a};{name: b}`."""

    def __init__(
        self,
        input_values: SomeSubstitutionsType,
        *,
        function: Callable[..., Iterable[LaunchDescriptionEntity] | None],
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.__input_values = normalize_to_list_of_substitutions(input_values)
        self.__function = function

    def execute(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Call it for each."""
        import yaml  # see launch.utilities.type_utils

        text = perform_substitutions(context, self.__input_values)
        found: list[LaunchDescriptionEntity] = []
        for part in text.strip().split(";"):
            keywords = yaml.safe_load(part.strip())
            if keywords is not None:
                found.extend(self.__function(**keywords) or ())
        return found


class ForLoop(Action):
    """Calls a function with each number from zero on."""

    def __init__(
        self,
        length: SomeSubstitutionsType,
        *,
        function: Callable[..., Iterable[LaunchDescriptionEntity] | None],
        name: str | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        del name  # only the substitution `index` of XML and YAML asks for it
        self.__length = normalize_to_list_of_substitutions(length)
        self.__function = function

    def execute(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Call it for each."""
        length = int(perform_substitutions(context, self.__length))
        if length > MOST_ITERATIONS:
            raise ValueError(f"a loop of {length} iterations; at most {MOST_ITERATIONS} are made")
        return [entity for i in range(length) for entity in self.__function(i=i) or ()]


class ForEachOfEntities(ForEach):
    """The same from XML or YAML: nested entities, made anew for each."""

    def __init__(
        self, input_values: SomeSubstitutionsType, *, entities: list[Action], **kwargs: Any
    ) -> None:
        super().__init__(
            input_values, function=lambda **values: _with_locals(entities, values), **kwargs
        )


class ForLoopOfEntities(ForLoop):
    """The same from XML or YAML: nested entities, made anew for each."""

    def __init__(
        self, length: SomeSubstitutionsType, *, name: str, entities: list[Action], **kwargs: Any
    ) -> None:
        super().__init__(
            length, function=lambda i: _with_locals(entities, {name: i}), name=name, **kwargs
        )


def local_of(name: str) -> str:
    """The local that holds the value of a loop's variable."""
    return f"for_each_{name}"


def _with_locals(
    entities: list[Action], values: Mapping[str, Any]
) -> list[LaunchDescriptionEntity]:
    """Copies of the entities, between setting the variables and unsetting them."""
    locals_of_loop = {local_of(name): str(value) for name, value in values.items()}

    def begin(context: LaunchContext) -> None:
        context._push_locals()  # noqa: SLF001  a friend of the context
        context.extend_locals(locals_of_loop)

    def end(context: LaunchContext) -> None:
        context._pop_locals()  # noqa: SLF001  same

    return [
        OpaqueFunction(function=begin),
        *copy.deepcopy(entities),
        OpaqueFunction(function=end),
    ]
