"""`wsgen launch`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.completion import complete_launch_words
from wsgen.cli.options import (
    ExampleCommand,
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
    from collections.abc import Mapping
    from pathlib import Path

    from wsgen.model.plan import LaunchPlan
    from wsgen.pipeline.request import ValidateRequest
    from wsgen.workspace.layout import Workspace
    from wsgen.workspace.overlay import Overlay


@click.command(
    cls=ExampleCommand,
    epilog="A launch file is a program, and evaluating it runs it: in a process of its own, with "
    "limits on time and memory. What it describes is not started.",
    examples=(
        "wsgen launch my_robot gazebo_model.launch.py z:=0.5",
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
    help="Show the arguments that may be given to the launch file.",
)
@click.option(
    "--play",
    is_flag=True,
    help="Do not show it but play it: spawn what it spawns into a physics engine, and check that.",
)
@click.option(
    "--record",
    type=click.Path(),
    metavar="FILE",
    help="With --play: write a video of it there, a .gif, or an .mp4 (pip install 'wsgen[video]').",
)
@picture_option
@seconds_option
@engine_option
@format_option
@output_options
def command(
    words: tuple[str, ...],
    *,
    workspace: str | None,
    show_arguments: bool,
    play: bool,
    record: str | None,
    picture: str | None,
    seconds: float,
    engine: str | None,
    output_format: str,
    quiet: bool,
    verbose: bool,
) -> int:
    """Evaluate a launch file without ROS and show what it would start.

    The words are those of `ros2 launch`: an installed package and the name of one of its launch
    files, or the path of a launch file; then launch arguments. With --play the robots stand up in
    PyBullet, and the outcome is what `wsgen validate` says.
    """
    from wsgen.cli.progress import listening
    from wsgen.cli.words import split_launch_arguments
    from wsgen.diagnostics import has_errors
    from wsgen.launch.evaluate import evaluate
    from wsgen.pipeline.clock import Clock

    place = _find_workspace(workspace, words[0])
    overlay = _source(place, is_wanted=workspace is not None)
    package, file, rest = _choose(words, place, overlay)
    arguments = split_launch_arguments(rest)
    if play and show_arguments:
        raise RequestError(
            "--show-args shows the arguments and --play plays the file.", hint="Take one of them."
        )
    if play:
        request = _request(arguments, record, picture, seconds, engine)
        return _play(
            file,
            package,
            overlay,
            request,
            place,
            output_format=output_format,
            quiet=quiet,
            verbose=verbose,
        )
    if record or picture or engine:
        raise RequestError(
            "Without --play nothing is simulated.", hint="Add --play, or leave the option out."
        )
    with (
        listening(quiet=quiet, verbose=verbose) as listener,
        Clock(package or file.stem, listener).step("launch", file.name) as step,
    ):
        plan = evaluate(
            file,
            package=package,
            arguments=arguments,
            environment=overlay.environment,
            only_arguments=show_arguments,
        )
        step.succeeded = not has_errors(plan.diagnostics)
    plan = _with_sources_named(plan, place, overlay)
    _write(plan, output_format=output_format, show_arguments=show_arguments)
    return EXIT_FAILED if has_errors(plan.diagnostics) else EXIT_PASSED


def _with_sources_named(
    plan: LaunchPlan, workspace: Workspace | None, overlay: Overlay
) -> LaunchPlan:
    """The plan whose diagnostics name the package's source, where the workspace has it."""
    share = overlay.share(plan.package) if plan.package else None
    if workspace is None or share is None or not plan.diagnostics:
        return plan
    from dataclasses import replace

    from wsgen.pipeline.package_validation import name_sources
    from wsgen.workspace.layout import find_packages

    told = plan.diagnostics
    for package in find_packages(workspace):
        if package.name == plan.package:
            told = tuple(name_sources(told, share, package.path))
    return replace(plan, diagnostics=told)


def _request(
    arguments: Mapping[str, str],
    record: str | None,
    picture: str | None,
    seconds: float,
    engine: str | None,
) -> ValidateRequest:
    from pathlib import Path

    from wsgen.pipeline.request import ValidateRequest

    return ValidateRequest(
        launch_arguments=arguments,
        seconds=seconds,
        engines=chosen_engines(engine),
        picture_folder=Path(picture) if picture else None,
        video=Path(record) if record else None,
    )


def _play(
    file: Path,
    package: str | None,
    overlay: Overlay,
    request: ValidateRequest,
    workspace: Workspace | None,
    *,
    output_format: str,
    quiet: bool,
    verbose: bool,
) -> int:
    from wsgen.cli.progress import listening
    from wsgen.cli.validate import write_outcome
    from wsgen.pipeline.validate import play

    with listening(quiet=quiet, verbose=verbose) as listener:
        outcome = play(file, package, overlay, request, workspace=workspace, listener=listener)
    write_outcome(outcome, output_format=output_format, verbose=verbose)
    return EXIT_PASSED if outcome.passed else EXIT_FAILED


