"""Warnings that a package allows."""

from pathlib import Path

from wsgen.checks.rules.catalogue import unknown_rule_allowed, without_allowed
from wsgen.checks.rules.robots import MASSLESS_ROOT, NO_VISUAL
from wsgen.checks.rules.runs import FALLS_WITHOUT_END

ROOT = MASSLESS_ROOT.at(None, message="massless")
INVISIBLE = NO_VISUAL.at(None, message="invisible")
FALLING = FALLS_WITHOUT_END.at(None, message="falls")


def test_an_allowed_warning_is_silent() -> None:
    assert without_allowed([ROOT, INVISIBLE], ["massless-root"]) == (INVISIBLE,)
    assert without_allowed([ROOT, INVISIBLE], ["ROB054"]) == (ROOT,)


def test_an_error_cannot_be_allowed() -> None:
    assert without_allowed([FALLING], ["falls-without-end"]) == (FALLING,)


def test_what_is_not_allowed_stays() -> None:
    assert without_allowed([ROOT], ["ros-1-plugin"]) == (ROOT,)


def test_a_misspelled_name_is_reported_with_the_nearest() -> None:
    (found,) = unknown_rule_allowed(["masless-root"], Path("wsgen.toml"), 3)
    assert (found.code, found.line) == ("PKG061", 3)
    assert "massless-root" in (found.hint or "")
    assert list(unknown_rule_allowed(["massless-root", "ROB051"], Path("wsgen.toml"))) == []
    assert len(list(unknown_rule_allowed(["Massless-Root"], Path("wsgen.toml")))) == 1
