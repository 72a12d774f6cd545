"""Test cases of a validation, in JUnit XML and in Markdown."""

from __future__ import annotations

import os
import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

import pytest
from hypothesis import given
from hypothesis import strategies as st
from markdown_it import MarkdownIt

from reporting.test_json_report import DIAGNOSTIC, ROBOT, outcome
from wsgen.checks.rules import runs
from wsgen.checks.rules.bodies import IMPLAUSIBLE_DENSITY
from wsgen.checks.rules.consequences import BEHAVES
from wsgen.checks.rules.runs import FALLS_WITHOUT_END, TIPS_OVER
from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.pipeline.check import CheckOutcome
from wsgen.pipeline.reported import Reported
from wsgen.reporting.cases import OF_COMPARISON, OF_RUNS, outcome_suites
from wsgen.reporting.check_formats import Case, Failure, Suite, render_suites
from wsgen.reporting.markdown import BAR, MOST_LISTED, _text, summarize_check, summarize_outcome
from wsgen.text.printable import clean

if TYPE_CHECKING:
    from collections.abc import Iterable

    from wsgen.model.outcome import Outcome

HERE = Path("/ws")

# The schema of Jenkins (junit-10.xsd): the children of each element, and its attributes; those
# with an asterisk are required.
CHILDREN = {
    "testsuites": {"testsuite"},
    "testsuite": {"testsuite", "properties", "testcase", "system-out", "system-err"},
    "properties": {"property"},
    "property": set(),
    "testcase": {"skipped", "error", "failure", "system-out", "system-err"},
    "failure": set(),
    "skipped": set(),
    "system-out": set(),
}
ATTRIBUTES = {
    "testsuites": "name time tests failures errors",
    "testsuite": "name* tests* failures* errors* time skipped timestamp hostname id package file",
    "properties": "",
    "property": "name* value*",
    "testcase": "name* time classname group",
    "failure": "type message",
    "skipped": "type message",
    "system-out": "",
}
TIME = re.compile(r"(([0-9]{0,3},)*[0-9]{3}|[0-9]{0,3})*(\.[0-9]*)?")


def violations(element: ET.Element, *, extra: Iterable[str] = ()) -> list[str]:
    """What the schema does not allow; test cases may have the attributes `extra`, too."""
    names = ATTRIBUTES[element.tag].split()
    allowed = {name.rstrip("*") for name in names}
    allowed |= set(extra) if element.tag == "testcase" else set()
    required = {name.rstrip("*") for name in names if name.endswith("*")}
    found = [f"{element.tag}@{name}" for name in set(element.attrib) - allowed]
    found += [f"{element.tag} without {name}" for name in required - set(element.attrib)]
    if element.tag.startswith("testsuite") and not TIME.fullmatch(element.get("time", "")):
        found.append(f"time {element.get('time')}")
    for child in element:
        if child.tag not in CHILDREN[element.tag]:
            found.append(f"{element.tag}/{child.tag}")
        else:
            found += violations(child, extra=extra)
    return found


def error(rule: Rule, element: str | None = None, **values: object) -> Diagnostic:
    found = rule.at(Path("/ws/src/p/r.urdf"), 7, element, message="It <falls> & `breaks`|")
    return replace(found, severity=Severity.ERROR, hint="Add *legs*.", **values)  # type: ignore[arg-type]


def read(result: Outcome, *, with_files: bool = True) -> ET.Element:
    suites = outcome_suites(result, HERE)
    return ET.fromstring(render_suites("v", suites, seconds=1.5, with_files=with_files))


def cases(result: Outcome) -> dict[str, ET.Element]:
    return {case.get("name", ""): case for case in read(result).iter("testcase")}


FALLEN = replace(
    ROBOT, engines=(replace(ROBOT.engines[0], codes=frozenset({FALLS_WITHOUT_END.code})),)
)


