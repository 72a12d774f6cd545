"""What a person reads about a robot, a launch and diagnostics, wherever it is shown.

Of a robot how it ended, what it did, where it is; of a launch which process starts which.
"""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.runs import TIPS_OVER, UNACTUATED_JOINTS_MOVE
from wsgen.model.engines import GAZEBO

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import BehaviorOutcome, Task
    from wsgen.model.outcome import EngineOutcome
    from wsgen.model.plan import Process


def result_of(one: EngineOutcome) -> str:
    """How a robot ended in an engine."""
    if one.rest is None:
        return "not simulated"
    if not (one.passed or one.is_untried):  # the line of a behavior says that it was not tried
        return "fails"
    if TIPS_OVER.code in one.codes:
        return "tips over"
    settled = one.rest.settled_after
    if UNACTUATED_JOINTS_MOVE.code in one.codes:
        end = "did not settle"
        if settled is not None:
            end = "settled" if one.engine == GAZEBO else f"settled after {settled:.1f} s"
        return f"{end}, unactuated joints"
    if settled is None:
        return "did not settle"
    return "stands" if one.engine == GAZEBO else f"stands after {settled:.1f} s"


def write_xyz(xyz: tuple[float, float, float]) -> str:
    """Centimeters on the ground, millimeters above it; adding zero makes -0.00 plain."""
    return " ".join(
        f"{round(value, decimals) + 0.0:.{decimals}f}" if math.isfinite(value) else str(value)
        for value, decimals in zip(xyz, (2, 2, 3), strict=True)
    )


def what_it_did(behavior: BehaviorOutcome) -> str:
    """What was measured at the end of a behavior."""
    if behavior.is_left_out:
        return "left out"
    parts = []
    if behavior.moved is not None:
        parts.append(_way(*behavior.moved))
    if behavior.traveled is not None:
        parts.append(f"traveled {_plain(behavior.traveled)} m")
    if behavior.positions is not None:
        parts.append(_positions(behavior.positions))
    return "; ".join(parts) or "not simulated"


def what_it_is_to_do(task: Task) -> str:
    """The commands of a behavior."""
    from wsgen.model.behavior import Drive, LaunchTask  # noqa: PLC0415  who has no behaviors need not load it

    if isinstance(task, Drive):
        return f"drive at {_plain(task.linear)} m/s, {_plain(task.angular)} rad/s"
    if isinstance(task, LaunchTask):
        return "what the nodes of the launch file do"
    return f"move to {_positions(task.positions)}"


def what_is_expected(task: Task) -> str:
    """Where a behavior is to end."""
    from wsgen.model.behavior import Drive, LaunchTask  # noqa: PLC0415  who has no behaviors need not load it

    if isinstance(task, LaunchTask):
        parts = [
            _way(task.x, task.y, task.yaw),
            "" if task.travels is None else f"traveled at least {_plain(task.travels)} m",
            _positions(task.positions),
        ]
        return "; ".join(filter(None, parts)) or "upright, no node fails"
    if isinstance(task, Drive):
        return _way(task.x, task.y, task.yaw) or "not checked"
    return f"within {task.within:g} of these positions"


def _way(x: float | None, y: float | None, yaw: float | None) -> str:
    parts = (
        (x, "{} m ahead"),
        (y, "{} m to the left"),
        (yaw, "turned by {} rad"),
    )
    return ", ".join(text.format(_plain(value)) for value, text in parts if value is not None)


def _positions(positions: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {_plain(value)}" for name, value in positions.items())


def _plain(value: float) -> str:
    return f"{round(value, 2) + 0.0:.2f}" if math.isfinite(value) else str(value)


def render_text(diagnostics: Iterable[Diagnostic]) -> str:
    """Each diagnostic with its place and what to do, as the command line shows it."""
    return "\n".join(line for one in diagnostics for line in _lines(one))


def _lines(diagnostic: Diagnostic) -> Iterator[str]:
    kind = f"{diagnostic.severity.value}[{diagnostic.code}]"
    yield f"{kind} {diagnostic.name}: {diagnostic.message}"
    place = "  ".join(filter(None, (_place(diagnostic), diagnostic.element)))
    if place:
        yield f"    at: {place}"
    if diagnostic.hint:
        yield f"   try: {diagnostic.hint}"


def _place(diagnostic: Diagnostic) -> str:
    if diagnostic.file is None:
        return ""
    file = os.fspath(diagnostic.file)
    return file if diagnostic.line is None else f"{file}:{diagnostic.line}"


class Started(NamedTuple):
    """A process, and those that its start or exit causes."""

    process: Process
    followers: tuple[Started, ...]


def start_tree(processes: Sequence[Process]) -> tuple[Started, ...]:
    """The processes that the launch itself starts, each with those that follow from it."""
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
    return _nodes(roots, followers)


def _nodes(
    processes: Sequence[Process], followers: dict[int, list[Process]]
) -> tuple[Started, ...]:
    return tuple(
        Started(process, _nodes(followers.get(id(process), ()), followers)) for process in processes
    )


def _name(process: Process) -> str:
    if process.command:
        return process.name or process.command[0].rpartition("/")[2]
    return process.name or process.executable or ""


def cause_of(process: Process) -> str:
    """What starts a process, as "after 3.0 s"; empty for the launch itself."""
    if process.starts == "launch":
        return ""
    kind, _, rest = process.starts.partition(" ")
    return {"timer": f"after {rest} s", "shutdown": "on shutdown"}.get(kind, f"on {process.starts}")
