"""Rules over what a launch file spawns."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence


def spawned_twice(entities: Sequence[str], in_world: Collection[str] = ()) -> Iterator[Diagnostic]:
    """Two robots are spawned under one name, or one under that of a model of the world.

    ## What it does
    Compares the names that the spawners give, and those of the models in the world.

    ## Why is this bad?
    The simulator refuses the second one.

    ## Use instead
    Another -entity (Gazebo Classic) or -name (Gazebo Sim) for each.
    """
    for entity in dict.fromkeys(entities):
        times = entities.count(entity)
        if times > 1 or entity in in_world:
            yield Diagnostic(
                code="SPN049",
                severity=Severity.ERROR,
                message=f"{times} robots are spawned as `{entity}`."
                if times > 1
                else f"A robot is spawned as `{entity}`, and the world has a model of that name.",
                element=entity,
                hint="Give each spawner a name of its own: -entity in Gazebo Classic, -name in "
                "Gazebo Sim.",
            )