def _find_workspace(given: str | None, first_word: str) -> Workspace | None:
    """The workspace that is named, or the one around the current folder or the launch file."""
    from pathlib import Path

    from wsgen.workspace.layout import find_workspace, open_workspace

    if given is not None:
        return open_workspace(given)
    if Path(first_word).is_file():
        return find_workspace(Path(first_word).resolve().parent) or find_workspace(Path.cwd())
    try:
        return open_workspace(None)
    except (NotFoundError, RequestError):  # none, or several: a sourced one may have the package
        return None


def _source(workspace: Workspace | None, *, is_wanted: bool) -> Overlay:
    """The workspace's overlay if it is built, else the environment as it is."""
    import os
    from pathlib import Path

    from wsgen.launch.known_packages import prefix
    from wsgen.workspace.overlay import Overlay, source_overlay

    if workspace is not None and (is_wanted or (workspace.install / "setup.bash").is_file()):
        return source_overlay(workspace, os.environ)
    # Where nothing is sourced, the packages of ROS that wsgen knows are all there is.
    environment = {"AMENT_PREFIX_PATH": prefix(), **os.environ}
    prefixes = environment["AMENT_PREFIX_PATH"].split(os.pathsep)
    return Overlay(
        install=Path(prefixes[0]),
        environment=environment,
        prefixes=tuple(Path(one) for one in prefixes if one),
    )


def _choose(
    words: tuple[str, ...], workspace: Workspace | None, overlay: Overlay
) -> tuple[str | None, Path, tuple[str, ...]]:
    """The package, the launch file and the launch arguments that the words mean."""
    from pathlib import Path

    from wsgen.workspace.layout import open_workspace
    from wsgen.workspace.overlay import require_share

    first, rest = words[0], words[1:]
    names_file = bool(rest) and ":=" not in rest[0]
    path = Path(first)
    if path.exists() and (not names_file or overlay.share(first) is None):
        if names_file:
            raise RequestError(
                f"{rest[0]!r} is no launch argument, and there is no package {first!r}.",
                hint="After the path of a launch file come arguments: name:=value.",
            )
        return _package_of(path), path, rest
    if not names_file and overlay.share(first) is not None:
        raise _no_file_named(first, require_share(overlay, workspace, first))
    if not names_file:
        raise RequestError(
            f"There is no launch file {first!r}.",
            hint="Give its path, or a package and the name of a launch file: "
            "wsgen launch PACKAGE FILE",
        )
    if workspace is None and overlay.share(first) is None and not overlay.packages():
        open_workspace(None)  # raises: says that there is none, or which ones there are
    share = require_share(overlay, workspace, first)
    return first, _find_file(first, share, rest[0]), rest[1:]


def _no_file_named(package: str, share: Path) -> RequestError:
    """The error for a package without the name of one of its launch files."""
    from wsgen.pipeline.selection import find_launch_files

    names = [file.name for file in find_launch_files(share)]
    if not names:
        return RequestError(
            f"{package} is a package, and has not installed a launch file.",
            hint="Install one from its CMakeLists.txt, then build again.",
        )
    return RequestError(
        f"{package} is a package: the name of the launch file is missing.",
        hint=f"wsgen launch {package} {' | '.join(names)}",
    )


def _find_file(package: str, share: Path, name: str) -> Path:
    """The file of that name anywhere in the share folder, as `ros2 launch` looks for it."""
    from wsgen.pipeline.selection import find_launch_files, no_such_launch_file

    found = sorted(file for file in share.rglob("*") if file.name == name and file.is_file())
    if len(found) == 1:
        return found[0]
    if found:
        raise RequestError(
            f"{package} has installed {name} more than once.",
            hint=f"Give the path of one: {', '.join(str(file) for file in found)}",
        )
    raise no_such_launch_file(package, name, find_launch_files(share))


def _package_of(file: Path) -> str | None:
    """The package that a launch file belongs to, by the nearest package.xml above it."""
    from wsgen.workspace.layout import read_package

    for folder in file.absolute().parents:
        if (folder / "package.xml").is_file():
            package = read_package(folder)
            return None if package is None else package.name
    return None


def _write(plan: LaunchPlan, *, output_format: str, show_arguments: bool) -> None:
    if output_format == "json":
        from wsgen.report.json_report import render_plan

        click.echo(render_plan(plan), nl=False)
        return
    from wsgen.cli.launch_tree import render_arguments, render_tree

    for line in render_arguments(plan) if show_arguments else render_tree(plan):
        click.echo(line)
