"""`wsgen new`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from wsgen.cli.options import (
    Choice,
    ExampleCommand,
    chosen_engines,
    chosen_target,
    complete_templates,
    distro_option,
    format_option,
    output_options,
    sim_option,
    workspace_option,
)
from wsgen.cli.terminal import echo, echo_next
from wsgen.errors import EXIT_FAILED, EXIT_PASSED, RequestError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from wsgen.packages.workspace.layout import Workspace
    from wsgen.pipeline.create import CreatedPackage
    from wsgen.porting.existing.comparison import ComparedRow
    from wsgen.porting.existing.package import ExistingRobot

MOST_NAMES = 5  # in a row of a comparison


class NewCommand(ExampleCommand):
    """A command whose help ends with the templates and licenses."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List them as they are installed; only --help loads them."""
        from wsgen.templating.spec import license_names
        from wsgen.templating.template import load_template, template_names

        with formatter.section("Templates, with variables that `wsgen templates NAME` explains"):
            formatter.write_dl(
                [
                    (name, f"{template.description} {' '.join(template.variables)}")
                    for name in template_names()
                    for template in [load_template(name)]
                ]
            )
        with formatter.section("Licenses"):
            formatter.write_text(", ".join(license_names()))
        super().format_epilog(ctx, formatter)


@click.command(
    cls=NewCommand,
    examples=(
        "wsgen new rover -t diff_drive --set wheel_radius=0.1 --distro jazzy --validate",
        "wsgen new my_arm --from exports/arm_description.zip --distro jazzy",
    ),
)
@click.argument("name", metavar="PACKAGE")
@workspace_option
@click.option(
    "-t",
    "--template",
    default="simple",
    metavar="NAME|FOLDER",
    show_default=True,
    shell_complete=complete_templates,
    help="Template of the robot: its name, or the folder of your own template.",
)
@distro_option
@sim_option
@click.option(
    "--set", "settings", multiple=True, metavar="KEY=VALUE", help="Variable of the template."
)
@click.option(
    "--from",
    "source",
    metavar="PATH",
    help="Robot that exists already, instead of a template: a URDF or xacro file, a folder, a zip.",
)
@click.option(
    "--arg",
    "arguments",
    multiple=True,
    metavar="NAME:=VALUE",
    help="With --from: argument of the xacro file.",
)
@click.option(
    "--copy-outside",
    is_flag=True,
    help="With --from: also copy meshes that are outside of PATH.",
)
@click.option(
    "--control",
    type=Choice(["none", "position", "velocity", "effort", "diff_drive"]),
    default="none",
    show_default=True,
    help="With --from: what moves the joints.",
)
@click.option(
    "--wheel",
    "wheels",
    multiple=True,
    metavar="SIDE:JOINT",
    help="With --control diff_drive: a wheel that is driven, as left:JOINT or right:JOINT.",
)
@click.option(
    "--sensor",
    "sensors",
    multiple=True,
    metavar="KIND:LINK",
    help="With --from: sensor on a link, as lidar:LINK, camera:LINK or imu:LINK.",
)
@click.option(
    "--fix",
    "fixes",
    is_flag=True,
    help="With --from: fix what simulators refuse of the robot, or change.",
)
@click.option(
    "--bolted", is_flag=True, help="With --from: fix the root link of the robot to the ground."
)
@click.option("--description", metavar="TEXT", help="Description of the package.")
@click.option(
    "--license",
    "license_name",
    default="Apache-2.0",
    metavar="SPDX",
    show_default=True,
    help="License; its text is written to the package.",
)
@click.option("--maintainer-name", metavar="TEXT", help="[default: git's user.name]")
@click.option("--maintainer-email", metavar="ADDRESS", help="[default: git's user.email]")
@click.option(
    "--ci",
    type=Choice(["github", "gitlab"]),
    help="Also write a CI workflow that builds with wsgen and with the target's ROS.",
)
@click.option("--dry-run", is_flag=True, help="List the files without writing them.")
@click.option("--build", "then_build", is_flag=True, help="Build the package afterwards.")
@click.option(
    "--validate", "then_validate", is_flag=True, help="Build and validate the package afterwards."
)
@format_option
@output_options
@click.pass_context
def command(
    ctx: click.Context,
    name: str,
    *,
    workspace: str | None,
    template: str,
    distro: str,
    sim: str | None,
    settings: tuple[str, ...],
    source: str | None,
    arguments: tuple[str, ...],
    copy_outside: bool,
    control: str,
    wheels: tuple[str, ...],
    sensors: tuple[str, ...],
    fixes: bool,
    bolted: bool,
    description: str | None,
    license_name: str,
    maintainer_name: str | None,
    maintainer_email: str | None,
    ci: str | None,
    dry_run: bool,
    then_build: bool,
    then_validate: bool,
    output_format: str,
    quiet: bool,
    verbose: bool,
) -> int:
    """Create a package with a robot, and a workspace if none exists."""
    from functools import partial

    from wsgen.cli.words import announce_place
    from wsgen.pipeline.create import create

    if output_format == "json" and (then_build or then_validate):
        raise RequestError(
            "--format json cannot be combined with --build or --validate.",
            hint="Run `wsgen build` and `wsgen validate --format json` separately.",
        )
    request: dict[str, Any] = {
        "target": chosen_target(ctx, distro, sim),
        "license_name": license_name,
        "workspace_folder": workspace,
        "settings": settings,
        "description": description,
        "maintainer_name": maintainer_name,
        "maintainer_email": maintainer_email,
        "workflow_service": ci,
    }
    announce = partial(announce_place, given=workspace)
    existing = None
    words: dict[str, Any] = {
        "--arg": arguments,
        "--copy-outside": copy_outside,
        "--control": "" if control == "none" else control,
        "--wheel": wheels,
        "--sensor": sensors,
        "--fix": fixes,
        "--bolted": bolted,
    }
    if source is None:
        _refuse_without_source(words)
        created = create(
            name, template_name=template, is_dry_run=dry_run, announce=announce, **request
        )
    else:
        request["settings"] = (f"control={control}",)
        existing = _create_existing(
            ctx, name, source, words, request, is_dry_run=dry_run, announce=announce
        )
        created = existing.created
    _print_notes(created, verbose=verbose)
    goes_on = then_build or then_validate
    if output_format == "json":
        from wsgen.reporting.json_report import render_created

        echo(render_created(created, existing), nl=False)
    elif dry_run or not quiet:  # --dry-run is for the list of files
        if existing is not None:
            _print_existing(existing, quiet=quiet, verbose=verbose)
        _print_text(created, goes_on=goes_on)
    if dry_run or not goes_on:
        return EXIT_PASSED if existing is None or existing.passed else EXIT_FAILED
    return go_on(created, validate=then_validate, quiet=quiet, verbose=verbose)