def test_the_report_follows_the_schema_of_jenkins() -> None:
    result = outcome(
        diagnostics=(error(TIPS_OVER, "r"), error(IMPLAUSIBLE_DENSITY), DIAGNOSTIC),
        picture=Path("/ws/p.png"),
        launch_file=HERE / "l.launch.py",
    )
    assert violations(read(result, with_files=False)) == []
    assert violations(read(result), extra={"file", "line"}) == []
    texts = [render_suites("v", [], seconds=0, with_files=one) for one in (True, False)]
    assert ["junit-10.xsd" in text for text in texts] == [True, True]
    assert ["but for the attributes file" in text for text in texts] == [True, False]
    assert "testcase@file" in violations(read(result))


def test_a_case_for_each_check() -> None:
    found = cases(outcome(diagnostics=(error(TIPS_OVER, "r"),), picture=Path("/ws/pictures/p.png")))
    checks = [f"r {check}" for check in OF_RUNS]
    assert list(found) == [
        "launch file",
        "robot descriptions",
        "r is loaded",
        *checks,
        "r does the same in all engines",
        "r: drives (PyBullet)",
        "r: untried (DART)",
        "is validated",
    ]
    failed = [name for name, case in found.items() if case.find("failure") is not None]
    assert failed == ["r does not tip over"]
    tips = found["r does not tip over"]
    assert (tips.get("file"), tips.get("line")) == ("src/p/r.urdf", "7")
    failure = tips.find("failure")
    assert failure is not None
    assert failure.attrib == {"message": "It <falls> & `breaks`|", "type": TIPS_OVER.code}
    assert "src/p/r.urdf:7: error[" in (failure.text or "")
    assert "Add *legs*." in (failure.text or "")
    # GitLab shows the picture beside the failure.
    assert "[[ATTACHMENT|pictures/p.png]]" in (tips.findtext("system-out") or "")
    (skipped,) = [case for case in found.values() if case.find("skipped") is not None][1:]
    assert skipped.get("classname") == "q.wsgen"


def test_every_rule_about_runs_is_in_a_check() -> None:
    rules = {value.code for value in vars(runs).values() if isinstance(value, Rule)}
    rules -= {*BEHAVES}  # each behavior is a case
    checked = [rule.code for of_check in (*OF_RUNS.values(), OF_COMPARISON) for rule in of_check]
    assert sorted(checked) == sorted(rules)


def test_no_error_is_lost() -> None:
    found = tuple(
        replace(
            error(TIPS_OVER, "elsewhere"), code=f"{family}001", name=f"{family}", message=family
        )
        for family in ("PKG", "BLD", "ROB", "WLD", "LCH", "SPN", "TPL")
    )
    texts = [failure.text or "" for failure in read(outcome(diagnostics=found)).iter("failure")]
    for one in found:
        assert sum(f"{one.code}]" in text for text in texts) == 1


def test_what_a_description_explains_fails_too() -> None:
    """The fall is no diagnostic of its own where the description is reported that causes it."""
    found = cases(outcome(robots=(FALLEN,), diagnostics=(error(IMPLAUSIBLE_DENSITY),)))
    failed = [name for name, case in found.items() if case.find("failure") is not None]
    assert failed == ["robot descriptions", "r does not sink or fall"]


def test_a_robot_that_was_not_simulated() -> None:
    robot = replace(ROBOT, engines=(), behaviors=())
    found = cases(outcome(robots=(robot,), diagnostics=(error(IMPLAUSIBLE_DENSITY),)))
    assert found["r is loaded"].find("failure") is not None
    found = cases(outcome(robots=(), diagnostics=()))
    assert found["robots are simulated"].find("failure") is not None


def test_a_run_that_was_interrupted_fails() -> None:
    result = replace(outcome(), is_complete=False)
    assert read(result).get("failures") == "1"
    assert "Interrupted" in summarize_outcome(result, HERE)


def test_names_are_unique() -> None:
    twice = [Case(suite="p", name="c"), Case(suite="p", name="c"), Case(suite="q", name="c")]
    suites = [Suite(name="s", cases=twice), Suite(name="t", cases=twice[:1])]
    # Within a suite: services show suites apart.
    root = ET.fromstring(render_suites("v", suites, seconds=0.0))
    assert [case.get("name") for case in root[0]] == ["c", "c (2)", "c"]


