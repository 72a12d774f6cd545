"""Rules over a robot as its URDF describes it.

The parameters are facts in SI units; a rule yields what it finds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.checks.extent_rules import HEAVIEST, LARGEST, largest_size
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.inertia import as_attributes, if_filled, principal_moments
from wsgen.model.robot import Box, Cylinder, Primitive, Sphere

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from wsgen.model.robot import GazeboTag, Joint, Link

# A hollow part has up to three times the inertia of a solid one, a part with its mass at one end
# more, and a collision shape may be a good deal larger or smaller than the part.
IMPLAUSIBLE = 30.0  # times the solid's largest moment, or that part of it

# What becomes of the child of a joint that is left out, by generation of the simulator.
LOOSE = {
    None: "in Gazebo Classic `{}` is loose, Gazebo Sim refuses the robot",
    "classic": "`{}` is loose",
    "gz": "Gazebo Sim refuses the robot, where `{}` is placed on it",
}
# Plugin libraries that no ROS 2 release has, with what took their place.
ROS_1_PLUGINS = {
    "gazebo_ros_control": "libgazebo_ros2_control.so with <ros2_control> tags",
    "gazebo_ros_skid_steer_drive": "libgazebo_ros_diff_drive.so with two wheel pairs",
    "gazebo_ros_laser": "libgazebo_ros_ray_sensor.so",
    "gazebo_ros_gpu_laser": "libgazebo_ros_ray_sensor.so",
    "gazebo_ros_block_laser": "libgazebo_ros_ray_sensor.so",
    "gazebo_ros_range": "libgazebo_ros_ray_sensor.so",
    "gazebo_ros_imu": "libgazebo_ros_imu_sensor.so",
    "gazebo_ros_depth_camera": "libgazebo_ros_camera.so",
    "gazebo_ros_openni_kinect": "libgazebo_ros_camera.so",
    "gazebo_ros_multicamera": "libgazebo_ros_camera.so",
    "gazebo_ros_f3d": "libgazebo_ros_ft_sensor.so",
    "gazebo_ros_joint_pose_trajectory_plugin": "libgazebo_ros_joint_pose_trajectory.so",
    "gazebo_ros_joint_trajectory": "libgazebo_ros_joint_pose_trajectory.so",
    "gazebo_mimic_joint_plugin": "<mimic> with gazebo_ros2_control",
    "roboticsgroup_gazebo_mimic_joint_plugin": "<mimic> with gazebo_ros2_control",
    "hector_gazebo_ros_imu": "libgazebo_ros_imu_sensor.so",
    "hector_gazebo_ros_gps": "libgazebo_ros_gps_sensor.so",
}


def implausible_inertia(links: Iterable[Link], file: Path | None) -> Iterator[Diagnostic]:
    """A link's inertia is not that of a body with its mass and shape.

    ## What it does
    Compares the largest principal moment of a link that has one primitive shape with that of an
    evenly filled body of this shape and the link's mass.

    ## Why is this bad?
    Too large, and the link turns as if through honey; too small, and joints shake or the
    simulation explodes. Both come from numbers copied from another robot.

    ## Example
    `<inertia ixx="100" ... />` on a cylinder of 1 kg with a radius of 0.4 m.

    ## Use instead
    The formula of the shape, in a xacro macro, or the figures of the CAD program.
    """
    for link in links:
        shapes = [collision.geometry for collision in link.collisions]
        shapes = shapes or [visual.geometry for visual in link.visuals]
        has_mass = link.inertial is not None and 0 < link.inertial.mass <= HEAVIEST
        if link.inertial is None or not has_mass or len(shapes) != 1 or not link.is_as_meant:
            continue
        shape = shapes[0]
        solid = if_filled(link)
        if solid is None or not isinstance(shape, Primitive) or largest_size(shape) > LARGEST:
            continue
        largest = principal_moments(link.inertial.inertia)[2]
        times = largest / max(solid)
        if 1 / IMPLAUSIBLE <= times <= IMPLAUSIBLE:
            continue
        yield Diagnostic(
            code="ROB050",
            severity=Severity.WARNING,
            message=f"The inertia of the link `{link.name}` ({largest:.4g} kg m²) is "
            f"{_ratio(times)} that of {_described(shape)} of {link.inertial.mass:g} kg.",
            file=file,
            line=link.line,
            element=f"link[@name='{link.name}']/inertial/inertia",
            hint=f"If it is evenly filled: {as_attributes(solid)} (kg m², the products 0).",
        )


def massless_root(
    root: Link, joints: Iterable[Joint], robot_mass: float, file: Path | None
) -> Iterator[Diagnostic]:
    """The root link has no mass of its own.

    ## What it does
    Looks for a root without <inertial> to which links with mass are fixed.

    ## Why is this bad?
    Gazebo lumps fixed links into their parent, which keeps its name: the robot's only body is
    called after the empty root, and <gazebo reference> and sensors move with it.

    ## Example
    An empty link `dummy` above `base_link`.

    ## Use instead
    A root called `base_footprint` or `base_link`, if the empty link is not there on purpose.
    """
    fixed = [joint for joint in joints if joint.parent == root.name and not joint.is_movable]
    is_massless = root.inertial is None or root.inertial.mass == 0
    if is_massless and root.is_as_meant and root.name != "world" and fixed and robot_mass > 0:
        yield Diagnostic(
            code="ROB051",
            severity=Severity.WARNING,
            message=f"The root link `{root.name}` has no mass: Gazebo lumps "
            f"`{fixed[0].child}` into it and calls the body `{root.name}`.",
            file=file,
            line=root.line,
            element=f"link[@name='{root.name}']",
            hint=f"Keep `{root.name}` if it is there for robot_state_publisher, whose KDL ignores "
            f"the inertia of a root link; Gazebo plugins then call the body `{root.name}`. "
            f"Otherwise remove `{root.name}` and its joint.",
        )


def ros_1_plugin(tags: Iterable[GazeboTag], file: Path | None) -> Iterator[Diagnostic]:
    """A plugin is one of ROS 1.

    ## What it does
    Looks for plugin libraries that exist in no ROS 2 release.

    ## Why is this bad?
    Gazebo logs that it cannot open the library, and goes on without what it should have done.

    ## Example
    `<plugin name="gazebo_ros_control" filename="libgazebo_ros_control.so">`.

    ## Use instead
    The plugin that took its place, which the hint names; or none.
    """
    for tag in tags:
        for plugin in (one.filename for one in tag.plugins):
            name = plugin.rpartition("/")[2].removeprefix("lib").removesuffix(".so")
            if name in ROS_1_PLUGINS:
                yield Diagnostic(
                    code="ROB052",
                    severity=Severity.WARNING,
                    message=f"The plugin `{plugin}` belongs to ROS 1: no ROS 2 release has it.",
                    file=file,
                    line=tag.line,
                    element=f"gazebo/plugin[@filename='{plugin}']",
                    hint=f"Remove it, or use {ROS_1_PLUGINS[name]}.",
                )


def nothing_to_touch(links: Iterable[Link], file: Path | None) -> Iterator[Diagnostic]:
    """No link of the robot has a <collision>.

    ## What it does
    Looks for <collision> in all links.

    ## Why is this bad?
    The robot falls through the ground.

    ## Use instead
    A <collision> with a simple shape in every link that can touch something.
    """
    links = list(links)
    is_as_meant = all(link.is_as_meant for link in links)
    if links and is_as_meant and not any(link.collisions for link in links):
        yield Diagnostic(
            code="ROB053",
            severity=Severity.WARNING,
            message="No link has a <collision>: the robot falls through the ground.",
            file=file,
            line=links[0].line,
            element="robot",
            hint="Copy <geometry> and <origin> of the <visual> into a <collision>.",
        )


def nothing_to_see(links: Iterable[Link], file: Path | None) -> Iterator[Diagnostic]:
    """A link can be touched and not be seen.

    ## What it does
    Looks for links with mass and <collision> and without <visual>.

    ## Why is this bad?
    The part is invisible in RViz and Gazebo, while things bump against it.

    ## Use instead
    A <visual> of the same shape.
    """
    for link in links:
        is_hidden = link.is_as_meant and not link.visuals
        if link.inertial is not None and link.collisions and is_hidden:
            yield Diagnostic(
                code="ROB054",
                severity=Severity.INFO,
                message=f"The link `{link.name}` can be touched and not be seen: it has no "
                "<visual>.",
                file=file,
                line=link.line,
                element=f"link[@name='{link.name}']",
                hint="Copy <geometry> and <origin> of the <collision> into a <visual>.",
            )


def loose_joint(
    joints: Iterable[Joint], file: Path | None, generation: str | None
) -> Iterator[Diagnostic]:
    """A joint is of a type that Gazebo makes no joint of.

    ## What it does
    Looks for floating and planar joints.

    ## Why is this bad?
    Gazebo's parser leaves the joint out: in Gazebo Classic the child is a loose body and falls off;
    Gazebo Sim refuses the robot, because the child is placed relative to a joint that is not there.

    ## Use instead
    For the base of a mobile robot nothing: it is free anyhow. Otherwise prismatic and revolute
    joints, one after the other.
    """
    for joint in joints:
        if joint.type.value in {"floating", "planar"}:
            yield Diagnostic(
                code="ROB055",
                severity=Severity.ERROR if generation == "gz" else Severity.WARNING,
                message=f"Gazebo has no {joint.type.value} joints and leaves `{joint.name}` out: "
                f"{LOOSE[generation].format(joint.child)}.",
                file=file,
                line=joint.line,
                element=f"joint[@name='{joint.name}']",
                hint=f"Make `{joint.child}` the root, or use prismatic and revolute joints.",
            )


def starts_outside_limits(joints: Iterable[Joint], file: Path | None) -> Iterator[Diagnostic]:
    """A joint starts at 0, and 0 is outside of its limits.

    ## What it does
    Looks for revolute and prismatic joints whose limits do not hold 0.

    ## Why is this bad?
    Simulators spawn a robot with all joints at 0 and then push this one to its limit with a jolt.

    ## Example
    `<limit lower="-3.07" upper="-0.07" ... />` of a Panda's elbow.

    ## Use instead
    Limits around 0, with the zero of the joint moved by <origin>; or a spawner that gives the start
    position (-J in Gazebo Classic), or a controller that takes it from there.
    """
    for joint in joints:
        limit = joint.limit
        if limit is None or not joint.starts_beyond_limit:
            continue
        yield Diagnostic(
            code="ROB070",
            severity=Severity.INFO,
            message=f"The joint `{joint.name}` is spawned at 0, outside of its limits "
            f"{limit.lower:g} to {limit.upper:g}: simulators push it there.",
            file=file,
            line=joint.line,
            element=f"joint[@name='{joint.name}']/limit",
            hint="Give the spawner a start position, or choose limits that hold 0.",
        )


def _ratio(times: float) -> str:
    if not times:
        return "zero, not"
    return f"{_rounded(times)} times" if times > 1 else f"only 1/{_rounded(1 / times)} of"


def _rounded(number: float) -> str:
    """Three digits, as a person writes them: 1250, not 1.25e+03."""
    return f"{float(f'{number:.3g}'):.9g}"


def _described(geometry: Primitive) -> str:
    if isinstance(geometry, Box):
        return "a box of " + " x ".join(f"{edge:g}" for edge in geometry.size) + " m"
    if isinstance(geometry, Sphere):
        return f"a sphere of radius {geometry.radius:g} m"
    name = "cylinder" if isinstance(geometry, Cylinder) else "capsule"
    return f"a {name} of radius {geometry.radius:g} m and length {geometry.length:g} m"
