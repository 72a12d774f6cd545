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
from wsgen.errors import EXIT_FAILED, EXIT_PASSED

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from wsgen.doctor.machine import Requirement
    from wsgen.doctor.report import DoctorReport


MARK_WIDTH = 7  # with the blanks behind it


@click.command(
    cls=ExampleCommand,
    epilog="Exit code 0: wsgen's own commands can work here, whatever ROS lacks.",
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
    """Compare this machine with a target: what is there, what is missing, what fixes it.

    What wsgen itself needs and what only ROS needs are kept apart.
    """
    import os
    import time

    from wsgen.doctor.machine import here
    from wsgen.doctor.report import check_machine

    target = chosen_target(ctx, distro, sim)
    report = check_machine(here(os.environ), target, today=time.strftime("%Y-%m-%d"))
    if output_format == "json":
        from wsgen.report.json_report import render_doctor_report

        click.echo(render_doctor_report(report), nl=False)
    else:
        for line in _render(report, with_all=not quiet):
            click.echo(line)
    return EXIT_PASSED if report.passed else EXIT_FAILED


def _render(report: DoctorReport, *, with_all: bool) -> Iterator[str]:
    """The lines that a person reads; without `with_all`, what is in order is left out."""
    from wsgen.model.installation import image, in_container

    target = report.target
    yield click.style(f"{target.ros} with {target.gazebo}, on Ubuntu {target.ubuntu}", bold=True)
    for note in report.notes:
        yield f"note: {note}"
    for title, requirements in (
        ("Without ROS: wsgen new, wsgen build, wsgen validate", report.wsgen),
        ("With ROS: ros2 launch", report.ros),
    ):
        yield ""
        yield click.style(title, bold=True)
        yield from _table([one for one in requirements if with_all or not one.is_met])
    yield ""
    installed = "All that steps 1 and 2 of the tutorial install, but for its editor"
    if report.takes_apt:
        yield f"{installed}:"
        yield f"  {report.apt}"
    else:
        yield f"{installed}; in a container of {image(target)}, not here:"
        yield f"  {in_container(report.apt)}"
    yield ""
    verdict = "can work here" if report.passed else "cannot work here until that is fixed"
    yield click.style(f"wsgen {verdict}.", bold=True)


def _table(requirements: Sequence[Requirement]) -> Iterator[str]:
    """A line for each, and one for what fixes it."""
    if not requirements:
        yield "  Nothing is missing."
    width = max((len(one.name) for one in requirements), default=0)
    for one in requirements:
        yield f"  {_mark(one)}{one.name:{width}}  {one.text}"
        if one.fix:
            yield f"{'':{width + MARK_WIDTH + 4}}{click.style('try:', fg='green')} {one.fix}"


def _mark(requirement: Requirement) -> str:
    if requirement.is_met:
        return click.style(f"{'ok':{MARK_WIDTH}}", fg="green")
    if requirement.is_required:
        return click.style(f"{'error':{MARK_WIDTH}}", fg="red", bold=True)
    return click.style(f"{'-':{MARK_WIDTH}}", fg="yellow")
