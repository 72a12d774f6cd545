"""Rules about a robot as its URDF describes it.

The parameters of a check are facts in SI units; a check yields what it reports.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import Measured, Rule, Severity
from wsgen.gazebo.successors import ROS_1_PLUGINS
from wsgen.model.inertia import as_attributes, if_filled, of_solid, principal_moments
from wsgen.model.robot import (
    Box,
    Capsule,
    Cylinder,
    JointType,
    Mesh,
    Primitive,
    Sphere,
    Triangulated,
    by_parent,
)
from wsgen.model.transform import IDENTITY, compose
from wsgen.text.suggestions import some_named

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import GazeboTag, Geometry, Joint, Link
    from wsgen.model.transform import Pose


# Doubles have 16 digits: beyond it a meter, a kilogram is lost in rounding, and squares overflow.
BEYOND = 1e15
LARGEST = 100.0  # m; a ship, a crane
SMALLEST = 1e-3  # m; contacts of engines are as thick
HEAVIEST = 1e6  # kg; the largest mining trucks have 600,000
# kg; before sdformat 12.7.2, as in Gazebo Classic, a link of less was one without mass.
LIGHTEST = 1e-6
# A hollow part has up to three times the inertia of a solid one, a part with its mass at one end
# more, and a collision shape may be a good deal larger or smaller than the part.
DENSE_PART = 3000.0  # kg/m³; parts of robots with motors in them are lighter
OVERSIZED = 15.0  # times the rest of the robot
FOAM = 100.0  # kg/m³; parts of robots are denser, but for what is hollow
VERY_LIGHT = 10.0  # kg/m³; hollow parts of robots are denser
DENSEST = 10_000.0  # kg/m³; of lead, or of a part that has a thinner shape
MISSED_BY = 5.0  # times that an inertia, or a size, may be off all the same
OF_MILLIMETERS = 120.0  # likewise: what is so much larger is in millimeters
INERTIA_FACTOR = 30.0  # times the solid's largest moment, or that part of it

# What becomes of the child of a joint that is ignored, by simulator.
LOOSE = {
    None: "`{}` falls off in Gazebo Classic, and Gazebo Sim refuses the robot",
    "classic": "`{}` falls off",
    "gz": "Gazebo Sim refuses the robot, because `{}` is placed relative to it",
}


NUMBER_BEYOND_ENGINES = Rule(
    code="ROB056",
    name="number-beyond-engines",
    severity=Severity.ERROR,
    measured=Measured(classic="simulates another robot", sim="accepts it"),
    summary="A number is too large for any physics engine.",
    what="Looks for masses, moments of inertia, positions, sizes, damping and friction beyond 1e15 "
    'in SI units. Limits of joints may be larger: descriptions use such values for "no limit".',
    why="All other numbers are lost in rounding, and the square of such a number overflows: the "
    "state of the whole robot becomes not-a-number in the first step.",
    example='<mass value="1e308"/>',
    instead='<mass value="1.5"/>  <!-- kg -->',
)


def number_beyond_engines(
    links: Iterable[Link], joints: Iterable[Joint], file: Path | None
) -> Iterator[Diagnostic]:
    """Report numbers that are too large for any physics engine."""
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


IMPLAUSIBLE_SIZE = Rule(
    code="ROB048",
    name="implausible-size",
    severity=Severity.WARNING,
    summary="The robot is larger than 100 m or smaller than 1 mm.",
    what="Measures the extent of the link frames and primitive shapes with all joints at zero. "
    "Meshes are not measured.",
    why="Lengths in a URDF are in meters. With millimeters the robot is 1000 times too large and "
    "seems to fall slowly; a robot that is too small is thinner than the contacts of the physics "
    "engine.",
    example='<box size="400 300 200"/>',
    instead='<box size="0.4 0.3 0.2"/>',
)


def implausible_size(
    links: Sequence[Link], joints: Iterable[Joint], file: Path | None
) -> Iterator[Diagnostic]:
    """Report a robot that is larger than a ship or smaller than a grain of sand."""
    extent = extent_of(links, joints)
    has_meshes = any(isinstance(geometry, Mesh) for link in links for geometry, _ in _shapes(link))
    is_small = 0 < extent < SMALLEST and not has_meshes
    if links and (LARGEST < extent < math.inf or is_small):
        yield IMPLAUSIBLE_SIZE.at(
            file,
            links[0].line,
            "robot",
            message=f"The size of the robot is {extent:.3g} m.",
            hint="Use meters: divide millimeters by 1000."
            if extent > LARGEST
            else "Use meters; a physics engine needs a robot of at least some millimeters.",
        )


OVERSIZED_PART = Rule(
    code="ROB145",
    name="oversized-part",
    severity=Severity.WARNING,
    severity_varies="an error where the simulation of the robot fails",
    summary="A part is many times larger than the rest of the robot, or than fits its mass.",
    what="Compares each primitive shape of links on movable joints with the largest of the other "
    "shapes and the distances between the frames; reports factors above 15. Reports smaller ones, "
    "and other links, where mass and inertia are those of a body that is a hundred or a thousand "
    "times as small.",
    why="Lengths in a URDF are in meters. A wheel with its radius in centimeters is a hundred "
    "times too large: the robot is spawned deep in the ground, or contact forces throw it into the "
    "air.",
    example='<link name="wheel">\n'
    '  <collision><geometry><cylinder radius="8" length="0.04"/></geometry></collision>\n'
    "</link>",
    instead='<link name="wheel">\n'
    '  <collision><geometry><cylinder radius="0.08" length="0.04"/></geometry></collision>\n'
    "</link>",
)


class Oversized(NamedTuple):
    """A link with a shape whose size is in other units."""

    link: Link
    shape: Primitive
    times: float  # as large as the rest of the robot; 0.0 where that is not what matters
    meant: Primitive  # the shape in meters
    unit: str  # in which it is written
    evidence: str  # what else says so, for the message


def find_oversized(links: Sequence[Link], joints: Sequence[Joint]) -> dict[str, Oversized]:
    """The links, by name, with a shape that is much larger than the rest, or than its mass."""
    moving = {joint.child for joint in joints if joint.is_movable}
    fixed = {joint.child for joint in joints if joint.parent == "world"}
    sizes = {
        link.name: max(
            (largest_size(one) for one, _ in _shapes(link) if isinstance(one, Primitive)),
            default=0.0,
        )
        for link in links
    }
    poses = poses_of(joints)
    # A frame without a shape may be as far away as a wheel that is too large is high.
    places = [poses.get(link.name, IDENTITY).xyz for link in links if any(_shapes(link))]
    apart = max((math.dist(places[0], place) for place in places), default=0.0)
    found: dict[str, Oversized] = {}
    for link in links:
        size = sizes[link.name]
        others = [one for name, one in sizes.items() if 0 < one < size / 2 and name != link.name]
        rest = max(apart, *others) if others else 0.0
        if not size or link.name in fixed:
            continue
        light = _in_other_units(link, max(others, default=0.0)) if link.is_as_meant else None
        if link.name in moving and rest and size >= OVERSIZED * rest:
            shape = max(
                (one for one, _ in _shapes(link) if isinstance(one, Primitive)), key=largest_size
            )
            unit, times = ("mm", 1000) if size > OF_MILLIMETERS * rest else ("cm", 100)
            large = Oversized(link, shape, 0.0, _smaller(shape, times), unit, "")
            found[link.name] = (light or large)._replace(times=size / rest, evidence="")
        elif light is not None and size <= LARGEST:
            found[link.name] = light
    return found


def _in_other_units(link: Link, rest: float) -> Oversized | None:
    """The largest shape of a link, if it is in other units by mass and inertia of the link.

    `rest` is the size of the shapes of other links, 0.0 where there are none.
    """
    for parts in (link.collisions, link.visuals):
        shapes = [one.geometry for one in parts if isinstance(one.geometry, Primitive)]
        if link.inertial is None or not shapes or len(shapes) < len(parts):
            continue
        mass = link.inertial.mass
        size = max(map(largest_size, shapes))
        if size > BEYOND:  # reported; its volume may be no number
            continue
        shape = max((one for one in shapes if 2 * largest_size(one) > size), key=_volume)
        moment = principal_moments(link.inertial.inertia)[2]
        solid = max(of_solid(shape, mass) or (0.0,))
        # A <visual> that is not that of the body may be a beam.
        is_of_body = parts is link.collisions or moment * MISSED_BY > solid
        # In centimeters, numbers below 1 are rare; a mass may be next to nothing.
        if is_of_body and _number_of(shape) >= 1 and 0 < mass < FOAM * _volume(shape):
            is_unlike = moment * INERTIA_FACTOR < solid
            found = _fitting_inertia(link, shape, mass, moment) if is_unlike else None
            found = found or _fitting_rest(link, shape, mass, rest)
            if found is not None:
                return found
    return None


def _fitting_inertia(link: Link, shape: Primitive, mass: float, moment: float) -> Oversized | None:
    """The shape in other units, where it then fits the largest moment of the inertia."""
    for unit, meant in _in_meters(shape, mass):
        solid = max(of_solid(meant, mass) or (0.0,))
        if solid / MISSED_BY < moment < solid * MISSED_BY:
            evidence = f", but its inertia fits {_described(meant)}"
            return Oversized(link, shape, 0.0, meant, unit, evidence)
    return None


def _fitting_rest(link: Link, shape: Primitive, mass: float, rest: float) -> Oversized | None:
    """A shape that is lighter than any, where it is as large as the rest in other units."""
    size, beside = largest_size(shape), sorted((0.0, *_sizes(shape)))[-2]
    if mass < VERY_LIGHT * _volume(shape):
        for unit, meant in _in_meters(shape, mass):
            if largest_size(meant) < MISSED_BY * (rest or beside) < size:
                times = size / rest if rest else 0.0
                return Oversized(link, shape, times, meant, unit, f", and weighs {mass:g} kg")
    return None


def _in_meters(shape: Primitive, mass: float) -> Iterator[tuple[str, Primitive]]:
    """A shape that may be in other units as it would be in meters, if it can have the mass."""
    for (unit, times), is_whole in itertools.product((("cm", 100), ("mm", 1000)), (False, True)):
        meant = _smaller(shape, times, is_whole=is_whole)
        if mass < DENSEST * _volume(meant):
            yield unit, meant


def _volume(shape: Primitive) -> float:
    return volume_of(shape) or 0.0


def _smaller(shape: Primitive, times: float, *, is_whole: bool = False) -> Primitive:
    """The shape with its largest number, or with all of them, divided."""
    number = _number_of(shape)

    def scaled(one: float) -> float:
        return one / times if is_whole or one == number else one

    if isinstance(shape, Box):
        x, y, z = map(scaled, shape.size)
        return Box(size=(x, y, z))
    if isinstance(shape, Sphere):
        return Sphere(radius=scaled(shape.radius))
    return type(shape)(radius=scaled(shape.radius), length=scaled(shape.length))


def oversized_parts(found: Iterable[Oversized], file: Path | None) -> Iterator[Diagnostic]:
    """Report, once for parts of one size, shapes whose size is in other units."""
    reported: set[Primitive] = set()
    for link, shape, times, meant, unit, evidence in found:
        if shape in reported:
            continue
        reported.add(shape)
        relation = f", {_rounded(times)} times as large as the rest of the robot" if times else ""
        pairs = zip(_written(shape), _written(meant), strict=True)
        changed = [(one, other) for one, other in pairs if one != other]
        yield OVERSIZED_PART.at(
            file,
            link.line,
            f"link[@name='{link.name}']",
            message=f"The link `{link.name}` is {_described(shape)}{relation}{evidence}.",
            hint=f"Use meters: for {' '.join(f'{one:g}' for one, _ in changed)} {unit}, write "
            f"{' '.join(f'{one:g}' for _, one in changed)}.",
        )


def _written(shape: Primitive) -> tuple[float, ...]:
    """The numbers of a shape, m."""
    if isinstance(shape, Box):
        return shape.size
    return (shape.radius,) if isinstance(shape, Sphere) else (shape.radius, shape.length)


def _number_of(shape: Primitive) -> float:
    """What is written of the largest size of a shape, m: a radius, a length or an edge."""
    if isinstance(shape, (Box, Sphere)):
        return max(_written(shape))
    return shape.radius if 2 * shape.radius >= shape.length else shape.length


IMPLAUSIBLE_MASS = Rule(
    code="ROB049",
    name="implausible-mass",
    severity=Severity.WARNING,
    summary="The robot is heavier than 1000 t, a moving part is lighter than 1 mg, or a mass is in "
    "grams.",
    what="Adds up the masses of all links, and looks for links below 1 mg without a fixed joint to "
    "other links, and for links whose inertia and shape fit a thousandth of the mass.",
    why="Masses in a URDF are in kilograms. Joints between very light and heavy parts shake or "
    "break, and older versions of Gazebo drop a link below 1 mg and everything attached to it.",
    example='<mass value="1e-9"/>',
    instead='<mass value="0.25"/>  <!-- kg -->',
)


def implausible_mass(
    links: Sequence[Link], joints: Iterable[Joint], file: Path | None
) -> Iterator[Diagnostic]:
    """Report a robot heavier than a mining truck, and parts lighter than a milligram."""
    mass = sum(link.inertial.mass for link in links if link.inertial is not None)
    if HEAVIEST < mass <= BEYOND:
        yield IMPLAUSIBLE_MASS.at(
            file,
            links[0].line,
            "robot",
            message=f"The robot weighs {mass:.3g} kg.",
            hint="Write masses in kilograms: divide grams by 1000.",
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
            yield IMPLAUSIBLE_MASS.at(
                file,
                link.line,
                f"link[@name='{link.name}']/inertial/mass",
                message=f"The link `{link.name}` weighs {link.inertial.mass:.3g} kg: Gazebo "
                "Classic treats it as massless and drops it with everything attached to it.",
                hint="Write the mass in kilograms.",
            )


IMPLAUSIBLE_INERTIA = Rule(
    code="ROB050",
    name="implausible-inertia",
    severity=Severity.WARNING,
    severity_varies="information about a link that fixed joints attach to a link with mass: only "
    "the sum matters",
    summary="The inertia of a link does not fit its mass and shape.",
    what="For a link with one primitive shape, compares the largest principal moment with that of "
    "a homogeneous body of this shape and mass; reports factors above 30. For a mesh or several "
    "shapes, compares it with that of their bounding box; reports less than a thousandth.",
    why="If the inertia is too large, the link hardly turns; if it is too small, joints shake or "
    "the simulation explodes. Such values are usually copied from another robot.",
    example="""
