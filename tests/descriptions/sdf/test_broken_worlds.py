"""Worlds that are wrong in every way: a clear word each, in little time and memory."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from broken_worlds import CASES
from wsgen.isolation.parent import run
from wsgen.isolation.result import Answered, Limits

if TYPE_CHECKING:
    from pathlib import Path


pytestmark = pytest.mark.slow

LIMITS = Limits(seconds=30, memory=2 * 2**30)


@pytest.mark.parametrize("case", CASES)
def test_a_broken_world(tmp_path: Path, case: str) -> None:
    make, codes, models = CASES[case]
    make(tmp_path)
    outcome = run("broken_worlds:read", str(tmp_path / "w.sdf"), limits=LIMITS)
    assert isinstance(outcome, Answered), outcome
    assert set(outcome.value["codes"]) == codes
    assert outcome.value["count"] <= 10
    assert outcome.value["are_clear"]
    assert outcome.value["models"] == models
    assert outcome.output == ""
