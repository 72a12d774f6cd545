"""The value of a Python expression."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from launch.substitution import Substitution
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions
from wsgen.launch.record import RECORD

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType


class PythonExpression(Substitution):
    """An expression that sees the given modules, and the names of `math` without its prefix."""

    def __init__(
        self,
        expression: SomeSubstitutionsType,
        python_modules: Iterable[SomeSubstitutionsType] = ("math",),
    ) -> None:
        self.__expression = normalize_to_list_of_substitutions(expression)
        self.__modules = [normalize_to_list_of_substitutions(name) for name in python_modules]

    @property
    def expression(self) -> list[Substitution]:
        """The expression."""
        return self.__expression

    def describe(self) -> str:
        """Itself in words."""
        return f"PythonExpr({' + '.join(sub.describe() for sub in self.__expression)})"

    def perform(self, context: LaunchContext) -> str:
        """What the expression gives, as `str` writes it."""
        names: dict[str, Any] = {}
        for module_name in self.__modules:
            name = perform_substitutions(context, module_name)
            module = importlib.import_module(name)
            if name == "math":
                names.update(vars(module))
            names[name] = module
        expression = perform_substitutions(context, self.__expression)
        if RECORD.is_unknown(expression):
            return RECORD.note_unknown(expression, "a part of it is not known", self.wsgen_location)
        # A launch file is a program already, and its expressions are part of it.
        return str(eval(expression, {}, names))  # noqa: S307  see above
