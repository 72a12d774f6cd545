"""What `wsgen check` reports, for programs: JSON, SARIF, JUnit, and the commands of GitHub."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from wsgen import __version__
from wsgen.checks.fixes.registry import FIXERS, has_fix
from wsgen.checks.rules.catalogue import find_rule, to_markdown
from wsgen.diagnostics import Severity
from wsgen.pipeline.baseline import without_lines
from wsgen.reporting.json_report import VERSION, diagnostic_to_json, dump_json
from wsgen.reporting.junit import Case, Failure, Suite, render_suites
from wsgen.text.printable import clean, clean_line

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.pipeline.check import CheckOutcome
    from wsgen.pipeline.reported import Reported
    from wsgen.reporting.places import Places


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
