"""LaunchPlan -> a tree that a person reads."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from wsgen.cli.output import render_findings
from wsgen.cli.words import short_path

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from wsgen.model.plan import Include, LaunchPlan, Process


MOST_CHARACTERS = 72  # of a value; a robot description has thousands


def render_arguments(plan: LaunchPlan) -> Iterator[str]:
    """The arguments, in the form of `ros2 launch --show-args`; what is wrong comes after them."""
    yield "Arguments (pass arguments as '<name>:=<value>'):"
    for argument in plan.arguments:
        yield ""
        yield f"    '{argument.name}':{'*' if argument.is_conditional else ''}"
        yield f"        {argument.description}"
        if argument.default is not None:
            yield f"        (default: {argument.default})"
    if not plan.arguments:
        yield ""
        yield "  No arguments."
    if any(argument.is_conditional for argument in plan.arguments):
        yield ""
        yield "* argument(s) which are only used if specific conditions occur"
    yield from _findings(plan)


def render_tree(plan: LaunchPlan) -> Iterator[str]:
    """What starts at once and what follows from that, with what decides about it above."""
    yield click.style(short_path(plan.launch_file), bold=True)
    yield from _section("arguments", [_argument(argument) for argument in plan.arguments])
    yield from _section(
        "environment", [f"{name}={value}" for name, value in plan.environment.items()]
    )
    yield from _section("includes", [line for one in plan.includes for line in _include(one)])
    yield from _section("starts", _starts(plan.processes))
    yield from _section(
        "not known without ROS",
        [
            f"{_clip(entry.what)}: {entry.why}{_place(entry.file, entry.line)}"
            for entry in plan.unresolved
        ],
    )
    yield from _findings(plan)


def _section(title: str, lines: Sequence[str]) -> Iterator[str]:
    if lines:
        yield ""
        yield click.style(title, bold=True)
        yield from (f"  {line}" for line in lines)


def _findings(plan: LaunchPlan) -> Iterator[str]:
    if plan.diagnostics:
        yield ""
        yield from render_findings(plan.diagnostics)


def _argument(argument: Any) -> str:
    given = "" if argument.value == argument.default else click.style("  (given)", dim=True)
    description = click.style(f"  {argument.description}", dim=True) if argument.description else ""
    return f"{argument.name}:={_clip(str(argument.value))}{given}{description}"


def _include(include: Include) -> Iterator[str]:
    name = f"{include.package} {include.file.name}" if include.package else short_path(include.file)
    note = "" if include.evaluated else click.style("  (not here: not evaluated)", fg="yellow")
    yield f"{name}{note}"
    for argument, value in include.arguments.items():
        yield f"    {argument}:={_clip(value)}"


def _starts(processes: Sequence[Process]) -> list[str]:
    """Each process below the one whose start or exit brings it about."""
    followers: dict[int, list[Process]] = {}
    first: dict[str, Process] = {}
    roots: list[Process] = []
    for process in processes:
        _, _, name = process.starts.partition(" of ")
        if name in first:
            followers.setdefault(id(first[name]), []).append(process)
        else:
            roots.append(process)
        first.setdefault(_name(process), process)
    return list(_branches(roots, followers))


def _branches(processes: Sequence[Process], followers: dict[int, list[Process]]) -> Iterator[str]:
    for process in processes:
        is_last = process is processes[-1]
        yield f"{'└─' if is_last else '├─'} {_title(process)}"
        below = followers.get(id(process), [])
        stem = "   " if is_last else "│  "
        for line in _details(process):
            yield f"{stem}{'│' if below else ' '}    {line}"
        for line in _branches(below, followers):
            yield f"{stem}{line}"


def _title(process: Process) -> str:
    what = click.style(_what(process), bold=True)
    cause = "" if process.starts == "launch" else f"  {click.style(_cause(process), fg='cyan')}"
    node = f"{process.namespace.rstrip('/')}/{process.name}" if process.name else process.namespace
    called = f"  {node}" if node and process.command is None else ""
    host = f"  in {process.container}" if process.container else ""
    return f"{what}{called}{host}{cause}{_place(process.file, process.line)}"


def _what(process: Process) -> str:
    if process.command is not None:
        return _clip(" ".join(process.command))
    return f"{process.package} {process.executable}" if process.package else str(process.executable)


def _cause(process: Process) -> str:
    kind, _, rest = process.starts.partition(" ")
    return {"timer": f"after {rest} s", "shutdown": "on shutdown"}.get(kind, f"on {process.starts}")


def _name(process: Process) -> str:
    if process.command:
        return process.name or process.command[0].rpartition("/")[2]
    return process.name or process.executable or ""


def _details(process: Process) -> Iterator[str]:
    if process.arguments:
        yield f"arguments: {_clip(' '.join(process.arguments))}"
    for name, value in process.parameters.items():
        if process.description_file is not None and str(value).lstrip().startswith("<"):
            yield f"{name}: {len(value)} characters from {short_path(process.description_file)}"
        else:
            yield f"{name}: {_clip(str(value))}"
    for source, target in process.remappings:
        yield f"{source} → {target}"


def _clip(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= MOST_CHARACTERS else f"{line[: MOST_CHARACTERS - 1]}…"


def _place(file: Path | None, line: int | None) -> str:
    if file is None:
        return ""
    return click.style(f"  {file.name}" + (f":{line}" if line else ""), dim=True)
