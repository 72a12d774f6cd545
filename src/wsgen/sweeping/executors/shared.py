"""Arguments that many calls have in common: they are sent once to whoever computes these calls."""

from __future__ import annotations

import hashlib
import pickle
from collections.abc import Mapping
from dataclasses import fields
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable


@dataclass(frozen=True)
class Shared:
    """An argument of many calls, by its content; a function that is called gets the value."""

    key: str  # of the content
    pickled: bytes
    files: tuple[str, ...] = ()  # absolute paths of files that the value names
    # Where these files are instead; what a call answers names them as the value does.
    moved: Mapping[str, str] | None = None


@dataclass(frozen=True)
class Reference:
    """What stands for a shared argument that a child has."""

    key: str


def share(value: Any, files: Iterable[str] = ()) -> Shared:
    """Make an argument that is sent once to each child or worker; it is pickled now.

    `files` are paths of files that the value names, as it names them; other machines get copies.
    """
    pickled = pickle.dumps(value, pickle.HIGHEST_PROTOCOL)
    return Shared(hashlib.sha256(pickled).hexdigest(), pickled, tuple(dict.fromkeys(files)))


def relocated(value: Any, moved: Mapping[str, str]) -> Any:
    """A value of dataclasses, sequences and mappings with other paths where it names these."""
    if isinstance(value, PurePath):
        return type(value)(moved[str(value)]) if str(value) in moved else value
    if isinstance(value, tuple | list):
        parts = [relocated(part, moved) for part in value]
        if all(new is old for new, old in zip(parts, value, strict=True)):
            return value
        return type(value)(*parts) if hasattr(value, "_fields") else type(value)(parts)
    if isinstance(value, Mapping):
        return {key: relocated(part, moved) for key, part in value.items()}
    if hasattr(value, "__dataclass_fields__"):
        return _relocated_fields(value, moved)
    return moved.get(value, value) if type(value) is str else value


def _relocated_fields(value: Any, moved: Mapping[str, str]) -> Any:
    before = {field.name: getattr(value, field.name) for field in fields(value) if field.init}
    after = {name: relocated(part, moved) for name, part in before.items()}
    if all(after[name] is before[name] for name in before):
        return value
    return type(value)(**after)


def named_as_before(answer: Any, moved: Mapping[str, str]) -> Any:
    """An answer as JSON has it, with texts that name files by the paths that they were moved from.

    The values of `moved` are the paths where they are.
    """
    if isinstance(answer, str):
        for old, new in moved.items():
            answer = answer.replace(new, old)
        return answer
    if isinstance(answer, list):
        return [named_as_before(part, moved) for part in answer]
    if isinstance(answer, dict):
        return {key: named_as_before(part, moved) for key, part in answer.items()}
    return answer
