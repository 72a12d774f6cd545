"""`wsgen validate`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.options import (
    chosen_engines,
    engine_option,
    format_option,
    output_options,
    picture_option,
    seconds_option,
    workspace_option,
)
from wsgen.errors import EXIT_FAILED, EXIT_PASSED, NotFoundError, RequestError

if TYPE_CHECKING:
    from wsgen.model.outcome import Outcome
    from wsgen.pipeline.request import ValidateRequest
    from wsgen.workspace.layout import Workspace


@click.command(
    epilog="Build first: what is judged is the installed package. A FILE needs no package."
)
@click.argument("names", nargs=-1, metavar="[PACKAGE | FILE]...")
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
    help="Launch argument, or argument of a xacro FILE; may be given several times.",
)
@seconds_option
@engine_option
@click.option(
    "-j",
    "--jobs",
    type=click.IntRange(min=1, max=256),
    default=1,
    show_default=True,
    metavar="N",
    help="So many packages or files at a time.",
)
@picture_option
@click.option(
    "--json", "json_file", type=click.Path(), metavar="FILE", help="Write the JSON there."
)
@format_option
@output_options
def command(
    names: tuple[str, ...],
    *,
    workspace: str | None,
    launch_file: str | None,
    arguments: tuple[str, ...],
    seconds: float,
    engine: str | None,
    jobs: int,
    picture: str | None,
    json_file: str | None,
    output_format: str,
    quiet: bool,
    verbose: bool,
) -> int:
    """Source the overlay, evaluate the installed launch file, spawn, simulate and judge.

    Without PACKAGE, all packages of the workspace that spawn a robot. A FILE (.urdf, .xacro, .sdf,
    .world) is tried by itself, a robot just above the ground of an empty world.
    """
    from pathlib import Path

    from wsgen.cli.words import split_launch_arguments
    from wsgen.pipeline.request import FILE_SUFFIXES, ValidateRequest

    if json_file is not None and not Path(json_file).absolute().parent.is_dir():
        raise NotFoundError(
            f"The folder of {json_file} does not exist.", hint="Make it first, or name another."
        )
    for name in names:
        if Path(name).is_file() and not name.lower().endswith(FILE_SUFFIXES):
            raise RequestError(
                f"{name} is no file that can be tried.",
                hint=f"It ends in none of {', '.join(FILE_SUFFIXES)}.",
            )
    request = ValidateRequest(
        packages=[name for name in names if not name.lower().endswith(FILE_SUFFIXES)],
        files=[Path(name) for name in names if name.lower().endswith(FILE_SUFFIXES)],
        launch_file=launch_file,
        launch_arguments=split_launch_arguments(arguments),
        seconds=seconds,
        engines=chosen_engines(engine),
        jobs=jobs,
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

    with listening(quiet=quiet, verbose=verbose) as listener:
        outcome = validate(
            _open_workspace(workspace, request),
            request,
            environment=os.environ,
            listener=listener,
        )
    write_outcome(outcome, output_format=output_format, json_file=json_file, verbose=verbose)
    return EXIT_PASSED if outcome.passed else EXIT_FAILED


def _open_workspace(given: str | None, request: ValidateRequest) -> Workspace | None:
    """The workspace that is meant; none where files alone are named and there is none."""
    from wsgen.workspace.layout import open_workspace

    try:
        return open_workspace(given)
    except (NotFoundError, RequestError):
        if given is None and request.files and not request.packages:
            return None
        raise


def write_outcome(
    outcome: Outcome, *, output_format: str, json_file: str | None = None, verbose: bool
) -> None:
    """Tell what came of it, as text or as JSON, and write the JSON file that is wanted."""
    if json_file or output_format == "json":
        from wsgen.report.json_report import render_outcome

        document = render_outcome(outcome)
        if json_file:
            _write_file(json_file, document)
        if output_format == "json":
            click.echo(document, nl=False)
            return
    from wsgen.cli.table import render_outcome_table

    for line in render_outcome_table(outcome, verbose=verbose):
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
