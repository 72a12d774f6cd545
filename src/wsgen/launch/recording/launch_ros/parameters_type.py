"""What can be given where parameters are wanted; only for annotations."""

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any

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