<link name="drum">
  <inertial>
    <mass value="1"/>
    <inertia ixx="100" iyy="100" izz="100" ixy="0" ixz="0" iyz="0"/>
  </inertial>
  <collision><geometry><cylinder radius="0.4" length="0.1"/></geometry></collision>
</link>
""",
    instead="""
<link name="drum">
  <inertial>
    <mass value="1"/>
    <inertia ixx="0.0408" iyy="0.0408" izz="0.08" ixy="0" ixz="0" iyz="0"/>
  </inertial>
  <collision><geometry><cylinder radius="0.4" length="0.1"/></geometry></collision>
</link>
""",
)


def implausible_inertia(
    links: Iterable[Link],
    file: Path | None,
    joints: Iterable[Joint] = (),
    *,
    apart_from: Collection[str] = (),
) -> Iterator[Diagnostic]:
    """Report inertias that do not fit the mass and the shape of the link.

    `apart_from` names links whose shapes are in other units.
    """
    links = tuple(links)
    attached = _attached_to_mass(links, joints)
    for link in links:
        if link.name in apart_from:
            continue
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
        if 1 / INERTIA_FACTOR <= times <= INERTIA_FACTOR:
            continue
        if _is_in_grams(link.inertial.mass, times, shape):
            yield IMPLAUSIBLE_MASS.at(
                file,
                link.line,
                f"link[@name='{link.name}']/inertial/mass",
                message=f"The mass of the link `{link.name}` ({link.inertial.mass:g} kg) is too "
                f"large for its inertia and for {_described(shape)}.",
                hint="If the mass is in grams, write "
                f'<mass value="{link.inertial.mass / 1000:g}"/> (kg), which fits the inertia.',
            )
            continue
        yield IMPLAUSIBLE_INERTIA.at(
            file,
            link.line,
            f"link[@name='{link.name}']/inertial/inertia",
            message=f"The inertia of the link `{link.name}` ({largest:.4g} kg m²) is "
            f"{ratio(times)} that of {_described(shape)} of {link.inertial.mass:g} kg.",
            hint=f"If the mass and the shape are right, write {as_attributes(solid)} (kg m², "
            "products 0).",
            severity=Severity.INFO if link.name in attached else None,
        )


def _is_in_grams(mass: float, times: float, shape: Primitive) -> bool:
    """Whether a thousandth of the mass fits the inertia and the shape, and the mass neither.

    `times` is what the inertia is of that of a homogeneous body of the mass.
    """
    volume = volume_of(shape)
    fits = 1 / INERTIA_FACTOR <= times * 1000 <= INERTIA_FACTOR
    return times < 1 and fits and volume is not None and mass > DENSE_PART * volume > 0


def _attached_to_mass(links: Iterable[Link], joints: Iterable[Joint]) -> set[str]:
    """The links that fixed joints attach to a link with mass, of which they are only a part."""
    above = {joint.child: joint.parent for joint in joints if joint.type is JointType.FIXED}
    with_mass = {link.name for link in links if link.inertial and link.inertial.mass > 0}
    with_mass.add("world")  # what is fixed to it never moves
    attached = set()
    for name in [*above]:
        seen, link = {name}, above[name]
        while link not in with_mass and link in above and link not in seen:
            seen.add(link)
            link = above[link]
        if link in with_mass:
            attached.add(name)
    return attached


MASSLESS_ROOT = Rule(
    code="ROB051",
    name="massless-root",
    severity=Severity.INFO,
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="The root link has no mass.",
    what="Looks for a root link without mass that has fixed joints; lists all links that Gazebo "
    "lumps into it, and the mass of the robot.",
    why="Gazebo lumps fixed links into their parent and keeps the parent's name: the body of the "
    "robot has the name of the empty root link, which `<gazebo reference>` and sensors follow.",
    example="""
