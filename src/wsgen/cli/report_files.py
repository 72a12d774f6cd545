"""Options for files in which services show a result: JUnit XML and Markdown."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.errors import NotFoundError

if TYPE_CHECKING:
    from wsgen.model.outcome import Outcome


JENKINS = "JENKINS_URL"  # an environment variable of every job of Jenkins

junit_option = click.option(
    "--junit",
    "junit_file",
    type=click.Path(),
    metavar="FILE",
    help="File for a JUnit report with a test case for each check.",
)

summary_option = click.option(
    "--summary",
    "summary_file",
    type=click.Path(),
    metavar="FILE",
    help="File to which a summary in Markdown is appended, such as $GITHUB_STEP_SUMMARY.",
)


def require_folders(*files: str | None) -> None:
    """Refuse files in folders that do not exist, before anything is simulated."""
    from pathlib import Path

    for file in files:
        if file is not None and not Path(file).absolute().parent.is_dir():
            raise NotFoundError(
                f"The folder of {file} does not exist.", hint="Create it, or give another path."
            )


def write_reports(outcome: Outcome, *, junit_file: str | None, summary_file: str | None) -> None:
    """Write the files that are wanted of a validation."""
    if junit_file is None and summary_file is None:
        return
    from pathlib import Path

    folder = Path.cwd()
    if junit_file is not None:
        from wsgen.files import write_file
        from wsgen.report.cases import outcome_suites
        from wsgen.report.junit import render_suites

        suites = outcome_suites(outcome, folder)
        seconds = sum(suite.seconds for suite in suites)
        text = render_suites("wsgen validate", suites, seconds=seconds, with_files=with_files())
        write_file(Path(junit_file), text)
    if summary_file is not None:
        from wsgen.report.markdown import summarize_outcome

        append_summary(summary_file, summarize_outcome(outcome, folder))


def append_summary(file: str, text: str) -> None:
    """Append a summary to the file, which may have those of earlier commands."""
    from pathlib import Path

    from wsgen.files import append_text

    append_text(Path(file), text)


def with_files() -> bool:
    """Whether test cases may name files: the schema of Jenkins refuses these attributes."""
    import os

    return JENKINS not in os.environ
