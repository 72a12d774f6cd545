"""`wsgen doctor`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.options import (
    ExampleCommand,
    chosen_target,
    distro_option,
    format_option,
    output_options,
    sim_option,
)
from wsgen.cli.terminal import echo
from wsgen.errors import EXIT_FAILED, EXIT_PASSED

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from wsgen.building.machine import DoctorReport, Requirement


@click.command(
    cls=ExampleCommand,
    epilog="The exit code is 0 if wsgen has all it needs, whether or not ROS is installed.",
    examples=("wsgen doctor --distro jazzy", "wsgen doctor --format json"),
)
@distro_option
@sim_option
@format_option
@output_options
@click.pass_context
def command(
    ctx: click.Context,
    *,
    distro: str,
    sim: str | None,
    output_format: str,
    quiet: bool,
    verbose: bool,  # noqa: ARG001  nothing is left out
) -> int:
    """Show what this machine has and lacks for a target, and the commands that fix it.

    The requirements of wsgen and those of ROS are listed separately. Without --distro and
    $ROS_DISTRO, the target is that of the packages here.
    """
    import os
    import time

    from wsgen.building.machine import check_machine, here

    if ctx.get_parameter_source("distro") is click.core.ParameterSource.DEFAULT:
        distro = _recorded() or distro
    target = chosen_target(ctx, distro, sim)
    report = check_machine(here(os.environ), target, today=time.strftime("%Y-%m-%d"))
    if output_format == "json":
        from wsgen.reporting.json_report import render_doctor_report

        echo(render_doctor_report(report), nl=False)
    else:
        for line in _render(report, quiet=quiet):
            echo(line)
    return EXIT_PASSED if report.passed else EXIT_FAILED


def _recorded() -> str | None:
    """The distribution that wsgen wrote the packages here for, if it is one."""
    from pathlib import Path

    files = (*Path().glob("wsgen.toml"), *Path().glob("src/*/wsgen.toml"))
    if not files:
        return None
    from wsgen.model.facts import DISTROS
    from wsgen.packages.workspace.settings import read_settings

    found = {read_settings(file.parent)[0].distro for file in files}
    return next(iter(found)) if len(found) == 1 and found <= {*DISTROS} else None


def _render(report: DoctorReport, *, quiet: bool) -> Iterator[str]:
    """The lines that a person reads; with `quiet`, only what is missing."""
    from wsgen.cli.terminal import fit_lines
    from wsgen.model.target import image, in_container

    target = report.target
    yield click.style(f"{target.ros} with {target.gazebo}, on Ubuntu {target.ubuntu}", bold=True)
    yield from fit_lines(f"note: {note}" for note in report.notes)
    for title, requirements in (
        ("Requirements of wsgen: wsgen new, wsgen build, wsgen validate", report.wsgen),
        ("Requirements of ROS: ros2 launch", report.ros),
    ):
        yield ""
        yield from fit_lines([click.style(title, bold=True)])
        shown = [found for found in requirements if not (quiet and found.is_met)]
        yield from _table(shown, [*report.wsgen, *report.ros], quiet=quiet)
    yield ""
    installed = "To install the packages of steps 1 and 2 of the tutorial, except the editor"
    if report.takes_apt:
        yield from fit_lines([f"{installed}:"])
        yield f"  {report.apt}"
    else:
        where = f"in a container of {image(target)} (not on this machine)"
        yield from fit_lines([f"{installed}, {where}:"])
        yield f"  {in_container(report.apt)}"
    yield ""
    result = (
        "wsgen has all it needs." if report.passed else "Fix the errors above before using wsgen."
    )
    yield click.style(result, bold=True)


def _table(
    requirements: Sequence[Requirement], of_all: Sequence[Requirement], *, quiet: bool
) -> list[str]:
    """A row for each, then the commands that fix what is missing, unwrapped, to be copied.

    The requirements of all tables decide the layout, so that it is the same.
    """
    from wsgen.cli.terminal import draw_table

    label = click.style("try:", fg="green")
    rows, alike = (
        [(_mark(found), found.name, found.text) for found in some]
        for some in (requirements, of_all)
    )
    fixes = [f"  {found.name}: {label} {found.fix}" for found in requirements if found.fix]
    return (draw_table(rows, alike=alike, quiet=quiet) or ["  Nothing is missing."]) + fixes


def _mark(found: Requirement) -> str:
    if found.is_met:
        return click.style("ok", fg="green")
    return (
        click.style("error", fg="red", bold=True)
        if found.is_required
        else click.style("-", fg="yellow")
    )
