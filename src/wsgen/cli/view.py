"""`wsgen view`, `wsgen launch --play --view`, and the address of pages in a browser."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.options import (
    ExampleCommand,
    answer_option,
    argument_option,
    chosen_answers,
    complete_launch_files,
    complete_packages_and_files,
    output_options,
    page_options,
    workspace_option,
)
from wsgen.cli.terminal import echo
from wsgen.errors import EXIT_FAILED, EXIT_PASSED, WsgenError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from wsgen.pipeline.describe import DescribedScene
    from wsgen.pipeline.requests import SelectedLaunchFile, ValidateRequest
    from wsgen.reporting.viewing.view import View


@click.command(
    cls=ExampleCommand,
    epilog="For a package that is not built, its source folder is used. Ctrl-C ends the viewer.",
    examples=("wsgen view my_robot", "wsgen view robot.urdf.xacro --arg arm:=true"),
)
@click.argument("name", metavar="PACKAGE|FILE", shell_complete=complete_packages_and_files)
@workspace_option
@click.option(
    "--launch",
    "launch_file",
    metavar="FILE",
    shell_complete=complete_launch_files,
    help="Name of the launch file, as for `ros2 launch`.  [default: the first that spawns a robot]",
)
@argument_option
@answer_option
@page_options
@output_options
def command(
    name: str,
    *,
    workspace: str | None,
    launch_file: str | None,
    arguments: tuple[str, ...],
    answers: tuple[str, ...],
    host: str,
    port: int | None,
    no_browser: bool,
    quiet: bool,
    verbose: bool,
) -> int:
    """Show a robot in the browser, with a slider for each joint.

    The robot of a package is the one that its launch file spawns, in its world; a FILE is a .urdf,
    .xacro, .sdf, .world or launch file. The page shows visuals, collisions, inertias, frames and
    diagnostics, and loads the robot again when one of its files changes.
    """
    import os
    from contextlib import closing
    from pathlib import Path

    from wsgen.cli.progress import listening
    from wsgen.cli.validate import is_file_name, open_workspace_of, refuse_folder
    from wsgen.cli.words import launch_file_of, split_launch_arguments
    from wsgen.pipeline.describe import describe
    from wsgen.pipeline.requests import ValidateRequest
    from wsgen.reporting.viewing.view import View, check_viewer, choose_port

    check_viewer()
    port = choose_port(host, port)
    named = launch_file_of([name], launch_file)
    around = None
    if named is not None:
        name, launch_file, around = named
    is_file = is_file_name(name)
    if is_file and Path(name).is_dir():
        raise refuse_folder(Path(name), command="view")
    request = ValidateRequest(
        packages=() if is_file else (name,),
        files=(Path(name),) if is_file else (),
        launch_file=launch_file,
        launch_arguments=split_launch_arguments(arguments),
        answers=chosen_answers(answers),
        engines=(),
        is_viewed=True,
    )
    place = open_workspace_of(workspace or around, request)

    def read(folder: Path) -> DescribedScene:
        with listening(quiet=quiet, verbose=verbose) as listener:
            return describe(place, request, folder, environment=os.environ, listener=listener)

    with closing(View(read)) as view:
        found = view.open()
        print_diagnostics(found, verbose=verbose)
        if not found.can_be_shown:
            return EXIT_FAILED
        if found.others and not quiet:
            names = ", ".join(file.name for file in found.others)
            echo(f"Other launch files that spawn robots: {names} (--launch FILE)", err=True)
        _serve(view, found.name, host, port, opens=not no_browser, quiet=quiet, verbose=verbose)
    return EXIT_PASSED


def _serve(
    view: View, name: str, host: str, port: int, *, opens: bool, quiet: bool, verbose: bool
) -> None:
    """Serve the page until the user ends it with Ctrl-C, which is how a viewer ends."""
    from contextlib import suppress
    from pathlib import Path

    from wsgen.cli.words import short_path
    from wsgen.reporting.viewing.page import JointPage

    def report(changed: Sequence[str], found: DescribedScene | WsgenError) -> None:
        if not quiet:
            first = short_path(Path(changed[0]))
            more = f" and {len(changed) - 1} more" if len(changed) > 1 else ""
            echo(f"Changed: {first}{more}", err=True)
        if isinstance(found, WsgenError):
            echo(f"error: {found.message}\n  try: {found.hint}", err=True)
        else:
            print_diagnostics(found, verbose=verbose)

    with suppress(KeyboardInterrupt):
        page = JointPage(host=host, port=port, title=name)
        try:
            view.show(page)
            announce(host, page.port, opens=opens, quiet=quiet)
            view.follow(page, on_change=report)
        finally:
            page.stop()


def print_diagnostics(found: DescribedScene, *, verbose: bool) -> None:
    """Print what is reported of robots that are shown; the page has it, too."""
    from wsgen.cli.output import MOST_ALIKE, render_diagnostics

    most_alike = None if verbose else MOST_ALIKE
    for line in render_diagnostics(found.diagnostics, most_alike=most_alike):
        echo(line, err=True)


def announce(host: str, port: int, *, opens: bool, quiet: bool) -> None:
    """Print the address of a page; open it in a browser if `opens` and somebody would see it."""
    url = url_of(host, port)
    echo(url)
    is_seen = opens and _has_desktop() and _open(url)
    if not quiet:
        what = "" if is_seen else "Open this address in a browser. "
        echo(f"{what}Press Ctrl-C to end.", err=True)


def url_of(host: str, port: int) -> str:
    """The address of a page that is served on this machine."""
    name = {"0.0.0.0": "127.0.0.1", "::": "[::1]"}.get(host)  # noqa: S104  an address to open
    return f"http://{name or (f'[{host}]' if ':' in host else host)}:{port}"


def _has_desktop() -> bool:
    """Whether a browser would have a window: not in CI, and not on a machine without a display."""
    import os
    import sys

    if os.environ.get("CI"):
        return False
    if sys.platform.startswith("linux"):
        return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return True


def _open(url: str) -> bool:
    import webbrowser

    try:
        return webbrowser.open(url)
    except webbrowser.Error:
        return False


def view_simulation(
    selected: SelectedLaunchFile,
    request: ValidateRequest,
    host: str,
    port: int | None,
    *,
    opens: bool,
    quiet: bool,
    verbose: bool,
) -> int:
    """Simulate what a launch file spawns, and show it until the user ends it with Ctrl-C."""
    from contextlib import closing, suppress
    from dataclasses import replace

    from wsgen.cli.progress import listening
    from wsgen.isolation.parent import make_scratch
    from wsgen.pipeline.describe import describe_launch
    from wsgen.pipeline.run_robots import spawned_robots
    from wsgen.reporting.viewing.view import check_viewer, choose_port
    from wsgen.simulation.run import check_engines
    from wsgen.simulation.scene import Scene
    from wsgen.simulation.session import Session

    check_viewer()
    check_engines(request.engines)
    port = choose_port(host, port)
    viewed = replace(request, is_viewed=True)
    with make_scratch() as folder:
        with listening(quiet=quiet, verbose=verbose) as listener:
            found = describe_launch(selected, viewed, folder, listener=listener)
        print_diagnostics(found, verbose=verbose)
        runnable = [robot for robot in found.robots if robot.can_run]
        if found.world is None or all(robot.is_static_model for robot in runnable):
            return EXIT_FAILED
        robots = spawned_robots(runnable)
        scene = Scene(world=found.world, robots=robots, engine=request.engines[0])
        # It takes half a second to import, and serves nothing that has an error.
        from wsgen.reporting.viewing.play import Player
        from wsgen.reporting.viewing.simulation_page import SimulationPage

        with suppress(KeyboardInterrupt):
            page = SimulationPage(host=host, port=port, title=found.name)
            try:
                with closing(Player(found, lambda: Session(scene, remembered=0), page)) as player:
                    announce(host, page.port, opens=opens, quiet=quiet)
                    player.run()
            finally:
                page.stop()
    return EXIT_PASSED
