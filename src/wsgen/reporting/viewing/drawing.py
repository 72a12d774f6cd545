"""What is drawn of a robot: its shapes, inertia and frames, and where its joints are.

Angles are in rad, distances in m; a slider shows degrees or m.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from wsgen.model.inertia import matrix_of
from wsgen.model.robot import JointType, Mesh
from wsgen.model.transform import IDENTITY, Pose, quaternion_of_rpy, rotate, rotation_of_rpy
from wsgen.rendering.render_items import (
    COLLISION,
    INVISIBLE,
    UNPAINTED,
    UNPAINTED_STATIC_MODEL,
    color_of,
    drawable,
)
from wsgen.rendering.surfaces import Part, outline, surface_of, write_glb
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from wsgen.model.robot import Inertial, Joint, Link, Robot
    from wsgen.model.transform import Vector
    from wsgen.pipeline.describe import DescribedScene
    from wsgen.pipeline.prepare import PreparedRobot

    Quaternion = tuple[float, float, float, float]
    Floats = NDArray[np.float64]


LEAST_EDGE = 1e-3  # m, of a box that stands for an inertia
FAINT = 0.35  # opacity of visuals that let see what is in them


@dataclass(frozen=True, kw_only=True)
class InertiaBox:
    """The box, filled evenly, that has the mass and the inertia of a link."""

    center: Vector  # of mass, m, in the link frame
    orientation: Quaternion  # in the link frame
    size: Vector  # m, edge lengths


@dataclass(frozen=True, kw_only=True)
class DrawnLink:
    """A link, below the one that its parent joint is on."""

    name: str
    parent: int | None  # number of the parent in `DrawnRobot.links`; None: a root
    joint: Joint | None = None  # to the parent
    visuals: tuple[Part, ...] = ()
    collisions: tuple[Part, ...] = ()
    mass: float | None = None  # kg; None: it has no <inertial>
    center: Vector | None = None  # of mass, m, in the link frame
    inertia: InertiaBox | None = None


@dataclass(frozen=True, kw_only=True)
class DrawnRobot:
    """A robot or a static model, in its place."""

    entity: str
    name: str  # as its description calls it
    pose_in_world: Pose
    links: tuple[DrawnLink, ...]  # each behind its parent
    sliders: tuple[Slider, ...] = ()
    is_static_model: bool = False
    robot: Robot
    low: Vector  # two corners of the box around it, in the world, with the joints at their start
    high: Vector

    @property
    def size(self) -> float:
        """The longest edge of the box around it, m."""
        return max(high - low for low, high in zip(self.low, self.high, strict=True))

    @property
    def start(self) -> dict[str, float]:
        """The positions of the sliders at the beginning, by joint."""
        return {slider.joint: slider.start for slider in self.sliders}


def glb(parts: Iterable[Part], *, is_faint: bool = False) -> bytes | None:
    """Shapes as a file that browsers draw; None if there are none."""
    return write_glb(parts, opacity=FAINT if is_faint else 1.0)


def draw(found: DescribedScene) -> list[DrawnRobot]:
    """What is drawn of what was read: the robots first, then the static models."""
    drawn = (draw_one(prepared, found.collision_surfaces) for prepared in found.robots)
    return sorted(filter(None, drawn), key=lambda robot: robot.is_static_model)


def draw_one(prepared: PreparedRobot, collision_surfaces: Mapping[str, str]) -> DrawnRobot | None:
    """What is drawn of a robot, as it is written; None if its meshes have not been read."""
    robot = prepared.readable
    return None if robot is None else _draw(prepared, robot, collision_surfaces)


def draw_simulated(
    robot: Robot,
    pose_in_world: Pose,
    collision_surfaces: Mapping[str, str],
    *,
    entity: str,
    is_static_model: bool,
) -> DrawnRobot:
    """What is drawn of a robot that is simulated: the links that the engine has, each by itself.

    The robot is the lumped one, `pose_in_world` where it is seen first.
    """
    links = _links(robot, collision_surfaces, is_subject=not is_static_model)
    low, high = _bounds(robot, links, {}, pose_in_world, touching=False)
    return DrawnRobot(
        entity=entity,
        name=robot.name,
        pose_in_world=IDENTITY,
        links=tuple(replace(link, parent=None) for link in links),
        is_static_model=is_static_model,
        robot=robot,
        low=low,
        high=high,
    )


def _draw(
    prepared: PreparedRobot, robot: Robot, collision_surfaces: Mapping[str, str]
) -> DrawnRobot:
    links = _links(robot, collision_surfaces, is_subject=not prepared.is_static_model)
    ranges = () if prepared.is_static_model else sliders(robot)
    start = {slider.joint: slider.start for slider in ranges}
    pose = prepared.spawn_pose if prepared.spawn_pose.is_finite else IDENTITY
    low, high = _bounds(robot, links, start, pose, touching=prepared.on_the_ground)
    if prepared.on_the_ground:  # it stands on the ground
        x, y, z = pose.xyz
        pose = replace(pose, xyz=(x, y, z - low[2]))
        low, high = _bounds(robot, links, start, pose, touching=False)
    return DrawnRobot(
        entity=prepared.entity,
        name=robot.name,
        pose_in_world=pose,
        links=links,
        sliders=ranges,
        is_static_model=prepared.is_static_model,
        robot=robot,
        low=low,
        high=high,
    )


def _links(
    robot: Robot, collision_surfaces: Mapping[str, str], *, is_subject: bool
) -> tuple[DrawnLink, ...]:
    """The links that joints connect with the root, parents first."""
    by_name = {link.name: link for link in robot.links}
    below: dict[str, list[Joint]] = {}
    for one in (*robot.joints, *robot.loose):
        below.setdefault(one.parent, []).append(one)
    drawn: list[DrawnLink] = []
    waiting: list[tuple[str, int | None, Joint | None]] = [(robot.root, None, None)]
    while waiting:
        name, parent, joint = waiting.pop(0)
        link = by_name.pop(name, None)
        if link is None:
            continue
        number = len(drawn)
        drawn.append(_link(link, parent, joint, collision_surfaces, is_subject=is_subject))
        waiting += ((one.child, number, one) for one in below.get(name, ()))
    return tuple(drawn)


def _link(
    link: Link,
    parent: int | None,
    joint: Joint | None,
    collision_surfaces: Mapping[str, str],
    *,
    is_subject: bool,
) -> DrawnLink:
    unpainted = UNPAINTED if is_subject else UNPAINTED_STATIC_MODEL
    visuals = [
        Part(geometry, rgba, visual.pose_in_link, visual.texture)
        for visual in link.visuals
        if (geometry := drawable(visual.geometry)) is not None
        and (rgba := color_of(visual, unpainted))[3] >= INVISIBLE
    ]
    inertial = link.inertial
    is_known = inertial is not None and inertial.pose_in_link.is_finite
    return DrawnLink(
        name=link.name,
        parent=parent,
        joint=joint,
        visuals=tuple(visuals),
        collisions=tuple(_collisions(link, collision_surfaces)),
        mass=None if inertial is None else inertial.mass,
        center=inertial.pose_in_link.xyz if inertial is not None and is_known else None,
        inertia=None if inertial is None else inertia_box(inertial),
    )


def _collisions(link: Link, surfaces: Mapping[str, str]) -> Iterator[Part]:
    for collision in link.collisions:
        geometry = drawable(collision.geometry)
        if isinstance(geometry, Mesh):
            path = surfaces.get(geometry.path or "")
            geometry = None if path is None else replace(geometry, path=path)
        if geometry is not None:
            yield Part(geometry, COLLISION, collision.pose_in_link)


def inertia_box(inertial: Inertial) -> InertiaBox | None:
    """The box of an inertia; None where it has no mass, or is not a number.

    An inertia that no body can have gives a box with an edge of next to nothing.
    """
    numbers = (inertial.mass, *inertial.inertia)
    if not all(map(math.isfinite, numbers)) or inertial.mass <= 0:
        return None
    if not inertial.pose_in_link.is_finite:
        return None
    moments, axes = np.linalg.eigh(np.array(matrix_of(inertial.inertia)))
    if np.linalg.det(axes) < 0:
        axes[:, 0] *= -1
    a, b, c = (float(moment) for moment in moments)
    squares = (b + c - a, c + a - b, a + b - c)
    edges = [math.sqrt(max(6 * square / inertial.mass, 0.0)) for square in squares]
    turned = np.array(rotation_of_rpy(inertial.pose_in_link.rpy)) @ axes
    return InertiaBox(
        center=inertial.pose_in_link.xyz,
        orientation=_quaternion(turned),
        size=(
            max(edges[0], LEAST_EDGE),
            max(edges[1], LEAST_EDGE),
            max(edges[2], LEAST_EDGE),
        ),
    )


def _quaternion(rotation: Floats) -> Quaternion:
    """The unit quaternion w, x, y, z of a rotation, by its largest part."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation.tolist()
    squares = (1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz)
    rows = (
        (squares[0], zy - yz, xz - zx, yx - xy),
        (zy - yz, squares[1], yx + xy, xz + zx),
        (xz - zx, yx + xy, squares[2], zy + yz),
        (yx - xy, xz + zx, zy + yz, squares[3]),
    )
    largest = max(range(4), key=squares.__getitem__)
    length = math.hypot(*rows[largest])
    w, x, y, z = (part / length for part in rows[largest])
    return (w, x, y, z)


