"""The catalogue of codes is what the code uses, and what the documentation lists."""

import re
from pathlib import Path

import pytest

from wsgen.rules.catalogue import RULES
from wsgen.rules.causes import CONSEQUENCES

ROOT = Path(__file__).parents[2]
HEAD = """# Findings

Every finding has a code, which other programs can rely on, and a name. A warning that is on
purpose is silenced by its name in the package's `wsgen.toml`:

```toml
[validate]
allow = ["massless-root"]
```

Errors cannot be allowed.

| code | name | what is the case |
|---|---|---|
"""
CAUSES = """
## What follows from what

One cause is one diagnostic. Where a diagnostic about the description of a robot explains what its
run shows, the run is not reported again: the diagnostic about the description becomes as severe as
what follows from it, and ends with its message ("In the simulation, ...").

| cause | explains | as errors only |
|---|---|---|
"""


def test_every_code_in_use_is_listed_and_every_listed_code_is_used() -> None:
    used = {
        code
        for path in (ROOT / "src" / "wsgen").rglob("*.py")
        if path.name != "catalogue.py"
        for code in re.findall(r'"((?:PKG|BLD|ROB|WLD|LCH|SPN|TPL)\d{3})"', path.read_text())
    }
    assert used == {rule.code for rule in RULES}


def test_codes_and_names_are_unique_and_in_order() -> None:
    codes = [rule.code for rule in RULES]
    families = list(dict.fromkeys(code[:3] for code in codes))
    assert codes == sorted(set(codes), key=lambda code: (families.index(code[:3]), code))
    assert len({rule.name for rule in RULES}) == len(RULES)


def test_names_read_after_allow() -> None:
    for rule in RULES:
        assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", rule.name)
        assert rule.summary.endswith(".")


def test_the_documentation_is_written_from_the_catalogue(*, regenerate: bool) -> None:
    rows = "".join(f"| {rule.code} | `{rule.name}` | {rule.summary} |\n" for rule in RULES)
    rows += CAUSES + "".join(
        f"| {row.cause} | {' '.join(sorted(row.follows))} | {' '.join(row.errors)} |\n"
        for row in CONSEQUENCES
    )
    file = ROOT / "docs" / "rules.md"
    if regenerate:
        file.write_text(HEAD + rows, encoding="utf-8")
    assert file.read_text(encoding="utf-8") == HEAD + rows


@pytest.mark.parametrize("name", ["massless-root", "ros-1-plugin"])
def test_names_that_packages_already_use(name: str) -> None:
    assert name in {rule.name for rule in RULES}
