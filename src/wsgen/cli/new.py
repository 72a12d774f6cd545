"""`wsgen new`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.completion import complete_templates
from wsgen.cli.options import (
    ExampleCommand,
    chosen_engines,
    chosen_target,
    distro_option,
    format_option,
    output_options,
    sim_option,
    workspace_option,
)
from wsgen.errors import EXIT_PASSED, RequestError

if TYPE_CHECKING:
    from wsgen.model.package import Maintainer, PackageSpec
    from wsgen.model.target import Target
    from wsgen.templating.manifest import Template
    from wsgen.templating.render import RenderedTree
    from wsgen.workspace.layout import Workspace


DEFAULT_WORKSPACE = "ws_gazebo"


class NewCommand(ExampleCommand):
    """A command whose help ends with what the templates and the licenses are."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List them as they are on this disk; only --help pays for it."""
        from wsgen.templating.manifest import load_template, template_names
        from wsgen.templating.spec import license_names

        with formatter.section("Templates, with variables that `wsgen templates NAME` explains"):
            formatter.write_dl(
                [
                    (name, f"{template.description} {' '.join(template.variables)}")
                    for name in template_names()
                    for template in [load_template(name)]
                ]
            )
        with formatter.section("Licences"):
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
    help="What kind of robot; a FOLDER is a template of yours.",
)
@distro_option
@sim_option
@click.option(
    "--set", "settings", multiple=True, metavar="KEY=VALUE", help="A variable of the template."
)
@click.option("--description", metavar="TEXT", help="What the package is for.")
@click.option(
    "--license",
    "license_name",
    default="Apache-2.0",
    metavar="SPDX",
    show_default=True,
    help="Licence; its text is written, too.",
)
@click.option("--maintainer-name", metavar="TEXT", help="[default: git's user.name]")
@click.option("--maintainer-email", metavar="ADDRESS", help="[default: git's user.email]")
@click.option(
    "--ci",
    type=click.Choice(["github", "gitlab"]),
    help="Write a workflow for the workspace, too: wsgen without ROS, and the target's ROS.",
)
@click.option("--dry-run", is_flag=True, help="Only say which files would be written.")
@click.option("--build", "then_build", is_flag=True, help="Build it at once.")
@click.option("--validate", "then_validate", is_flag=True, help="Build and validate it at once.")
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
    """Write a package with a robot, and the workspace around it if there is none."""
    from dataclasses import replace

    from wsgen.cli.new_output import (
        ignore_files,
        note_repository,
        tell_json,
        tell_text,
        workflow_files,
    )
    from wsgen.templating.manifest import load_template
    from wsgen.templating.spec import make_spec
    from wsgen.templating.write import adding_files, refuse_files, write_package
    from wsgen.workspace.entities import spawned_entities

    if output_format == "json" and (then_build or then_validate):
        raise RequestError(
            "--format json gives what was written, and nothing after it.",
            hint="Call `wsgen build` and `wsgen validate --format json` by themselves.",
        )
    target = chosen_target(ctx, distro, sim)
    selected = load_template(template)
    spec = make_spec(
        name,
        template=selected,
        target=target,
        maintainer=_choose_maintainer(maintainer_name, maintainer_email),
        license_name=license_name,
        settings=settings,
        description=description,
    )
    place = _choose_place(workspace, spec.name)
    spec = replace(spec, taken_entities=spawned_entities(place))
    folder = place.source / spec.name
    workflow = workflow_files(ci, target)
    refuse_files(workflow, place.root)
    ignored = ignore_files(place, verbose=verbose)
    tree = _render(spec, selected)
    if not dry_run:
        with adding_files(workflow, place.root, where_missing=ignored):
            write_package(tree, folder)
    _note_end_of_life(target)
    if workflow:
        note_repository(place.root)
    tell = tell_json if output_format == "json" else tell_text
    goes_on = then_build or then_validate
    if dry_run or output_format == "json" or not quiet:  # these two give the list of files
        tell(
            place,
            folder,
            list(tree),
            [*ignored, *workflow],
            is_written=not dry_run,
            goes_on=goes_on,
        )
    if dry_run or not goes_on:
        return EXIT_PASSED
    return go_on(place, spec.name, validate=then_validate, quiet=quiet, verbose=verbose)


