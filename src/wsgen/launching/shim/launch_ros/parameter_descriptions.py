"""Parameters of nodes, described."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from launch._utilities import (
    normalize_to_list_of_substitutions,
    normalize_typed_substitution,
    perform_substitutions,
    perform_typed_substitution,
)
from wsgen.launching.record import caller

if TYPE_CHECKING:
    from launch.base import SomeSubstitutionsType
    from launch.launch_context import LaunchContext


class ParameterValue:
    """A value whose type is said."""

    def __init__(self, value: Any, *, value_type: Any = None) -> None:
        self.wsgen_location = caller()
        self.value = normalize_typed_substitution(value, value_type)
        self.value_type = value_type

    def evaluate(self, context: LaunchContext) -> Any:
        """The value."""
        return perform_typed_substitution(context, self.value, self.value_type)


class Parameter:
    """A name and a value."""

    def __init__(self, name: SomeSubstitutionsType, value: Any, *, value_type: Any = None) -> None:
        self.wsgen_location = caller()
        self.__name = normalize_to_list_of_substitutions(name)
        self.__value = ParameterValue(value, value_type=value_type)

    def evaluate(self, context: LaunchContext) -> tuple[str, Any]:
        """The name and the value."""
        return perform_substitutions(context, self.__name), self.__value.evaluate(context)


class ParameterFile:
    """A file of parameters."""

    def __init__(self, param_file: Any, *, allow_substs: Any = False) -> None:
        self.__param_file = normalize_to_list_of_substitutions(param_file)
        self.__allow_substs = normalize_typed_substitution(allow_substs, bool)

    def evaluate(self, context: LaunchContext) -> Path:
        """The path."""
        return Path(perform_substitutions(context, self.__param_file))

    def may_have_substitutions(self, context: LaunchContext) -> bool:
        """Whether `$(...)` in the file is to be performed."""
        return bool(perform_typed_substitution(context, self.__allow_substs, bool))


SomeParameterName = Sequence[Any] | str
SomeParameterValue = Any
SomeParameterFile = str | PathLike[str] | Any
SomeParametersDict = Mapping[Any, Any]
SomeParameters = Sequence[Any]
ParameterName = Sequence[Any]
ParametersDict = dict[Any, Any]
Parameters = Sequence[Any]
EvaluatedParameterValue = Any
EvaluatedParameters = Sequence[Any]


SomeRemapRule = tuple[Any, Any]
SomeRemapRules = Iterable[SomeRemapRule]
RemapRules = Iterable[tuple[Any, Any]]
