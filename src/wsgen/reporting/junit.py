"""JUnit XML: test reports that GitHub, GitLab, Jenkins and `colcon test-result` read.

The elements and attributes are those of the schema of Jenkins (junit-10.xsd of its xUnit plugin),
but for `file` and `line` of a test case, with which GitLab links to the source.
"""

from __future__ import annotations

import html
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.text.printable import clean
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence


SCHEMA = "junit-10.xsd of the xUnit plugin of Jenkins"
WITH_FILES = ", but for the attributes file and line of a testcase, which GitLab reads"


@dataclass(frozen=True, kw_only=True)
class Failure:
    """Why a test case failed."""

    message: str  # in a line
    kind: str  # code of the rule
    text: str  # all that is known


@dataclass(frozen=True, kw_only=True)
class Case:
    """A test case."""

    suite: str  # by which services group cases, with a dot between package and file
    name: str
    seconds: float = 0.0  # wall-clock
    file: str | None = None  # relative to the root of the repository, with slashes
    line: int | None = None  # 1-based
    failure: Failure | None = None
    skipped: str | None = None  # why it was not run
    output: str = ""


@dataclass(frozen=True, kw_only=True)
class Suite:
    """The test cases of a package or a file."""

    name: str
    cases: Sequence[Case]
    seconds: float = 0.0  # wall-clock
    properties: Mapping[str, str] | None = None


def render_suites(
    name: str, suites: Sequence[Suite], *, seconds: float, with_files: bool = True
) -> str:
    """A test report; without `with_files` it has nothing that Jenkins' schema does not know."""
    suites = [replace(suite, cases=_with_unique_names(suite.cases)) for suite in suites]
    numbers = _numbers([case for suite in suites for case in suite.cases], seconds)
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f"<!-- Schema: {SCHEMA}{WITH_FILES if with_files else ''} -->",
        f"<testsuites name={_quoted(name)} {numbers}>",
        *(line for suite in suites for line in _suite(suite, with_files=with_files)),
        "</testsuites>",
    ]
    return "\n".join(lines) + "\n"


def _numbers(cases: Sequence[Case], seconds: float) -> str:
    failures = sum(case.failure is not None for case in cases)
    return f'tests="{len(cases)}" failures="{failures}" errors="0" time="{seconds:.3f}"'


def _with_unique_names(cases: Sequence[Case]) -> list[Case]:
    """GitLab shows one case of a name: number those that come after it."""
    counted: dict[tuple[str, str], int] = {}
    unique = []
    for case in cases:
        key = (case.suite, case.name)
        counted[key] = counted.get(key, 0) + 1
        is_first = counted[key] == 1
        unique.append(case if is_first else replace(case, name=f"{case.name} ({counted[key]})"))
    return unique


def _suite(suite: Suite, *, with_files: bool) -> Iterator[str]:
    skipped = sum(case.skipped is not None for case in suite.cases)
    numbers = f'{_numbers(suite.cases, suite.seconds)} skipped="{skipped}"'
    yield f"  <testsuite name={_quoted(suite.name)} {numbers}>"
    if suite.properties:
        yield "    <properties>"
        for name, value in suite.properties.items():
            yield f"      <property name={_quoted(name)} value={_quoted(value)}/>"
        yield "    </properties>"
    for case in suite.cases:
        yield from _case(case, with_files=with_files)
    yield "  </testsuite>"


def _case(case: Case, *, with_files: bool) -> Iterator[str]:
    attributes = f"classname={_quoted(case.suite)} name={_quoted(case.name)}"
    attributes += f' time="{case.seconds:.3f}"'
    if with_files and case.file:
        attributes += f" file={_quoted(case.file)}"
        attributes += f' line="{case.line}"' if case.line else ""
    inside = []
    if case.failure is not None:
        message, kind = _quoted(case.failure.message), _quoted(case.failure.kind)
        text = _escaped(case.failure.text)
        inside.append(f"<failure message={message} type={kind}>{text}</failure>")
    if case.skipped is not None:
        inside.append(f"<skipped message={_quoted(case.skipped)}/>")
    if case.output:
        inside.append(f"<system-out>{_escaped(case.output)}</system-out>")
    if not inside:
        yield f"    <testcase {attributes}/>"
        return
    yield f"    <testcase {attributes}>"
    yield from (f"      {line}" for line in inside)
    yield "    </testcase>"


def _escaped(text: str) -> str:
    return html.escape(clean(text))


def _quoted(text: str) -> str:
    return f'"{_escaped(text).replace(chr(10), "&#10;").replace(chr(9), "&#9;")}"'