def _note_end_of_life(target: Target) -> None:
    import time

    from wsgen.model.target import end_of_life_note

    note = end_of_life_note(target, time.strftime("%Y-%m-%d"))
    if note is not None:
        click.echo(f"note: {note}", err=True)


def _render(spec: PackageSpec, template: Template) -> RenderedTree:
    """The files of the package; a template of the user is rendered in a process of its own."""
    if template.is_shipped:
        from wsgen.templating.render import render_package

        return render_package(spec, template)
    from wsgen.templating.render_apart import render_package_apart

    return render_package_apart(spec, template)


def go_on(workspace: Workspace, package: str, *, validate: bool, quiet: bool, verbose: bool) -> int:
    """Build the package, then validate it if that is wanted; the exit code."""
    from wsgen.cli.build import build_workspace

    root = str(workspace.root)
    code = build_workspace(
        (package,), workspace=root, quiet=quiet, verbose=verbose, goes_on=validate
    )
    if code != EXIT_PASSED or not validate:
        return code
    from wsgen.cli.validate import validate_packages
    from wsgen.pipeline.request import ValidateRequest

    request = ValidateRequest(packages=(package,), engines=chosen_engines(None))
    return validate_packages(request, workspace=root, quiet=quiet, verbose=verbose)


def _choose_place(given: str | None, name: str) -> Workspace:
    """The workspace, if a package of this name can be written into it."""
    from wsgen.templating.write import refuse_existing
    from wsgen.workspace.paths import check_workspace_path

    place = choose_workspace(given)
    check_workspace_path(place.root)
    refuse_existing(place.source / name)
    refuse_duplicate(name, place)
    return place


def choose_workspace(given: str | None) -> Workspace:
    """The given folder, else the workspace around the current one, else ./ws_gazebo.

    Raises:
        RequestError: the given folder is the source folder of another workspace, or is among its
            packages.
    """
    from pathlib import Path

    from wsgen.workspace.layout import Workspace, find_workspace, workspace_of_source_folder

    if given is None:
        here = Path.cwd()
        return (
            find_workspace(here)
            or workspace_of_source_folder(here)
            or Workspace(root=here / DEFAULT_WORKSPACE)
        )
    root = Path(given).expanduser().absolute()
    around = find_workspace(root)
    if around is None and root.name == "src":
        around = workspace_of_source_folder(root)
    if around is not None and (root == around.source or around.source in root.parents):
        raise RequestError(
            f"{root} lies among the packages of the workspace {around.root}.",
            hint=f"Give the workspace itself: -w {around.root}",
        )
    return Workspace(root=root)


def refuse_duplicate(name: str, workspace: Workspace) -> None:
    """Stop if the workspace has a package of this name: colcon builds none of two.

    Raises:
        WouldOverwriteError: it has; says where.
    """
    from wsgen.errors import WouldOverwriteError
    from wsgen.workspace.layout import find_packages

    for package in find_packages(workspace):
        if package.name == name:
            raise WouldOverwriteError(
                f"The workspace has a package {name} in {package.path}; nothing was written.",
                hint="Take another name: colcon refuses two packages of one name.",
            )


def _choose_maintainer(name: str | None, email: str | None) -> Maintainer:
    """What is given; git is asked for the rest."""
    if name is not None and email is not None:
        from wsgen.templating.spec import make_maintainer

        return make_maintainer(name, email)
    from wsgen.templating.maintainer import UNKNOWN_DOMAIN, find_maintainer

    maintainer = find_maintainer(name, email)
    if email is None and maintainer.email.endswith(f"@{UNKNOWN_DOMAIN}"):
        click.echo(
            f"note: git knows no usable user.email: {maintainer.email} in package.xml is to be"
            " changed. Or give --maintainer-email.",
            err=True,
        )
    return maintainer