<link name="base_footprint"/>
<joint name="base_joint" type="fixed">
  <parent link="base_footprint"/>
  <child link="base_link"/>
</joint>
<gazebo><plugin ...><link_name>base_link</link_name></plugin></gazebo>
""",
    instead="""
<link name="base_footprint"/>
<joint name="base_joint" type="fixed">
  <parent link="base_footprint"/>
  <child link="base_link"/>
</joint>
<gazebo><plugin ...><link_name>base_footprint</link_name></plugin></gazebo>
""",
)


def massless_root(
    root: Link,
    joints: Iterable[Joint],
    robot_mass: float,
    file: Path | None,
    preserved: Collection[str] = (),
) -> Iterator[Diagnostic]:
    """Report a root link without mass to which links with mass are fixed.

    `preserved` are the fixed joints that Gazebo keeps.
    """
    below = by_parent(
        joint for joint in joints if not joint.is_movable and joint.name not in preserved
    )
    fixed = below.pop(root.name, [])
    lumped = [joint.child for joint in fixed]
    for name in lumped:  # it grows by what is fixed to these
        lumped += (joint.child for joint in below.pop(name, ()))
    is_massless = root.inertial is None or root.inertial.mass == 0
    if is_massless and root.is_as_meant and root.name != "world" and fixed and robot_mass > 0:
        yield MASSLESS_ROOT.at(
            file,
            root.line,
            f"link[@name='{root.name}']",
            message=f"The root link `{root.name}` has no mass: Gazebo lumps "
            f"{some_named(lumped)} into it and calls the body "
            f"`{root.name}`. The robot weighs {robot_mass:.4g} kg.",
            hint=f"Keep `{root.name}`: Nav2 and robot_state_publisher expect such a link. Where a "
            f"Gazebo plugin names a link, write `{root.name}` instead of `{fixed[0].child}`.",
        )


ROS_1_PLUGIN = Rule(
    code="ROB052",
    name="ros-1-plugin",
    severity=Severity.WARNING,
    summary="A Gazebo plugin exists only in ROS 1.",
    why="Gazebo logs that it cannot load the library and continues without the plugin.",
    example='<plugin name="control" filename="libgazebo_ros_control.so"/>',
    instead='<plugin name="control" filename="libgazebo_ros2_control.so"/>',
)


def ros_1_plugin(tags: Iterable[GazeboTag], file: Path | None) -> Iterator[Diagnostic]:
    """Report plugin libraries that no ROS 2 release has."""
    for tag in tags:
        for plugin in (one.filename for one in tag.plugins):
            name = plugin.rpartition("/")[2].removeprefix("lib").removesuffix(".so")
            if name in ROS_1_PLUGINS:
                yield ROS_1_PLUGIN.at(
                    file,
                    tag.line,
                    f"gazebo/plugin[@filename='{plugin}']",
                    message=f"The plugin `{plugin}` exists only in ROS 1.",
                    hint=f"Remove it, or use {ROS_1_PLUGINS[name]}.",
                )


NO_COLLISION = Rule(
    code="ROB053",
    name="no-collision",
    severity=Severity.WARNING,
    summary="No link of the robot has a `<collision>`.",
    why="The robot falls through the ground.",
    example="""
