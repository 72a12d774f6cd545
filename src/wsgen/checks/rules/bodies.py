"""Rules about the masses and shapes of single links, with what is known of their mesh files.

The parameters of a check are facts in SI units; a check yields what it reports. A link that fixed
joints attach to others is only a part of a body, and is left alone.
"""

from __future__ import annotations

import itertools
import math
import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.drives import is_oblique
from wsgen.checks.rules.robots import HEAVIEST, IMPLAUSIBLE_INERTIA, LARGEST, ratio, volume_of
from wsgen.diagnostics import Rule, Severity
from wsgen.model.inertia import as_attributes, of_solid, principal_moments
from wsgen.model.robot import Box, Capsule, Cylinder, JointType, Mesh, Sphere
from wsgen.model.transform import Pose, compose, rotate, rotation_of_rpy
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import GazeboTag, Geometry, Joint, Link

    Vector = tuple[float, float, float]


# A hollow part, or one whose mass is at an end, has more inertia than a filled box around it; a
# thin one in a large box has less.
# Times that of the filled box; beyond the first, people also add some against shaking.
MOST_INERTIA = (100.0, 1000.0)
LEAST_INERTIA = 1 / 1000
FARTHEST_CENTER = 2.0  # diagonals of the box, beyond it
SMALLEST_BOX = 0.02  # m, diagonal; below it nothing can be said
HIGHEST_DENSITY = 25_000.0  # kg/m³; gold and tungsten have 19,300
LOWEST_DENSITY = 0.5  # of a shape without holes; aerogel has more than 1
UNLIKE = (500.0, 2000.0)  # how many times larger a mesh in millimeters is, give or take
WHEELS = lazy_pattern(r"wheel|tyre|tire|caster|castor", re.IGNORECASE)
ROLLS_FREELY = lazy_pattern(r"cast[eo]r|omni|mecanum|roller|passive|free", re.IGNORECASE)
SLIPPERY = 1e-3  # friction coefficient


class Extent(NamedTuple):
    """A box along the axes of a link, around its shapes."""

    low: Vector  # m
    high: Vector

    @property
    def size(self) -> Vector:
        """The edges, m."""
        x, y, z = (high - low for low, high in zip(self.low, self.high, strict=True))
        return (x, y, z)

    @property
    def diagonal(self) -> float:
        """The distance between opposite corners, m."""
        return math.hypot(*self.size)


def check_bodies(
    links: Sequence[Link], joints: Sequence[Joint], file: Path | None
) -> Iterator[Diagnostic]:
    """Everything about single links."""
    attached = {
        end
        for joint in joints
        if joint.type is JointType.FIXED
        for end in (joint.parent, joint.child)
    }
    for link in links:
        yield from unlike_shapes(link, file)
        if link.name not in attached and link.is_as_meant:
            yield from body_in_its_shapes(link, file)


def attached_bodies(
    links: Sequence[Link], joints: Iterable[Joint], file: Path | None
) -> Iterator[Diagnostic]:
    """As IMPLAUSIBLE_DENSITY of links that are attached: one may have the mass of all."""
    for group in _attached(links, joints):
        mass = sum(map(_mass, group))
        volumes = [_largest_volume(link) for link in group]
        volume = sum(one for one in volumes if one is not None)
        if None in volumes or not HEAVIEST >= mass > HIGHEST_DENSITY * volume > 0:
            continue
        heaviest = max(group, key=_mass)
        yield IMPLAUSIBLE_DENSITY.at(
            file,
            heaviest.line,
            f"link[@name='{heaviest.name}']/inertial/mass",
            message=f"The link `{heaviest.name}` weighs {_mass(heaviest):g} kg, and with all that "
            f"is fixed to it {mass:g} kg in {volume * 1000:.3g} liters: no material is this dense.",
            hint="Write the mass in kilograms and the sizes of the shapes in meters.",
        )


def _attached(links: Sequence[Link], joints: Iterable[Joint]) -> Iterator[list[Link]]:
    """The links that fixed joints attach to each other; of each group, more than one."""
    group_of = {link.name: [link] for link in links}
    for joint in joints:
        if joint.type is not JointType.FIXED:
            continue
        one, other = group_of.get(joint.parent, []), group_of.get(joint.child, [])
        if one is not other:
            one += other
            group_of |= {link.name: one for link in other}
    groups = {id(group): group for group in group_of.values()}
    yield from (group for group in groups.values() if len(group) > 1)