@pytest.mark.slow
@given(st.text(max_size=30))
def test_any_text_is_xml(text: str) -> None:
    failure = Failure(message=text, kind=text, text=text)
    case = Case(suite=text, name=text, file=text, failure=failure, skipped=text, output=text)
    suite = Suite(name=text, cases=[case], properties={"a": text})
    root = ET.fromstring(render_suites(text, [suite], seconds=0.0).encode("utf-8"))
    kept = clean(text)
    (read_failure,) = root.iter("failure")
    assert read_failure.get("message") == kept
    assert (read_failure.text or "") == kept


def test_the_summary_of_a_validation() -> None:
    found = (error(TIPS_OVER, "r"), replace(error(TIPS_OVER, "r"), severity=Severity.WARNING))
    text = summarize_outcome(outcome(diagnostics=found, picture=HERE / "out" / "a|b.png"), HERE)
    lines = text.splitlines()
    assert lines[0] == "## wsgen validate: 0 passed, 1 failed"
    assert lines[4] == (
        "| p | `l.launch.py` | r | **failed**, stands after 0.5 s, 1 of 3 behaviors "
        "| `out/a\\|b.png` |"
    )
    (item,) = [line for line in lines if "Try:" in line][:1]
    assert item == (
        f"- `src/p/r.urdf:7`: **{TIPS_OVER.code}** It &lt;falls&gt; &amp; `breaks`|"
        "<br>Try: Add \\*legs\\*."
    )
    assert text.index("### Errors") < text.index("### Warnings") < text.index("### Not validated")
    assert "- q: spawns no robot" in lines


@pytest.mark.slow
@given(st.text(alphabet="ab `\\*_[]()<>#~$|&!-+.1:@\n", max_size=30))
def test_a_text_in_a_summary_is_no_markup_but_code(text: str) -> None:
    shown = MarkdownIt("gfm-like", {"linkify": False}).parse(f"- **X** {_text(text)}")
    (line,) = [token for token in shown if token.type == "inline"]
    kinds = {"strong_open", "strong_close", "text", "text_special", "code_inline"}
    assert line.children is not None
    assert {token.type for token in line.children} <= kinds
    content = "".join(token.content for token in line.children)
    assert re.sub("[ `]", "", content) == "X" + re.sub("[ `\n]", "", text)
    assert "\\`" not in _text("no `code` ` here")


def test_a_name_in_a_summary_is_no_markup() -> None:
    name = os.fsdecode(b"a``b|`\xff\x1b[31m <b>.urdf")
    found = replace(error(IMPLAUSIBLE_DENSITY), file=HERE / name)
    checked = CheckOutcome(packages=(), files=(HERE / name,), folders={})
    text = summarize_check(checked, Reported(diagnostics=(found,)), HERE)
    code = "``` a``b|`\ufffd\u241b[31m <b>.urdf ```"
    assert f"\n| {code.replace('|', BAR)} | **failed** | 1 | 0 |\n" in text
    assert f"\n- {code.replace(' ```', ':7 ```')}: **" in text
    assert text.encode()


def test_the_summary_of_a_check() -> None:
    inside = error(IMPLAUSIBLE_DENSITY)
    alone = replace(inside, file=HERE / "a.urdf", severity=Severity.WARNING)
    checked = CheckOutcome(
        packages=("p", "q"),
        files=(HERE / "a.urdf",),
        folders={"p": HERE / "src" / "p", "q": HERE / "src" / "q"},
    )
    text = summarize_check(checked, Reported(diagnostics=(inside, alone), known=(alone,)), HERE)
    assert text.startswith("## wsgen check: 1 error, 1 warning\n")
    assert "| p | **failed** | 1 | 0 |" in text
    assert "| q | passed | 0 | 0 |" in text
    assert "| `a.urdf` | passed | 0 | 1 |" in text
    assert "Not listed: 1 in the baseline." in text


@pytest.mark.parametrize("number", [MOST_LISTED, MOST_LISTED + 20])
def test_a_summary_is_not_without_end(number: int) -> None:
    many = tuple(replace(error(TIPS_OVER), line=line) for line in range(number))
    text = summarize_outcome(outcome(diagnostics=many), HERE)
    assert text.count("Try:") == MOST_LISTED
    assert ("- and 20 more" in text) == (number > MOST_LISTED)
