"""All rules over a robot, in the order in which a user should read what they find."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.checks import robot_rules, trial_rules

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.pose import Pose
    from wsgen.model.robot import Robot
    from wsgen.model.world import World
    from wsgen.simulation.scene import RobotTrial


def judge_robot(written: Robot, file: Path | None) -> tuple[Diagnostic, ...]:
    """Judge a robot as its description gives it; `file` is what the findings name."""
    return (
        *robot_rules.implausible_inertia(written.links, file),
        *robot_rules.massless_root(written.link(written.root), written.joints, written.mass, file),
        *robot_rules.ros_1_plugin(written.gazebo, file),
        *robot_rules.nothing_to_touch(written.links, file),
        *robot_rules.nothing_to_see(written.links, file),
        *robot_rules.loose_joint(written.joints, file),
    )


def judge_trial(
    robot: Robot, spawn_pose: Pose, world: World, trial: RobotTrial
) -> tuple[Diagnostic, ...]:
    """Judge what was measured of a robot; `robot` is the one Gazebo would build (lumped)."""
    entity = trial.entity
    found = [
        *trial_rules.mass_differs_from_description(entity, robot.mass, trial.mass),
        *trial_rules.joints_differ_from_description(
            entity, len(robot.movable_joints), trial.movable_joints
        ),
        *trial_rules.state_not_finite(entity, is_finite=trial.is_finite),
    ]
    if robot.fixed_to_world:
        # It hangs or stands where it is spawned; only its joints can move.
        return (*found, *_unrest(trial))
    if world.has_ground_plane:
        found += trial_rules.born_inside_the_ground(entity, trial.penetration, spawn_pose.xyz[2])
        found += trial_rules.spawned_high_above_the_ground(
            entity, trial.lowest_point, spawn_pose.xyz[2]
        )
    if trial.is_finite:
        found += _judge_motion(spawn_pose, world, trial)
    return tuple(found)


def _judge_motion(spawn_pose: Pose, world: World, trial: RobotTrial) -> list[Diagnostic]:
    entity = trial.entity
    falls = list(
        trial_rules.falls_without_end(
            entity,
            trial.lowest_point,
            trial.lowest_point_at_end,
            has_ground=world.has_ground_plane,
        )
    )
    if falls:
        return falls
    found = list(trial_rules.stuck_in_the_ground(entity, -trial.lowest_point_at_end))
    is_stuck = bool(found)  # and still being pushed out: it moves for that alone
    found += trial_rules.thrown_into_the_air(
        entity, trial.highest_point - spawn_pose.xyz[2] - trial.penetration
    )
    if not is_stuck:
        found += _unrest(trial)
    found += trial_rules.tips_over(entity, trial.tilt)
    return found


def _unrest(trial: RobotTrial) -> Iterator[Diagnostic]:
    return trial_rules.keeps_moving(
        trial.entity,
        trial.settled_after,
        trial.speed,
        trial.movable_joints,
        turning=trial.turning,
        joint_speed=trial.joint_speed,
    )
