"""What `wsgen check` reports, as services read it."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

import pytest
import yaml

from reporting.test_json_report import documented_keys, keys
from wsgen.checks.rules.robots import NO_VISUAL
from wsgen.cli.check import command
from wsgen.cli.check_output import render_report, render_statistics, render_summary
from wsgen.cli.output import render_diagnostics
from wsgen.descriptions.urdf.joints import UNNORMALIZED_AXIS
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.model.robot import Robot
from wsgen.pipeline.check import CheckOutcome
from wsgen.pipeline.reported import Reported
from wsgen.reporting.check_formats import (
    Places,
    render_github,
    render_json,
    render_junit,
    render_sarif,
)

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic

ROOT = Path(__file__).parents[2]
ROBOT = """<robot name="r" version="2.0">
  <link name="base"/><link name="arm"/>
\t<joint name="j" type="continuous"><parent link="base"/><child link="arm"/>
    <axis xyz="0 0 2"/>
  </joint>
</robot>
"""


@pytest.fixture
def found(tmp_path: Path) -> tuple[Diagnostic, ...]:
    """An error and a warning in a file, and a note about nothing in particular."""
    file = tmp_path / "my robots" / "r.urdf"
    file.parent.mkdir()
    file.write_text(ROBOT)
    robot, reported = read_urdf(file.read_bytes(), file=file)
    assert isinstance(robot, Robot) or robot is None
    assert [one.line for one in reported] == [1, 4]
    return (*reported, NO_VISUAL.at(None, message="100 %, `a`: b", hint="One\ntwo."))


def test_json_has_the_documented_keys(found: tuple[Diagnostic, ...]) -> None:
    outcome = CheckOutcome(packages=("p",), files=(Path("f"),), seconds=1.0)
    document = json.loads(render_json(outcome, Reported(diagnostics=found), Places()))
    assert documented_keys("wsgen check") == keys(document)
    assert document["passed"] is False
    axis = document["diagnostics"][1]
    assert (axis["line"], axis["column"], axis["end_column"]) == (4, 5, 24)
    assert axis["fixable"] is True
    assert document["diagnostics"][2]["column"] is None


def test_sarif_has_what_its_schema_requires(found: tuple[Diagnostic, ...], tmp_path: Path) -> None:
    document = json.loads(render_sarif(found, Places(), tmp_path))
    assert document["version"] == "2.1.0"
    (run,) = document["runs"]
    rules = run["tool"]["driver"]["rules"]
    assert run["tool"]["driver"]["name"] == "wsgen"
    assert [rule["id"] for rule in rules] == sorted({one.code for one in found})
    for rule in rules:
        assert rule["shortDescription"]["text"]
        assert rule["fullDescription"]["text"]
        assert rule["defaultConfiguration"]["level"] in {"error", "warning", "note"}
    for one, result in zip(found, run["results"], strict=True):
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"] == one.code
        assert result["level"] in {"error", "warning", "note"}
        assert one.message in result["message"]["text"]
        assert len(set(result["partialFingerprints"].values())) == 1
    physical = run["results"][1]["locations"][0]["physicalLocation"]
    assert physical["artifactLocation"] == {"uri": "my%20robots/r.urdf", "uriBaseId": "SRCROOT"}
    assert physical["region"] == {"startLine": 4, "startColumn": 5, "endColumn": 24}
    assert "locations" not in run["results"][2]
    assert run["originalUriBaseIds"]["SRCROOT"]["uri"] == f"{tmp_path.as_uri()}/"
    elsewhere = json.loads(render_sarif(found, Places(), tmp_path / "other"))
    place = elsewhere["runs"][0]["results"][0]["locations"][0]["physicalLocation"]
    assert place["artifactLocation"]["uri"].startswith("file:///")


def test_the_fingerprint_does_not_depend_on_lines(tmp_path: Path) -> None:
    prints = []
    for line in (3, 4):
        one = UNNORMALIZED_AXIS.at(tmp_path / "r.urdf", line, "axis", message="2")
        (result,) = json.loads(render_sarif([one], Places(), tmp_path))["runs"][0]["results"]
        prints.append(result["partialFingerprints"])
    assert prints[0] == prints[1]


def test_github_gets_a_command_a_line(found: tuple[Diagnostic, ...], tmp_path: Path) -> None:
    lines = list(render_github(found, Places(), tmp_path))
    assert len(lines) == 2
    assert lines[1].startswith(
        "::warning title=ROB019 unnormalized-axis,file=my robots/r.urdf,line=4,col=5,endColumn=24::"
    )
    verbose = list(render_github(found, Places(), tmp_path, verbose=True))
    assert verbose[2] == "::notice title=ROB054 no-visual::100 %25, `a`: b%0AOne two."
    comma = UNNORMALIZED_AXIS.at(Path("a,b:c"), message="m")
    (line,) = render_github([comma], Places(), tmp_path)
    assert "file=a%2Cb%3Ac::m" in line


def test_junit(found: tuple[Diagnostic, ...], tmp_path: Path) -> None:
    text = render_junit(found, ["p"], tmp_path, seconds=1.5)
    suite = ET.fromstring(text)[0]
    assert suite.attrib | {"tests": "4", "failures": "1"} == suite.attrib
    cases = list(suite)
    assert [len(case) for case in cases] == [0, 1, 1, 1]
    assert [case[0].tag for case in cases[1:]] == ["failure", "system-out", "system-out"]
    assert cases[2].get("line") == "4"
    strict = ET.fromstring(render_junit(found, ["p"], tmp_path, seconds=1.5, is_strict=True))
    assert strict.get("failures") == "2"
    bell = NO_VISUAL.at(None, message="a\x07<b>\n")
    assert "a\u2407&lt;b&gt;" in render_junit([bell], [], tmp_path, seconds=0)


def test_text(found: tuple[Diagnostic, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    assert found[0].file is not None
    monkeypatch.chdir(found[0].file.parent)
    lines = list(render_report(Reported(diagnostics=found), Places()))
    assert len(lines) == 4
    assert lines[2] == (
        "\x1b[1mr.urdf:4:5\x1b[0m: \x1b[33mwarning[ROB019]\x1b[0m unnormalized-axis: "
        "The axis has length 2, not 1."
    )
    assert lines[3].startswith("   try: ")
    quiet = list(render_report(Reported(diagnostics=found), Places(), quiet=True, verbose=True))
    assert len(quiet) == 3
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    on_terminal = list(render_report(Reported(diagnostics=found), Places()))
    assert re.sub(r"\x1b\[\d*m", "", "\n".join(on_terminal[5:7])) == (
        '    4 | <axis xyz="0 0 2"/>\n        ^^^^^^^^^^^^^^^^^^^'
    )


def test_what_is_alike_is_summed_up_unless_verbose() -> None:
    many = [
        UNNORMALIZED_AXIS.at(Path("r.urdf"), line, message=f"`j{line}` is bad") for line in range(5)
    ]
    assert len(list(render_report(Reported(diagnostics=tuple(many)), Places()))) == 1
    all_of_them = render_report(Reported(diagnostics=tuple(many)), Places(), verbose=True)
    assert len(list(all_of_them)) == 5


def test_the_problem_matcher_reads_the_text(
    found: tuple[Diagnostic, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    file = ROOT / ".github" / "wsgen-problem-matcher.json"
    (pattern,) = json.loads(file.read_text())["problemMatcher"][0]["pattern"]
    lines = [
        re.sub(r"\x1b\[\d*m", "", line)
        for line in render_report(Reported(diagnostics=found), Places())
    ]
    matches = [match for line in lines if (match := re.search(pattern["regexp"], line))]
    assert [match[pattern["line"]] for match in matches] == ["1", "4"]
    assert matches[1][pattern["file"]] == "my robots/r.urdf"
    assert matches[1][pattern["code"]] == "ROB019"
    assert matches[1][pattern["severity"]] == "warning"


def test_statistics_and_summary(found: tuple[Diagnostic, ...]) -> None:
    reported = Reported(diagnostics=(*found, found[1]), allowed=found[:1], known=found[1:2])
    lines = render_statistics(reported, quiet=True)
    assert lines[0].split() == ["2", "warning", "ROB019", "unnormalized-axis"]
    outcome = CheckOutcome(packages=("p", "q"), files=(Path("f"),))
    lines = render_summary(outcome, reported, fixable=1)
    assert lines[0] == (
        "2 packages and 1 file checked: 1 error, 2 warnings, 1 note. "
        "Not counted: 1 allowed, 1 in the baseline."
    )
    assert lines[1] == "1 diagnostic can be fixed: add --fix, or --diff first."
    clean = render_summary(CheckOutcome(packages=("p",)), Reported(diagnostics=()), fixed=2)
    assert clean == ["Fixed 2 diagnostics.", "1 package checked: no errors."]


def test_the_hooks_for_pre_commit() -> None:
    hooks = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text())
    assert [hook["id"] for hook in hooks] == ["wsgen-check", "wsgen-fix"]
    for hook in hooks:
        program, name, *words = hook["entry"].split()
        assert (program, name) == ("wsgen", "check")
        assert command.make_context(name, words)
        assert hook["pass_filenames"] is False
        assert hook["id"] in (ROOT / "docs" / "check.md").read_text()


def test_a_number_in_a_hint_is_not_what_is_meant(tmp_path: Path) -> None:
    file = tmp_path / "r.urdf"
    file.write_text('<robot name="r">\n  <axis xyz="0 0 1"/>\n</robot>\n')
    place = Places().find(
        NO_VISUAL.at(file, 2, "joint[@name='j']/limit", message="No limit.", hint='Add upper="1".')
    )
    assert place is not None
    assert (place.column, place.end_column) == (3, 22)


HOSTILE = "\x1b]0;title\x07\u202eRTL\r\n::error::\x9b31m"


def test_no_format_has_characters_that_steer_a_terminal_or_begin_a_line(tmp_path: Path) -> None:
    file = tmp_path / HOSTILE
    found = UNNORMALIZED_AXIS.at(file, 1, element=HOSTILE, message=HOSTILE, hint=HOSTILE)
    assert found.message == found.hint == "␛]0;title␇�RTL␍ ::error::�31m"
    places = Places()
    reported = Reported(diagnostics=(found,))
    texts = (
        *render_github([found], places, tmp_path),
        render_junit([found], [HOSTILE], tmp_path, seconds=0.0),
        render_sarif([found], places, tmp_path),
        *render_report(reported, places),
        *render_diagnostics([found]),
    )
    for text in texts:
        assert not re.search(
            "[\x00-\x08\x0b-\x1f\x7f-\x9f\u202e]", re.sub(r"\x1b\[\d+m", "", text)
        ), text
        assert not re.search("^ *::error", text, re.MULTILINE), text


def test_a_message_has_an_end() -> None:
    found = NO_VISUAL.at(None, message="a" * 100_000)
    assert found.message == "a" * 4000 + "... (100,000 characters)"
