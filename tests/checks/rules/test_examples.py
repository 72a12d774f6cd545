"""The documentation of the rules holds: a bad example is reported, and a good one is silent.

Each example that is code is planted into a sound package, and the package is checked.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from planted_examples import NOT_PLANTED, PLANTS, TABLES
from planted_packages import check_all, complete, write
from wsgen.checks.rules.catalogue import all_rules
from wsgen.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from pathlib import Path

BY_CODE = {rule.code: rule for rule in all_rules()}
# What a folder that is not installed lacks is reported of that folder.
OF_FOLDERS = {"LCH005", "SPN012", "WLD001"}
SERIOUS = {Severity.ERROR, Severity.WARNING}


def test_each_rule_is_planted_or_it_says_why_not() -> None:
    planted = [code for table in TABLES for code in table]
    not_planted = [code for codes in NOT_PLANTED.values() for code in codes]
    listed = [*planted, *not_planted]
    left = sorted(BY_CODE.keys() - listed)
    assert not left, f"Plant the examples of {left} in tests/planted_examples.py, or say why not."
    assert sorted(listed) == sorted(BY_CODE), "tests/planted_examples.py names a rule twice."


@pytest.mark.slow
def test_bad_examples_are_reported_and_good_ones_are_silent(tmp_path: Path) -> None:
    found: dict[str, list[Diagnostic]] = {}
    for distro in sorted({plant.distro for plant in PLANTS.values()}):
        folder = tmp_path / distro
        for code, plant in PLANTS.items():
            if plant.distro == distro:
                rule = BY_CODE[code]
                bad = complete(plant.plant(rule.example), distro)
                write(folder, f"bad_{code.lower()}", bad)
                if plant.is_good_code:
                    good = complete(plant.plant(rule.instead, is_good=True), distro)
                    write(folder, f"good_{code.lower()}", good)
        found |= check_all(folder, distro)
    wrong = []
    for code, plant in PLANTS.items():
        reported = found.get(f"bad_{code.lower()}", [])
        is_folded = code in OF_FOLDERS and any(
            one.code == "BLD054" and one.severity is Severity.ERROR for one in reported
        )
        if not is_folded and code not in {one.code for one in reported}:
            wrong.append(f"{code} is not reported of its example, but {_shown(reported)}")
        serious = [one for one in found.get(f"good_{code.lower()}", []) if one.severity in SERIOUS]
        if plant.is_good_code and serious:
            wrong.append(f"{code}: {_shown(serious)} of what to use instead")
    assert not wrong, "\n".join(wrong)


def _shown(found: list[Diagnostic]) -> str:
    return "; ".join(f"{one.code} {one.line}: {one.message}" for one in found)