def link_places(
    links: Sequence[DrawnLink], robot: Robot, chosen: Mapping[str, float], pose_in_world: Pose
) -> list[Floats]:
    """Where the frame of each link is in the world: 3 by 4, a rotation and an origin (m)."""
    positions = all_positions(robot, chosen)
    x, y, z, w = quaternion_of_rpy(pose_in_world.rpy)
    root = _place(pose_in_world.xyz, (w, x, y, z))
    places: list[Floats] = []
    for link in links:
        if link.parent is None or link.joint is None:
            places.append(root)
            continue
        origin, orientation = place_in_parent(link.joint, positions.get(link.joint.name, 0.0))
        outer, inner = places[link.parent], _place(origin, orientation)
        rotation = outer[:, :3] @ inner[:, :3]
        shift = outer[:, :3] @ inner[:, 3] + outer[:, 3]
        places.append(np.column_stack([rotation, shift]))
    return places


def _place(origin: Vector, orientation: Quaternion) -> Floats:
    w, x, y, z = orientation
    rotation = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.column_stack([np.array(rotation), np.array(origin)])


def _bounds(
    robot: Robot,
    links: Sequence[DrawnLink],
    chosen: Mapping[str, float],
    pose: Pose,
    *,
    touching: bool,
) -> tuple[Vector, Vector]:
    """Two corners of the box around the shapes; around the collisions, if it is `touching`."""
    corners = []
    has_collisions = any(link.collisions for link in links)
    for link, place in zip(links, link_places(links, robot, chosen, pose), strict=True):
        parts = link.collisions if touching and has_collisions else ()
        for part in parts or (*link.visuals, *link.collisions):
            if touching and has_collisions and not link.collisions:
                continue
            points = _outline(part)
            if points is not None:
                corners.append(place[:, :3] @ points + place[:, 3:])
        if not touching:
            corners.append(place[:, 3:])
    around = np.hstack(corners) if corners else np.zeros((3, 1))
    around = around[:, np.isfinite(around).all(axis=0)]
    if not around.size:
        around = np.zeros((3, 1))
    low, high = around.min(axis=1).tolist(), around.max(axis=1).tolist()
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def _outline(part: Part) -> Floats | None:
    """Points that a part lies between, 3 by n, m, in the link frame."""
    geometry = part.geometry
    if isinstance(geometry, Mesh):
        if geometry.path is None:
            return None
        points = outline(surface_of(geometry.path)).astype(np.float64)
        points *= np.array(geometry.scale)[:, None]
    else:
        points = outline(surface_of(geometry)).astype(np.float64)
    if not points.size or not part.pose.is_finite:
        return None
    turned: Floats = np.array(rotation_of_rpy(part.pose.rpy)) @ points
    turned += np.array(part.pose.xyz)[:, None]
    return turned


