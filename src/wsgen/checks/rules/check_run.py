"""All rules about the run of a robot, in the order in which a user should read what they report."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.checks.rules import runs
from wsgen.diagnostics import Severity, has_errors
from wsgen.gazebo.plugins import carried_by
from wsgen.model.kinematics import link_poses, unactuated_joints
from wsgen.model.robot import JointType, Mesh

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Robot
    from wsgen.model.world import SpawnHeight, World
    from wsgen.simulation.scene import RobotRun


# A joint is passive if gravity moves it by more.
PASSIVE_TURNING = 0.1  # rad
PASSIVE_SLIDING = 0.01  # m
OVERSHOT = 1.5  # times the way to the limit that a joint is pushed to: so far a push carries it
# What a robot does that the simulator pushes out of another one.
FOLLOW_FROM_OVERLAP = {
    rule.code
    for rule in (runs.GAINS_ENERGY, runs.STUCK_IN_GROUND, runs.KEEPS_MOVING, runs.TIPS_OVER)
}
# What a robot does in the simulation that water or air carries in Gazebo.
FOLLOW_FROM_WEIGHT = {
    rule.code
    for rule in (
        *(runs.SPAWNED_IN_GROUND, runs.SPAWNED_HIGH, runs.STUCK_IN_GROUND, runs.FALLS_WITHOUT_END),
        *(runs.THROWN_INTO_THE_AIR, runs.KEEPS_MOVING, runs.TIPS_OVER, runs.LEANS),
    )
}
# What a model of a world does whose collision meshes are reported as missing.
FOLLOW_FROM_MISSING_MESH = {
    rule.code for rule in (runs.FALLS_WITHOUT_END, runs.TIPS_OVER, runs.LEANS)
}
ON_THE_GROUND = 0.02  # m
TOUCHES = 0.003  # m; engines have collision margins of 1 mm


def check_run(  # noqa: PLR0913  most have defaults
    robot: Robot,
    world: World,
    robot_run: RobotRun,
    *,
    height: SpawnHeight | None = None,
    is_alone: bool = True,
    static_models: Collection[str] = (),
    pushed: Collection[str] = (),
) -> tuple[Diagnostic, ...]:
    """Check what was measured of a robot; `robot` is the one Gazebo would build (lumped).

    `height` is where a launch file says how high it is spawned, if one does; `is_alone` says that
    no other robot of the scene can push it; `static_models` are, of the entities of the scene, the
    models of the world and those that do not move; `pushed` are joints that are reported to start
    outside of their limits.
    """
    entity = robot_run.entity
    collide = [link.name for link in robot.links if link.self_collide]
    movable = 0 if robot.is_static else len(robot.movable_joints)
    found = [
        *runs.mass_differs(entity, robot.mass, robot_run.mass),
        *runs.joints_differ(entity, movable, robot_run.movable_joints),
        *runs.state_not_finite(entity, is_finite=robot_run.is_finite),
        *runs.cut_short(entity, is_cut_short=robot_run.is_cut_short),
        *(
            found
            for found in runs.overlapping_robots(entity, robot_run.overlaps, static_models)
            if not robot.is_static  # nothing pushes it
        ),
        *runs.overlapping_links(entity, robot_run.overlaps, collide),
    ]
    if robot.is_static:
        return tuple(found)
    # What is fixed to the world stays where it is: machines stand in their foundations.
    if world.has_ground_plane and not robot.fixed_to_world:
        found += runs.spawned_in_ground(
            entity, robot_run.penetration, robot_run.spawn_pose.xyz[2], height
        )
        # On a platform of the world it is high above the ground, and does not fall.
        fall = min(robot_run.lowest_point, robot_run.lowest_point - robot_run.lowest_point_at_end)
        found += runs.spawned_high(entity, fall, robot_run.spawn_pose.xyz[2], height)
    if robot_run.is_finite and not robot_run.is_cut_short:
        depths = [one.depth for one in robot_run.overlaps if one.other_entity is not None]
        motion = _check_motion(
            robot, world, robot_run, is_alone=is_alone and not depths, pushed=pushed
        )
        found, motion = _as_buried(found, motion)
        if max(depths, default=0.0) > runs.SHALLOW:
            others = {one.other_entity for one in robot_run.overlaps if one.other_entity}
            is_pushed_out = max(depths) <= runs.PUSHED_OUT and not has_errors(motion)
            if is_pushed_out and others <= set(static_models):
                found = [_as_pushed_out(one) for one in found]
            motion = [one for one in motion if one.code not in FOLLOW_FROM_OVERLAP]
        if static_models and not _is_on_the_ground(world, robot_run):
            motion = [_as_on_a_slope(one) for one in motion]
        elif is_alone and not motion and not depths and _is_on_the_ground(world, robot_run):
            motion = [*_leaning(robot, robot_run)]
        if _lacks_collision_mesh(robot):
            motion = [one for one in motion if one.code not in FOLLOW_FROM_MISSING_MESH]
        found += motion
    plugin = carried_by(robot, world)
    if plugin is not None and any(one.code in FOLLOW_FROM_WEIGHT for one in found):
        found = [one for one in found if one.code not in FOLLOW_FROM_WEIGHT]
        found.append(runs.no_buoyancy(entity, plugin))
    return tuple(found)


def _lacks_collision_mesh(robot: Robot) -> bool:
    return any(
        isinstance(one.geometry, Mesh) and one.geometry.path is None
        for link in robot.links
        for one in link.collisions
    )


def _as_buried(
    found: list[Diagnostic], motion: list[Diagnostic]
) -> tuple[list[Diagnostic], list[Diagnostic]]:
    """What is said of a robot that falls since it is spawned so deep that nothing pushes it out."""
    deep, fall = runs.SPAWNED_IN_GROUND.code, runs.FALLS_WITHOUT_END.code
    if not {deep, fall} <= {one.code for one in (*found, *motion)}:
        return found, motion
    return (
        [replace(one, severity=Severity.ERROR) if one.code == deep else one for one in found],
        [one for one in motion if one.code != fall],
    )


def _as_pushed_out(found: Diagnostic) -> Diagnostic:
    """What is said of a robot in a model of the world that stands all the same."""
    is_overlap = found.code == runs.OVERLAPPING_ROBOTS.code
    return replace(found, severity=Severity.WARNING) if is_overlap else found


def _is_on_the_ground(world: World, robot_run: RobotRun) -> bool:
    """Whether it ends up where a robot that leans has fallen over, and stands on no slope."""
    return world.has_ground_plane and abs(robot_run.lowest_point_at_end) < ON_THE_GROUND


def _as_on_a_slope(diagnostic: Diagnostic) -> Diagnostic:
    """On the models of a world it may be right that a robot leans."""
    leans = diagnostic.code == runs.TIPS_OVER.code and diagnostic.severity is Severity.ERROR
    return replace(diagnostic, severity=Severity.WARNING) if leans else diagnostic


def _leaning(robot: Robot, robot_run: RobotRun) -> Iterator[Diagnostic]:
    """Say by which parts a robot that is at rest on the ground is not upright."""
    is_upright = robot_run.tilt <= runs.LEANING
    if is_upright or robot_run.settled_after is None or robot.fixed_to_world:
        return
    # It reads meshes, for the few that lean.
    from wsgen.simulation.surfaces import UnreadError, lowest_points  # noqa: PLC0415

    try:
        upright = lowest_points(robot, link_poses(robot, robot_run.spawn_pose))
        at_end = lowest_points(robot, link_poses(robot, robot_run.rest_pose))
    except (OSError, UnreadError):
        upright, at_end = {}, {}
    ground = min(at_end.values(), default=0.0)
    touching = sorted(name for name, z in at_end.items() if z - ground < TOUCHES)
    least = min(upright.values(), default=0.0)
    heights = {name: z - least for name, z in upright.items()}
    yield from runs.leans(robot_run.entity, robot_run.tilt, touching, heights)


def _check_motion(
    robot: Robot,
    world: World,
    robot_run: RobotRun,
    *,
    is_alone: bool,
    pushed: Collection[str],
) -> list[Diagnostic]:
    entity = robot_run.entity
    passive = passive_joints(robot, robot_run)
    is_moving = robot_run.settled_after is None
    found = list(
        runs.gains_energy(
            entity,
            robot_run.energy_gain,
            robot_run.mass,
            math.hypot(*world.gravity),
            _pushed_out(robot_run),
            is_alone=is_alone,
        )
    )
    if found and is_alone:
        return found  # anything else follows from that
    # A robot that is fixed to the world stays where it is spawned; only its joints can move.
    if not robot.fixed_to_world:
        is_held = any(joint.is_held for joint in robot.joints)
        found += _check_place(world, robot_run, has_passive_joints=bool(passive), is_held=is_held)
    found += runs.rests_on_hull(entity, robot_run.hull_gaps)
    found += runs.joint_beyond_limit(entity, robot.joints, robot_run.joint_positions)
    # What its limits move is not reported as moved by gravity.
    to_limits = {
        joint.name: max(joint.limit.lower, -joint.limit.upper)
        for joint in robot.joints
        if joint.name in pushed and joint.limit is not None
    }
    by_gravity = {
        name: travel
        for name, travel in passive.items()
        if travel > OVERSHOT * to_limits.get(name, 0.0)
    }
    found += runs.unactuated_joints_move(by_gravity, entity, is_moving=is_moving)
    return found


def _pushed_out(robot_run: RobotRun) -> float:
    """How far contacts lift it out of the ground, or of what else it is spawned in, m."""
    depths = [one.depth for one in robot_run.overlaps if one.other_entity is not None]
    return max(robot_run.penetration, *depths, 0.0)


def _check_place(
    world: World, robot_run: RobotRun, *, has_passive_joints: bool, is_held: bool
) -> list[Diagnostic]:
    entity = robot_run.entity
    falls = list(
        runs.falls_without_end(
            entity,
            robot_run.lowest_point,
            robot_run.lowest_point_at_end,
            has_ground=world.has_ground_plane,
            is_falling=robot_run.is_falling,
        )
    )
    if falls:
        return falls
    depth = -robot_run.lowest_point_at_end if world.has_ground_plane else 0.0
    found = list(runs.stuck_in_ground(entity, depth, robot_run.climb))
    # Or still being pushed out: it moves for that alone.
    is_stuck = bool(found) or (depth > 0 and runs.is_on_its_way_out(depth, robot_run.climb))
    found += runs.thrown_into_the_air(
        entity, robot_run.highest_point - robot_run.spawn_pose.xyz[2] - _pushed_out(robot_run)
    )
    if not is_stuck:
        found += runs.keeps_moving(
            entity,
            robot_run.settled_after,
            robot_run.speed,
            turning=robot_run.turning,
            joint_speed=robot_run.joint_speed,
            has_passive_joints=has_passive_joints,
        )
    found += runs.tips_over(
        entity, robot_run.tilt, has_passive_joints=has_passive_joints, is_held=is_held
    )
    return found


def passive_joints(robot: Robot, robot_run: RobotRun) -> dict[str, float]:
    """The joints that gravity moved, with how far (rad or m)."""
    types = {joint.name: joint.type for joint in robot.joints}
    return {
        name: robot_run.joint_travel[name]
        for name in sorted(unactuated_joints(robot) & robot_run.joint_travel.keys())
        if robot_run.joint_travel[name]
        > (PASSIVE_SLIDING if types[name] is JointType.PRISMATIC else PASSIVE_TURNING)
    }
