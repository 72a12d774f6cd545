"""Rules about robots in one scene, and about one scene in two engines.

The parameters of a check are facts in SI units; a check yields what it reports.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.model.transform import multiply, rotation_of_rpy, transpose

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.transform import Pose
    from wsgen.simulation.engine import HullGap
    from wsgen.simulation.scene import Overlapping, RobotRun


SHALLOW = 0.02  # m; engines push a robot out of less without a jump
NAMED = 3  # at most so many pairs of links are named in a message
SAME_PLACE = 0.005  # m; engines have collision margins of 1 mm
SAME_HEADING = math.radians(2)
SAME_JOINT = 0.1  # rad or m


OVERLAPPING_ROBOTS = Rule(
    code="SPN063",
    name="overlapping-robots",
    severity=Severity.ERROR,
    severity_varies="a warning up to a depth of 2 cm, out of which engines push without a jump",
    summary="Two robots, or a robot and a model of the world, overlap when spawned.",
    why="The simulator pushes them apart with a large force.",
    example="""
Node(package="gazebo_ros", executable="spawn_entity.py", arguments=["-entity", "a", "-x", "0.0"]),
Node(package="gazebo_ros", executable="spawn_entity.py", arguments=["-entity", "b", "-x", "0.0"]),
""",
    instead="""
Node(package="gazebo_ros", executable="spawn_entity.py", arguments=["-entity", "a", "-x", "0.0"]),
Node(package="gazebo_ros", executable="spawn_entity.py", arguments=["-entity", "b", "-x", "2.0"]),
""",
)


def overlapping_robots(
    entity: str, overlaps: Sequence[Overlapping], static_models: Collection[str] = ()
) -> Iterator[Diagnostic]:
    """Report robots that are spawned inside each other, or inside a model of the world."""
    for other in dict.fromkeys(found.other_entity for found in overlaps if found.other_entity):
        deepest = max(
            (found for found in overlaps if found.other_entity == other),
            key=lambda found: found.depth,
        )
        # Once for each pair: about the robot, if the other is a model of the world, else about the
        # first by name.
        is_reported = (
            entity < str(other)
            if (entity in static_models) == (other in static_models)
            else (other in static_models)
        )
        if is_reported:
            yield OVERLAPPING_ROBOTS.at(
                None,
                element=entity,
                message=f"`{entity}` and `{other}` are spawned inside each other: "
                f"`{entity}/{deepest.link}` is {deepest.depth:.3f} m deep in "
                f"`{other}/{deepest.other_link}`.",
                hint="Spawn them farther apart (-x, -y), or higher (-z).",
                severity=Severity.ERROR if deepest.depth > SHALLOW else Severity.WARNING,
            )


OVERLAPPING_LINKS = Rule(
    code="SPN064",
    name="overlapping-links",
    severity=Severity.WARNING,
    summary="Links of a robot that can collide with each other overlap when spawned.",
    what="Looks for overlapping links with `<selfCollide>` that no joint connects.",
    why="The simulator pushes them apart from the first step on: the robot shakes or jumps.",
    example='<gazebo reference="upper_arm"><selfCollide>true</selfCollide></gazebo>',
    instead="Use smaller collision shapes, or remove <selfCollide> from these links.",
)


def overlapping_links(
    entity: str, overlaps: Sequence[Overlapping], collide: Collection[str]
) -> Iterator[Diagnostic]:
    """Report links of one robot that can collide with each other and overlap when spawned."""
    inside = [
        found
        for found in overlaps
        if found.other_entity is None and {found.link, found.other_link} <= set(collide)
    ]
    if inside:
        pairs = ", ".join(
            f"`{found.link}` in `{found.other_link}` ({found.depth:.3f} m)"
            for found in sorted(inside, key=lambda found: -found.depth)[:NAMED]
        )
        pairs += f" and {len(inside) - NAMED} more" if len(inside) > NAMED else ""
        yield OVERLAPPING_LINKS.at(
            None,
            element=entity,
            message=f"Links that collide with each other start inside each other: {pairs}.",
            hint="Make their collision shapes smaller, or remove <selfCollide>.",
        )


RESTS_ON_HULL = Rule(
    code="SPN066",
    name="rests-on-hull",
    severity=Severity.WARNING,
    summary="A mesh rests on its convex hull, where Gazebo would let it sink in.",
    what="At the end of the simulation, measures how far the contacts of a mesh with anything but "
    "level ground are from its nearest triangle. Up to 5 mm are not reported.",
    why="PyBullet collides the convex hull of a mesh, Gazebo its triangles: a fork above "
    "a post rests on the post in PyBullet, and lower in Gazebo.",
    example='<collision><geometry><mesh filename="package://robot/fork.stl"/></geometry></collision>',
    instead="""