CENTER_OF_MASS_OUTSIDE = Rule(
    code="ROB117",
    name="center-of-mass-outside",
    severity=Severity.WARNING,
    summary="The center of mass of a link is far from its shapes.",
    what="Compares `<origin>` of `<inertial>` with the bounding box of the shapes of the link; "
    "reports distances above twice the diagonal of the box. Links that fixed joints attach to "
    "others are not checked.",
    why="The robot tips over, or its joints swing. Usually the origin is in millimeters, or not in "
    "the frame of the link.",
    example="""
<inertial>
  <origin xyz="12 0 35"/>
  <mass value="0.4"/>
  …
""",
    instead="""
<inertial>
  <origin xyz="0.012 0 0.035"/>
  <mass value="0.4"/>
  …
""",
)

IMPLAUSIBLE_DENSITY = Rule(
    code="ROB118",
    name="implausible-density",
    severity=Severity.WARNING,
    severity_varies="information about a body lighter than air; an error where its simulation "
    "fails",
    summary="A link is denser than any material, or lighter than air.",
    what="Divides the mass by the volume of the primitive shapes, or of the bounding box of all "
    "shapes; reports more than 25,000 and less than 0.5 kg/m³.",
    why="Usually the mass is in grams, or a shape is in millimeters. Joints between very light and "
    "very heavy parts shake.",
    example="""
<inertial><mass value="500"/>…</inertial>
<collision><geometry><sphere radius="0.05"/></geometry></collision>
""",
    instead="""
<inertial><mass value="0.5"/>…</inertial>
<collision><geometry><sphere radius="0.05"/></geometry></collision>
""",
)


def body_in_its_shapes(link: Link, file: Path | None) -> Iterator[Diagnostic]:
    """Report an inertia, a center of mass and a mass that do not fit the shapes of a link."""
    inertial = link.inertial
    extent = extent_of(link)
    if inertial is None or not 0 < inertial.mass <= HEAVIEST or extent is None:
        return
    if extent.diagonal < SMALLEST_BOX or max(extent.size) > LARGEST:
        return
    place = f"link[@name='{link.name}']/inertial"
    away = math.dist(
        inertial.pose_in_link.xyz,
        [
            min(max(center, low), high)
            for center, low, high in zip(
                inertial.pose_in_link.xyz, extent.low, extent.high, strict=True
            )
        ],
    )
    if away > FARTHEST_CENTER * extent.diagonal:
        yield CENTER_OF_MASS_OUTSIDE.at(
            file,
            link.line,
            f"{place}/origin",
            message=f"The center of mass of the link `{link.name}` is {away:.3g} m away from its "
            f"shapes, which measure {extent.diagonal:.3g} m.",
            hint="Write <origin> of <inertial> in meters, in the frame of the link.",
        )
        return
    yield from _density(link, file)
    yield from _inertia_of_several(link, extent, file)


def _inertia_of_several(link: Link, extent: Extent, file: Path | None) -> Iterator[Diagnostic]:
    """As IMPLAUSIBLE_INERTIA of one primitive: of a mesh, or of several shapes."""
    shapes = [one.geometry for one in link.collisions] or [one.geometry for one in link.visuals]
    inertial = link.inertial
    if inertial is None or (len(shapes) == 1 and not isinstance(shapes[0], Mesh)):
        return
    solid = of_solid(Box(size=extent.size), inertial.mass)
    if solid is None or max(solid) <= 0:
        return
    largest = principal_moments(inertial.inertia)[2]
    times = largest / max(solid)
    if largest > 0 and not LEAST_INERTIA <= times <= MOST_INERTIA[0]:
        edges = " x ".join(f"{edge:.3g}" for edge in extent.size)
        yield IMPLAUSIBLE_INERTIA.at(
            file,
            link.line,
            f"link[@name='{link.name}']/inertial/inertia",
            message=f"The inertia of the link `{link.name}` ({largest:.4g} kg m²) is "
            f"{ratio(times)} that of a box of {edges} m around its shapes of {inertial.mass:g} kg.",
            hint=f"If mass and shapes are right, write {as_attributes(solid)} (kg m², products 0).",
            severity=Severity.INFO if 1 < times <= MOST_INERTIA[1] else Severity.WARNING,
        )


