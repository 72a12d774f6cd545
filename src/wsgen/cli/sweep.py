"""`wsgen sweep`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.options import (
    RUN_SECONDS,
    ExampleCommand,
    argument_option,
    complete_launch_files,
    complete_packages_and_files,
    complete_templates,
    distro_option,
    engine_option,
    format_option,
    jobs_option,
    output_options,
    sim_option,
    workspace_option,
)
from wsgen.cli.terminal import echo
from wsgen.errors import EXIT_FAILED, EXIT_PASSED, RequestError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from wsgen.model.target import Target
    from wsgen.packages.workspace.layout import Workspace
    from wsgen.packages.workspace.sweep_settings import SweepSettings
    from wsgen.sweeping.sweep import SweepOutcome


class SweepCommand(ExampleCommand):
    """A command whose help ends with the parameters that every sweep has."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List them; only --help loads them."""
        from wsgen.sweeping.parameters import OWN

        with formatter.section("Parameters of every sweep, beside those of the robot"):
            formatter.write_dl(
                [(f"{one.name} {one.unit}".rstrip(), one.meaning) for one in OWN], col_max=30
            )
        super().format_epilog(ctx, formatter)


@click.command(
    cls=SweepCommand,
    epilog="NAME is an argument of the launch file or of the xacro file, a variable of the "
    "template, or one of the parameters below. Run the same command again to continue an "
    "interrupted sweep.",
    examples=(
        "wsgen sweep rover --over world.slope=0deg:45deg:46 --plot slope.png",
        "wsgen sweep -t diff_drive --random 'body_mass=uniform(2,50)' --samples 500 -j 4",
    ),
)
@click.argument(
    "name",
    required=False,
    metavar="[PACKAGE | FILE]",
    shell_complete=complete_packages_and_files,
)
@click.option(
    "-t",
    "--template",
    metavar="NAME|FOLDER",
    shell_complete=complete_templates,
    help="Template that is rendered for each variant, in place of a PACKAGE or FILE.",
)
@click.option(
    "--over",
    multiple=True,
    metavar="NAME=VALUES",
    help="Values of a parameter: START:STOP:COUNT, or a list with commas; several parameters make "
    "a grid. A number may end in `deg`.",
)
@click.option(
    "--random",
    "random",
    multiple=True,
    metavar="NAME=DISTRIBUTION",
    help="Distribution of a parameter: uniform(LOW, HIGH), normal(MEAN, DEVIATION), "
    "loguniform(LOW, HIGH) or choice(A, B, ...).",
)
@click.option(
    "--samples",
    type=int,
    metavar="N",
    help="Number of samples for each point of the grid.  [default: 100]",
)
@click.option(
    "--sampler",
    metavar="NAME",
    help="random, lhs (Latin hypercube) or sobol: how evenly samples cover the space.  "
    "[default: random]",
)
@click.option("--seed", type=int, metavar="N", help="Seed of the random numbers.  [default: 0]")
@click.option(
    "--out",
    metavar="FILE",
    help="Table with one row for each run: .csv, .jsonl, or .parquet (pip install "
    "'wsgen[sweep]').  [default: NAME-sweep-PARAMETERS.csv]",
)
@click.option(
    "--plot",
    "plots",
    multiple=True,
    metavar="FILE",
    help="Plot of the table, .png or .html (pip install 'wsgen[sweep]'); can be repeated.",
)
@click.option(
    "--worst",
    metavar="K[:COLUMN]",
    help="Also write the K worst variants, as robots or packages with picture and video: those "
    "that fail and tilt most, or that have the largest values in a column.",
)
@jobs_option("Number of runs at a time.")
@click.option(
    "--scheduler",
    metavar="ADDRESS|local",
    help="Run on the workers of a Dask scheduler, such as tcp://192.168.1.5:8786; `local` starts "
    "one on this machine (pip install 'wsgen[sweep]').",
)
@click.option(
    "--launch",
    "launch_file",
    metavar="FILE",
    shell_complete=complete_launch_files,
    help="Name of the launch file of the PACKAGE.  [default: the one that spawns a robot]",
)
@argument_option
@click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="KEY=VALUE",
    help="Variable of the template that does not vary.",
)
@distro_option
@sim_option
@click.option(
    "--seconds",
    type=RUN_SECONDS,
    help="Simulated time of each run in seconds.  [default: 3.0]",
)
@engine_option
@click.option(
    "--behaviors/--no-behaviors",
    default=None,
    help="Whether to run the behaviors in wsgen.toml for each variant.  [default: behaviors]",
)
@workspace_option
@format_option
@output_options
@click.pass_context
def command(
    ctx: click.Context,
    name: str | None,
    *,
    template: str | None,
    over: tuple[str, ...],
    random: tuple[str, ...],
    samples: int | None,
    sampler: str | None,
    seed: int | None,
    out: str | None,
    plots: tuple[str, ...],
    worst: str | None,
    jobs: int,
    scheduler: str | None,
    launch_file: str | None,
    arguments: tuple[str, ...],
    settings: tuple[str, ...],
    distro: str,
    sim: str | None,
    seconds: float | None,
    engine: str | None,
    behaviors: bool | None,
    workspace: str | None,
    output_format: str,
    quiet: bool,
    verbose: bool,
) -> int:
    """Simulate many variants of a robot, and write a table with a row for each.

    The robot is the one that a launch file of the PACKAGE spawns, that of a FILE (.urdf, .xacro,
    .sdf, or a launch file), or that of a template. The [sweep] table in wsgen.toml gives defaults.
    """
    import os
    from pathlib import Path

    from wsgen.cli.progress import SweepProgress, listening
    from wsgen.cli.report_files import require_places
    from wsgen.cli.validate import is_file_name
    from wsgen.cli.words import launch_file_of, split_launch_arguments
    from wsgen.packages.workspace.sweep_settings import SweepSettings
    from wsgen.pipeline.load_scene import BrokenSceneError
    from wsgen.sweeping.subject import SubjectRequest
    from wsgen.sweeping.sweep import DEFAULT_SECONDS, SweepRequest, sweep
    from wsgen.sweeping.words import make_design_with, read_axes, read_distributions
    from wsgen.sweeping.worst import read_choice

    named = launch_file_of([name or ""], launch_file)
    around = None
    if named is not None:
        name, launch_file, around = named
    is_file = name is not None and is_file_name(name)
    place = _workspace(workspace or around, name, is_file=is_file)
    defaults = SweepSettings() if name is None or is_file else _settings(place, name)
    if defaults is None:
        return EXIT_FAILED
    out = out or defaults.out
    files = [Path(file) for file in plots]
    require_places(out, *plots)
    for file in files:
        from wsgen.reporting.sweep_plot import check_plot

        check_plot(file)
    request = SweepRequest(
        subject=SubjectRequest(
            package=None if is_file else name,
            file=Path(name) if name is not None and is_file else None,
            template=template,
            workspace=place,
            launch_file=launch_file,
            launch_arguments=split_launch_arguments(arguments),
            settings=settings,
            target=_target(ctx, template, distro, sim),
            has_behaviors=_first(behaviors, defaults.behaviors, default=True),
        ),
        design=make_design_with(
            defaults,
            over=read_axes(over),
            random=read_distributions(random),
            samples=samples,
            sampler=sampler,
            seed=seed,
        ),
        out=None if out is None else Path(out),
        seconds=seconds or defaults.seconds or DEFAULT_SECONDS,
        engine=_engine(engine or defaults.engine),
        jobs=jobs,
        scheduler=scheduler,
        worst=None if worst is None else read_choice(worst),
    )

    def show(outcome: SweepOutcome) -> None:
        progress.hide()
        for file in files:
            from wsgen.reporting.sweep_plot import render_plot
            from wsgen.text.files import write_file

            write_file(file, render_plot(file, outcome.data, outcome.summary, outcome.name))
        if output_format == "text":
            _print_text(outcome, files, quiet=quiet)

    try:
        with (
            listening(quiet=quiet, verbose=verbose) as listener,
            SweepProgress(quiet=quiet) as progress,
        ):
            outcome = sweep(
                request,
                environment=os.environ,
                listener=listener,
                on_progress=progress,
                on_table=show,
            )
    except BrokenSceneError as error:
        from wsgen.cli.output import render_diagnostics

        for line in render_diagnostics(error.diagnostics):
            echo(line)
        echo(f"{error} Nothing was run.", err=True)
        return EXIT_FAILED
    if output_format == "json":
        _print_json(outcome, files)
    else:
        _print_worst(outcome)
    return EXIT_PASSED


