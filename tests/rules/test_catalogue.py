"""The rules that modules define are complete, and the documentation shows them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from wsgen.diagnostics import Severity
from wsgen.rules.allowances import UNKNOWN_RULE_ALLOWED
from wsgen.rules.catalogue import collect, find_rule


def test_two_rules_of_one_code_or_name_are_refused() -> None:
    rule = UNKNOWN_RULE_ALLOWED
    assert collect([rule, rule]) == (rule,)
    with pytest.raises(ValueError, match="code of two"):
        collect([rule, replace(rule, name="another")])
    with pytest.raises(ValueError, match="name of two"):
        collect([rule, replace(rule, code="PKG998")])
    with pytest.raises(ValueError, match="no family"):
        collect([replace(rule, code="XYZ001")])


def test_the_severity_is_the_rules_unless_it_says_that_it_varies() -> None:
    rule = UNKNOWN_RULE_ALLOWED
    found = rule.at(Path("wsgen.toml"), 3, "validate.allow", message="No.", hint="Yes.")
    assert (found.code, found.name, found.severity) == (rule.code, rule.name, rule.severity)
    assert (found.file, found.line, found.element) == (Path("wsgen.toml"), 3, "validate.allow")
    with pytest.raises(ValueError, match="always"):
        rule.at(None, message="No.", severity=Severity.ERROR)
    varying = replace(rule, severity_varies="an error on Mondays")
    assert varying.at(None, message="No.", severity=Severity.ERROR).severity is Severity.ERROR


@pytest.mark.parametrize("name", ["massless-root", "ros-1-plugin"])
def test_names_that_packages_already_use(name: str) -> None:
    assert find_rule(name) is not None
