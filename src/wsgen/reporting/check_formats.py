"""What `wsgen check` reports, for programs: JSON, SARIF, JUnit, and the commands of GitHub.

JUnit XML is read by GitHub, GitLab, Jenkins and `colcon test-result`. Its elements and attributes
are those of the schema of Jenkins (junit-10.xsd of its xUnit plugin), but for `file` and `line` of
a test case, with which GitLab links to the source.

The columns of the element, attribute or name that a diagnostic means are found in its line.
"""

from __future__ import annotations

import hashlib
import html
import os
import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from wsgen import __version__
from wsgen.checks.fixes.plan import FIXERS, has_fix
from wsgen.checks.fixes.source import SourceText, find_tag, read_source
from wsgen.checks.rules.catalogue import find_rule, to_markdown
from wsgen.diagnostics import Severity
from wsgen.pipeline.reported import without_lines
from wsgen.reporting.json_report import VERSION, diagnostic_to_json, dump_json
from wsgen.text.printable import clean, clean_line
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.pipeline.check import CheckOutcome
    from wsgen.pipeline.reported import Reported


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


SARIF_SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"
SARIF_VERSION = "2.1.0"
SOURCE_ROOT = "SRCROOT"
LEVELS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "note"}
COMMANDS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "notice"}


def relative_name(file: Path | None, folder: Path) -> str:
    """The path of a file, relative to a folder if it is below it, with slashes."""
    if file is None:
        return ""
    relative = os.path.relpath(file, folder)
    name = os.fspath(file) if relative.startswith("..") else relative
    return name.replace(os.sep, "/")


def full_message(found: Diagnostic) -> str:
    """The message, and the hint on a line of its own."""
    return f"{found.message}\n{found.hint}" if found.hint else found.message


def render_json(outcome: CheckOutcome, reported: Reported, places: Places) -> str:
    """A document of our own; docs/json.md lists the keys."""
    document = {
        "version": VERSION,
        "passed": reported.passed,
        "packages": list(outcome.packages),
        "files": [os.fspath(file) for file in outcome.files],
        "diagnostics": [_placed(found, places) for found in reported.diagnostics],
        "allowed": len(reported.allowed),
        "known": len(reported.known),
        "seconds": round(outcome.seconds, 4),
    }
    return dump_json(document)


def _placed(found: Diagnostic, places: Places) -> dict[str, Any]:
    place = places.find(found)
    return diagnostic_to_json(found) | {
        "column": place.column if place else None,
        "end_column": place.end_column if place else None,
        "fixable": has_fix(found),
    }


def render_sarif(diagnostics: Sequence[Diagnostic], places: Places, folder: Path) -> str:
    """A SARIF 2.1.0 log, for code scanning; paths are relative to the folder."""
    codes = sorted({found.code for found in diagnostics})
    run = {
        "tool": {
            "driver": {
                "name": "wsgen",
                "version": __version__,
                "semanticVersion": __version__,
                "rules": [_sarif_rule(code) for code in codes],
            }
        },
        "columnKind": "unicodeCodePoints",
        "originalUriBaseIds": {SOURCE_ROOT: {"uri": f"{folder.as_uri()}/"}},
        "results": [
            _sarif_result(found, codes.index(found.code), places, folder) for found in diagnostics
        ],
    }
    document = {"$schema": SARIF_SCHEMA, "version": SARIF_VERSION, "runs": [run]}
    return dump_json(document)


def _sarif_rule(code: str) -> dict[str, Any]:
    rule = find_rule(code)
    if rule is None:  # a diagnostic has the code of a rule
        return {"id": code}
    return {
        "id": code,
        "name": rule.name,
        "shortDescription": {"text": rule.summary},
        "fullDescription": {"text": rule.why},
        "help": {
            "text": f"{rule.summary} {rule.why}",
            "markdown": to_markdown(rule, has_fix=rule.name in FIXERS),
        },
        "defaultConfiguration": {"level": LEVELS[rule.severity]},
    }


def _sarif_result(
    found: Diagnostic, rule_index: int, places: Places, folder: Path
) -> dict[str, Any]:
    result: dict[str, Any] = {
        "ruleId": found.code,
        "ruleIndex": rule_index,
        "level": LEVELS[found.severity],
        "message": {"text": full_message(found)},
        "partialFingerprints": {"wsgen/v1": _fingerprint(found, folder)},
    }
    location: dict[str, Any] = {}
    if found.file is not None:
        name = relative_name(found.file, folder)
        artifact = (
            {"uri": Path(name).as_uri()}
            if Path(name).is_absolute()
            else {"uri": quote(os.fsencode(name)), "uriBaseId": SOURCE_ROOT}
        )
        physical: dict[str, Any] = {"artifactLocation": artifact}
        if found.line is not None:
            place = places.find(found)
            physical["region"] = {"startLine": found.line} | (
                {"startColumn": place.column, "endColumn": place.end_column} if place else {}
            )
        location["physicalLocation"] = physical
    if found.element:
        location["logicalLocations"] = [{"fullyQualifiedName": found.element}]
    return {**result, "locations": [location]} if location else result


