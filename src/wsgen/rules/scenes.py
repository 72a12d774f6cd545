"""Rules over robots in one scene, and over one scene in two engines.

The parameters are facts in SI units; a rule yields what it finds.

Rules over what a launch file spawns.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.transform import multiply, rotation_of_rpy, transpose

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from wsgen.model.transform import Pose
    from wsgen.simulation.engine import HullGap
    from wsgen.simulation.scene import Overlapping, RobotRun


SHALLOW = 0.02  # m; out of so much the engine pushes a robot without a jump
NAMED = 3  # so many pairs of links are told in a message
SAME_PLACE = 0.005  # m; engines have collision margins of 1 mm
SAME_HEADING = math.radians(2)
SAME_JOINT = 0.1  # rad or m


def robots_in_each_other(
    entity: str, overlaps: Sequence[Overlapping], static_models: Collection[str] = ()
) -> Iterator[Diagnostic]:
    """Two robots are spawned inside each other, or one inside a model of the world.

    ## What it does
    Looks for links of two robots that are in each other when all are spawned. Up to 2 cm are a
    warning: the engine pushes them apart without a jump.

    ## Why is this bad?
    The simulator shoots them apart.

    ## Use instead
    Spawn poses (-x, -y) with room for every robot.
    """
    for other in dict.fromkeys(found.other_entity for found in overlaps if found.other_entity):
        deepest = max(
            (found for found in overlaps if found.other_entity == other),
            key=lambda found: found.depth,
        )
        # Told once: of the robot that is in the world's model, else of the first by name.
        is_told = (
            entity < str(other)
            if (entity in static_models) == (other in static_models)
            else (other in static_models)
        )
        if is_told:
            yield Diagnostic(
                code="SPN063",
                severity=Severity.ERROR if deepest.depth > SHALLOW else Severity.WARNING,
                message=f"`{entity}` and `{other}` are spawned inside each other: "
                f"`{entity}/{deepest.link}` is {deepest.depth:.3f} m deep in "
                f"`{other}/{deepest.other_link}`.",
                element=entity,
                hint="Spawn them farther apart (-x, -y), or higher (-z).",
            )


def links_in_each_other(
    entity: str, overlaps: Sequence[Overlapping], collide: Collection[str]
) -> Iterator[Diagnostic]:
    """Links of one robot that may touch each other start inside each other.

    ## What it does
    Looks for overlapping links with <selfCollide> that no joint joins.

    ## Why is this bad?
    The simulator pushes them apart from the first moment on: the robot shakes or jumps.

    ## Use instead
    Smaller collision shapes, or no <selfCollide> for these links.
    """
    inside = [
        found
        for found in overlaps
        if found.other_entity is None and {found.link, found.other_link} <= set(collide)
    ]
    if inside:
        told = ", ".join(
            f"`{found.link}` in `{found.other_link}` ({found.depth:.3f} m)"
            for found in sorted(inside, key=lambda found: -found.depth)[:NAMED]
        )
        told += f" and {len(inside) - NAMED} more" if len(inside) > NAMED else ""
        yield Diagnostic(
            code="SPN064",
            severity=Severity.WARNING,
            message=f"Links that collide with each other start inside each other: {told}.",
            element=entity,
            hint="Make their collision shapes smaller, or leave <selfCollide> away.",
        )


def rests_on_its_hull(entity: str, gaps: Sequence[HullGap]) -> Iterator[Diagnostic]:
    """A mesh rests on something with its convex hull, where Gazebo would let it sink in.

    ## What it does
    At the end of the simulation, looks at what touches something else than level ground: how far
    is it from the nearest triangle of the mesh? Up to 5 mm are nothing.

    ## Why is this bad?
    PyBullet collides the convex hull of a mesh, Gazebo its triangles: a fork that stands over a
    post stands on nothing here, and rests lower there.

    ## Use instead
    DART, which collides triangles (--engine dart); or, in the description, a <collision> of
    several convex shapes, which is faster in every engine.
    """
    for found in sorted(gaps, key=lambda found: -found.gap)[:NAMED]:
        yield Diagnostic(
            code="SPN066",
            severity=Severity.WARNING,
            message=f"The mesh of `{found.link}` touches `{found.other_entity}` "
            f"{found.gap * 1000:.0f} mm from its triangles: PyBullet takes its convex hull, "
            "Gazebo would let it sink in.",
            element=entity,
            hint="Try it with --engine dart, or make the <collision> of several convex shapes.",
        )


def engines_disagree(first: RobotRun, second: RobotRun) -> Iterator[Diagnostic]:
    """Two engines do not agree on what becomes of the robot.

    ## What it does
    Compares mass, joints and, where both come to rest, the poses and joint positions.

    ## Why is this bad?
    What happens hangs on details that no description fixes: a balance, a fall, a mesh that one
    engine takes as its convex hull and the other as triangles.

    ## Use instead
    DART is what Gazebo Sim takes by default.
    """
    different = list(_differences(first, second))
    if different:
        yield Diagnostic(
            code="SPN065",
            severity=Severity.WARNING,
            message=f"PyBullet and DART disagree: {'; '.join(different)}.",
            element=first.entity,
            hint="Gazebo Sim takes DART by default. A robot that falls or balances ends up "
            "somewhere else each time; one that stands should not.",
        )


def _differences(first: RobotRun, second: RobotRun) -> Iterator[str]:
    if not math.isclose(first.mass, second.mass, rel_tol=1e-6):
        yield f"mass {first.mass:g} and {second.mass:g} kg"
    if first.movable_joints != second.movable_joints:
        yield f"{first.movable_joints} and {second.movable_joints} joints"
    if not (first.is_finite and second.is_finite):
        return  # told by each engine's own simulation
    if (first.settled_after is None) != (second.settled_after is None):
        names = ("PyBullet", "DART") if second.settled_after is None else ("DART", "PyBullet")
        yield f"only in {names[0]} it comes to rest"
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
