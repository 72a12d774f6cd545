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

    from wsgen.doctor.machine import Finding
    from wsgen.doctor.report import Examination


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
    from wsgen.doctor.report import examine

    target = chosen_target(ctx, distro, sim)
    examination = examine(here(os.environ), target, today=time.strftime("%Y-%m-%d"))
    if output_format == "json":
        from wsgen.report.json_report import render_examination

        click.echo(render_examination(examination), nl=False)
    else:
        for line in _render(examination, with_all=not quiet):
            click.echo(line)
    return EXIT_PASSED if examination.passed else EXIT_FAILED


def _render(examination: Examination, *, with_all: bool) -> Iterator[str]:
    """The lines that a person reads; without `with_all`, what is in order is left out."""
    from wsgen.model.installation import image, in_container

    target = examination.target
    yield click.style(f"{target.ros} with {target.gazebo}, on Ubuntu {target.ubuntu}", bold=True)
    for note in examination.notes:
        yield f"note: {note}"
    for title, findings in (
        ("Without ROS: wsgen new, wsgen build, wsgen validate", examination.own),
        ("With ROS: ros2 launch", examination.ros),
    ):
        yield ""
        yield click.style(title, bold=True)
        yield from _table([found for found in findings if with_all or not found.is_met])
    yield ""
    installed = "All that steps 1 and 2 of the tutorial install, but for its editor"
    if examination.takes_apt:
        yield f"{installed}:"
        yield f"  {examination.apt}"
    else:
        yield f"{installed}; in a container of {image(target)}, not here:"
        yield f"  {in_container(examination.apt)}"
    yield ""
    verdict = "can work here" if examination.passed else "cannot work here until that is fixed"
    yield click.style(f"wsgen {verdict}.", bold=True)


def _table(findings: Sequence[Finding]) -> Iterator[str]:
    """A line for each, and one for what fixes it."""
    if not findings:
        yield "  Nothing is missing."
    width = max((len(found.name) for found in findings), default=0)
    for found in findings:
        yield f"  {_mark(found)}{found.name:{width}}  {found.text}"
        if found.fix:
            yield f"{'':{width + MARK_WIDTH + 4}}{click.style('try:', fg='green')} {found.fix}"


def _mark(found: Finding) -> str:
    if found.is_met:
        return click.style(f"{'ok':{MARK_WIDTH}}", fg="green")
    if found.is_needed:
        return click.style(f"{'error':{MARK_WIDTH}}", fg="red", bold=True)
    return click.style(f"{'-':{MARK_WIDTH}}", fg="yellow")
