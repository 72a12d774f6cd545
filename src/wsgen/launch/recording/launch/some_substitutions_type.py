"""What is accepted where a text is wanted."""

from __future__ import annotations

from collections.abc import Iterable
from os import PathLike

from launch.substitution import Substitution

SomeSubstitutionsType = str | PathLike[str] | Substitution | Iterable[str | Substitution]
SomeSubstitutionsType_types_tuple = (str, Substitution, Iterable)
