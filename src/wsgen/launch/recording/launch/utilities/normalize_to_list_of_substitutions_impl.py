"""Texts and substitutions, alone or in a list, as a list of substitutions."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from launch.substitution import Substitution
from launch.substitutions.text_substitution import TextSubstitution

if TYPE_CHECKING:
    from launch.some_substitutions_type import SomeSubstitutionsType


def normalize_to_list_of_substitutions(subs: SomeSubstitutionsType) -> list[Substitution]:
    """The substitutions whose texts follow one another without anything in between."""
    if isinstance(subs, (str, os.PathLike, Substitution)):
        return [_normalize(subs)]
    return [_normalize(item) for item in subs]


def _normalize(item: Any) -> Substitution:
    if isinstance(item, Substitution):
        return item
    if isinstance(item, (str, os.PathLike)):
        return TextSubstitution(text=os.fspath(item))
    raise TypeError(
        f"Failed to normalize given item of type '{type(item)}', when only 'str' or "
        "'launch.Substitution' were expected."
    )
