"""What is allowed is not reported, and what allows nothing is."""

from __future__ import annotations

from pathlib import Path

from wsgen.checks.rules.catalogue import OF_MACHINE, find_rule, suppress
from wsgen.checks.rules.robots import MASSLESS_ROOT, NO_VISUAL
from wsgen.checks.rules.runs import FALLS_WITHOUT_END
from wsgen.descriptions.urdf.reader import UNKNOWN_URDF_VERSION
from wsgen.diagnostics import has_errors
from wsgen.packages.workspace.settings import Allowance

PACKAGE = Path("/p")
ROBOT = PACKAGE / "urdf" / "r.urdf"
SETTINGS = PACKAGE / "wsgen.toml"
INVISIBLE = NO_VISUAL.at(ROBOT, 3, message="invisible")
REFUSED = UNKNOWN_URDF_VERSION.at(ROBOT, 1, message="refused")


def in_settings(rule: str, reason: str = "why", *patterns: str) -> Allowance:
    return Allowance(rule=rule, reason=reason, file=SETTINGS, line=2, patterns=patterns)


def in_comment(rule: str, line: int, reason: str = "why") -> Allowance:
    return Allowance(rule=rule, reason=reason, file=ROBOT, line=line, lines=(line, line))


def test_a_comment_allows_on_its_line() -> None:
    assert suppress([INVISIBLE], [in_comment("no-visual", 3)]) == ((), (INVISIBLE,))
    assert suppress([INVISIBLE], [in_comment("ROB054", 3)]) == ((), (INVISIBLE,))
    found = suppress([INVISIBLE], [in_comment("no-visual", 4)])
    assert [one.name for one in found.reported] == ["no-visual", "unused-allowance"]


def test_settings_allow_in_the_package_or_in_some_of_its_files() -> None:
    elsewhere = NO_VISUAL.at(Path("/q/r.urdf"), 3, message="m")
    for allowance in (
        in_settings("no-visual"),
        in_settings("no-visual", "why", "urdf/*"),
        in_settings("no-visual", "why", "*.xacro", "r.urdf"),
    ):
        assert suppress([INVISIBLE, elsewhere], [allowance]) == ((elsewhere,), (INVISIBLE,))
    kept = suppress([INVISIBLE], [in_settings("no-visual", "why", "meshes/*")])
    assert [one.name for one in kept.reported] == ["no-visual", "unused-allowance"]


def test_a_package_may_be_given_by_a_link(tmp_path: Path) -> None:
    (tmp_path / "package").mkdir()
    link = tmp_path / "link"
    link.symlink_to(tmp_path / "package")
    found = NO_VISUAL.at(tmp_path / "package" / "r.urdf", 3, message="m")
    settings = Allowance(rule="no-visual", reason="why", file=link / "wsgen.toml", line=2)
    comment = Allowance(rule="no-visual", reason="why", file=link / "r.urdf", line=3, lines=(3, 3))
    for allowance in (settings, comment):
        assert suppress([found], [allowance], read=[link]) == ((), (found,))
    (unused,) = suppress([], [settings], read=[tmp_path / "package"]).reported
    assert unused.name == "unused-allowance"


def test_an_error_can_be_allowed_with_a_reason() -> None:
    assert not has_errors(suppress([REFUSED], [in_settings("unknown-urdf-version")]).reported)


def test_without_a_reason_nothing_is_allowed() -> None:
    for allowance in (in_settings("no-visual", ""), in_comment("no-visual", 3, "")):
        found = suppress([INVISIBLE], [allowance])
        assert [one.name for one in found.reported] == ["no-visual", "allowed-without-reason"]
        assert "REASON" in (found.reported[1].hint or "")


def test_an_unknown_rule_is_reported_with_the_nearest() -> None:
    (found,) = suppress([], [in_comment("no-visul", 3)]).reported
    assert (found.code, found.file, found.line) == ("PKG061", ROBOT, 3)
    assert found.hint == "Did you mean `no-visual`?"


def test_what_was_not_checked_may_be_unused() -> None:
    assert suppress([], [in_comment("no-visual", 3)], read=[PACKAGE / "launch"]).reported == ()
    assert len(suppress([], [in_comment("no-visual", 3)], read=[PACKAGE]).reported) == 1


def test_a_rule_about_simulations_may_be_unused() -> None:
    assert suppress([], [in_settings(FALLS_WITHOUT_END.name)]).reported == ()
    assert suppress([], [in_settings("package-not-found")]).reported == ()
    assert all(find_rule(name) for name in OF_MACHINE)
    assert len(suppress([], [in_settings(MASSLESS_ROOT.name)]).reported) == 1
