"""`wsgen check`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.options import (
    Choice,
    ExampleCommand,
    complete_rules,
    jobs_option,
    output_options,
    workspace_option,
)
from wsgen.cli.report_files import append_summary, require_places, summary_option, with_files
from wsgen.cli.terminal import echo
from wsgen.errors import EXIT_FAILED, EXIT_PASSED, RequestError
from wsgen.model.facts import WITHOUT_CLASSIC

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager
    from pathlib import Path

    from wsgen.checks.fixes.plan import FixPlan
    from wsgen.events import Listener
    from wsgen.pipeline.check import CheckOutcome, CheckRequest
    from wsgen.pipeline.reported import Filters, Reported


MOST_ROUNDS = 10  # of fixes: one may make room for another one
FORMATS = ("text", "json", "github", "sarif", "junit")


@click.command(
    cls=ExampleCommand,
    epilog="Errors make the exit code 1; with --strict, warnings too.",
    examples=(
        "wsgen check src/my_robot --fix",
        "wsgen check --format github --changed-since origin/main",
    ),
)
@click.argument("paths", nargs=-1, type=click.Path(readable=False), metavar="[PATH]...")
@workspace_option
@click.option(
    "--distro",
    metavar="NAME",
    help="Target ROS 2 distribution, where wsgen.toml names none.  [default: $ROS_DISTRO]",
)
@click.option(
    "--to",
    type=Choice(WITHOUT_CLASSIC),
    help="List what `wsgen port` would change for this distribution instead.",
)
@click.option(
    "--select",
    multiple=True,
    metavar="RULE,...",
    shell_complete=complete_rules,
    help="Report only these rules: names, codes or families such as ROB.",
)
@click.option(
    "--ignore",
    multiple=True,
    metavar="RULE,...",
    shell_complete=complete_rules,
    help="Do not report these rules.",
)
@click.option("--fix", is_flag=True, help="Apply the safe fixes, and check again.")
@click.option("--diff", is_flag=True, help="Show what --fix would change; write nothing.")
@click.option("--strict", is_flag=True, help="Fail on warnings too.")
@click.option("--statistics", is_flag=True, help="Show the number of diagnostics of each rule.")
@click.option(
    "--baseline",
    type=click.Path(),
    metavar="FILE",
    help="Report only what is not in this file, which --write-baseline wrote.",
)
@click.option(
    "--write-baseline",
    type=click.Path(),
    metavar="FILE",
    help="Write what is reported now to a file for --baseline.",
)
@click.option(
    "--changed-since",
    metavar="REF",
    help="Report only files that changed since this git commit or branch, and errors in their "
    "packages.",
)
@jobs_option("Number of packages to check in parallel.")
@click.option(
    "--format",
    "output_format",
    type=Choice(FORMATS),
    default="text",
    show_default=True,
    help="Format of the result on standard output.",
)
@summary_option
@output_options
def command(
    paths: tuple[str, ...],
    *,
    workspace: str | None,
    distro: str | None,
    to: str | None,
    select: tuple[str, ...],
    ignore: tuple[str, ...],
    fix: bool,
    diff: bool,
    strict: bool,
    statistics: bool,
    baseline: str | None,
    write_baseline: str | None,
    changed_since: str | None,
    jobs: int,
    output_format: str,
    summary_file: str | None,
    quiet: bool,
    verbose: bool,
) -> int:
    """Check packages and files without building or simulating them.

    PATH is a package, a workspace, an install space, or a file of any origin. Without PATH, check
    the workspace around the current folder. `wsgen rule` explains each rule.
    """
    from functools import partial
    from pathlib import Path

    from wsgen.diagnostics import Severity
    from wsgen.pipeline.check import CheckRequest
    from wsgen.pipeline.reported import Filters

    if to is not None:
        from wsgen.cli.port import preview

        return preview(paths, workspace, to)
    _refuse_useless(fix=fix, diff=diff, output_format=output_format)
    require_places(summary_file)
    filters = Filters(
        select=select,
        ignore=ignore,
        baseline=Path(baseline) if baseline else None,
        changed_since=changed_since,
    )
    filters.check()
    request = CheckRequest(
        paths=[Path(path) for path in paths], workspace=workspace, distro=distro, jobs=jobs
    )
    make_plan = partial(_plan, with_notes=verbose or bool(select))
    run = partial(_run, request, filters, quiet=quiet, verbose=verbose)
    outcome, reported = run()
    fixed, plan = 0, None
    if fix:
        _announce(paths, workspace)
        outcome, reported, fixed = _fix_all(outcome, reported, run, make_plan)
    if not fix and (diff or (output_format == "text" and not quiet and reported.diagnostics)):
        plan = make_plan(outcome, reported)
    if diff and plan is not None:
        from wsgen.cli.check_output import print_diff

        print_diff(plan.files)
    elif write_baseline is not None:
        _write_baseline(reported, Path(write_baseline))
        return EXIT_PASSED
    else:
        _print(outcome, reported, output_format, strict=strict, quiet=quiet, verbose=verbose)
        if output_format == "text":
            from wsgen.cli.check_output import render_statistics, render_summary

            lines = render_statistics(reported, quiet=quiet) if statistics else []
            if not quiet:
                fixable = len(plan.fixed) if plan else 0
                lines += render_summary(
                    outcome, reported, fixed=fixed, fixable=fixable, verbose=verbose
                )
            for line in lines:
                echo(line)
    _write_summary(outcome, reported, summary_file)
    failing = {Severity.ERROR, *([Severity.WARNING] if strict else [])}
    is_failed = any(found.severity in failing for found in reported.diagnostics)
    return EXIT_FAILED if is_failed else EXIT_PASSED


def _refuse_useless(*, fix: bool, diff: bool, output_format: str) -> None:
    """Refuse options that cannot be combined.

    Raises:
        RequestError: Two of them are given.
    """
    if fix and diff:
        raise RequestError("--diff shows what --fix would do.", hint="Remove one of them.")
    if diff and output_format != "text":
        raise RequestError(
            f"--diff cannot be combined with --format {output_format}.",
            hint="Remove one of them.",
        )


def _announce(paths: tuple[str, ...], workspace: str | None) -> None:
    """Say whose files will be fixed, where no path does."""
    from wsgen.cli.words import announce_place
    from wsgen.packages.workspace.layout import open_workspace

    if not paths:
        announce_place(open_workspace(workspace), workspace)


def _write_summary(outcome: CheckOutcome, reported: Reported, file: str | None) -> None:
    if file is not None:
        from pathlib import Path

        from wsgen.reporting.markdown import summarize_check

        append_summary(file, summarize_check(outcome, reported, Path.cwd()))


def _run(
    request: CheckRequest, filters: Filters, *, quiet: bool, verbose: bool
) -> tuple[CheckOutcome, Reported]:
    import os

    from wsgen.pipeline.check import check
    from wsgen.pipeline.reported import filter_outcome
    from wsgen.text.files import remembering

    with remembering():
        with _listening(quiet=quiet, verbose=verbose) as listener:
            outcome = check(request, environment=os.environ, listener=listener)
        return outcome, filter_outcome(outcome, filters)


def _listening(*, quiet: bool, verbose: bool) -> AbstractContextManager[Listener | None]:
    """What shows progress: on a terminal, or with `verbose`. A log has the result alone."""
    import sys

    from wsgen.cli.progress import listening

    is_terminal = sys.stderr is not None and sys.stderr.isatty()
    return listening(quiet=quiet or not (is_terminal or verbose), verbose=verbose, is_short=True)


def _plan(outcome: CheckOutcome, reported: Reported, *, with_notes: bool) -> FixPlan:
    """The fixes of what is reported; notes are fixed if they are shown or selected."""
    from wsgen.checks.fixes.plan import plan_fixes
    from wsgen.diagnostics import Severity

    roots = (*outcome.only, *outcome.files) if outcome.only else ()
    roots = roots or (*outcome.folders.values(), *outcome.files)
    wanted = [
        found for found in reported.diagnostics if with_notes or found.severity is not Severity.INFO
    ]
    return plan_fixes(wanted, roots)


def _fix_all(
    outcome: CheckOutcome,
    reported: Reported,
    again: Callable[[], tuple[CheckOutcome, Reported]],
    make_plan: Callable[[CheckOutcome, Reported], FixPlan],
) -> tuple[CheckOutcome, Reported, int]:
    """Apply fixes and check again until there are no more; the number of fixes."""
    from pathlib import Path

    from wsgen.checks.fixes.plan import write_fixes
    from wsgen.cli.words import short_name

    fixed, written = 0, set[Path]()
    for _ in range(MOST_ROUNDS):
        plan = make_plan(outcome, reported)
        if not plan.files:
            break
        for file in write_fixes(plan):
            if file not in written:
                echo(f"Fixed {short_name(file)}", err=True)
            written.add(file)
        fixed += len(plan.fixed)
        outcome, reported = again()
    return outcome, reported, fixed


def _write_baseline(reported: Reported, file: Path) -> None:
    from wsgen.cli.words import short_name
    from wsgen.pipeline.reported import render_baseline
    from wsgen.text.files import write_file

    found = (*reported.diagnostics, *reported.known)
    write_file(file, render_baseline(found, file.absolute().parent))
    echo(f"Wrote {short_name(file)}", err=True)


def _print(
    outcome: CheckOutcome,
    reported: Reported,
    output_format: str,
    *,
    strict: bool,
    quiet: bool,
    verbose: bool,
) -> None:
    from pathlib import Path

    folder, found = Path.cwd(), reported.diagnostics
    if output_format == "text" and not found and not (verbose and reported.allowed):
        return
    from wsgen.reporting.check_formats import Places

    places = Places()
    if output_format == "text":
        from wsgen.cli.check_output import render_report

        for line in render_report(reported, places, quiet=quiet, verbose=verbose):
            echo(line)
        return
    from wsgen.reporting import check_formats

    if output_format == "github":
        for line in check_formats.render_github(found, places, folder, verbose=verbose):
            echo(line)
    else:
        if output_format == "json":
            text = check_formats.render_json(outcome, reported, places)
        elif output_format == "sarif":
            text = check_formats.render_sarif(found, places, folder)
        else:
            names = (*outcome.packages, *(file.name for file in outcome.files))
            text = check_formats.render_junit(
                found,
                names,
                folder,
                seconds=outcome.seconds,
                is_strict=strict,
                with_files=with_files(),
            )
        echo(text, nl=False)
