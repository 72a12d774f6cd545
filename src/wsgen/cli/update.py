"""`wsgen update`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.options import Choice, ExampleCommand, output_options, workspace_option
from wsgen.cli.terminal import echo, echo_next
from wsgen.errors import EXIT_FAILED, EXIT_PASSED

if TYPE_CHECKING:
    from wsgen.pipeline.update import UpdatePlan


@click.command(
    cls=ExampleCommand,
    epilog="Conflicts are marked as git marks them, and listed; then the exit code is 1.",
    examples=(
        "wsgen update my_robot --diff",
        "wsgen update my_robot --set wheel_radius=0.1 --distro jazzy",
    ),
)
@click.argument("package", required=False, metavar="[PACKAGE]")
@workspace_option
@click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="KEY=VALUE",
    help="Variable of the template, to be changed.",
)
@click.option("--distro", metavar="NAME", help="ROS 2 distribution to change to.")
@click.option(
    "--sim",
    type=Choice(["classic", "gz"], meant={"ign": "gz", "ignition": "gz"}),
    help="Simulator to change to.",
)
@click.option(
    "-t",
    "--template",
    metavar="FOLDER",
    help="Where your own template is now.  [default: where it was]",
)
@click.option("--diff", is_flag=True, help="Show what would change; write nothing.")
@click.option(
    "--ours", "prefer", flag_value="ours", help="In conflicts, keep your lines instead of marks."
)
@click.option(
    "--theirs", "prefer", flag_value="theirs", help="In conflicts, take the template's lines."
)
@click.option("--force", is_flag=True, help="Write also over changes that are not committed.")
@output_options
def command(
    package: str | None,
    *,
    workspace: str | None,
    settings: tuple[str, ...],
    distro: str | None,
    sim: str | None,
    template: str | None,
    diff: bool,
    prefer: str | None,
    force: bool,
    quiet: bool,
    verbose: bool,  # noqa: ARG001  nothing more to say
) -> int:
    """Merge what the template of a package has become into what you made of the package.

    PACKAGE is one of `wsgen new`, by its name or folder. Without PACKAGE, it is the one around the
    current folder, or the only one of the workspace.
    """
    from wsgen.pipeline.update import (
        UpdateRequest,
        find_package,
        plan_update,
        refuse_unsaved,
        write_update,
    )

    folder = find_package(package, workspace)
    request = UpdateRequest(settings, distro, sim, template, prefer or "")
    plan = plan_update(folder, request)
    if diff:
        _print_diff(plan)
    elif plan.writes:
        if not force:
            refuse_unsaved(folder)
        write_update(plan)
    _print_plan(plan, is_diff=diff, quiet=quiet)
    return EXIT_FAILED if plan.conflicts and not diff else EXIT_PASSED


def _print_plan(plan: UpdatePlan, *, is_diff: bool, quiet: bool) -> None:
    """Print what happens to the files, and the next step."""
    from wsgen import __version__
    from wsgen.cli.words import short_path
    from wsgen.pipeline.merged_files import CONFLICT, KEPT

    for note in plan.notes:
        echo(f"note: {note}", err=True)
    for change in plan.changes:
        if quiet and change.kind not in {CONFLICT, KEPT}:
            continue
        note = f"  {change.note}" if change.note else ""
        echo(f"{change.kind:<9}{short_path(plan.folder / change.path)}{note}", err=is_diff)
    if is_diff or quiet:
        return
    if not plan.changes:
        echo(
            f"Nothing to update: {plan.folder.name} has the template {plan.template} of wsgen"
            f" {__version__}, with these answers."
        )
    elif plan.conflicts:
        echo_next("Next: resolve the conflicts, then wsgen build && wsgen validate", err=False)
    else:
        echo_next("Next: wsgen build && wsgen validate", err=False)


def _print_diff(plan: UpdatePlan) -> None:
    from wsgen.checks.fixes.plan import FileFix
    from wsgen.cli.check_output import print_diff

    def text(data: bytes | None) -> str:
        return (data or b"").decode("utf-8", "surrogateescape")

    print_diff(
        FileFix(
            file=plan.folder / change.path,
            before=text(change.before),
            after=text(change.after),
            data=change.after or b"",
            fixed=(),
        )
        for change in plan.writes
    )
