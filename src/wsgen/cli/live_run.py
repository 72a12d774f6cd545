"""`wsgen launch --run`."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from wsgen.cli.terminal import echo, echo_next

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
    from contextlib import AbstractContextManager
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.live.journal import FailedProgram
    from wsgen.live.recording import Recorded, Recordings
    from wsgen.live.run import RunEnd
    from wsgen.model.behavior import BehaviorRun, LiveMeasurement
    from wsgen.pipeline.requests import SelectedLaunchFile, ValidateRequest
    from wsgen.reporting.viewing.simulation_page import RunPage
    from wsgen.ros.environment import RosEnvironment


class PageOptions(NamedTuple):
    """Where a page is served."""

    host: str
    port: int
    opens: bool  # in a browser, where there is one


def choose_page(host: str, port: int | None, *, opens: bool) -> PageOptions:
    """A page that can be served now.

    Raises:
        NotFoundError: The library for it is not installed.
        RequestError: The port is taken, or the address not one of this machine.
    """
    from wsgen.reporting.viewing.view import check_viewer, choose_port

    check_viewer()
    return PageOptions(host, choose_port(host, port), opens)


def run(
    selected: SelectedLaunchFile,
    request: ValidateRequest,
    *,
    rate: float | None,
    seconds: float | None,
    until_exit: str | None,
    is_strict: bool,
    recordings: Recordings,
    page: PageOptions | None,
    quiet: bool,
    verbose: bool,
) -> int:
    """Start a launch file, and wait for its end; gives the exit code of `ros2 launch`.

    With a `page`, the run is shown there.
    """
    import contextlib
    import sys
    from functools import partial

    import click

    from wsgen.isolation.system import require_linux

    require_linux("--run", "--play simulates the robots here.")
    from wsgen.cli import raise_dropped_end, take_all_signals
    from wsgen.cli.progress import listening
    from wsgen.cli.words import report_unfinished, unwritten, written
    from wsgen.live.prepare import RunRequest
    from wsgen.live.run import run_launch
    from wsgen.ros.environment import open_ros
    from wsgen.simulation.run import check_engines

    take_all_signals()
    check_engines(request.engines)
    if page is not None or recordings.video is not None:
        from dataclasses import replace

        request = replace(request, is_viewed=True)
    shown: list[Diagnostic] = []  # for the page
    known: set[Diagnostic] = set()
    context = click.get_current_context()
    # Only what is started prints on a terminal that shows progress, and only when that has ended.
    with contextlib.ExitStack() as progress:
        listener = progress.enter_context(listening(quiet=quiet, verbose=verbose, is_short=True))

        def open_environment(messages: Collection[str]) -> RosEnvironment:
            environment = selected.overlay.environment
            return open_ros(
                environment, messages=messages, listener=listener or (lambda _event: None)
            )

        def show(diagnostics: Iterable[Diagnostic]) -> None:
            progress.close()
            # A robot that is spawned later may have what the launch file has.
            fresh = tuple(one for one in diagnostics if one not in known)
            known.update(fresh)
            shown.extend(fresh)
            with context.scope(cleanup=False):  # robots that come later are read in a thread
                _print(fresh, verbose=verbose)
            raise_dropped_end()  # what follows is a launch, which goes on until somebody ends it

        def finish(remains: Callable[[Listener | None], Iterable[Diagnostic]]) -> None:
            with listening(quiet=quiet, verbose=verbose) as listener:
                found = remains(listener)
            _print(tuple(found), verbose=verbose)

        def report(one: Recorded) -> None:
            if one.messages == 0:
                echo(unwritten(one.file), err=True)
            elif not quiet:
                echo(f"Recorded {written(one.file)}, {_opened_by(one)}", err=True)
            if one.lost:
                echo(_lacking(one), err=True)

        is_new = seconds is not None and page is None  # --view may be
        is_terminal = sys.stdout is not None and sys.stdout.isatty()
        return run_launch(
            selected,
            RunRequest(
                prepared_as=request,
                rate=rate,
                seconds=seconds,
                until_exit=until_exit,
                is_strict=is_strict,
                recordings=recordings,
                is_colored=is_terminal if context.color is None else context.color,
            ),
            open_environment,
            show=show,
            finish=finish,
            recorded=report,
            unfinished=report_unfinished,
            ended=partial(_print_next, selected, request, quiet=quiet, is_new=is_new),
            beside=page and partial(_showing, selected, page, shown, quiet=quiet),
            listener=listener,
        )


MOST_CORRECTIONS = 3  # that are named after a run
FOR_JOINTS = "std_msgs/msg/Float64MultiArray"  # of a controller, which refuses another number
# What drives a robot a little, by the type of its topic; the first ones first.
DRIVES = {
    "geometry_msgs/msg/Twist": "{linear: {x: 0.5}}",
    "geometry_msgs/msg/TwistStamped": "{twist: {linear: {x: 0.5}}}",
    "ackermann_msgs/msg/AckermannDriveStamped": "{drive: {speed: 0.5}}",
    FOR_JOINTS: "{data: [0.5]}",
    "std_msgs/msg/Float64": "{data: 0.5}",
}


def _print_next(
    selected: SelectedLaunchFile,
    request: ValidateRequest,
    end: RunEnd,
    *,
    quiet: bool,
    is_new: bool,
) -> None:
    import contextlib
    import sys

    if quiet or sys.stderr is None or not sys.stderr.isatty():
        return
    for line in _next_steps(selected, request, end, shows=is_new):
        with contextlib.suppress(OSError):  # the terminal may be gone
            echo_next(line)


def _next_steps(
    selected: SelectedLaunchFile, request: ValidateRequest, end: RunEnd, *, shows: bool
) -> Iterator[str]:
    """What to do after a run.

    Correct what has died, or drive a robot that nobody would drive; and see what was not seen.

    Args:
        selected: What was launched.
        request: With what.
        end: How the run has ended.
        shows: Whether it could be seen in the browser next time.
    """
    import shlex

    from wsgen.cli.words import engine_words, short_name, workspace_words
    from wsgen.reporting.viewing import INSTALL, is_viewer_installed

    label = "Next:"
    workspace = workspace_words(selected.workspace)
    topics = [(one, kind) for kind in DRIVES for one, of in end.unheard.items() if of == kind]
    if end.failed:
        again = "run it again"
        if selected.workspace is not None and any(one.is_built for one in end.failed):
            again = f"run: {shlex.join(['wsgen', 'build', *workspace])}"
        yield f"{label} {_corrections(end.failed)}, and {again}"
        label = "     "
    elif topics:
        topic, kind = topics[0]
        words = [*workspace, topic, kind, DRIVES[kind], "-r", "10"]
        drive = shlex.join(["wsgen", "topic", "pub", *words])
        what = "drives a robot"
        if kind == FOR_JOINTS:
            what += ", with one number for each joint of the controller"
        yield f"{label} {drive}  ({what}; in another terminal while the run goes on)"
        label = "     "
    if shows and end.has_simulator:
        arguments = [f"{name}:={value}" for name, value in request.launch_arguments.items()]
        launched = [selected.package, selected.file.name] if selected.package else None
        words = [*(launched or [short_name(selected.file)]), *workspace, "--run", "--view"]
        run = shlex.join(["wsgen", "launch", *words, *engine_words(request), *arguments])
        after = "" if is_viewer_installed() else f"; after: {INSTALL}"
        yield f"{label} {run}  (shows the robots in the browser{after})"


def _corrections(failed: Sequence[FailedProgram]) -> str:
    """What to correct where these have died."""
    texts = list(dict.fromkeys(map(_correction, failed)))
    if len(texts) > MOST_CORRECTIONS:
        texts[MOST_CORRECTIONS:] = [f"the errors that ended {len(texts) - MOST_CORRECTIONS} more"]
    return f"correct {', '.join(texts)}"


def _correction(one: FailedProgram) -> str:
    if one.place is not None:
        return one.place
    if not one.is_of_user:
        return f"what the launch file gives {one.name}"
    if one.missing_module is not None:
        return f"the import of {one.missing_module} in {one.name} (or install it, see above)"
    return f"the error that ended {one.name}"


def _opened_by(one: Recorded) -> str:
    """How long a recording is, and what opens it."""
    import shlex

    if one.messages is None:
        return f"{one.seconds:.1f} s. Open it in a browser or a video player."
    play = shlex.join(["ros2", "bag", "play", "-s", "mcap", str(one.file)])
    how = f"Open it in Foxglove, or where ROS is installed: {play}"
    return f"{one.seconds:.1f} s, {one.messages} messages. {how}"


def _lacking(one: Recorded) -> str:
    """Say what a recording lacks."""
    counts = ", ".join(f"{count} of {topic}" for topic, count in one.lost.items())
    return (
        f"warning: {one.file.name} lacks messages that were sent: {counts}. This machine was too "
        "busy: lower --rate, or the rates and sizes of cameras."
    )


def _showing(
    selected: SelectedLaunchFile,
    page: PageOptions,
    diagnostics: Sequence[Diagnostic],
    folder: Path,
    *,
    quiet: bool,
) -> AbstractContextManager[None]:
    """Show the run of a folder in the browser."""
    from wsgen.cli.view import announce
    from wsgen.reporting.viewing.live_run import Launched, showing_run
    from wsgen.reporting.viewing.view import not_listening

    name = selected.package or selected.file.name

    def open_page() -> RunPage:
        from wsgen.reporting.viewing.simulation_page import RunPage

        try:
            made = RunPage(host=page.host, port=page.port, title=name)
        except OSError as error:
            raise not_listening(page.host, page.port, error) from error
        announce(page.host, made.port, opens=page.opens, quiet=quiet)
        return made

    def report_failure(error: BaseException) -> None:
        text = f"The page does not show the run any more: {type(error).__name__}: {error}"
        echo(f"{text}\nThe run goes on.", err=True)

    launch_file = selected.file if selected.package else None
    launched = Launched(name, launch_file, diagnostics)
    return showing_run(folder, open_page, launched, report_failure)


def run_for_behaviors(
    selected: SelectedLaunchFile, request: ValidateRequest, behavior_runs: Sequence[BehaviorRun]
) -> Mapping[str, LiveMeasurement]:
    """Run a launch file for each of these behaviors; see `wsgen.live.behaviors`."""
    from wsgen.isolation.system import require_linux

    require_linux("A behavior with run = true", "Behaviors without it are simulated here.")
    from wsgen.live.behaviors import run_live

    return run_live(selected, request, behavior_runs)


def _print(diagnostics: tuple[Diagnostic, ...], *, verbose: bool) -> None:

    from wsgen.cli.output import MOST_ALIKE, render_diagnostics, without_notes
    from wsgen.diagnostics import has_errors
    from wsgen.model.outcome import summed_up

    most_alike = None if verbose else MOST_ALIKE
    if not verbose and not has_errors(diagnostics):
        diagnostics = without_notes(diagnostics)
    for line in render_diagnostics(summed_up(diagnostics), most_alike=most_alike):
        echo(line, err=True)
