"""`wsgen launch --run`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.live.recording import Recordings
    from wsgen.pipeline.plan_launch import SelectedLaunchFile
    from wsgen.pipeline.selection import ValidateRequest
    from wsgen.ros_environment import RosEnvironment


def run(
    selected: SelectedLaunchFile,
    request: ValidateRequest,
    *,
    rate: float | None,
    seconds: float | None,
    until_exit: str | None,
    is_strict: bool,
    recordings: Recordings,
    quiet: bool,
    verbose: bool,
) -> int:
    """Start a launch file, and wait for its end; gives the exit code of `ros2 launch`."""
    import contextlib
    import sys

    import click

    if sys.platform != "linux":
        raise NotFoundError(
            "--run needs Linux: processes are ended with all that they have started by what "
            "Linux alone has.",
            hint="--play simulates the robots here; on Windows use the Windows Subsystem for "
            "Linux.",
        )
    from wsgen.cli.progress import listening
    from wsgen.live.run import RunRequest, run_launch
    from wsgen.pipeline.engines import check_engines
    from wsgen.ros_environment import open_ros

    check_engines(request.engines)
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
            _print(tuple(diagnostics), verbose=verbose)

        def finish(remains: Callable[[Listener | None], Iterable[Diagnostic]]) -> None:
            with listening(quiet=quiet, verbose=verbose) as listener:
                found = remains(listener)
            _print(tuple(found), verbose=verbose)

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
            listener=listener,
        )


def _print(diagnostics: tuple[Diagnostic, ...], *, verbose: bool) -> None:
    import click

    from wsgen.alike import summed_up
    from wsgen.cli.output import MOST_ALIKE, render_diagnostics

    most_alike = None if verbose else MOST_ALIKE
    for line in render_diagnostics(summed_up(diagnostics), most_alike=most_alike):
        click.echo(line, err=True)