<link name="base_link">
  <visual><geometry><box size="0.4 0.3 0.2"/></geometry></visual>
</link>
""",
    instead="""
<link name="base_link">
  <visual><geometry><box size="0.4 0.3 0.2"/></geometry></visual>
  <collision><geometry><box size="0.4 0.3 0.2"/></geometry></collision>
</link>
""",
)


def no_collision(
    links: Iterable[Link], file: Path | None, *, fixed_to_world: bool = False
) -> Iterator[Diagnostic]:
    """Report a robot without any collision shape, which falls unless it is fixed to the world."""
    links = [] if fixed_to_world else list(links)
    is_as_meant = all(link.is_as_meant for link in links)
    if links and is_as_meant and not any(link.collisions for link in links):
        yield NO_COLLISION.at(
            file,
            links[0].line,
            "robot",
            message="No link has a <collision>: the robot falls through the ground.",
            hint="Add a <collision> with the <geometry> and <origin> of each <visual>.",
        )


NO_VISUAL = Rule(
    code="ROB054",
    name="no-visual",
    severity=Severity.INFO,
    summary="A link has a `<collision>` but no `<visual>`.",
    what="Looks for links with mass and `<collision>` but without `<visual>`.",
    why="The link is invisible in RViz and Gazebo, but other objects collide with it.",
    example="""