def _mass(link: Link) -> float:
    return 0.0 if link.inertial is None else link.inertial.mass


def _largest_volume(link: Link) -> float | None:
    """At most so many m³ are in the shapes of a link; None where a mesh is not known."""
    # Either may leave parts out; the larger is nearer to what is weighed.
    boxes = [
        _around((one.geometry, one.pose_in_link) for one in shapes)
        for shapes in (link.collisions, link.visuals)
        if shapes
    ]
    volumes = [volume_of(one.geometry) or 0.0 for one in link.collisions or link.visuals]
    sizes = [math.prod(box.size) for box in boxes if box is not None]
    return None if len(sizes) < len(boxes) else max(sum(volumes), *sizes, 0.0)


def _density(link: Link, file: Path | None) -> Iterator[Diagnostic]:
    mass = _mass(link)
    volumes = [volume_of(one.geometry) for one in link.collisions or link.visuals]
    filled = sum(volume for volume in volumes if volume is not None)
    largest = _largest_volume(link)
    is_heavy = largest is not None and mass > HIGHEST_DENSITY * largest > 0
    is_light = None not in volumes and mass < LOWEST_DENSITY * filled
    if is_heavy or is_light:
        volume = largest or filled if is_heavy else filled
        yield IMPLAUSIBLE_DENSITY.at(
            file,
            link.line,
            f"link[@name='{link.name}']/inertial/mass",
            message=f"The link `{link.name}` weighs {mass:g} kg in {volume * 1000:.3g} liters: "
            + ("no material is this dense." if is_heavy else "it is lighter than air."),
            hint="Write the mass in kilograms and the sizes of the shapes in meters.",
            severity=Severity.WARNING if is_heavy else Severity.INFO,
        )


UNLIKE_SHAPES = Rule(
    code="ROB119",
    name="unlike-shapes",
    severity=Severity.WARNING,
    summary="The visual and the collision of a link differ in size by a factor of about 1000.",
    what="Compares the bounding boxes of the visuals and of the collisions of a link; reports "
    "factors between 500 and 2000.",
    why="One of the two is in another unit: the robot looks right in RViz, but in Gazebo it "
    "collides with everything or falls through the ground.",
    example="""
<visual><geometry><mesh filename="…/base.stl" scale="0.001 0.001 0.001"/></geometry></visual>
<collision><geometry><mesh filename="…/base.stl"/></geometry></collision>
""",
    instead="""
<visual><geometry><mesh filename="…/base.stl" scale="0.001 0.001 0.001"/></geometry></visual>
<collision><geometry><mesh filename="…/base.stl" scale="0.001 0.001 0.001"/></geometry></collision>
""",
)


def unlike_shapes(link: Link, file: Path | None) -> Iterator[Diagnostic]:
    """Report a link whose visuals and collisions are in different units."""
    visual = _around((one.geometry, one.pose_in_link) for one in link.visuals)
    collision = _around((one.geometry, one.pose_in_link) for one in link.collisions)
    if visual is None or collision is None:
        return
    small, large = sorted((visual.diagonal, collision.diagonal))
    if small <= 0 or max(*visual.size, *collision.size) > LARGEST:
        return  # reported as the size of the mesh or of the robot
    if not UNLIKE[0] <= large / small <= UNLIKE[1]:
        return
    kind, other = "visual", "collision"
    if collision.diagonal > visual.diagonal:
        kind, other = other, kind
    yield UNLIKE_SHAPES.at(
        file,
        link.line,
        f"link[@name='{link.name}']/{kind}",
        message=f"The {kind} of the link `{link.name}` measures {large:.3g} m, its {other} "
        f"{small:.3g} m.",
        hint='Use meters: for a mesh in millimeters, write <mesh … scale="0.001 0.001 0.001"/>.',
    )


def extent_of(link: Link) -> Extent | None:
    """The box around the collisions of a link, or around its visuals; None where it is unknown."""
    collisions = [(one.geometry, one.pose_in_link) for one in link.collisions]
    return _around(collisions or [(one.geometry, one.pose_in_link) for one in link.visuals])


