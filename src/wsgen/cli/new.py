"""`wsgen new`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

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
from wsgen.errors import EXIT_PASSED, RequestError

if TYPE_CHECKING:
    from wsgen.pipeline.create import CreatedPackage


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
        "wsgen new my_robot --set length=0.8 --license MIT",
        "wsgen new rover -t diff_drive --distro jazzy --validate",
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
    created = create(
        name,
        target=chosen_target(ctx, distro, sim),
        template_name=template,
        license_name=license_name,
        workspace_folder=workspace,
        settings=settings,
        description=description,
        maintainer_name=maintainer_name,
        maintainer_email=maintainer_email,
        workflow_service=ci,
        is_dry_run=dry_run,
        announce=partial(announce_place, given=workspace),
    )
    _print_notes(created, verbose=verbose)
    goes_on = then_build or then_validate
    if output_format == "json":
        from wsgen.reporting.json_report import render_created

        echo(render_created(created), nl=False)
    elif dry_run or not quiet:  # --dry-run is for the list of files
        _print_text(created, goes_on=goes_on)
    if dry_run or not goes_on:
        return EXIT_PASSED
    return go_on(created, validate=then_validate, quiet=quiet, verbose=verbose)


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