def _fingerprint(found: Diagnostic, folder: Path) -> str:
    """The same for one diagnostic after other lines of the file have changed."""
    message = without_lines(found.message)
    parts = (found.code, relative_name(found.file, folder), found.element or "", message)
    return hashlib.sha256("\0".join(parts).encode(errors="replace")).hexdigest()[:32]


def render_github(
    diagnostics: Iterable[Diagnostic], places: Places, folder: Path, *, verbose: bool = False
) -> Iterator[str]:
    """A command of GitHub's runners a line: they annotate the files of a pull request.

    GitHub shows ten of a step: notes are left out unless `verbose` wants them.
    """
    for found in diagnostics:
        if found.severity is Severity.INFO and not verbose:
            continue
        properties = {"title": f"{found.code} {found.name}"}
        if found.file is not None:
            properties["file"] = relative_name(found.file, folder)
        if found.line is not None:
            properties["line"] = str(found.line)
            place = places.find(found)
            if place is not None:
                properties |= {"col": str(place.column), "endColumn": str(place.end_column)}
        written = ",".join(f"{key}={_property(value)}" for key, value in properties.items())
        yield f"::{COMMANDS[found.severity]} {written}::{_data(full_message(found))}"


def _data(text: str) -> str:
    return clean(text).replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")


def render_junit(  # noqa: PLR0913  half of them have defaults
    diagnostics: Sequence[Diagnostic],
    checked: Sequence[str],
    folder: Path,
    *,
    seconds: float,
    is_strict: bool = False,
    with_files: bool = True,
) -> str:
    """A test report: a test for each package or file that was checked, and for each diagnostic.

    Errors are failures; with `is_strict`, warnings too. `with_files` is that of `render_suites`.
    """
    failing = {Severity.ERROR, *([Severity.WARNING] if is_strict else [])}
    cases = [
        *(Case(suite="wsgen.check", name=name) for name in checked),
        *(_junit_case(found, folder, failing) for found in diagnostics),
    ]
    suite = Suite(name="wsgen check", cases=cases, seconds=seconds)
    return render_suites("wsgen check", [suite], seconds=seconds, with_files=with_files)


def _junit_case(found: Diagnostic, folder: Path, failing: set[Severity]) -> Case:
    file = clean_line(relative_name(found.file, folder))
    place = f"{file}:{found.line}" if found.line else file
    text = "\n".join(filter(None, (place, full_message(found))))
    is_failure = found.severity in failing
    return Case(
        suite=f"wsgen.{found.code[:3]}",
        name=f"{found.code} {found.name}" + (f" {place}" if place else ""),
        file=file or None,
        line=found.line,
        failure=Failure(message=found.message, kind=found.code, text=text) if is_failure else None,
        output="" if is_failure else text,
    )


QUOTED = re.compile(r"`([^`\n]+)`|'([^'\n]+)'|\"([^\"\n]+)\"|<([\w:.-]+)>|\b(\w+)\(\)")
_LETTER = re.compile(r"[^\W\d]")


@dataclass(frozen=True, kw_only=True)
class Place:
    """A piece of a line."""

    column: int  # of its first character, 1-based
    end_column: int  # of the character behind its last
    text: str  # the whole line, without its end


class Places:
    """Finds places; each file is read once."""

    def __init__(self) -> None:
        self._sources: dict[Path, SourceText | None] = {}

    def find(self, diagnostic: Diagnostic) -> Place | None:
        """The place of a diagnostic; None where it has no line, or the file has no such line."""
        if diagnostic.file is None or diagnostic.line is None:
            return None
        if diagnostic.file not in self._sources:
            self._sources[diagnostic.file] = read_source(diagnostic.file)
        source = self._sources[diagnostic.file]
        if source is None:
            return None
        begin = source.start_of(diagnostic.line)
        text = source.text[begin : source.start_of(diagnostic.line + 1)].rstrip("\r\n")
        if not text.strip():
            return None
        start, end = _in_tag(diagnostic, source, begin, text) or _in_line(diagnostic, text)
        return Place(column=start + 1, end_column=end + 1, text=text)


def _in_tag(
    diagnostic: Diagnostic, source: SourceText, begin: int, text: str
) -> tuple[int, int] | None:
    """The attribute or the start tag, as far as it is on the line."""
    if not source.text.lstrip().startswith("<"):
        return None
    found = find_tag(source, diagnostic.line, diagnostic.element)
    if found is None:
        return None
    tag, attribute = found
    written = tag.attributes.get(attribute)
    span = (written.name.start, written.value.end + 1) if written else tag.start
    start, end = max(span[0] - begin, 0), min(span[1] - begin, len(text))
    return (start, end) if start < end else None


def _in_line(diagnostic: Diagnostic, text: str) -> tuple[int, int]:
    """What the diagnostic names, if the line has it; else the line without its indent."""
    names = [
        name
        for text_of in (diagnostic.message, diagnostic.hint or "")
        for found in QUOTED.findall(text_of)
        for name in found
        if _LETTER.search(name)  # `1` is anywhere
    ]
    for name in (diagnostic.element or "", *names):
        place = re.search(rf"(?<!\w){re.escape(name)}(?!\w)", text) if name else None
        if place is not None:
            return place.start(), place.end()
    start = len(text) - len(text.lstrip())
    return start, len(text.rstrip())
