"""The plan is what the real launch does, case by case."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from conformance import (
    CASES,
    CONFORMANCE,
    NOT_YET,
    REFUSALS,
    answers,
    evaluate_case,
    lines,
    merged,
    packages_of_cases,
)
from wsgen.diagnostics import Severity

if TYPE_CHECKING:
    from install_space import InstallSpace


@pytest.fixture
def packages(space: InstallSpace) -> InstallSpace:
    return packages_of_cases(space)


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in answers() if name not in NOT_YET])
def test_the_plan_is_the_real_one(name: str, packages: InstallSpace) -> None:
    # The cases lay in a folder of this name when they were recorded.
    answer = [merged(line.replace('"micro"', f'"{CASES.name}"')) for line in answers()[name]]
    plan = evaluate_case(packages, name)
    errors = [one for one in plan.diagnostics if one.severity is Severity.ERROR]
    assert lines(plan) == [line for line in answer if not line.startswith("ERROR")]
    if any(line.startswith("ERROR") for line in answer):
        (error,) = errors
        assert REFUSALS[name] in error.message
        assert error.file == CASES / f"{name}.launch.py"
    else:
        assert not errors


@pytest.mark.skipif(not CONFORMANCE.is_dir(), reason="the cases are not here")
def test_every_refusal_is_compared() -> None:
    refused = {name for name, answer in answers().items() if any(line[0] == "E" for line in answer)}
    assert refused - set(NOT_YET) == set(REFUSALS)