<link name="base_link">
  <collision><geometry><box size="0.4 0.3 0.2"/></geometry></collision>
</link>
""",
    instead="""
<link name="base_link">
  <collision><geometry><box size="0.4 0.3 0.2"/></geometry></collision>
  <visual><geometry><box size="0.4 0.3 0.2"/></geometry></visual>
</link>
""",
)


def no_visual(links: Iterable[Link], file: Path | None) -> Iterator[Diagnostic]:
    """Report links that have mass and collision shapes and are invisible."""
    for link in links:
        is_hidden = link.is_as_meant and not link.visuals
        if link.inertial is not None and link.collisions and is_hidden:
            yield NO_VISUAL.at(
                file,
                link.line,
                f"link[@name='{link.name}']",
                message=f"The link `{link.name}` has a <collision> but no <visual>.",
                hint="Add a <visual> with the <geometry> and <origin> of the <collision>.",
            )


LOOSE_JOINT = Rule(
    code="ROB055",
    name="loose-joint",
    severity=Severity.WARNING,
    severity_varies="an error for Gazebo Sim, which refuses the robot",
    measured=Measured(classic="simulates it", sim="refuses it"),
    summary="Gazebo does not create floating and planar joints.",
    why="Gazebo's parser ignores the joint. In Gazebo Classic the child is a separate body and "
    "falls off; Gazebo Sim refuses the robot, because the child is placed relative to a joint that "
    "does not exist.",
    example="""
