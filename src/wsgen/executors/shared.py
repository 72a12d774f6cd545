"""Arguments that many calls have in common: they are sent once to whoever computes these calls."""

from __future__ import annotations

import hashlib
import pickle
from typing import Any

from wsgen.values import dataclass


@dataclass(frozen=True)
class Shared:
    """An argument of many calls, by its content; a function that is called gets the value."""

    key: str  # of the content
    pickled: bytes


@dataclass(frozen=True)
class Reference:
    """What stands for a shared argument that a child has."""

    key: str


def share(value: Any) -> Shared:
    """Make an argument that is sent once to each child or worker; it is pickled now."""
    pickled = pickle.dumps(value, pickle.HIGHEST_PROTOCOL)
    return Shared(hashlib.sha256(pickled).hexdigest(), pickled)