def _workspace(
    given: str | Workspace | None, name: str | None, *, is_file: bool
) -> Workspace | None:
    """The workspace of a package, or that of what a file names; None where none is found."""
    from pathlib import Path

    from wsgen.cli.validate import open_workspace_of
    from wsgen.pipeline.requests import ValidateRequest

    if name is None:
        return None
    request = ValidateRequest(
        packages=() if is_file else (name,), files=(Path(name),) if is_file else ()
    )
    return open_workspace_of(given, request)


def _settings(place: Workspace | None, package: str) -> SweepSettings | None:
    """What the package's wsgen.toml says of sweeps; None where it has errors, which are printed."""
    from wsgen.cli.output import render_diagnostics
    from wsgen.diagnostics import Severity
    from wsgen.packages.workspace.layout import find_packages
    from wsgen.packages.workspace.settings import read_settings
    from wsgen.packages.workspace.sweep_settings import SweepSettings

    sources = [] if place is None else find_packages(place)
    for source in sources:
        if source.name == package:
            settings, found = read_settings(source.path)
            errors = [one for one in found if one.severity is Severity.ERROR]
            for line in render_diagnostics(errors):
                echo(line, err=True)
            return None if errors else settings.sweep or SweepSettings()
    return SweepSettings()


def _target(
    ctx: click.Context, template: str | None, distro: str, sim: str | None
) -> Target | None:
    """The target of a template; None where nobody asked for one."""
    from click.core import ParameterSource

    from wsgen.cli.options import chosen_target

    source = ctx.get_parameter_source("distro")
    is_given = sim is not None or source is ParameterSource.COMMANDLINE
    return chosen_target(ctx, distro, sim) if template is not None or is_given else None


