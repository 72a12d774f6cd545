"""All rules about a robot as it is described, in the order in which a user should read them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.checks.rules import (
    bodies,
    drives,
    joint_limits,
    lumped,
    plugins,
    robot_files,
    robots,
    ros2_control,
)
from wsgen.checks.rules.joint_limits import unstable_damping

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Robot


def check_robot(
    written: Robot,
    file: Path | None,
    *,
    in_gazebo: Robot | None = None,
    simulator: str | None = None,
    distro: str | None = None,
) -> tuple[Diagnostic, ...]:
    """Check a robot as its description gives it.

    `in_gazebo` is the same robot with its fixed joints lumped; without it, nothing is said of that.
    `file` is what the diagnostics name, `simulator` what the robot is for: "classic", "gz", or None
    for either; `distro` is the ROS 2 distribution, if that is known.
    """
    control = ros2_control.ControlFacts(
        controls=written.controls,
        joints=written.joints,
        plugins=ros2_control.control_plugins(written.gazebo),
        simulator=simulator,
        distro=distro,
    )
    preserved = {joint.name for joint in written.joints if joint.kept_by}
    plugin_facts = plugins.PluginFacts(
        tags=written.gazebo,
        joints=written.joints,
        links={
            *(link.name for link in written.links),
            *(frame for tag in written.gazebo for frame in tag.frames),
        },
        simulator=simulator or plugins.simulator_meant(written.gazebo),
        distro=distro,
        preserved=preserved,
    )
    oversized = robots.find_oversized(written.links, written.joints)
    driven = plugins.driven_joints(written.gazebo)
    driven |= ros2_control.driven_joints(written.controls, written.joints)
    return (
        *robots.number_beyond_engines(written.links, written.joints, file),
        *robots.implausible_size(written.links, written.joints, file),
        *robots.oversized_parts(oversized.values(), file),
        *robots.implausible_mass(written.links, written.joints, file),
        *bodies.check_bodies(
            [link for link in written.links if link.name not in oversized], written.joints, file
        ),
        *robots.implausible_inertia(
            written.links, file, written.joints, apart_from=oversized.keys()
        ),
        *bodies.attached_bodies(written.links, written.joints, file),
        *robots.massless_root(
            written.link(written.root), written.joints, written.mass, file, preserved
        ),
        *robots.ros_1_plugin(written.gazebo, file),
        *robots.no_collision(written.links, file, fixed_to_world=written.fixed_to_world),
        *robots.no_visual(written.links, file),
        *robots.loose_joint(written.joints, written.gazebo, file, simulator),
        *robots.starts_outside_limits(written.joints, file),
        *joint_limits.limits_in_degrees(written.joints, file),
        *joint_limits.zero_limits(written.joints, file, written.gazebo),
        *joint_limits.negative_limits(written.joints, file),
        *joint_limits.limits_in_millimeters(
            written.joints, written.links, robots.extent_of(written.links, written.joints), file
        ),
        *joint_limits.no_range(written.joints, file),
        *joint_limits.useless_mimics(written.joints, file),
        *bodies.wheel_without_collision(written.links, written.joints, file),
        *bodies.preserved_movable_joint(written.joints, written.gazebo, file),
        *bodies.slippery_wheels(driven, written.joints, written.gazebo, file),
        *bodies.sticky_wheels(driven, written.joints, written.gazebo, file),
        *bodies.dragging_casters(driven, written.links, written.joints, written.gazebo, file),
        *plugins.check_plugins(plugin_facts, file),
        *drives.check_drive(written, file),
        *ros2_control.check_control(control, file),
        *ros2_control.transmissions(written.transmissions, written.joints, written.controls, file),
        *robot_files.ogre_materials(
            written.links, written.gazebo, file, simulator=simulator, distro=distro
        ),
        *(() if in_gazebo is None else lumped.check_lumped(written, in_gazebo, file)),
        *(() if in_gazebo is None else unstable_damping(in_gazebo, file, simulator)),
    )
