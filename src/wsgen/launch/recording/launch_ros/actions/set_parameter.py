"""A parameter for what comes next."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch_ros.utilities.parameters import (
    add_global_parameters,
    evaluate_parameters,
    normalize_parameters,
)

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType


class SetParameter(Action):
    """A parameter of all nodes that come next; their own come after it."""

    def __init__(self, name: SomeSubstitutionsType, value: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        key = tuple(name) if isinstance(name, list) else name
        self.__parameters = normalize_parameters([{key: value}])

    def execute(self, context: LaunchContext) -> None:
        """Add it to those that are set."""
        evaluated = evaluate_parameters(
            context, self.__parameters, node="", location=self.wsgen_location
        )
        add_global_parameters(context, evaluated.items())
