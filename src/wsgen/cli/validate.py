"""`wsgen validate`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.options import (
    ExampleCommand,
    answer_option,
    argument_option,
    chosen_answers,
    chosen_engines,
    chosen_gazebo,
    complete_launch_files,
    complete_packages_and_files,
    engine_or_gazebo_option,
    github_format_option,
    jobs_option,
    output_options,
    picture_option,
    seconds_option,
    workspace_option,
)
from wsgen.cli.report_files import (
    html_option,
    junit_option,
    require_libraries,
    require_places,
    summary_option,
    write_reports,
)
from wsgen.cli.terminal import echo, echo_next
from wsgen.errors import EXIT_FAILED, EXIT_PASSED, NotFoundError, RequestError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from wsgen.model.outcome import Outcome, PackageOutcome
    from wsgen.packages.workspace.layout import Workspace
    from wsgen.pipeline.requests import ValidateRequest


MOST_SEARCHED = 100  # folders, for packages and files to suggest


@click.command(
    cls=ExampleCommand,
    epilog="For a package that is not built, its source folder is used. A FILE needs no package.",
    examples=("wsgen validate my_robot --picture .", "wsgen validate robot.urdf --engine dart"),
)
@click.argument(
    "names",
    nargs=-1,
    metavar="[PACKAGE | FILE]...",
    shell_complete=complete_packages_and_files,
)
@workspace_option
@click.option(
    "--launch",
    "launch_file",
    metavar="FILE",
    shell_complete=complete_launch_files,
    help="Name of the launch file, as for `ros2 launch`.  [default: all that spawn a robot]",
)
@argument_option
@answer_option
@seconds_option
@engine_or_gazebo_option
@jobs_option(
    "Number of packages or files to process in parallel; for a single one, number of engines."
)
@picture_option
@click.option(
    "--json", "json_file", type=click.Path(), metavar="FILE", help="File for the result as JSON."
)
@html_option
@junit_option
@summary_option
@github_format_option
# Given by `colcon validate`, which knows both.
@click.option("--install-base", type=click.Path(), hidden=True)
@click.option("--package-folder", "package_folders", multiple=True, hidden=True)
@output_options
def command(
    names: tuple[str, ...],
    *,
    workspace: str | None,
    install_base: str | None,
    package_folders: tuple[str, ...],
    launch_file: str | None,
    arguments: tuple[str, ...],
    answers: tuple[str, ...],
    seconds: float,
    engine: str | None,
    jobs: int,
    picture: str | None,
    json_file: str | None,
    junit_file: str | None,
    summary_file: str | None,
    html_file: str | None,
    output_format: str,
    quiet: bool,
    verbose: bool,
) -> int:
    """Simulate the robots that launch files spawn, and check the result.

    Without PACKAGE, validate all packages of the workspace. A FILE (.urdf, .xacro, .sdf, .world,
    or another with a <robot> or <sdf>) is simulated by itself; a robot starts just above the
    ground of an empty world. A FILE may also be a launch file of a package.
    """
    from functools import partial
    from pathlib import Path

    from wsgen.cli.live_run import run_for_behaviors
    from wsgen.cli.words import launch_file_of, split_launch_arguments
    from wsgen.pipeline.requests import ValidateRequest

    require_places(json_file, junit_file, summary_file, html_file)
    require_libraries(html_file)
    named = launch_file_of(names, launch_file)
    place = _as_colcon_says(workspace, install_base, package_folders)
    if named is not None:
        package, launch_file, around = named
        names, place = (package,), place or around
    if len(names) == 1 and Path(names[0]).is_dir() and is_file_name(names[0]):
        raise refuse_folder(Path(names[0]))
    request = ValidateRequest(
        packages=[name for name in names if not is_file_name(name)],
        files=[Path(name) for name in names if is_file_name(name)],
        launch_file=launch_file,
        launch_arguments=split_launch_arguments(arguments),
        answers=chosen_answers(answers),
        seconds=seconds,
        engines=chosen_engines(engine),
        gazebo=chosen_gazebo(engine),
        jobs=jobs,
        picture_folder=Path(picture) if picture else None,
        run_live=run_for_behaviors,
    )
    return validate_packages(
        request.for_page() if html_file else request,
        workspace=place,
        quiet=quiet,
        verbose=verbose,
        output_format=output_format,
        json_file=json_file,
        write_reports=partial(
            write_reports,
            junit_file=junit_file,
            summary_file=summary_file,
            html_file=html_file,
            quiet=quiet,
        ),
        answers=answers,
    )


def is_file_name(name: str) -> bool:
    """Whether an argument names a file, or what is taken for one, and no package."""
    import os
    from pathlib import Path

    from wsgen.pipeline.requests import FILE_SUFFIXES

    path = Path(name)
    if name.lower().endswith(FILE_SUFFIXES):
        return True
    if path.exists():
        return not path.is_dir() or os.sep in name
    bare = name.strip("./")  # PACKAGE/ also means a package
    return os.sep in bare or bool(Path(bare).suffix)


def refuse_folder(folder: Path, *, command: str = "validate") -> RequestError:
    """The error for a folder in place of a package or file; the hint names those in it."""
    from itertools import islice

    from wsgen.packages.workspace.layout import crawl, read_package
    from wsgen.pipeline.requests import FILE_SUFFIXES

    named = []
    for place, files in islice(crawl(folder), MOST_SEARCHED):
        package = read_package(place) if "package.xml" in files else None
        if package is not None:
            named.append(package.name)
        elif place == folder:
            named += [str(place / file) for file in files if file.endswith(FILE_SUFFIXES)]
    hint = f"wsgen {command} {' | '.join(sorted(named)[:3])}" if named else "Give a file in it."
    return RequestError(f"{folder} is a folder, not a file or the name of a package.", hint=hint)


def validate_packages(
    request: ValidateRequest,
    *,
    workspace: str | Workspace | None,
    quiet: bool,
    verbose: bool,
    output_format: str = "text",
    json_file: str | None = None,
    write_reports: Callable[[Outcome], None] | None = None,
    answers: Sequence[str] = (),
) -> int:
    """Validate, print the outcome, and return the exit code.

    `write_reports` writes other files about the outcome; `answers` are those of the options.
    """
    import os
    from functools import partial

    from wsgen.cli.progress import listening
    from wsgen.model.outcome import Outcome
    from wsgen.pipeline.validate import validate

    place = open_workspace_of(workspace, request)
    write = partial(
        write_outcome,
        output_format=output_format,
        json_file=json_file,
        quiet=quiet,
        verbose=verbose,
    )
    ended: list[PackageOutcome] = []
    try:
        with listening(quiet=quiet, verbose=verbose) as listener:
            outcome = validate(
                place,
                request,
                environment=os.environ,
                listener=listener,
                ended=ended,
            )
    except (KeyboardInterrupt, SystemExit):  # a signal; the exit code stays that of the signal
        stopped = Outcome(packages=tuple(ended), is_complete=False)
        if write_reports is not None:
            write_reports(stopped)
        if ended:
            write(stopped)
        else:
            _write_json(stopped, output_format=output_format, json_file=json_file)
        raise
    write(outcome)
    if write_reports is not None:
        write_reports(outcome)
    if outcome.passed and output_format == "text" and not quiet:
        for line in _next_steps(outcome, request, place, answers):
            echo_next(line)
    return EXIT_PASSED if outcome.passed else EXIT_FAILED


def _next_steps(
    outcome: Outcome,
    request: ValidateRequest,
    workspace: Workspace | None,
    answers: Sequence[str],
) -> Iterator[str]:
    """What to do next with a robot that stands; for the first one, if there are several."""
    import os
    import shlex

    from wsgen.cli.words import engine_words, workspace_words
    from wsgen.isolation.system import has_guards
    from wsgen.packages.workspace.overlay import SOURCE_USED
    from wsgen.reporting.viewing import is_viewer_installed
    from wsgen.ros.environment.environment import why_no_ros
    from wsgen.ros.environment.wheels import EXTRA

    label = "Next:"
    arguments = [f"{name}:={value}" for name, value in request.launch_arguments.items()]
    if request.picture_folder is None and any(package.robots for package in outcome.packages):
        words = [*request.packages, *map(str, request.files), *workspace_words(workspace)]
        if request.launch_file is not None:
            words += ["--launch", request.launch_file]
        for argument in arguments:
            words += ["--arg", argument]
        for answer in answers:
            words += ["--answer", answer]
        words += _simulation_options(request)
        yield f"{label} {shlex.join(['wsgen', 'validate', *words, '--picture', '.'])}"
        label = "     "
    found = [one for package in outcome.packages for one in package.diagnostics]
    if any(one.code == SOURCE_USED.code for one in found):
        if any(package.package for package in outcome.packages):
            yield f"{label} {shlex.join(['wsgen', 'build', *workspace_words(workspace)])}"
        return
    for package in outcome.packages:
        if package.package is not None and package.launch_file is not None:
            words = ["launch", package.package, package.launch_file.name]
            ros2 = shlex.join(["ros2", *words, *arguments])
            why_not = why_no_ros(os.environ)
            if has_guards() and (why_not is None or EXTRA in why_not.hint):
                is_one = len(request.engines) == 1  # a live run is in one
                engine = engine_words(request) if is_one else []
                view = ["--view"] if is_viewer_installed() else []  # it would refuse to start
                options = [*workspace_words(workspace), "--run", *view, *engine]
                run = shlex.join(["wsgen", *words, *options, *arguments])
                after = "" if why_not is None else f"; after: {EXTRA}"
                yield f"{label} {run}  (starts its nodes, too, without ROS{after})"
                label = "     "
            yield f"{label} {ros2}  (where ROS and install/setup.bash are sourced)"
            break


def _simulation_options(request: ValidateRequest) -> list[str]:
    """`--seconds` and `--engine`, where they differ from the defaults."""
    from wsgen.cli.words import engine_words
    from wsgen.pipeline.requests import ValidateRequest

    words = []
    if request.seconds != ValidateRequest().seconds:
        words += ["--seconds", f"{request.seconds:g}"]
    return [
        *words,
        *(["--engine", "gazebo"] if request.gazebo == "required" else engine_words(request)),
    ]


def _as_colcon_says(
    workspace: str | None, install_base: str | None, package_folders: Sequence[str]
) -> str | Workspace | None:
    """The workspace whose packages colcon has found, and whose install space it names."""
    if install_base is None:
        return workspace
    from pathlib import Path

    from wsgen.packages.workspace.layout import Workspace

    return Workspace(
        root=Path(workspace or ".").absolute(),
        package_folders=tuple(Path(folder).absolute() for folder in package_folders),
        install_base=Path(install_base).absolute(),
    )


def open_workspace_of(given: str | Workspace | None, request: ValidateRequest) -> Workspace | None:
    """The selected workspace; None if only files are given and no workspace is found.

    Files belong to the clone around them, not to that around the current folder.
    """
    from wsgen.packages.workspace.layout import Workspace, open_workspace

    if isinstance(given, Workspace):
        return given
    has_only_files = bool(request.files) and not request.packages
    try:
        return open_workspace(given, takes_packages=not has_only_files)
    except (NotFoundError, RequestError):
        if given is None and has_only_files:
            return None
        raise


def write_outcome(
    outcome: Outcome,
    *,
    output_format: str,
    json_file: str | None = None,
    quiet: bool = False,
    verbose: bool,
) -> None:
    """Print the outcome as text or as JSON, and write the JSON file if one is wanted."""
    _write_json(outcome, output_format=output_format, json_file=json_file)
    if output_format == "json":
        return
    if output_format == "github":
        _print_github(outcome, verbose=verbose)
        return
    from wsgen.cli.output import render_outcome

    for line in render_outcome(outcome, verbose=verbose, quiet=quiet):
        echo(line)


def _print_github(outcome: Outcome, *, verbose: bool) -> None:
    """Print the annotations of GitHub for what is reported, each once."""
    from pathlib import Path

    from wsgen.reporting.check_formats import Places, render_github

    found = dict.fromkeys(one for package in outcome.packages for one in package.diagnostics)
    for line in render_github(found, Places(), Path.cwd(), verbose=verbose):
        echo(line)


def _write_json(outcome: Outcome, *, output_format: str, json_file: str | None) -> None:
    """Write the JSON to the file, standard output, both or neither."""
    if json_file is None and output_format != "json":
        return
    from wsgen.reporting.json_report import render_outcome

    document = render_outcome(outcome)
    if json_file:
        from pathlib import Path

        from wsgen.text.files import write_file

        write_file(Path(json_file), document)
    if output_format == "json":
        echo(document, nl=False)
