"""Rules over what a launch file spawns."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence


def spawned_twice(entities: Sequence[str]) -> Iterator[Diagnostic]:
    """Two robots are spawned under one name.

    ## What it does
    Compares the names that the spawners give.

    ## Why is this bad?
    The simulator refuses the second one.

    ## Use instead
    Another -entity (Gazebo Classic) or -name (Gazebo Sim) for each.
    """
    for entity in dict.fromkeys(entities):
        times = entities.count(entity)
        if times > 1:
            yield Diagnostic(
                code="SPN049",
                severity=Severity.ERROR,
                message=f"{times} robots are spawned as `{entity}`.",
                element=entity,
                hint="Give each spawner a name of its own: -entity in Gazebo Classic, -name in "
                "Gazebo Sim.",
            )
