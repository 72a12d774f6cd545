"""Which process of a launch plan is started by which."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.model.plan import Process


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
