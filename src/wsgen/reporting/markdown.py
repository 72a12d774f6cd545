"""Results as Markdown, for the page that GitHub shows of a run ($GITHUB_STEP_SUMMARY)."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING

from wsgen.diagnostics import Severity
from wsgen.reporting.check_formats import relative_name
from wsgen.text.printable import clean, count_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.outcome import Outcome, PackageOutcome, RobotOutcome
    from wsgen.pipeline.check import CheckOutcome
    from wsgen.pipeline.reported import Reported


MOST_LISTED = 100  # diagnostics or packages: GitHub takes up to 1 MiB from a step
LONGEST = 500  # characters of a message
# As `\#` or, for GitHub to read no formula, `\$`; a backquote becomes an entity, as GitHub shows a
# backslash before it in code.
_SPECIAL = re.compile(r"([\\*_{}\[\]<>#~$`])")
_SPAN = re.compile(r"(`[^`]+`)")
BAR = r"\|"
_ENTITIES = {"<": "&lt;", ">": "&gt;", "`": "&#96;"}


def summarize_outcome(outcome: Outcome, folder: Path) -> str:
    """What `wsgen validate` found; paths are relative to the folder, with slashes."""
    packages = outcome.packages
    passed = sum(package.passed for package in packages)
    lines = [f"## wsgen validate: {passed} passed, {len(packages) - passed} failed", ""]
    if not outcome.is_complete:
        lines += ["Interrupted: only the packages and files below were validated.", ""]
    if packages:
        headings = ("Package", "Launch file", "Robot", "Result", "Picture")
        rows = (row for package in packages for row in _rows(package, folder))
        lines += [*_table(headings, rows), ""]
    lines += _listed((one for package in packages for one in package.diagnostics), folder)
    if outcome.not_validated:
        lines += ["### Not validated", ""]
        lines += [
            f"- {_text(one.package)}"
            f"{f' {_code(one.launch_file.name)}' if one.launch_file else ''}: {_text(one.reason)}"
            for one in outcome.not_validated[:MOST_LISTED]
        ]
        lines.append("")
    return "\n".join(lines) + "\n"


def summarize_check(outcome: CheckOutcome, reported: Reported, folder: Path) -> str:
    """What `wsgen check` found; paths are relative to the folder, with slashes."""
    counted = Counter(found.severity for found in reported.diagnostics)
    errors, warnings = counted[Severity.ERROR], counted[Severity.WARNING]
    numbers = f"{count_of(errors, 'error')}, {count_of(warnings, 'warning')}"
    lines = [f"## wsgen check: {numbers}", ""]
    rows: list[tuple[str, ...]] = []
    for package in outcome.packages:
        folder_of_package = outcome.folders.get(package)
        own = Counter(
            found.severity
            for found in reported.diagnostics
            if folder_of_package and found.file and folder_of_package in found.file.parents
        )
        mark = _mark(passed=not own[Severity.ERROR])
        rows.append((_text(package), mark, str(own[Severity.ERROR]), str(own[Severity.WARNING])))
    rows += [
        (_code(relative_name(file, folder)), _mark(passed=not of_file[0]), *map(str, of_file))
        for file in outcome.files
        for of_file in [_numbers(reported.diagnostics, file)]
    ]
    headings = ("Package or file", "Result", "Errors", "Warnings")
    lines += [*_table(headings, rows), ""]
    lines += _listed(reported.diagnostics, folder)
    hidden = [
        f"{len(those)} {what}"
        for those, what in ((reported.allowed, "allowed"), (reported.known, "in the baseline"))
        if those
    ]
    if hidden:
        lines += [f"Not listed: {', '.join(hidden)}.", ""]
    return "\n".join(lines) + "\n"


def _numbers(diagnostics: Iterable[Diagnostic], file: Path) -> tuple[int, int]:
    counted = Counter(found.severity for found in diagnostics if found.file == file)
    return counted[Severity.ERROR], counted[Severity.WARNING]


def _rows(package: PackageOutcome, folder: Path) -> Iterator[tuple[str, ...]]:
    """One for each robot, or one if there is none."""
    file = package.launch_file.name if package.launch_file else ""
    name = package.package or relative_name(package.file, folder)
    picture = relative_name(package.picture, folder) if package.picture else ""
    ends = (_code(file), _code(picture))
    for robot in package.robots:
        yield (_text(name), ends[0], _text(robot.entity), _result(robot, package), ends[1])
    if not package.robots:
        yield (_text(name), ends[0], "", _mark(passed=package.passed), ends[1])


def _result(robot: RobotOutcome, package: PackageOutcome) -> str:
    mark = _mark(passed=robot.passed and package.passed)
    rest = robot.rest
    if rest is None:
        return f"{mark}, not simulated"
    if rest.settled_after is None:
        return f"{mark}, did not settle"
    behaviors = [one for one in robot.behaviors if not one.is_left_out]
    done = sum(behavior.passed for behavior in behaviors)
    more = f", {done} of {len(behaviors)} behaviors" if behaviors else ""
    return f"{mark}, stands after {rest.settled_after:.1f} s{more}"


def _mark(*, passed: bool) -> str:
    return "passed" if passed else "**failed**"


def _listed(diagnostics: Iterable[Diagnostic], folder: Path) -> Iterator[str]:
    """Errors, then warnings, each with its place and what to do; each once."""
    found = list(dict.fromkeys(diagnostics))
    for severity, title in ((Severity.ERROR, "Errors"), (Severity.WARNING, "Warnings")):
        those = [one for one in found if one.severity is severity]
        if those:
            yield f"### {title}"
            yield ""
            yield from (_item(one, folder) for one in those[:MOST_LISTED])
            if len(those) > MOST_LISTED:
                yield f"- and {len(those) - MOST_LISTED} more"
            yield ""


def _item(found: Diagnostic, folder: Path) -> str:
    file = relative_name(found.file, folder)
    place = f"{file}:{found.line}" if file and found.line else file
    where = f"{_code(place)}: " if place else ""
    tried = f"<br>Try: {_text(found.hint)}" if found.hint else ""
    return f"- {where}**{found.code}** {_text(found.message)}{tried}"


def _table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> Iterator[str]:
    cells = list(rows)
    yield f"| {' | '.join(headings)} |"
    yield f"|{'---|' * len(headings)}"
    for row in cells[:MOST_LISTED]:
        # A bar ends a cell, even one in code.
        yield f"| {' | '.join(cell.replace('|', BAR) for cell in row)} |"
    if len(cells) > MOST_LISTED:
        more = f"and {len(cells) - MOST_LISTED} more"
        yield f"| {' | '.join([more, *[''] * (len(headings) - 1)])} |"


def _text(text: str) -> str:
    """A text on one line, in which nothing is markup but code between backquotes."""
    line = " ".join(clean(text).split())
    line = line if len(line) <= LONGEST else f"{line[:LONGEST]}…"
    return "".join(
        part if index % 2 else _plain(part) for index, part in enumerate(_SPAN.split(line))
    )


def _plain(text: str) -> str:
    return _SPECIAL.sub(
        lambda found: _ENTITIES.get(found[1], f"\\{found[1]}"), text.replace("&", "&amp;")
    )


def _code(text: str) -> str:
    """A path or a name as code, between more backticks than it has side by side."""
    plain = " ".join(clean(text).split())
    if "`" not in plain:
        return f"`{plain}`" if plain else ""
    fence = "`" * (max(map(len, re.findall("`+", plain))) + 1)
    return f"{fence} {plain} {fence}"
