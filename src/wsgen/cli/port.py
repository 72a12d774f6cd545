"""`wsgen port`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.options import Choice, ExampleCommand, output_options, workspace_option
from wsgen.cli.terminal import echo
from wsgen.errors import EXIT_PASSED
from wsgen.model.facts import WITHOUT_CLASSIC
from wsgen.model.target import CLASSIC, SIM, SIMULATORS

if TYPE_CHECKING:
    from wsgen.porting.plan import PortPlan


@click.command(
    cls=ExampleCommand,
    epilog="What cannot be ported stays, and is listed. Ported again, nothing changes.",
    examples=(
        "wsgen port src/my_robot --to jazzy --diff",
        "wsgen port --to kilted",
    ),
)
@click.argument("paths", nargs=-1, type=click.Path(readable=False), metavar="[PATH]...")
@workspace_option
@click.option(
    "--to",
    "distro",
    type=Choice(WITHOUT_CLASSIC),
    required=True,
    help="ROS 2 distribution to port to.",
)
@click.option("--diff", is_flag=True, help="Show what would change; write nothing.")
@click.option("--force", is_flag=True, help="Write also over what git cannot take back.")
@output_options
def command(
    paths: tuple[str, ...],
    *,
    workspace: str | None,
    distro: str,
    diff: bool,
    force: bool,
    quiet: bool,
    verbose: bool,
) -> int:
    """Port packages from Gazebo Classic to Gazebo Sim, in place.

    PATH is a package or a workspace. Without PATH, port the workspace around the current folder.
    """
    import os
    from pathlib import Path

    from wsgen.cli.words import short_name
    from wsgen.model.target import Target
    from wsgen.pipeline.check_targets import find_targets
    from wsgen.porting.plan import plan_port
    from wsgen.porting.write import refuse_unsaved, write_port

    targets = find_targets([Path(path) for path in paths], workspace)
    if not (diff or force):
        refuse_unsaved(package.path for package in targets.packages)
    plan = plan_port(targets, Target(distro=distro, simulator=SIM), os.environ)
    if diff or verbose:
        _print_diff(plan)
    if diff:
        for line in _left(plan):
            echo(line, err=True)
        return EXIT_PASSED
    for file in write_port(plan):
        if not quiet:
            echo(f"Ported {short_name(file)}", err=True)
    for line in _summary(plan, distro, quiet=quiet):
        echo(line)
    return EXIT_PASSED


def _print_diff(plan: PortPlan) -> None:
    from wsgen.checks.fixes.plan import FileFix
    from wsgen.cli.check_output import print_diff

    created = [
        FileFix(file=file, before="", after=text, data=text.encode(), fixed=())
        for file, text in plan.created
    ]
    print_diff([*created, *plan.files])


def _left(plan: PortPlan) -> list[str]:
    """What the author has to do, by file and line; one advice for all that it is about."""
    from wsgen.cli.words import short_path

    by_advice: dict[str, list[str]] = {}
    for one in plan.unported:
        by_advice.setdefault(one.advice, []).append(
            f"  {short_path(one.file)}:{one.line}: {one.what}"
        )
    lines = [line for advice, those in by_advice.items() for line in (*those, f"    {advice}")]
    return ["Left to you:", *lines] if lines else []


def _summary(plan: PortPlan, distro: str, *, quiet: bool) -> list[str]:
    if not plan.files and not plan.created:
        names = ", ".join(plan.packages)
        text = (
            f"Nothing to port: {names} names nothing of {SIMULATORS[CLASSIC]} that can be edited."
        )
        return [*_left(plan), *([] if quiet else [text])]
    if quiet:
        return _left(plan)
    return [
        *_left(plan),
        f"Next: wsgen check --distro {distro}, wsgen build, wsgen validate",
    ]
