"""`wsgen validate`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.options import format_option, output_options, workspace_option
from wsgen.errors import EXIT_FAILED, EXIT_PASSED, NotFoundError

if TYPE_CHECKING:
    from wsgen.model.outcome import Outcome
    from wsgen.pipeline.request import ValidateRequest


@click.command(epilog="Build first: what is judged is the installed package.")
@click.argument("packages", nargs=-1, metavar="[PACKAGE]...")
@workspace_option
@click.option(
    "--launch",
    "launch_file",
    metavar="FILE",
    help="Launch file, as `ros2 launch` names it.  [default: the only one that spawns a robot]",
)
@click.option(
    "--arg",
    "arguments",
    multiple=True,
    metavar="NAME:=VALUE",
    help="Launch argument; may be given several times.",
)
@click.option(
    "--seconds",
    type=click.FloatRange(min=0.1, max=600.0),
    default=3.0,
    show_default=True,
    help="Simulated time.",
)
@click.option("--picture", type=click.Path(), metavar="DIR", help="Write a PNG of the end there.")
@click.option(
    "--json", "json_file", type=click.Path(), metavar="FILE", help="Write the JSON there."
)
@format_option
@output_options
def command(
    packages: tuple[str, ...],
    *,
    workspace: str | None,
    launch_file: str | None,
    arguments: tuple[str, ...],
    seconds: float,
    picture: str | None,
    json_file: str | None,
    output_format: str,
    quiet: bool,
    verbose: bool,
) -> int:
    """Source the overlay, evaluate the installed launch file, spawn, simulate and judge.

    Without PACKAGE, all packages of the workspace that spawn a robot.
    """
    from pathlib import Path

    from wsgen.cli.words import split_launch_arguments
    from wsgen.pipeline.request import ValidateRequest

    if json_file is not None and not Path(json_file).absolute().parent.is_dir():
        raise NotFoundError(
            f"The folder of {json_file} does not exist.", hint="Make it first, or name another."
        )
    request = ValidateRequest(
        packages=packages,
        launch_file=launch_file,
        launch_arguments=split_launch_arguments(arguments),
        seconds=seconds,
        picture_folder=Path(picture) if picture else None,
    )
    return validate_packages(
        request,
        workspace=workspace,
        quiet=quiet,
        verbose=verbose,
        output_format=output_format,
        json_file=json_file,
    )


def validate_packages(
    request: ValidateRequest,
    *,
    workspace: str | None,
    quiet: bool,
    verbose: bool,
    output_format: str = "text",
    json_file: str | None = None,
) -> int:
    """Validate, tell the outcome, and return the exit code."""
    import os

    from wsgen.cli.progress import listening
    from wsgen.pipeline import validate
    from wsgen.workspace.layout import open_workspace

    with listening(quiet=quiet, verbose=verbose) as listener:
        outcome = validate(
            open_workspace(workspace), request, environment=os.environ, listener=listener
        )
    _write(outcome, output_format=output_format, json_file=json_file)
    return EXIT_PASSED if outcome.passed else EXIT_FAILED


def _write(outcome: Outcome, *, output_format: str, json_file: str | None) -> None:
    if json_file or output_format == "json":
        from wsgen.report.json_report import render_outcome

        document = render_outcome(outcome)
        if json_file:
            _write_file(json_file, document)
        if output_format == "json":
            click.echo(document, nl=False)
            return
    from wsgen.cli.table import render_outcome_table

    for line in render_outcome_table(outcome):
        click.echo(line)


def _write_file(path: str, text: str) -> None:
    from pathlib import Path

    from wsgen.errors import NotReadableError

    try:
        Path(path).write_text(text, encoding="utf-8")
    except OSError as error:
        raise NotReadableError(
            f"{path} cannot be written: {error.strerror}.",
            hint="Name a file in a folder that exists and that you may write to.",
        ) from error
