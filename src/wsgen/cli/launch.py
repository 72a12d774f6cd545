"""`wsgen launch`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.options import (
    ExampleCommand,
    answer_option,
    chosen_answers,
    chosen_engines,
    complete_launch_words,
    engine_option,
    format_option,
    output_options,
    page_options,
    picture_option,
    seconds_option,
    workspace_option,
)
from wsgen.cli.report_files import html_option, require_libraries, require_places, write_reports
from wsgen.cli.terminal import echo
from wsgen.errors import EXIT_FAILED, EXIT_PASSED, RequestError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path
    from typing import Any

    from wsgen.model.plan import LaunchPlan
    from wsgen.pipeline.requests import SelectedLaunchFile, ValidateRequest


class RateType(click.ParamType):  # type: ignore[type-arg,unused-ignore]  # newer ones have some
    """A factor of real time; `max`, which becomes None, is as fast as possible."""

    name = "rate"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float | None:
        """The factor of a text."""
        if value == "max":
            return None
        try:
            rate = float(value)
        except ValueError:
            rate = 0.0
        if not 0.0 < rate < float("inf"):
            self.fail(f"{value!r} is neither a number above 0 nor `max`.", param, ctx)
        return rate


@click.command(
    cls=ExampleCommand,
    epilog="Evaluating a launch file runs its Python code in a child process with limits on time "
    "and memory. The processes that it describes are started with --run alone.",
    examples=(
        "wsgen launch my_robot gazebo_model.launch.py --run z:=0.5",
        "wsgen launch launch/gazebo_model.launch.py --play --record fall.gif",
    ),
)
@click.argument(
    "words",
    nargs=-1,
    required=True,
    metavar="(PACKAGE FILE | PATH) [NAME:=VALUE]...",
    shell_complete=complete_launch_words,
)
@workspace_option
@click.option(
    "-s",
    "--show-args",
    "--show-arguments",
    "show_arguments",
    is_flag=True,
    help="Show the arguments of the launch file.",
)
@answer_option
@click.option(
    "--play",
    is_flag=True,
    help="Simulate the robots that the launch file spawns, and check the result.",
)
@click.option(
    "--record",
    "recordings",
    type=click.Path(),
    multiple=True,
    metavar="FILE",
    help="With --play or --run: file for a video, .gif or .mp4 (pip install 'wsgen[video]'). With "
    "--run also: .mcap for all topics.",
)
@click.option(
    "--view",
    "is_viewed",
    is_flag=True,
    help="With --play or --run: show the simulation in the browser while it runs (pip install "
    "'wsgen[view]').",
)
@click.option(
    "--run",
    "is_run",
    is_flag=True,
    help="Start the launch file as `ros2 launch` does, with wsgen in the place of Gazebo (pip "
    "install 'wsgen[ros]').",
)
@click.option(
    "--rate",
    type=RateType(),
    default="1",
    show_default=True,
    metavar="RATE",
    help="With --run: simulated seconds a second, or `max`.",
)
@click.option(
    "--for",
    "run_seconds",
    type=click.FloatRange(min=0.0, min_open=True),
    metavar="SECONDS",
    help="With --run: end after this many simulated seconds.",
)
@click.option(
    "--until-exit",
    metavar="NODE",
    help="With --run: end when this node or program ends, with exit code 1 if it failed.",
)
@click.option(
    "--strict",
    "is_strict",
    is_flag=True,
    help="With --run: report what cannot run here as an error, instead of leaving it out.",
)
@page_options
@picture_option
@html_option
@seconds_option
@engine_option
@format_option
@output_options
def command(
    words: tuple[str, ...],
    *,
    workspace: str | None,
    show_arguments: bool,
    answers: tuple[str, ...],
    play: bool,
    recordings: tuple[str, ...],
    is_viewed: bool,
    is_run: bool,
    rate: float | None,
    run_seconds: float | None,
    until_exit: str | None,
    is_strict: bool,
    host: str,
    port: int | None,
    no_browser: bool,
    picture: str | None,
    html_file: str | None,
    seconds: float,
    engine: str | None,
    output_format: str,
    quiet: bool,
    verbose: bool,
) -> int:
    """Evaluate a launch file without ROS and show what it would start.

    The arguments are those of `ros2 launch`: an installed package and the name of one of its launch
    files, or the path of a launch file; then launch arguments. With --play, simulate the
    robots as `wsgen validate` does; with --play --view, in the browser, until you end it. With
    --run, start its nodes, and simulate what they drive; with --run --view, see it in the browser.
    """
    from click.core import ParameterSource

    from wsgen.cli.progress import listening
    from wsgen.cli.words import split_launch_arguments
    from wsgen.diagnostics import has_errors
    from wsgen.pipeline.plan_launch import plan_launch, select_launch_file

    context = click.get_current_context()
    selected = context.with_resource(select_launch_file(words, workspace))
    arguments = split_launch_arguments(selected.words)
    if play and show_arguments:
        raise RequestError("--show-args and --play cannot be combined.", hint="Remove one of them.")
    if is_run:
        _refuse_beside_run(context)
    else:
        _refuse_without_run(context)
    if not is_viewed:
        _refuse_without_view(context)
    elif not is_run:
        _refuse_beside_view(context)
    if is_run:
        from pathlib import Path

        from wsgen.cli.live_run import choose_page, run
        from wsgen.live.recording import choose_recordings

        request = _request(arguments, answers, None, picture, seconds, engine)

        return run(
            selected,
            request,
            rate=rate,
            seconds=run_seconds,
            until_exit=until_exit,
            is_strict=is_strict,
            recordings=choose_recordings([Path(file) for file in recordings]),
            page=choose_page(host, port, opens=not no_browser) if is_viewed else None,
            quiet=quiet,
            verbose=verbose,
        )
    video = _only_video(recordings)
    request = _request(arguments, answers, video, picture, seconds, engine)
    if play and is_viewed:
        from wsgen.cli.view import view_simulation

        return view_simulation(
            selected, request, host, port, opens=not no_browser, quiet=quiet, verbose=verbose
        )
    if play:
        require_places(html_file)
        require_libraries(html_file)
        return _play(
            selected,
            request.for_page() if html_file else request,
            html_file=html_file,
            output_format=output_format,
            quiet=quiet,
            verbose=verbose,
        )
    asked = context.get_parameter_source("seconds")
    if video or picture or html_file or engine or asked is not ParameterSource.DEFAULT:
        raise RequestError(
            "Without --play nothing is simulated.", hint="Add --play, or remove the option."
        )
    with listening(quiet=quiet, verbose=verbose) as listener:
        plan = plan_launch(
            selected,
            arguments,
            answers=chosen_answers(answers),
            only_arguments=show_arguments,
            with_origins=output_format == "json",
            listener=listener,
        )
    _write(plan, output_format=output_format, show_arguments=show_arguments, quiet=quiet)
    return EXIT_FAILED if has_errors(plan.diagnostics) else EXIT_PASSED


def _only_video(recordings: Sequence[str]) -> str | None:
    """The file of the video that --play makes."""
    if len(recordings) > 1:
        raise RequestError(
            "--play makes one video.", hint="Write --record once, with a .gif or an .mp4 file."
        )
    return next(iter(recordings), None)


NOT_WITH_RUN = (
    *("show_arguments", "play", "picture", "html_file", "seconds"),
    "output_format",
)
OF_RUN = ("rate", "run_seconds", "until_exit", "is_strict")


def _refuse_beside_run(context: click.Context) -> None:
    """Refuse what a launch that is started has no use for."""
    from click.core import ParameterSource

    if context.params["engine"] == "all":
        raise RequestError("--run simulates in one engine.", hint="Name it: --engine bullet")
    for name in NOT_WITH_RUN:
        if context.get_parameter_source(name) is not ParameterSource.DEFAULT:
            option = _option(context, name)
            hint = "End it with --for SECONDS." if name == "seconds" else "Remove one of them."
            raise RequestError(f"--run and {option} cannot be combined.", hint=hint)


def _refuse_without_run(context: click.Context) -> None:
    """Refuse what only a launch that is started has a use for."""
    from click.core import ParameterSource

    for name in OF_RUN:
        if context.get_parameter_source(name) is not ParameterSource.DEFAULT:
            option = _option(context, name)
            raise RequestError(
                f"Without --run nothing is started, and {option} has no effect.",
                hint=f"Add --run, or remove {option}.",
            )


def _option(context: click.Context, name: str) -> str:
    """The option of a parameter, as users write it."""
    return next(one.opts[-1] for one in context.command.params if one.name == name)


NOT_WITH_VIEW = ("recordings", "picture", "html_file", "seconds", "output_format")


def _refuse_beside_view(context: click.Context) -> None:
    """Refuse what a simulation without an end and a result has no use for."""
    from click.core import ParameterSource

    if not context.params["play"]:
        raise RequestError(
            "Without --play or --run nothing is simulated.",
            hint="Write --play --view, or --run --view.",
        )
    if context.params["engine"] == "all":
        raise RequestError("--view simulates in one engine.", hint="Name it: --engine bullet")
    for name in NOT_WITH_VIEW:
        if context.get_parameter_source(name) is not ParameterSource.DEFAULT:
            option = next(one.opts[0] for one in context.command.params if one.name == name)
            raise RequestError(
                f"--view and {option} cannot be combined: the simulation goes on until you end it.",
                hint="Remove one of them.",
            )


OF_THE_PAGE = ("host", "port", "no_browser")


def _refuse_without_view(context: click.Context) -> None:
    """Refuse what only a page in the browser has a use for."""
    from click.core import ParameterSource

    for name in OF_THE_PAGE:
        if context.get_parameter_source(name) is not ParameterSource.DEFAULT:
            option = next(one.opts[0] for one in context.command.params if one.name == name)
            raise RequestError(
                f"Without --view no page is served, and {option} has no effect.",
                hint=f"Add --view, or remove {option}.",
            )


def _request(  # noqa: PLR0917  the options
    arguments: Mapping[str, str],
    answers: Sequence[str],
    record: str | None,
    picture: str | None,
    seconds: float,
    engine: str | None,
) -> ValidateRequest:
    from pathlib import Path

    from wsgen.pipeline.requests import ValidateRequest

    return ValidateRequest(
        launch_arguments=arguments,
        answers=chosen_answers(answers),
        seconds=seconds,
        engines=chosen_engines(engine),
        picture_folder=Path(picture) if picture else None,
        video=Path(record) if record else None,
    )


def _play(
    selected: SelectedLaunchFile,
    request: ValidateRequest,
    *,
    html_file: str | None,
    output_format: str,
    quiet: bool,
    verbose: bool,
) -> int:
    from wsgen.cli.progress import listening
    from wsgen.cli.validate import write_outcome
    from wsgen.cli.words import report_unfinished
    from wsgen.pipeline.validate import play

    before = _version(request.video)
    try:
        with listening(quiet=quiet, verbose=verbose) as listener:
            outcome = play(
                selected.file,
                selected.package,
                selected.overlay,
                request,
                workspace=selected.workspace,
                listener=listener,
            )
    except (KeyboardInterrupt, SystemExit):  # a signal
        if request.video is not None and _version(request.video) == before:
            report_unfinished(request.video)
        raise
    write_outcome(outcome, output_format=output_format, quiet=quiet, verbose=verbose)
    write_reports(outcome, html_file=html_file, quiet=quiet)
    return EXIT_PASSED if outcome.passed else EXIT_FAILED


def _version(file: Path | None) -> tuple[int, int] | None:
    """What is another one once a file is written anew; None where it is not there."""
    try:
        found = None if file is None else file.stat()
    except OSError:
        return None
    return None if found is None else (found.st_ino, found.st_mtime_ns)


def _write(plan: LaunchPlan, *, output_format: str, show_arguments: bool, quiet: bool) -> None:
    if output_format == "json":
        from wsgen.reporting.json_report import render_plan

        echo(render_plan(plan), nl=False)
        return
    from wsgen.cli.output import render_arguments, render_tree

    for line in render_arguments(plan) if show_arguments else render_tree(plan, quiet=quiet):
        echo(line)
