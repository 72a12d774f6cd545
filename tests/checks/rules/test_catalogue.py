"""The rules that modules define are complete, and the documentation shows them."""

from __future__ import annotations

import ast
import re
from dataclasses import replace
from pathlib import Path

import pytest

from wsgen.checks.fixes.plan import FIXERS
from wsgen.checks.rules.catalogue import (
    FAMILIES,
    MODULES,
    UNKNOWN_RULE_ALLOWED,
    all_rules,
    collect,
    find_rule,
    to_markdown,
)
from wsgen.checks.rules.consequences import CONSEQUENCES
from wsgen.diagnostics import Rule, Severity

ROOT = Path(__file__).parents[3]
SOURCE = ROOT / "src" / "wsgen"
CODE = re.compile(rf"(?:{'|'.join(FAMILIES)})\d{{3}}")
CAUSES = """
# What follows from what

One cause is one diagnostic. Where a diagnostic about the description of a robot explains what its
run shows, the run is not reported again: the diagnostic about the description becomes as severe as
what follows from it, and ends with its message ("In the simulation, ...").

| cause | explains | as errors only |
|---|---|---|
"""
HEAD = """# Rules

Every diagnostic has a code, which other programs can rely on, and the name of its rule. A warning
that is on purpose is silenced by its name in the package's `wsgen.toml`:

```toml
[validate]
allow = ["massless-root"]
```

Errors cannot be allowed. `wsgen rule NAME` shows the documentation of one rule.
"""


@pytest.mark.slow
def test_the_catalogue_knows_every_module_with_rules() -> None:
    defining = {
        ".".join(path.relative_to(SOURCE.parent).with_suffix("").parts)
        for path in SOURCE.rglob("*.py")
        if "Rule(" in (text := path.read_text(encoding="utf-8"))
        for node in ast.parse(text).body
        if isinstance(node, ast.Assign)
        and isinstance(node.value, ast.Call)
        and isinstance(node.value.func, ast.Name)
        and node.value.func.id == "Rule"
    }
    assert set(MODULES) == defining


@pytest.mark.slow
def test_no_code_is_written_anywhere_else() -> None:
    for path in SOURCE.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        if not CODE.search(text):
            continue
        nodes = [*ast.walk(ast.parse(text))]
        of_rules = {
            keyword.value
            for node in nodes
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Rule"
            for keyword in node.keywords
            if keyword.arg == "code"
        }
        for node in nodes:
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                is_code = CODE.fullmatch(node.value) is not None
                assert not is_code or node in of_rules, f"{path}:{node.lineno}"


def test_two_rules_of_one_code_or_name_are_refused() -> None:
    rule = UNKNOWN_RULE_ALLOWED
    assert collect([rule, rule]) == (rule,)
    with pytest.raises(ValueError, match="code of two"):
        collect([rule, replace(rule, name="another")])
    with pytest.raises(ValueError, match="name of two"):
        collect([rule, replace(rule, code="PKG998")])
    with pytest.raises(ValueError, match="not belong to a family"):
        collect([replace(rule, code="XYZ001")])


@pytest.mark.parametrize("rule", all_rules(), ids=lambda rule: rule.code)
def test_every_rule_is_documented(rule: Rule) -> None:
    assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", rule.name)  # reads after "allow"
    for sentence in filter(None, (rule.summary, rule.what, rule.why)):
        assert sentence[0].isupper() or not sentence[0].isalpha() or sentence[0] == "`"
        assert sentence.endswith((".", "`", ")", ":")), sentence
        assert "<" not in re.sub("`[^`]*`", "", sentence), "Markdown hides what looks like HTML"
    assert "\n" not in rule.summary
    assert len(rule.summary) <= 100
    assert rule.why
    assert rule.example.strip()
    assert rule.instead.strip()
    assert rule.example.strip() != rule.instead.strip()


def test_the_severity_is_the_rules_unless_it_says_that_it_varies() -> None:
    rule = UNKNOWN_RULE_ALLOWED
    found = rule.at(Path("wsgen.toml"), 3, "validate.allow", message="No.", hint="Yes.")
    assert (found.code, found.name, found.severity) == (rule.code, rule.name, rule.severity)
    assert (found.file, found.line, found.element) == (Path("wsgen.toml"), 3, "validate.allow")
    with pytest.raises(ValueError, match="always"):
        rule.at(None, message="No.", severity=Severity.ERROR)
    varying = replace(rule, severity_varies="an error on Mondays")
    assert varying.at(None, message="No.", severity=Severity.ERROR).severity is Severity.ERROR


def test_the_documentation_is_written_from_the_rules(*, regenerate: bool) -> None:
    file = ROOT / "docs" / "rules.md"
    text = HEAD
    for family, title in FAMILIES.items():
        listed = [rule for rule in all_rules() if rule.code.startswith(family)]
        rows = [
            f"| [{one.code}](#{_anchor(one)}) | `{one.name}` | {one.summary} |" for one in listed
        ]
        text += "\n".join(
            ["", f"# {title}", "", "| code | name | summary |", "|---|---|---|", *rows, ""]
        )
        text += "".join(f"\n{to_markdown(rule, has_fix=rule.name in FIXERS)}" for rule in listed)
    text += CAUSES + "".join(
        f"| {row.cause} | {' '.join(sorted(row.follows))} | {' '.join(row.errors)} |\n"
        for row in CONSEQUENCES
    )
    if regenerate:
        file.write_text(text, encoding="utf-8")
    assert file.read_text(encoding="utf-8") == text


def _anchor(rule: Rule) -> str:
    """As GitHub makes it of the heading."""
    return f"{rule.name}-{rule.code.lower()}"


@pytest.mark.parametrize("name", ["massless-root", "ros-1-plugin"])
def test_names_that_packages_already_use(name: str) -> None:
    assert find_rule(name) is not None
