"""What a package has on purpose."""

from pathlib import Path

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.rules.allowances import unknown_rule_allowed, without_allowed

ROOT = Diagnostic(code="ROB051", severity=Severity.WARNING, message="massless")
DROPPED = Diagnostic(code="ROB040", severity=Severity.ERROR, message="dropped")


def test_an_allowed_warning_is_silent() -> None:
    assert without_allowed([ROOT, DROPPED], ["massless-root"]) == (DROPPED,)


def test_an_error_cannot_be_allowed() -> None:
    assert without_allowed([DROPPED], ["dropped-link"]) == (DROPPED,)


def test_what_is_not_allowed_stays() -> None:
    assert without_allowed([ROOT], ["ros-1-plugin"]) == (ROOT,)


def test_a_misspelt_name_is_told_with_its_neighbor() -> None:
    (found,) = unknown_rule_allowed(["masless-root"], Path("wsgen.toml"))
    assert found.code == "PKG061"
    assert "massless-root" in (found.hint or "")
    assert list(unknown_rule_allowed(["massless-root"], Path("wsgen.toml"))) == []
