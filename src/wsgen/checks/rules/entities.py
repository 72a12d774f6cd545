"""Rules about the names under which robots are spawned."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.world import Spawn


SPAWNED_TWICE = Rule(
    code="SPN049",
    name="spawned-twice",
    severity=Severity.ERROR,
    summary="Two robots, or a robot and a model of the world, have the same name.",
    what="Compares the names in the arguments of spawners with each other and with the models in "
    "the world.",
    why="The simulator refuses the second robot.",
    example="""
Node(package="ros_gz_sim", executable="create",
     arguments=["-topic", "robot_description", "-name", "robot", "-x", "0"]),
Node(package="ros_gz_sim", executable="create",
     arguments=["-topic", "robot_description", "-name", "robot", "-x", "2"]),
""",
    instead="""
Node(package="ros_gz_sim", executable="create",
     arguments=["-topic", "robot_description", "-name", "robot_1", "-x", "0"]),
Node(package="ros_gz_sim", executable="create",
     arguments=["-topic", "robot_description", "-name", "robot_2", "-x", "2"]),
""",
)


def spawned_twice(spawns: Sequence[Spawn], in_world: Collection[str] = ()) -> Iterator[Diagnostic]:
    """Report robots that are spawned under one name, or under that of a model of the world.

    The place is that of the spawner that the simulator refuses: the last one of a name.
    """
    entities = [spawn.entity for spawn in spawns]
    spawners = {spawn.entity: spawn.process for spawn in spawns}
    for entity, spawner in spawners.items():
        times = entities.count(entity)
        if times > 1 or entity in in_world:
            yield SPAWNED_TWICE.at(
                spawner.file if spawner else None,
                spawner.line if spawner else None,
                entity,
                message=f"{times} robots are spawned as `{entity}`."
                if times > 1
                else f"A robot is spawned as `{entity}`, and the world has a model of that name.",
                hint="Give each spawner a different name: `-entity` in Gazebo Classic, `-name` in "
                "Gazebo Sim.",
            )
