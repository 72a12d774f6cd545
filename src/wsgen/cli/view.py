"""`wsgen view`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.completion import complete_launch_files, complete_packages_and_files
from wsgen.cli.options import (
    ExampleCommand,
    answer_option,
    argument_option,
    chosen_answers,
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

    from wsgen.cli.browser import announce
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