TURNING = frozenset((JointType.REVOLUTE, JointType.CONTINUOUS))
ENDLESS = 8 * math.pi  # rad between limits; some write them for wheels
FARTHEST = 10.0  # m either way, of a sliding joint whose limits are no limits
STEPS = 1000  # that a slider has at least
FINEST = 1e-4  # m
DEGREES = 0.1
SLACK = 1e-6  # steps that rounding may add to a limit
DIGITS = 6  # after the point
MOST_MIMICS = 100  # of a chain of joints that mimic each other


@dataclass(frozen=True, kw_only=True)
class Slider:
    """The range of a joint that a person may move."""

    joint: str
    lower: float
    upper: float
    start: float  # where `joint_state_publisher_gui` has it, too: 0, or the middle of its limits
    is_angle: bool
    is_endless: bool = False  # a continuous joint, or one whose limits are many turns apart
    followers: tuple[str, ...] = ()  # joints that mimic it

    @property
    def unit(self) -> str:
        """What the slider counts in."""
        return "°" if self.is_angle else "m"

    def shown(self, position: float) -> float:
        """A position in the unit of the slider."""
        return math.degrees(position) if self.is_angle else position

    def position(self, shown: float) -> float:
        """The position that a slider shows; within the limits, which the slider has rounded."""
        position = math.radians(shown) if self.is_angle else shown
        return min(max(position, self.lower), self.upper)

    @property
    def step(self) -> float:
        """The smallest change, in the unit of the slider."""
        if self.is_angle:
            return DEGREES
        exponent = math.floor(math.log10(max(self.upper - self.lower, FINEST) / STEPS))
        return float(max(FINEST, 10.0**exponent))

    @property
    def range_shown(self) -> tuple[float, float]:
        """The limits in the unit of the slider, rounded outwards to whole steps."""
        lower, upper = self.shown(self.lower), self.shown(self.upper)
        return (
            round(math.floor(lower / self.step + SLACK) * self.step, DIGITS),
            round(math.ceil(upper / self.step - SLACK) * self.step, DIGITS),
        )

    @property
    def middle(self) -> float:
        """The middle of its range."""
        return 0.0 if self.is_endless else (self.lower + self.upper) / 2