def _refuse_without_source(given: Mapping[str, object]) -> None:
    """Refuse options that would have no effect.

    Raises:
        RequestError: One is given.
    """
    for option, value in given.items():
        if value:
            raise RequestError(
                f"{option} is for a robot that exists already.",
                hint=f"Add --from PATH, or omit {option}.",
            )


def _create_existing(
    ctx: click.Context,
    name: str,
    source: str,
    words: Mapping[str, Any],
    request: Mapping[str, Any],
    *,
    is_dry_run: bool,
    announce: Callable[[Workspace], None],
) -> ExistingRobot:
    """Write a package of a robot that exists."""
    import os

    from wsgen.cli.words import split_launch_arguments
    from wsgen.pipeline.create import plan_new
    from wsgen.porting.existing.extensions import Wanted
    from wsgen.porting.existing.package import TEMPLATE, ExistingRequest, create_existing
    from wsgen.templating.template import load_template

    def is_given(option: str) -> bool:
        return ctx.get_parameter_source(option) is ParameterSource.COMMANDLINE

    for option, parameter in (("--template", "template"), ("--set", "settings")):
        if is_given(parameter):
            raise RequestError(
                f"{option} cannot be combined with --from: the robot is that of its source.",
                hint=f"Omit {option}, or --from.",
            )
    planned = plan_new(name, template=load_template(TEMPLATE, may_be_abstract=True), **request)
    control = words["--control"] or "none"
    return create_existing(
        planned,
        ExistingRequest(
            source,
            arguments=split_launch_arguments(words["--arg"]),
            copy_outside=words["--copy-outside"],
            keeps_license=not is_given("license_name"),
            wanted=Wanted(control, words["--wheel"], words["--sensor"]),
            is_bolted=words["--bolted"],
            fixes=words["--fix"],
        ),
        environment=os.environ,
        is_dry_run=is_dry_run,
        announce=announce,
    )


