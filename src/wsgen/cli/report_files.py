"""Options for files about a result: JUnit XML and Markdown for services, a page for people."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.terminal import echo
from wsgen.cli.words import written
from wsgen.errors import NotFoundError, RequestError

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

html_option = click.option(
    "--html",
    "html_file",
    type=click.Path(),
    metavar="FILE",
    help="File for a report as one HTML page: pictures, 3D views, plots (pip install "
    "'wsgen[report]').",
)
summary_option = click.option(
    "--summary",
    "summary_file",
    type=click.Path(),
    metavar="FILE",
    help="File to which a summary in Markdown is appended, such as $GITHUB_STEP_SUMMARY.",
)


def require_places(*files: str | None) -> None:
    """Refuse files that cannot be written, before anything is simulated."""
    from pathlib import Path

    given = [file for file in files if file is not None]
    for file in given:
        if Path(file).is_dir():
            raise NotFoundError(f"{file} is a folder.", hint="Give the path of a file.")
        if not Path(file).absolute().parent.is_dir():
            raise NotFoundError(
                f"The folder of {file} does not exist.", hint="Create it, or give another path."
            )
        if Path(file).is_file() or not Path(file).exists():  # not /dev/stderr
            same = [other for other in given if Path(other).absolute() == Path(file).absolute()]
            if len(same) > 1:
                raise RequestError(
                    f"{file} is named for two reports.", hint="Give each another file."
                )


def require_libraries(html_file: str | None) -> None:
    """Refuse a page whose plots cannot be drawn, before anything is simulated."""
    if html_file is not None:
        from wsgen.reporting.page_data import require_plotly

        require_plotly()


def write_reports(
    outcome: Outcome,
    *,
    junit_file: str | None = None,
    summary_file: str | None = None,
    html_file: str | None = None,
    quiet: bool = False,
) -> None:
    """Write the files that are wanted of a validation, and name the page, unless `quiet`."""
    if (junit_file, summary_file, html_file) == (None, None, None):
        return
    from pathlib import Path

    folder = Path.cwd()
    if junit_file is not None:
        from wsgen.reporting.cases import outcome_suites
        from wsgen.reporting.check_formats import render_suites
        from wsgen.text.files import write_file

        suites = outcome_suites(outcome, folder)
        seconds = sum(suite.seconds for suite in suites)
        text = render_suites("wsgen validate", suites, seconds=seconds, with_files=with_files())
        write_file(Path(junit_file), text)
    if summary_file is not None:
        from wsgen.reporting.markdown import summarize_outcome

        append_summary(summary_file, summarize_outcome(outcome, folder))
    if html_file is not None:
        from wsgen.reporting.html_report import render_page
        from wsgen.text.files import write_file

        write_file(Path(html_file), render_page(outcome, folder))
        if not quiet:
            echo(f"Wrote {written(Path(html_file))} (open it in a browser)", err=True)


def append_summary(file: str, text: str) -> None:
    """Append a summary to the file, which may have those of earlier commands."""
    from pathlib import Path

    from wsgen.text.files import append_text

    append_text(Path(file), text)


def with_files() -> bool:
    """Whether test cases may name files: the schema of Jenkins refuses these attributes."""
    import os

    return JENKINS not in os.environ
