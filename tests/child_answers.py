"""Answers for what starts child processes in tests, as they come out of a child."""

from __future__ import annotations

import json

from wsgen.isolation.codec import encode
from wsgen.isolation.result import Answered


def answered(value: object) -> Answered:
    """The answer of a child whose function returned this."""
    return Answered(value=json.loads(encode(value)), output="")