def _print_existing(existing: ExistingRobot, *, quiet: bool, verbose: bool) -> None:
    """Print the comparison, what was done, and what simulators make of the robot."""
    from wsgen.cli.output import MOST_ALIKE, render_diagnostics
    from wsgen.cli.terminal import draw_table
    from wsgen.cli.words import short_path

    rows = [
        (
            row.aspect,
            row.source,
            row.package,
            _verdict(row),
        )
        for row in existing.rows
    ]
    echo(f"Read {existing.source}")
    for line in draw_table(rows, headings=("", "source", "package", ""), quiet=quiet):
        echo(line)
    for sentence in existing.fixes:
        echo(f"fixed: {sentence}")
    for note in existing.notes:
        echo(f"note: {note}", err=True)
    for one in existing.unported:
        echo(f"{short_path(one.file)}:{one.line}: {one.what} {one.advice}", err=True)
    if existing.diagnostics:
        echo("What simulators make of it:", err=True)
        for line in render_diagnostics(
            existing.diagnostics, most_alike=None if verbose else MOST_ALIKE
        ):
            echo(line, err=True)
    if existing.fixable:
        echo(f"Fixable with --fix: {', '.join(existing.fixable)}.", err=True)


def _verdict(row: ComparedRow) -> str:
    if row.is_same:
        return "same"
    names = ", ".join(row.differing[:MOST_NAMES])
    more = len(row.differing) - MOST_NAMES
    word = "fixed" if row.is_fixed else "different"
    return f"{word}: {names}{f' and {more} more' if more > 0 else ''}"


def _print_notes(created: CreatedPackage, *, verbose: bool) -> None:
    if created.placeholder_email is not None:
        _note(
            f"git has no usable user.email. package.xml has the placeholder"
            f" {created.placeholder_email}: change it, or give --maintainer-email."
        )
    if created.kept_file is not None and verbose:
        from wsgen.cli.words import short_name

        _note(f"{short_name(created.kept_file)} already exists and is not changed.")
    if created.is_of_ros:
        _note(
            f"ROS has a package {created.folder.name}: where this one is built and sourced, it"
            " hides that one. Choose another name, unless it is to replace it."
        )
    if created.end_of_life is not None:
        _note(created.end_of_life)
    if created.repository is not None:
        _note(
            f"CI services read workflows only at the top of the repository, {created.repository}."
            " Move the workflow there, and have it run its steps in"
            f" {created.workspace.root.relative_to(created.repository)}."
        )


def _note(text: str) -> None:
    echo(f"note: {text}", err=True)


def _print_text(created: CreatedPackage, *, goes_on: bool) -> None:
    """Print what was written; the next step, unless wsgen `goes_on` to take it."""
    from wsgen.cli.words import next_command, short_name
    from wsgen.text.printable import clean_line

    workspace, folder = created.workspace, created.folder
    beside = [workspace.root / name for name in created.workspace_files]
    if not created.is_written:
        for path in (*(folder / name for name in created.files), *beside):
            echo(clean_line(str(path)))
        echo("Nothing was written.", err=True)
        return
    for path in (folder, *beside):
        echo(f"Wrote {short_name(path)}")
    if not goes_on:
        next_step = next_command(workspace, "wsgen build", "wsgen validate")
        echo_next(f"Next: {next_step}", err=False)


def go_on(created: CreatedPackage, *, validate: bool, quiet: bool, verbose: bool) -> int:
    """Build the package, then validate it if that is wanted; the exit code."""
    from wsgen.cli.build import build_workspace

    package, root = created.folder.name, str(created.workspace.root)
    code = build_workspace(
        (package,), workspace=root, quiet=quiet, verbose=verbose, goes_on=validate
    )
    if code != EXIT_PASSED or not validate:
        return code
    from wsgen.cli.validate import validate_packages
    from wsgen.pipeline.requests import ValidateRequest

    request = ValidateRequest(packages=(package,), engines=chosen_engines(None))
    return validate_packages(request, workspace=root, quiet=quiet, verbose=verbose)