<joint name="arm_joint" type="floating">
  <parent link="base_link"/>
  <child link="arm"/>
</joint>
""",
    instead="""
<joint name="arm_joint" type="revolute">
  <parent link="base_link"/>
  <child link="arm"/>
  <axis xyz="0 1 0"/>
  <limit lower="-1.57" upper="1.57" effort="10" velocity="1"/>
</joint>
""",
)


def loose_joint(
    joints: Iterable[Joint], tags: Iterable[GazeboTag], file: Path | None, simulator: str | None
) -> Iterator[Diagnostic]:
    """Report joints of types that Gazebo does not have, unless a ball joint of SDF replaces one."""
    held = {
        joint.ends.get("child")
        for tag in tags
        for joint in tag.joints
        if joint.is_ball and simulator != "gz"
    }
    for joint in joints:
        if joint.type.value in {"floating", "planar"} and joint.child not in held:
            yield LOOSE_JOINT.at(
                file,
                joint.line,
                f"joint[@name='{joint.name}']",
                message=f"Gazebo does not support {joint.type.value} joints and ignores "
                f"`{joint.name}`: {LOOSE[simulator].format(joint.child)}.",
                hint=f"Make `{joint.child}` the root link, or use prismatic and revolute joints.",
                severity=Severity.ERROR if simulator == "gz" else Severity.WARNING,
            )


STARTS_OUTSIDE_LIMITS = Rule(
    code="ROB070",
    name="starts-outside-limits",
    severity=Severity.INFO,
    summary="The limits of a joint do not include 0, the position at which it is spawned.",
    what="Looks for revolute and prismatic joints whose limits do not include 0.",
    why="Simulators spawn a robot with all joints at 0 and then push this joint to its limit with "
    "a jolt. Give the spawner a start position (`-J` in Gazebo Classic), or move the zero of the "
    "joint.",
    example='<limit lower="-3.07" upper="-0.07" effort="87" velocity="2.2"/>',
    instead="""
