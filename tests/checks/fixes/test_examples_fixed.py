"""The fixes of all bad examples of the rules' documentation, in files of every layout.

After the fix the diagnostic is gone, no other has come, a second fix changes nothing, and only the
lines that must change have changed.
"""

from __future__ import annotations

import difflib
import re
from typing import TYPE_CHECKING

import pytest

from planted_examples import PLANTS
from planted_packages import check_all, complete, write
from wsgen.checks.fixes.plan import FIXERS, plan_fixes, write_fixes
from wsgen.checks.rules.catalogue import all_rules
from wsgen.diagnostics import Severity

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic

RULES = {rule.code: rule for rule in all_rules() if rule.name in FIXERS}
MOST_LINES = 12  # of a file that a fix changes: the largest writes three plugins
ROUNDS = 4  # as many as `wsgen check --fix` needs at most here
SERIOUS = {Severity.ERROR, Severity.WARNING}
IN_XML = (".xml", ".urdf", ".xacro", ".sdf", ".world")
TEXTS = (*IN_XML, ".py", ".txt", ".yaml", ".toml", ".cfg")
# Whose example does not show what is meant.
NOT_FIXED = frozenset(
    (
        *("LCH008", "LCH074", "LCH078", "LCH079", "PKG060", "ROB001", "ROB013", "ROB015", "ROB030"),
        *("ROB031", "ROB032", "ROB102", "ROB106", "ROB111"),
    )
)


def windows(name: str, text: str) -> str:
    """With line ends of Windows, and a byte order mark where programs read one."""
    if name.startswith("scripts/") or not name.endswith(TEXTS):
        return text  # scripts would not start
    mark = "" if name.endswith((".toml", ".cfg", ".yaml")) else "\ufeff"
    return mark + text.replace("\n", "\r\n")


def ragged(name: str, text: str) -> str:
    """With tabs, and no newline at the end."""
    if name.endswith((".yaml", ".cfg")) or not name.endswith(TEXTS):
        return text.rstrip("\n")
    return re.sub(r"(?m)^ +", lambda found: "\t" * -(-len(found[0]) // 4), text).rstrip("\n")


def commented(name: str, text: str) -> str:
    """With a comment at the end."""
    if not name.endswith(TEXTS) or not text.strip():
        return text
    return f"{text}\n<!-- kept ä -->\n" if name.endswith(IN_XML) else f"{text}\n# kept ä\n"


@pytest.mark.slow
@pytest.mark.parametrize("layout", [windows, ragged])
def test_all_fixes_of_all_examples(tmp_path: Path, layout: Callable[[str, str], str]) -> None:
    wrong: list[str] = []
    for distro in sorted({PLANTS[code].distro for code in RULES if code in PLANTS}):
        folder = tmp_path / distro
        for code, plant in PLANTS.items():
            if plant.distro == distro and code in RULES:
                files = complete(plant.plant(RULES[code].example), distro)
                write(
                    folder,
                    f"bad_{code.lower()}",
                    {name: layout(name, commented(name, text)) for name, text in files.items()},
                )
        wrong += _fix_and_compare(folder, distro)
    assert not wrong, "\n".join(wrong)


def _fix_and_compare(folder: Path, distro: str) -> list[str]:
    found = left = check_all(folder, distro)
    wrong = []
    for _ in range(ROUNDS):
        plan = plan_fixes([one for those in left.values() for one in those], [folder])
        if not plan.files:
            break
        wrong += [
            f"{one.file.relative_to(folder)}: {what}"
            for one in plan.files
            for what in _unwanted(one.before, one.after)
        ]
        assert len([*write_fixes(plan)]) == len(plan.files)
        left = check_all(folder, distro)
    else:
        wrong.append(f"{[str(one.file) for one in plan.files]} are fixed again and again")
    for code in RULES.keys() & PLANTS.keys():
        if PLANTS[code].distro == distro:
            name = f"bad_{code.lower()}"
            wrong += _compare(code, found.get(name, []), left.get(name, []))
    return wrong


def _unwanted(before: str, after: str) -> Iterator[str]:
    """What a fix must not do to a text."""
    lines = difflib.ndiff(before.splitlines(True), after.splitlines(True))
    changed = sum(line.startswith(("+", "-")) for line in lines)
    if changed > MOST_LINES:
        yield f"{changed} lines have changed"
    if before.count("kept ä") != after.count("kept ä"):
        yield "a comment is lost"
    if "\r\n" in before and after.count("\n") != after.count("\r\n"):
        yield "mixed line ends"
    if before.endswith("\n") and not after.endswith("\n"):
        yield "the newline at the end is lost"


def _compare(code: str, before: list[Diagnostic], after: list[Diagnostic]) -> Iterator[str]:
    if code not in {one.code for one in before}:
        yield f"{code} is not reported"
    if (code in NOT_FIXED) != (code in {one.code for one in after}):
        yield f"{code}: {_shown(after, code)}"
    new = {one.code for one in after if one.severity in SERIOUS} - {one.code for one in before}
    if new:
        yield f"{code}: new after the fix: {_shown(after, *new)}"


def _shown(found: list[Diagnostic], *codes: str) -> str:
    return "; ".join(
        f"{one.code} {one.line}: {one.message} ({one.hint})" for one in found if one.code in codes
    )
