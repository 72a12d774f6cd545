"""What `wsgen check` reports -> the lines that a person reads, in the manner of compilers."""

from __future__ import annotations

import sys
from collections import Counter
from typing import TYPE_CHECKING

import click

from wsgen.cli.output import COLORS, ORDER
from wsgen.cli.terminal import draw_table, echo
from wsgen.cli.words import short_name, short_path
from wsgen.diagnostics import Severity
from wsgen.model.outcome import summed_up
from wsgen.text.printable import count_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from wsgen.checks.fixes.plan import FileFix
    from wsgen.diagnostics import Diagnostic
    from wsgen.pipeline.check import CheckOutcome
    from wsgen.pipeline.reported import Reported
    from wsgen.reporting.check_formats import Place, Places


WIDEST = 120  # columns of a source line that is shown; of a longer one, the part around the place
NAMES = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "note"}


def render_report(
    reported: Reported, places: Places, *, quiet: bool = False, verbose: bool = False
) -> Iterator[str]:
    """For each diagnostic `FILE:LINE:COLUMN: SEVERITY[CODE] NAME: MESSAGE`, and what to do.

    On a terminal, the line of the file is shown, with the place marked. Those that differ only in
    what they name are summed up, and notes and what is allowed left out, unless `verbose`.
    """
    shown = _shown(reported.diagnostics, verbose=verbose)
    is_terminal = sys.stdout is not None and sys.stdout.isatty()
    for found in shown:
        place = places.find(found)
        where = _where(found, place)
        kind = click.style(f"{found.severity.value}[{found.code}]", fg=COLORS[found.severity])
        yield f"{where}{kind} {found.name}: {found.message}"
        if quiet:
            continue
        if is_terminal and place is not None and found.line is not None:
            yield from _excerpt(place, found)
        if found.hint:
            yield f"   try: {found.hint}"
    for found in reported.allowed if verbose else ():
        yield f"{_where(found, places.find(found))}allowed[{found.code}] {found.name}: " + (
            found.message
        )


def _shown(diagnostics: Sequence[Diagnostic], *, verbose: bool) -> Sequence[Diagnostic]:
    if verbose:
        return diagnostics
    return [one for one in summed_up(diagnostics) if one.severity is not Severity.INFO]


def _where(found: Diagnostic, place: Place | None) -> str:
    if found.file is None:
        return ""
    numbers = [str(number) for number in (found.line, place and place.column) if number]
    return f"{click.style(':'.join([short_name(found.file), *numbers]), bold=True)}: "


def _excerpt(place: Place, found: Diagnostic) -> Iterator[str]:
    """The line, and carets below the place; tabs become blanks, which carets can stand below."""
    number = f"{found.line:>5} | "
    start, end = place.column - 1, max(place.end_column - 1, place.column)
    text = "".join(one if one.isprintable() else " " for one in place.text)
    if len(text) > WIDEST:
        first = max(0, min(start - WIDEST // 4, len(text) - WIDEST))
        text = text[first : first + WIDEST]
        start, end = start - first, min(end - first, len(text))
    indent = len(text) - len(text.lstrip())
    carets = " " * (start - indent) + "^" * max(end - start, 1)
    yield f"{click.style(number, dim=True)}{text[indent:]}"
    yield f"{' ' * len(number)}{click.style(carets, fg=COLORS[found.severity])}"


def render_statistics(reported: Reported, *, quiet: bool = False) -> list[str]:
    """A table of the rules and how often each is reported, the most frequent first."""
    counted = Counter(
        (ORDER.index(found.severity), found.code, found.name) for found in reported.diagnostics
    )
    rows = [
        (str(count), ORDER[severity].value, code, name)
        for (severity, code, name), count in sorted(
            counted.items(), key=lambda one: (-one[1], one[0])
        )
    ]
    return draw_table(rows, headings=("number", "severity", "code", "name"), quiet=quiet)


def render_summary(
    outcome: CheckOutcome,
    reported: Reported,
    *,
    fixed: int = 0,
    fixable: int = 0,
    verbose: bool = False,
) -> list[str]:
    """How much was checked and reported, and what to do next."""
    counted = Counter(found.severity for found in reported.diagnostics)
    numbers = [count_of(counted[severity], name) for severity, name in NAMES.items()]
    lines = []
    if fixed:
        lines.append(f"Fixed {count_of(fixed, 'diagnostic')}.")
    subjects = [
        count_of(number, what)
        for number, what in ((len(outcome.packages), "package"), (len(outcome.files), "file"))
        if number
    ]
    hidden = [
        f"{len(those)} {what}"
        for those, what in ((reported.allowed, "allowed"), (reported.known, "in the baseline"))
        if those
    ]
    what = ", ".join(number for number in numbers if not number.startswith("0 ")) or "no errors"
    more = f" Not counted: {', '.join(hidden)}." if hidden else ""
    lines.append(f"{' and '.join(subjects)} checked: {what}.{more}")
    if fixable:
        lines.append(f"{count_of(fixable, 'diagnostic')} can be fixed: add --fix, or --diff first.")
    elif counted[Severity.INFO] and len(counted) == 1 and not verbose:
        lines.append("-v shows notes.")
    return lines


def print_diff(files: Iterable[FileFix]) -> None:
    """Print what would change, as `git diff` does."""
    from wsgen.checks.fixes.plan import unified_diff

    colors = {"+": "green", "-": "red", "@": "cyan"}
    for fix in files:
        for line in unified_diff(fix, short_path(fix.file)):
            color = colors.get(line[:1])
            shown = click.style(line, fg=color) if color else line
            # In a pipe it is a patch, with all that a file holds.
            (echo if sys.stdout.isatty() else click.echo)(shown)