<origin xyz="0 0 0.3" rpy="0 -1.57 0"/>
<limit lower="-1.5" upper="1.5" effort="87" velocity="2.2"/>
""",
)


def starts_outside_limits(joints: Iterable[Joint], file: Path | None) -> Iterator[Diagnostic]:
    """Report joints whose limits do not include their position when spawned, 0."""
    for joint in joints:
        limit = joint.limit
        if limit is None or not joint.starts_beyond_limit:
            continue
        yield STARTS_OUTSIDE_LIMITS.at(
            file,
            joint.line,
            f"joint[@name='{joint.name}']/limit",
            message=f"The joint `{joint.name}` is spawned at 0, outside its limits "
            f"{limit.lower:g} to {limit.upper:g}: simulators push it to the nearest limit.",
            hint="Give the spawner a start position (`-J` in Gazebo Classic), or choose limits "
            "that include 0.",
        )


def ratio(times: float) -> str:
    """How many times, as the beginning of a phrase."""
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


def _beyond(
    what: str, numbers: Iterable[float], place: str, line: int | None, file: Path | None
) -> Iterator[Diagnostic]:
    largest = max(map(abs, numbers), default=0.0)
    if largest > BEYOND:
        yield NUMBER_BEYOND_ENGINES.at(
            file,
            line,
            f"{place}/{what}",
            message=f"The number {largest:.3g} is too large for any physics engine.",
            hint="Write the value in SI units (meters, kilograms, seconds).",
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


def volume_of(shape: Geometry) -> float | None:
    """Of a primitive, m³; None of any other shape."""
    if isinstance(shape, Box):
        return math.prod(shape.size)
    if isinstance(shape, Sphere):
        return 4 / 3 * math.pi * shape.radius**3
    if isinstance(shape, Cylinder):
        return math.pi * shape.radius**2 * shape.length
    if isinstance(shape, Capsule):
        return math.pi * shape.radius**2 * (shape.length + 4 / 3 * shape.radius)
    return None


def _sizes(geometry: Geometry) -> tuple[float, ...]:
    if isinstance(geometry, Box):
        return geometry.size
    if isinstance(geometry, Mesh):
        return geometry.scale
    if isinstance(geometry, Sphere):
        return (2 * geometry.radius,)
    if isinstance(geometry, Triangulated):  # of SDF, and checked by its reader
        return ()
    return (2 * geometry.radius, geometry.length)


def _shapes(link: Link) -> Iterator[tuple[Geometry, Pose]]:
    for collision in link.collisions:
        yield collision.geometry, collision.pose_in_link
    for visual in link.visuals:
        yield visual.geometry, visual.pose_in_link


def extent_of(links: Iterable[Link], joints: Iterable[Joint]) -> float:
    """The longest edge of the box along the root's axes around frames and primitives, m."""
    poses = poses_of(joints)
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


def poses_of(joints: Iterable[Joint]) -> dict[str, Pose]:
    """The poses of all links but the root, in the root's frame; the joints make a tree."""
    below = by_parent(joints)
    children = {joint.child for hanging in below.values() for joint in hanging}
    poses: dict[str, Pose] = {}
    queue = [name for name in below if name not in children]
    for name in queue:
        for joint in below.get(name, ()):
            poses[joint.child] = compose(poses.get(name, IDENTITY), joint.pose_in_parent)
            queue.append(joint.child)
    return poses