def _around(shapes: Iterable[tuple[Geometry, Pose]]) -> Extent | None:
    points: list[Vector] = []
    for geometry, pose in shapes:
        corners = _corners(geometry)
        if corners is None:
            return None
        points += (
            compose(pose, Pose(xyz=(x, y, z))).xyz
            for x, y, z in itertools.product(*zip(*corners, strict=True))
        )
    if not points:
        return None
    (low_x, high_x), (low_y, high_y), (low_z, high_z) = (
        (min(axis), max(axis)) for axis in zip(*points, strict=True)
    )
    return Extent((low_x, low_y, low_z), (high_x, high_y, high_z))


def _corners(geometry: Geometry) -> tuple[Vector, Vector] | None:
    """Two opposite corners of the box around a shape, along its axes."""
    if isinstance(geometry, Mesh):
        if geometry.bounds is None:
            return None
        low, high = (
            (corner[0] * scale[0], corner[1] * scale[1], corner[2] * scale[2])
            for scale in (geometry.scale,)
            for corner in geometry.bounds
        )
        return low, high
    if isinstance(geometry, Box):
        x, y, z = (edge / 2 for edge in geometry.size)
    elif isinstance(geometry, Sphere):
        x = y = z = geometry.radius
    elif isinstance(geometry, Cylinder | Capsule):
        x = y = geometry.radius
        z = geometry.length / 2 + (geometry.radius if isinstance(geometry, Capsule) else 0.0)
    else:
        return None
    return (-x, -y, -z), (x, y, z)


WHEEL_WITHOUT_COLLISION = Rule(
    code="ROB120",
    name="wheel-without-collision",
    severity=Severity.WARNING,
    summary="A wheel has no `<collision>`.",
    what="Looks for links with a `<visual>` and without `<collision>` at the end of a continuous "
    "or fixed joint, with `wheel`, `tire` or `caster` in a name, where other links have a "
    "collision.",
    why="The wheel sinks into the ground and does not drive the robot, which stands on its body.",
    example="""
<link name="left_wheel">
  <visual><geometry><cylinder radius="0.1" length="0.04"/></geometry></visual>
</link>
""",
    instead="""
<link name="left_wheel">
  <visual><geometry><cylinder radius="0.1" length="0.04"/></geometry></visual>
  <collision><geometry><cylinder radius="0.1" length="0.04"/></geometry></collision>
</link>
""",
)


def wheel_without_collision(
    links: Sequence[Link], joints: Iterable[Joint], file: Path | None
) -> Iterator[Diagnostic]:
    """Report wheels that touch nothing."""
    if not any(link.collisions for link in links):
        return  # reported of the whole robot
    # A collision may be that of a link that is fixed to the wheel; a caster carries another wheel.
    joints = tuple(joints)
    carrying = {joint.parent for joint in joints}
    kinds = (JointType.CONTINUOUS, JointType.FIXED)  # a caster may be a ball that only slides
    above = {joint.child: joint for joint in joints if joint.type in kinds}
    for link in links:
        joint = above.get(link.name)
        is_bare = bool(link.visuals) and not link.collisions and link.name not in carrying
        if joint is None or not is_bare or not link.is_as_meant:
            continue
        if WHEELS.search(link.name) or WHEELS.search(joint.name):
            yield WHEEL_WITHOUT_COLLISION.at(
                file,
                link.line,
                f"link[@name='{link.name}']",
                message=f"The wheel `{link.name}` has a <visual> but no <collision>: it does not "
                "touch the ground.",
                hint="Copy <geometry> and <origin> of its <visual> into a <collision>.",
            )


PRESERVED_MOVABLE_JOINT = Rule(
    code="ROB121",
    name="preserved-movable-joint",
    severity=Severity.INFO,
    summary="`<preserveFixedJoint>` is set for a joint that is not fixed.",
    why="Gazebo lumps only fixed joints: the setting has no effect on other joints. Usually it "
    "names the wrong joint.",
    example='<joint name="wheel_joint" type="continuous">…</joint>\n'
    '<gazebo reference="wheel_joint"><preserveFixedJoint>true</preserveFixedJoint></gazebo>',
    instead='<joint name="camera_joint" type="fixed">…</joint>\n'
    '<gazebo reference="camera_joint"><preserveFixedJoint>true</preserveFixedJoint></gazebo>',
)


