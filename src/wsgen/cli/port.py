"""`wsgen port`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.options import (
    Choice,
    ExampleCommand,
    format_option,
    output_options,
    workspace_option,
)
from wsgen.cli.terminal import draw_table, echo, echo_next
from wsgen.errors import EXIT_FAILED, EXIT_PASSED, RequestError
from wsgen.model.facts import WITHOUT_CLASSIC
from wsgen.model.target import CLASSIC, SIM, SIMULATORS

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from wsgen.checks.fixes.plan import FileFix
    from wsgen.model.target import Target
    from wsgen.pipeline.check import Targets
    from wsgen.porting.plan import PortPlan
    from wsgen.porting.proof import Proof


@click.command(
    cls=ExampleCommand,
    epilog="What cannot be ported stays, and is listed. Ported again, nothing changes.",
    examples=(
        "wsgen port src/my_robot --to jazzy --diff",
        "wsgen port --to kilted --check",
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
@click.option(
    "--check",
    "is_proof",
    is_flag=True,
    help="Simulate the robots before and after the port, and compare them; write nothing.",
)
@click.option(
    "--before",
    type=click.Path(readable=False),
    metavar="FOLDER",
    help="With --check: the packages before their port, if git does not have them.",
)
@format_option
@output_options
def command(
    paths: tuple[str, ...],
    *,
    workspace: str | None,
    distro: str,
    diff: bool,
    force: bool,
    is_proof: bool,
    before: str | None,
    output_format: str,
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
    from wsgen.pipeline.check import find_targets
    from wsgen.porting.plan import plan_port
    from wsgen.porting.write import refuse_unsaved, write_port

    _refuse_useless(is_proof=is_proof, before=before, writes=diff or force)
    targets = _require_packages(find_targets([Path(path) for path in paths], workspace))
    target = Target(distro=distro, simulator=SIM)
    is_text = output_format == "text"
    if is_proof:
        return _prove(targets, target, before, is_text=is_text, quiet=quiet, verbose=verbose)
    plan = plan_port(targets, target, os.environ)
    if (plan.files or plan.created) and not (diff or force):
        refuse_unsaved(package.path for package in targets.packages)
    if is_text and (diff or verbose):
        print_created(plan.created, plan.files)
    for file in () if diff else write_port(plan):
        if not quiet:
            echo(f"Ported {short_name(file)}", err=True)
    if is_text:
        for line in _left(plan) if diff else _summary(plan, quiet=quiet):
            echo(line, err=diff)
    else:
        from wsgen.reporting.json_report import render_port

        echo(render_port(plan, is_written=not diff), nl=False)
    if plan.files and not (diff or quiet):
        echo_next(f"Next: wsgen check --distro {distro}  (then build and validate)")
    return EXIT_PASSED


def _refuse_useless(*, is_proof: bool, before: str | None, writes: bool) -> None:
    """Refuse options that would have no effect.

    Raises:
        RequestError: One is given.
    """
    if before is not None and not is_proof:
        raise RequestError("`--before` is for --check.", hint="Add --check, or omit --before.")
    if is_proof and writes:
        raise RequestError(
            "`--check` writes nothing: --diff and --force cannot be used with it.",
            hint="Omit --check, or the other option.",
        )


def _prove(
    targets: Targets,
    target: Target,
    before: str | None,
    *,
    is_text: bool,
    quiet: bool,
    verbose: bool,
) -> int:
    """Compare the robots before and after a port; gives the exit code."""
    import os
    from pathlib import Path

    from wsgen.cli.live_run import run_for_behaviors
    from wsgen.cli.progress import listening
    from wsgen.pipeline.check import find_targets
    from wsgen.porting.plan import plan_port
    from wsgen.porting.proof import prove_port

    with listening(quiet=quiet, verbose=verbose, is_short=True) as listener:
        proof = prove_port(
            targets,
            target,
            os.environ,
            lambda: plan_port(targets, target, os.environ),
            before=None if before is None else find_targets([Path(before)]),
            listener=listener,
            run_live=run_for_behaviors,
        )
    if is_text:
        for line in _compared(proof, quiet=quiet):
            echo(line)
    else:
        from wsgen.reporting.json_report import render_proof

        echo(render_proof(proof), nl=False)
    return EXIT_PASSED if proof.passed else EXIT_FAILED


def _compared(proof: Proof, *, quiet: bool) -> list[str]:
    """The table of a proof, and its verdict; with `quiet`, what differs alone."""
    words = {True: "same", False: "different", None: "not compared"}
    rows, robot = [], ""
    for row in proof.rows:
        if quiet and row.is_same:
            continue
        is_new = quiet or row.robot != robot
        robot = row.robot
        aspect = f"{'' if quiet or not row.is_detail else '  '}{row.aspect}"
        rows.append((robot if is_new else "", aspect, row.before, row.after, words[row.is_same]))
    headings = ("robot", "aspect", "before", "after", "")
    lines = draw_table(rows, headings=headings, wrapped=(2, 3), quiet=quiet)
    if quiet:
        return lines
    differing = sum(row.is_same is False and not row.is_detail for row in proof.rows)
    unknown = sum(row.is_same is None for row in proof.rows)
    verdict = (
        f"{differing} of {sum(not row.is_detail for row in proof.rows)} differ"
        if differing
        else "The robots do what they did before"
    )
    more = f"; {unknown} could not be compared" if unknown else ""
    return [f"Before: {proof.before}", "", *lines, "", f"{verdict}{more}."]


def print_created(created: Iterable[tuple[Path, str]], files: Iterable[FileFix]) -> None:
    """Print what would be created and changed, as `git diff` does."""
    from wsgen.checks.fixes.plan import FileFix
    from wsgen.cli.check_output import print_diff

    new = [
        FileFix(file=file, before="", after=text, data=text.encode(), fixed=())
        for file, text in created
    ]
    print_diff([*new, *files])


def _require_packages(targets: Targets) -> Targets:
    """The packages to port.

    Raises:
        RequestError: A path is a file, a part of a package, or installed.
    """
    folders = [package.path for package in targets.packages]
    given = (*targets.files, *targets.only, *targets.prefixes)
    other = next((one for one in given if one not in folders), None)
    if other is not None:
        package = next((one for one in folders if other.is_relative_to(one)), None)
        raise RequestError(
            f"{other} is not a package: the files of a package are ported together.",
            hint=f"Give its package: {package}" if package else "Give the folder of a package.",
        )
    return targets


def preview(paths: tuple[str, ...], workspace: str | None, distro: str) -> int:
    """List what a port would change, by file and line; gives the exit code."""
    import os
    import shlex
    from difflib import SequenceMatcher
    from pathlib import Path

    from wsgen.cli.words import short_path
    from wsgen.model.target import Target
    from wsgen.pipeline.check import find_targets
    from wsgen.porting.plan import plan_port

    targets = _require_packages(find_targets([Path(path) for path in paths], workspace))
    plan = plan_port(targets, Target(distro=distro, simulator=SIM), os.environ)
    for file, _ in plan.created:
        echo(f"{short_path(file)}: new")
    for fix in plan.files:
        matcher = SequenceMatcher(
            None, fix.before.splitlines(), fix.after.splitlines(), autojunk=False
        )
        lines = [str(start + 1) for tag, start, *_ in matcher.get_opcodes() if tag != "equal"]
        echo(f"{short_path(fix.file)}: {'line' if len(lines) == 1 else 'lines'} {', '.join(lines)}")
    for line in _left(plan):
        echo(line)
    if plan.files or plan.created:
        given = [short_path(Path(path)) for path in paths]
        echo_next(
            f"Next: {shlex.join(['wsgen', 'port', *given, '--to', distro, '--diff'])}", err=False
        )
    return EXIT_PASSED


def _left(plan: PortPlan) -> list[str]:
    """What the author has to do, by file and line; one advice for all that it is about."""
    from wsgen.cli.words import short_path

    lines: list[str] = []
    for heading, is_note in (
        ("Left to you:", False),
        ("Left to you, if you need it; robots do what they did:", True),
    ):
        by_advice: dict[str, list[str]] = {}
        for one in plan.unported:
            if one.is_note == is_note:
                place = f"  {short_path(one.file)}:{one.line}: {one.what}"
                by_advice.setdefault(one.advice, []).append(place)
        lines += [heading] if by_advice else []
        lines += [line for advice, those in by_advice.items() for line in (*those, f"    {advice}")]
    return lines


def _summary(plan: PortPlan, *, quiet: bool) -> list[str]:
    if not plan.files and not plan.created:
        names = ", ".join(plan.packages)
        text = (
            f"Nothing to port: {names} names nothing of {SIMULATORS[CLASSIC]} that can be edited."
        )
        return [*_left(plan), *([] if quiet else [text])]
    return _left(plan)
