"""Rules about the entities that are spawned: their names, and how high they are."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.checks.rules.runs import spawned_high, spawned_in_ground
from wsgen.diagnostics import Rule, Severity
from wsgen.model.kinematics import link_poses
from wsgen.model.robot import Box, Capsule, Cylinder, Mesh, Sphere
from wsgen.model.transform import compose, rotation_of_rpy

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Geometry, Robot
    from wsgen.model.transform import Pose
    from wsgen.model.world import Spawn, SpawnHeight


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


ALONG_AN_AXIS = 1e-6  # of a direction: how far the others may be from 0


def check_spawn_height(
    robot: Robot, pose: Pose, height: SpawnHeight | None, *, entity: str, is_bare: bool
) -> Iterator[Diagnostic]:
    """Check how high above a ground at z = 0 a robot is spawned.

    Args:
        robot: As Gazebo has it.
        pose: Of its root link in the world.
        height: Where a launch file says how high; None: it is not known.
        entity: What the robot is called.
        is_bare: Nothing but the ground is there, which it may stand on.
    """
    if height is None or robot.fixed_to_world or robot.is_static:
        return
    lowest = lowest_point(robot, pose)
    if lowest is None:
        return
    z = pose.xyz[2]
    yield from spawned_in_ground(entity, max(0.0, -lowest), z, height)
    if is_bare:
        yield from spawned_high(entity, lowest, z, height)


def lowest_point(robot: Robot, pose: Pose) -> float | None:
    """The z of the lowest point of its collisions with all joints at zero, m.

    None where it has none, or where one of them is not known exactly.
    """
    if any(joint.starts_beyond_limit for joint in robot.joints):
        return None
    poses = link_poses(robot, pose)
    lowest = [
        _lowest(collision.geometry, compose(poses[link.name], collision.pose_in_link))
        for link in robot.links
        for collision in link.collisions
    ]
    known = [one for one in lowest if one is not None]
    return min(known) if known and len(known) == len(lowest) else None


def _lowest(geometry: Geometry, pose: Pose) -> float | None:
    down = rotation_of_rpy(pose.rpy)[2]
    z = pose.xyz[2]
    across, along = math.hypot(down[0], down[1]), abs(down[2])
    match geometry:
        case Sphere():
            return z - geometry.radius
        case Capsule():
            return z - along * geometry.length / 2 - geometry.radius
        case Cylinder():
            return z - along * geometry.length / 2 - across * geometry.radius
        case Box():
            return z - sum(
                abs(part) * edge / 2 for part, edge in zip(down, geometry.size, strict=True)
            )
        case Mesh():
            return _lowest_of_mesh(geometry, down, z)
    return None


def _lowest_of_mesh(mesh: Mesh, down: tuple[float, float, float], z: float) -> float | None:
    """That of its box, which touches the mesh where it lies along the axes of the world."""
    axis = max(range(3), key=lambda one: abs(down[one]))
    is_along = all(abs(down[one]) < ALONG_AN_AXIS for one in range(3) if one != axis)
    if mesh.bounds is None or not is_along:
        return None
    ends = (corner[axis] * mesh.scale[axis] * down[axis] for corner in mesh.bounds)
    return z + min(ends)