def preserved_movable_joint(
    joints: Iterable[Joint], tags: Iterable[GazeboTag], file: Path | None
) -> Iterator[Diagnostic]:
    """Report settings against lumping on joints that are never lumped."""
    movable = {joint.name for joint in joints if joint.type is not JointType.FIXED}
    for tag in tags:
        keys = [key for key in KEPT if key in tag.values]
        if keys and tag.reference in movable:
            yield PRESERVED_MOVABLE_JOINT.at(
                file,
                tag.line,
                f"gazebo[@reference='{tag.reference}']/{keys[0]}",
                message=f"<{keys[0]}> has no effect: the joint `{tag.reference}` is not fixed.",
                hint="Name the fixed joint that Gazebo should keep, or remove the element.",
            )


KEPT = ("preserveFixedJoint", "disableFixedJointLumping")

SLIPPERY_WHEEL = Rule(
    code="ROB122",
    name="slippery-wheel",
    severity=Severity.WARNING,
    severity_varies="information about a wheel that no drive turns",
    summary="A wheel has no friction.",
    what="Looks for `<mu1>` or `<mu2>` below 0.001 on the links of the joints that a drive turns, "
    "and of continuous joints with `wheel` in a name. Casters may have no friction; mecanum wheels "
    "may have one of the two coefficients at 0, with an `<fdir1>` oblique to the axis.",
    why="The wheel spins and the robot stays where it is.",
    example='<gazebo reference="left_wheel">\n  <mu1>0</mu1>\n  <mu2>0</mu2>\n</gazebo>',
    instead='<gazebo reference="left_wheel">\n  <mu1>1.0</mu1>\n  <mu2>1.0</mu2>\n</gazebo>',
)


def slippery_wheels(
    driven: Collection[str], joints: Iterable[Joint], tags: Iterable[GazeboTag], file: Path | None
) -> Iterator[Diagnostic]:
    """Report wheels that cannot push; `driven` are the joints that a drive turns."""
    wheels = {
        joint.child: Severity.WARNING if joint.name in driven else Severity.INFO
        for joint in joints
        if joint.name in driven
        or (joint.type is JointType.CONTINUOUS and _is_wheel(f"{joint.name} {joint.child}"))
    }
    tags, joints = tuple(tags), tuple(joints)
    directed = {tag.reference for tag in tags if "fdir1" in tag.values}
    with_rollers = {
        name for name in directed.intersection(wheels) if name and _has_rollers(name, joints, tags)
    }
    for tag in tags:
        for key in ("mu1", "mu2"):
            text = tag.values.get(key, "")
            name = tag.reference
            if name in wheels and name not in with_rollers and _is_below(text, SLIPPERY):
                yield SLIPPERY_WHEEL.at(
                    file,
                    tag.line,
                    f"gazebo[@reference='{name}']/{key}",
                    message=f"The wheel `{name}` has no friction (<{key}> is {text}): it "
                    f"{'spins, or slides to the side' if name in directed else 'spins'}.",
                    hint=f"Write <{key}>1.0</{key}>.",
                    severity=wheels[name],
                )
                break


def _has_rollers(wheel: str, joints: Sequence[Joint], tags: Iterable[GazeboTag]) -> bool:
    """Whether it is a mecanum wheel: it grips in one of two directions, which are oblique.

    Some write the direction in the frame of the wheel, others in that of the robot.
    """
    values: dict[str, str] = {}
    for tag in tags:
        if tag.reference == wheel:
            values.update(tag.values)
    if all(_is_below(values.get(key, "1"), SLIPPERY) for key in ("mu1", "mu2")):
        return False
    try:
        x, y, z = map(float, values["fdir1"].split())
    except ValueError:
        return False
    joint_of = {joint.child: joint for joint in joints}
    axis = axis_in_root = joint_of[wheel].axis_in_joint
    link = wheel
    while (joint := joint_of.pop(link, None)) is not None:
        axis_in_root = rotate(rotation_of_rpy(joint.pose_in_parent.rpy), axis_in_root)
        link = joint.parent
    return is_oblique(axis, (x, y, z)) or is_oblique(axis_in_root, (x, y, z))