<collision><geometry><box size="1.0 0.1 0.05"/></geometry><origin xyz="0 0.3 0"/></collision>
<collision><geometry><box size="1.0 0.1 0.05"/></geometry><origin xyz="0 -0.3 0"/></collision>
""",
)


def rests_on_hull(entity: str, gaps: Sequence[HullGap]) -> Iterator[Diagnostic]:
    """Report meshes that rest on their convex hulls, where Gazebo lets them sink in."""
    for found in sorted(gaps, key=lambda found: -found.gap)[:NAMED]:
        yield RESTS_ON_HULL.at(
            None,
            element=entity,
            message=f"The mesh of `{found.link}` touches `{found.other_entity}` "
            f"{found.gap * 1000:.0f} mm from its triangles: PyBullet uses its convex hull, "
            "Gazebo would let it sink in.",
            hint="Use --engine dart, or replace the mesh by several convex <collision> shapes.",
        )


ENGINES_DISAGREE = Rule(
    code="SPN065",
    name="engines-disagree",
    severity=Severity.WARNING,
    summary="The robot ends up differently in two physics engines.",
    what="Compares mass, joints and, where the robot comes to rest in both, poses and joint "
    "positions.",
    why="The result depends on details that no description fixes: a balance, a fall, or a mesh "
    "that one engine treats as its convex hull and the other as triangles. Gazebo Sim uses DART by "
    "default.",
    example="A robot is spawned balancing on one wheel.",
    instead="Spawn the robot in a pose in which it stands by itself.",
)


def engines_disagree(first: RobotRun, second: RobotRun) -> Iterator[Diagnostic]:
    """Report differences between the runs of one robot in two engines."""
    different = list(_differences(first, second))
    if different:
        yield ENGINES_DISAGREE.at(
            None,
            element=first.entity,
            message=f"PyBullet and DART disagree: {'; '.join(different)}.",
            hint="Gazebo Sim uses DART by default. A robot that falls or balances ends up "
            "somewhere else each time; a robot that stands should not.",
        )


def _differences(first: RobotRun, second: RobotRun) -> Iterator[str]:
    if not math.isclose(first.mass, second.mass, rel_tol=1e-6):
        yield f"mass {first.mass:g} and {second.mass:g} kg"
    if first.movable_joints != second.movable_joints:
        yield f"{first.movable_joints} and {second.movable_joints} joints"
    if not (first.is_finite and second.is_finite):
        return  # reported for each engine
    if (first.settled_after is None) != (second.settled_after is None):
        names = ("PyBullet", "DART") if second.settled_after is None else ("DART", "PyBullet")
        yield f"it comes to rest only in {names[0]}"
    if first.settled_after is None or second.settled_after is None:
        return
    apart = math.dist(first.rest_pose.xyz, second.rest_pose.xyz)
    angle = _angle(first.rest_pose, second.rest_pose)
    if apart > SAME_PLACE or angle > SAME_HEADING:
        yield f"it rests {apart * 1000:.0f} mm and {math.degrees(angle):.1f} degrees apart"
    far = {
        name: abs(position - second.joint_positions[name])
        for name, position in first.joint_positions.items()
        if name in second.joint_positions
    }
    worst = max(far, key=lambda name: far[name], default=None)
    if worst is not None and far[worst] > SAME_JOINT:
        yield f"the joint `{worst}` rests {far[worst]:.2f} rad or m apart"


def _angle(first: Pose, second: Pose) -> float:
    turned = multiply(rotation_of_rpy(first.rpy), transpose(rotation_of_rpy(second.rpy)))
    cosine = (turned[0][0] + turned[1][1] + turned[2][2] - 1) / 2
    return math.acos(min(1.0, max(-1.0, cosine)))


SPAWNED_TWICE = Rule(
    code="SPN049",
    name="spawned-twice",
    severity=Severity.ERROR,
    summary="Two robots, or a robot and a model of the world, have the same name.",
    what="Compares the names given to the spawners and those of the models in the world.",
    why="The simulator refuses the second robot.",
    example="""
Node(package="ros_gz_sim", executable="create", arguments=["-name", "robot", "-x", "0"]),
Node(package="ros_gz_sim", executable="create", arguments=["-name", "robot", "-x", "2"]),
""",
    instead="""
Node(package="ros_gz_sim", executable="create", arguments=["-name", "robot_1", "-x", "0"]),
Node(package="ros_gz_sim", executable="create", arguments=["-name", "robot_2", "-x", "2"]),
""",
)


def spawned_twice(entities: Sequence[str], in_world: Collection[str] = ()) -> Iterator[Diagnostic]:
    """Report robots that are spawned under one name, or under that of a model of the world."""
    for entity in dict.fromkeys(entities):
        times = entities.count(entity)
        if times > 1 or entity in in_world:
            yield SPAWNED_TWICE.at(
                None,
                element=entity,
                message=f"{times} robots are spawned as `{entity}`."
                if times > 1
                else f"A robot is spawned as `{entity}`, and the world has a model of that name.",
                hint="Give each spawner a different name: -entity in Gazebo Classic, -name in "
                "Gazebo Sim.",
            )
