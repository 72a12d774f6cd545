"""Rules over a robot as its URDF describes it.

The parameters are facts in SI units; a rule yields what it finds.

Rules over how large and how heavy a robot is: what is absurd is surely in other units.

The parameters are facts in SI units; a rule yields what it finds.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.inertia import as_attributes, if_filled, principal_moments
from wsgen.model.robot import Box, Cylinder, JointType, Mesh, Primitive, Sphere, Triangulated
from wsgen.model.transform import IDENTITY, compose

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.model.robot import GazeboTag, Geometry, Joint, Link
    from wsgen.model.transform import Pose


# Doubles have 16 digits: beyond it a meter, a kilogram is lost in rounding, and squares overflow.
BEYOND = 1e15
LARGEST = 100.0  # m; a ship, a crane
SMALLEST = 1e-3  # m; contacts of engines are as thick
HEAVIEST = 1e6  # kg; the largest mining trucks have 600,000
# kg; before sdformat 12.7.2, as in Gazebo Classic, a link of less was one without mass.
LIGHTEST = 1e-6


def number_beyond_engines(
    links: Iterable[Link], joints: Iterable[Joint], file: Path | None
) -> Iterator[Diagnostic]:
    """A number is so large that no physics engine can compute with it.

    ## What it does
    Looks for masses, moments, positions, sizes, damping and friction beyond 1e15 in SI units.
    Limits of joints may be as large as they like: that is how "no limit" is written.

    ## Why is this bad?
    Next to such a number every other one is lost in rounding, and its square may overflow: the
    state of the whole robot becomes not-a-number in the first step.

    ## Example
    `<mass value="1e308"/>`.

    ## Use instead
    Kilograms and meters.
    """
    for link in links:
        for what, numbers in _numbers_of_link(link):
            yield from _beyond(what, numbers, f"link[@name='{link.name}']", link.line, file)
    for joint in joints:
        place = f"joint[@name='{joint.name}']"
        dynamics = (joint.damping, joint.friction, joint.spring_stiffness)
        for what, joint_numbers in (
            ("origin", joint.pose_in_parent.xyz),
            ("dynamics", dynamics),
        ):
            yield from _beyond(what, joint_numbers, place, joint.line, file)


def implausible_size(
    links: Sequence[Link], joints: Iterable[Joint], file: Path | None
) -> Iterator[Diagnostic]:
    """The robot is larger than a ship or smaller than a grain of sand.

    ## What it does
    Measures the robot with all joints at zero: the frames of its links and its primitive shapes.
    Meshes are not measured.

    ## Why is this bad?
    Lengths of a URDF are meters. Written in millimeters, the robot is a thousand times too large,
    and falls as slowly as a mountain would; too small, and it is thinner than the contacts of the
    engine.

    ## Example
    `<box size="400 300 200"/>` for a box of 40 cm.

    ## Use instead
    Metres; for a mesh in millimeters scale="0.001 0.001 0.001".
    """
    extent = _extent(links, joints)
    has_meshes = any(isinstance(geometry, Mesh) for link in links for geometry, _ in _shapes(link))
    is_small = 0 < extent < SMALLEST and not has_meshes
    if links and (LARGEST < extent < math.inf or is_small):
        yield Diagnostic(
            code="ROB048",
            severity=Severity.WARNING,
            message=f"The robot measures {extent:.3g} m.",
            file=file,
            line=links[0].line,
            element="robot",
            hint="Lengths of a URDF are in meters: divide millimeters by 1000."
            if extent > LARGEST
            else "Lengths of a URDF are in meters; a physics engine needs some millimeters.",
        )


def implausible_mass(
    links: Sequence[Link], joints: Iterable[Joint], file: Path | None
) -> Iterator[Diagnostic]:
    """The robot is heavier than a mining truck, or a moving part lighter than a milligram.

    ## What it does
    Adds up the masses, and looks for links that have next to none and that nothing is fixed to.

    ## Why is this bad?
    Masses of a URDF are kilograms. Between very light and heavy parts joints shake or tear, and
    older versions of Gazebo drop a link below a milligram with all that hangs on it.

    ## Example
    `<mass value="1e-9"/>` on a wheel.

    ## Use instead
    The mass in kilograms.
    """
    mass = sum(link.inertial.mass for link in links if link.inertial is not None)
    if HEAVIEST < mass <= BEYOND:
        yield Diagnostic(
            code="ROB049",
            severity=Severity.WARNING,
            message=f"The robot weighs {mass:.3g} kg.",
            file=file,
            line=links[0].line,
            element="robot",
            hint="Masses of a URDF are in kilograms: divide grams by 1000.",
        )
    fixed = {
        end
        for joint in joints
        if joint.type is JointType.FIXED
        for end in (joint.parent, joint.child)
    }
    for link in links:
        if (
            link.inertial is not None
            and 0 < link.inertial.mass < LIGHTEST
            and link.name not in fixed
        ):
            yield Diagnostic(
                code="ROB049",
                severity=Severity.WARNING,
                message=f"The link `{link.name}` weighs {link.inertial.mass:.3g} kg: Gazebo "
                "Classic takes that for nothing, and drops the link with all that hangs on it.",
                file=file,
                line=link.line,
                element=f"link[@name='{link.name}']/inertial/mass",
                hint="Masses of a URDF are in kilograms.",
            )


def _beyond(
    what: str, numbers: Iterable[float], place: str, line: int | None, file: Path | None
) -> Iterator[Diagnostic]:
    largest = max(map(abs, numbers), default=0.0)
    if largest > BEYOND:
        yield Diagnostic(
            code="ROB056",
            severity=Severity.ERROR,
            message=f"{largest:.3g} is too large a number for any physics engine.",
            file=file,
            line=line,
            element=f"{place}/{what}",
            hint="Write it in meters, kilograms and seconds.",
        )


def _numbers_of_link(link: Link) -> Iterator[tuple[str, tuple[float, ...]]]:
    if link.inertial is not None:
        inertial = link.inertial
        yield "inertial", (inertial.mass, *inertial.inertia, *inertial.pose_in_link.xyz)
    for geometry, pose in _shapes(link):
        yield "geometry", (*pose.xyz, *_sizes(geometry))


def largest_size(shape: Primitive) -> float:
    """The longest of its edges, diameter and length, m."""
    return max(_sizes(shape))


def _sizes(geometry: Geometry) -> tuple[float, ...]:
    if isinstance(geometry, Box):
        return geometry.size
    if isinstance(geometry, Mesh):
        return geometry.scale
    if isinstance(geometry, Sphere):
        return (2 * geometry.radius,)
    if isinstance(geometry, Triangulated):  # of SDF, and told by its reader
        return ()
    return (2 * geometry.radius, geometry.length)


def _shapes(link: Link) -> Iterator[tuple[Geometry, Pose]]:
    for collision in link.collisions:
        yield collision.geometry, collision.pose_in_link
    for visual in link.visuals:
        yield visual.geometry, visual.pose_in_link


def _extent(links: Iterable[Link], joints: Iterable[Joint]) -> float:
    """The longest edge of the box along the root's axes around frames and primitives, m."""
    poses = _poses(joints)
    corners: list[tuple[tuple[float, float, float], float]] = []
    for link in links:
        pose = poses.get(link.name, IDENTITY)
        corners.append((pose.xyz, 0.0))
        corners += (
            (compose(pose, place).xyz, max(_sizes(geometry)) / 2)
            for geometry, place in _shapes(link)
            if isinstance(geometry, Primitive)
        )
    return max(
        (
            max(xyz[axis] + reach for xyz, reach in corners)
            - min(xyz[axis] - reach for xyz, reach in corners)
            for axis in range(3)
            if corners
        ),
        default=0.0,
    )


def _poses(joints: Iterable[Joint]) -> dict[str, Pose]:
    """The poses of all links but the root, in the root's frame; the joints make a tree."""
    below: dict[str, list[Joint]] = {}
    children = set()
    for joint in joints:
        below.setdefault(joint.parent, []).append(joint)
        children.add(joint.child)
    poses: dict[str, Pose] = {}
    queue = [name for name in below if name not in children]
    for name in queue:
        for joint in below.get(name, ()):
            poses[joint.child] = compose(poses.get(name, IDENTITY), joint.pose_in_parent)
            queue.append(joint.child)
    return poses


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
            f"{_ratio(times)} that of {_prepared(shape)} of {link.inertial.mass:g} kg.",
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


def _prepared(geometry: Primitive) -> str:
    if isinstance(geometry, Box):
        return "a box of " + " x ".join(f"{edge:g}" for edge in geometry.size) + " m"
    if isinstance(geometry, Sphere):
        return f"a sphere of radius {geometry.radius:g} m"
    name = "cylinder" if isinstance(geometry, Cylinder) else "capsule"
    return f"a {name} of radius {geometry.radius:g} m and length {geometry.length:g} m"