def sliders(robot: Robot) -> tuple[Slider, ...]:
    """A slider for each joint that turns or slides and mimics no other one of the robot."""
    names = {joint.name for joint in robot.joints}
    leaders = {
        joint.name: joint.mimic.joint
        for joint in robot.joints
        if joint.mimic is not None and joint.mimic.joint in names
    }
    return tuple(
        _slider(joint, tuple(name for name, leader in leaders.items() if leader == joint.name))
        for joint in robot.joints
        if joint.type in {*TURNING, JointType.PRISMATIC} and joint.name not in leaders
    )


def _slider(joint: Joint, followers: tuple[str, ...]) -> Slider:
    is_angle = joint.type in TURNING
    limit = None if joint.type is JointType.CONTINUOUS else joint.limit
    lower, upper = (limit.lower, limit.upper) if limit is not None else (-math.inf, math.inf)
    if not (math.isfinite(lower) and math.isfinite(upper)) and limit is not None:
        lower = lower if math.isfinite(lower) else -math.inf
        upper = upper if math.isfinite(upper) else math.inf
    lower, upper = min(lower, upper), max(lower, upper)
    room = ENDLESS if is_angle else 2 * FARTHEST
    is_endless = upper - lower > room
    if is_endless:
        most = math.pi if is_angle else FARTHEST
        lower, upper = max(lower, -most), min(upper, most)
        lower, upper = min(lower, upper), max(lower, upper)
    return Slider(
        joint=joint.name,
        lower=lower,
        upper=upper,
        start=0.0 if lower <= 0 <= upper else (lower + upper) / 2,
        is_angle=is_angle,
        is_endless=is_endless,
        followers=followers,
    )


def all_positions(robot: Robot, chosen: Mapping[str, float]) -> dict[str, float]:
    """The positions of all joints, those that mimic others included; 0 where none is chosen.

    Joints that mimic each other in a circle stay at 0.
    """
    joints = {joint.name: joint for joint in robot.joints}
    positions: dict[str, float] = {}
    for name in joints:
        factor, offset, leader = 1.0, 0.0, name
        for _ in range(MOST_MIMICS):
            mimic = joints[leader].mimic
            if mimic is None or mimic.joint not in joints:
                positions[name] = factor * chosen.get(leader, 0.0) + offset
                break
            offset += factor * mimic.offset
            factor *= mimic.multiplier
            leader = mimic.joint
        else:
            positions[name] = 0.0
        if not math.isfinite(positions[name]):
            positions[name] = 0.0
    return positions


def place_in_parent(joint: Joint, position: float) -> tuple[Vector, Quaternion]:
    """Where the child of a joint is, seen from the parent: its origin (m), and its quaternion."""
    pose = joint.pose_in_parent
    if not pose.is_finite:
        return IDENTITY.xyz, (1.0, 0.0, 0.0, 0.0)
    x, y, z, w = quaternion_of_rpy(pose.rpy)
    turned = (w, x, y, z)
    axis = unit_axis(joint)
    if axis is None or position == 0:
        return pose.xyz, turned
    if joint.type in TURNING:
        sine = math.sin(position / 2)
        about = (math.cos(position / 2), *(sine * part for part in axis))
        return pose.xyz, _product(turned, about)
    if joint.type is JointType.PRISMATIC:
        along = rotate(rotation_of_rpy(pose.rpy), axis)
        moved = tuple(a + position * b for a, b in zip(pose.xyz, along, strict=True))
        return (moved[0], moved[1], moved[2]), turned
    return pose.xyz, turned


def unit_axis(joint: Joint) -> Vector | None:
    """The axis in the frame of the child, of length 1; None where it has none."""
    x, y, z = joint.axis_in_joint
    length = math.hypot(x, y, z)
    if not math.isfinite(length) or length == 0:
        return None
    return (x / length, y / length, z / length)


def _product(one: Quaternion, other: tuple[float, ...]) -> Quaternion:
    """The rotation by `other`, then by `one`."""
    (a, b, c, d), (e, f, g, h) = one, other
    return (
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    )