def _first(*values: bool | None, default: bool) -> bool:
    """The first that is given."""
    return next((value for value in values if value is not None), default)


def _engine(given: str | None) -> str:
    from wsgen.cli.options import chosen_engines

    if given == "all":
        raise RequestError(
            "A sweep is simulated in one engine.",
            hint="Name it; for another engine sweep again, with another --out.",
        )
    (engine,) = chosen_engines(given)
    return engine


def _print_text(outcome: SweepOutcome, plots: Sequence[Path], *, quiet: bool) -> None:
    from wsgen.cli.terminal import fit_lines
    from wsgen.cli.words import short_name
    from wsgen.sweeping.summary import render_summary

    for line in fit_lines(render_summary(outcome.summary)):
        echo(line)
    if quiet:
        return
    for hint in outcome.hints:
        echo(f"note: {hint}", err=True)
    runs = f"{outcome.summary.done:,} runs"
    kept = ", as it was" if outcome.was_complete else ""
    echo(f"Table: {short_name(outcome.out)} ({runs}{kept})", err=True)
    for file in plots:
        echo(f"Plot: {short_name(file)}", err=True)


def _print_worst(outcome: SweepOutcome) -> None:
    from wsgen.cli.words import short_name
    from wsgen.sweeping.parameters import write_value

    if outcome.worst:
        echo()
        echo("the worst variants")
    for one in outcome.worst:
        values = ", ".join(f"{name}={write_value(value)}" for name, value in one.values.items())
        passes = "  (passes)" if one.passed else ""
        echo(f"  {short_name(one.folder)}  {values}{passes}")


def _print_json(outcome: SweepOutcome, plots: Sequence[Path]) -> None:
    import json

    from wsgen.sweeping.summary import summary_as_json

    document = {
        "schema": 1,
        "name": outcome.name,
        "table": str(outcome.out.absolute()),
        "was_complete": outcome.was_complete,
        "plots": [str(file.absolute()) for file in plots],
        **summary_as_json(outcome.summary),
        "worst": [
            {
                "run": one.number,
                "parameters": dict(one.values),
                "passed": one.passed,
                "folder": str(one.folder.absolute()),
                "picture": one.picture and str(one.picture.absolute()),
                "video": one.video and str(one.video.absolute()),
            }
            for one in outcome.worst
        ],
    }
    echo(json.dumps(document, indent=2))