STICKY_WHEEL = Rule(
    code="ROB129",
    name="sticky-wheel",
    severity=Severity.INFO,
    summary="The friction coefficient of a wheel is too large.",
    what="Looks for `<mu1>` or `<mu2>` above 100 on the links of the joints that a drive turns.",
    why="The coefficient of a real tire is about 1. With a huge one the wheels cannot slide: a "
    "robot that turns on the spot jerks, tips over or stands still.",
    example='<gazebo reference="left_wheel">\n  <mu1>200000</mu1>\n  <mu2>200000</mu2>\n</gazebo>',
    instead='<gazebo reference="left_wheel">\n  <mu1>1.0</mu1>\n  <mu2>1.0</mu2>\n</gazebo>',
)


def sticky_wheels(
    driven: Collection[str], joints: Iterable[Joint], tags: Iterable[GazeboTag], file: Path | None
) -> Iterator[Diagnostic]:
    """Report, in one diagnostic, wheels that cannot slide."""
    wheels = {joint.child for joint in joints if joint.name in driven}
    found = [
        (tag, key, tag.values[key])
        for tag in tags
        for key in ("mu1", "mu2")
        if tag.reference in wheels and _is_above(tag.values.get(key, ""), STICKY)
    ]
    if found:
        tag, key, text = found[0]
        others = len({one.reference for one, _, _ in found}) - 1
        more = (
            f" {others} more {'has' if others == 1 else 'have'} the same problem." if others else ""
        )
        yield STICKY_WHEEL.at(
            file,
            tag.line,
            f"gazebo[@reference='{tag.reference}']/{key}",
            message=f"The wheel `{tag.reference}` has a friction of {text} (<{key}>); that of a "
            f"real tire is about 1.{more}",
            hint=f"Write <{key}>1.0</{key}>.",
        )


STICKY = 100.0  # friction coefficient

DRAGGING_CASTER = Rule(
    code="ROB130",
    name="dragging-caster",
    severity=Severity.INFO,
    summary="A caster that cannot turn has the friction of a tire.",
    what="In robots with driven wheels, looks for links with `caster` in their names on fixed "
    "joints, with a `<collision>` but without `<mu1>` and `<mu2>`.",
    why="The default friction in Gazebo is 1. The caster drags over the ground: the robot turns "
    "more slowly than its odometry says, and does not drive straight.",
    example='<joint name="caster_joint" type="fixed">…</joint>\n<link name="caster">'
    "<collision>…</collision></link>",
    instead='<gazebo reference="caster">\n  <mu1>0.001</mu1>\n  <mu2>0.001</mu2>\n</gazebo>',
)


def dragging_casters(
    driven: Collection[str],
    links: Iterable[Link],
    joints: Iterable[Joint],
    tags: Iterable[GazeboTag],
    file: Path | None,
) -> Iterator[Diagnostic]:
    """Report casters that slide, and to which nobody gave a friction."""
    fixed = {joint.child for joint in joints if joint.type is JointType.FIXED}
    given = {tag.reference for tag in tags if any(key.startswith("mu") for key in tag.values)}
    for link in links if driven else ():
        is_caster = link.name in fixed and _CASTER.search(link.name)
        if is_caster and link.collisions and link.name not in given:
            yield DRAGGING_CASTER.at(
                file,
                link.line,
                f"link[@name='{link.name}']",
                message=f"The caster `{link.name}` is fixed, and slides with a friction of 1.",
                hint=f'Add <gazebo reference="{link.name}"><mu1>0.001</mu1><mu2>0.001</mu2>'
                "</gazebo>.",
            )


_CASTER = lazy_pattern(r"cast[eo]r", re.IGNORECASE)


def _is_wheel(names: str) -> bool:
    return "wheel" in names.lower() and not ROLLS_FREELY.search(names)


def _is_above(text: str, bound: float) -> bool:
    try:
        return float(text) > bound
    except ValueError:
        return False


def _is_below(text: str, bound: float) -> bool:
    try:
        return 0 <= float(text) < bound
    except ValueError:
        return False
