"""What can be given where remappings are wanted; only for annotations."""

from collections.abc import Iterable
from typing import Any

SomeRemapRule = tuple[Any, Any]
SomeRemapRules = Iterable[SomeRemapRule]
RemapRules = Iterable[tuple[Any, Any]]
