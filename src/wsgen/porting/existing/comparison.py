"""Compare the robot of a package with that of its source: everything that its motion depends on."""

from __future__ import annotations

import math
import random
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.model.inertia import about_link_axes, turned
from wsgen.model.robot import JointType, Mesh
from wsgen.model.transform import UNIT, Matrix, Vector, multiply, rotate, rotation_of_rpy

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from wsgen.model.robot import Geometry, Joint, Link, Robot
    from wsgen.porting.existing.description import Reference


CONFIGURATIONS = 10  # random positions of all joints
TOLERANCE = 1e-6  # m, rad, and of masses and inertias their share
_SEED = 32
_WIDE = math.pi  # rad or m to both sides of 0, of joints without limits
_LONGEST = 10.0  # m, that a prismatic joint is moved at most

Placement = tuple[Matrix, Vector]  # of a link's frame, seen from that of the root


class ComparedRow(NamedTuple):
    """One aspect of the robot, in the source and in the package."""

    aspect: str
    source: str
    package: str
    is_same: bool
    differing: tuple[str, ...] = ()  # links or joints, as the source names them
    is_fixed: bool = False  # it differs by fixes alone


class Renamed(NamedTuple):
    """Names of the source, and those that they have in the package."""

    links: Mapping[str, str] = {}
    joints: Mapping[str, str] = {}


def compare(source: Robot, package: Robot, renamed: Renamed = Renamed()) -> list[ComparedRow]:  # noqa: B008  immutable
    """Compare two robots whose meshes have their paths.

    Args:
        source: The robot as its source describes it.
        package: The robot as the package does.
        renamed: What has another name in the package.
    """
    return [*_Comparison(source, package, renamed).rows()]


class _Comparison:
    def __init__(self, source: Robot, package: Robot, renamed: Renamed) -> None:
        self.source, self.package = source, package
        self.renamed = renamed
        links = {one.name: one for one in package.links}
        joints = {one.name: one for one in package.joints}
        self.links = [
            (one, links.get(renamed.links.get(one.name, one.name))) for one in source.links
        ]
        self.joints = [
            (one, joints.get(renamed.joints.get(one.name, one.name))) for one in source.joints
        ]

    def rows(self) -> Iterator[ComparedRow]:
        yield self._row(
            "links", str(len(self.source.links)), str(len(self.package.links)), self._other_links()
        )
        yield self._row("joints", _types(self.source), _types(self.package), self._other_joints())
        yield self._of_joints("origins of joints", _origin)
        yield self._of_joints("axes of joints", _axis)
        yield self._of_joints("limits, damping, friction and mimics", _limits)
        yield self._of_links(
            "masses", f"{self.source.mass:.9g} kg", f"{self.package.mass:.9g} kg", _mass
        )
        yield self._of_links("centers of mass", "", "", _center)
        yield self._of_links("inertias", "", "", _inertia)
        for kind in ("visuals", "collisions"):
            yield self._of_shapes(kind)
        yield self._poses()

    def _row(
        self, aspect: str, source: str, package: str, differing: Sequence[str] = ()
    ) -> ComparedRow:
        return ComparedRow(aspect, source, package, not differing, tuple(differing))

    def _other_links(self) -> list[str]:
        known = {self.renamed.links.get(one.name, one.name) for one in self.source.links}
        lost = [one.name for one, other in self.links if other is None]
        return [*lost, *(one.name for one in self.package.links if one.name not in known)]

    def _other_joints(self) -> list[str]:
        named = self.renamed.links
        known = {self.renamed.joints.get(one.name, one.name) for one in self.source.joints}
        differing = [
            one.name
            for one, other in self.joints
            if other is None
            or (one.type, named.get(one.parent, one.parent), named.get(one.child, one.child))
            != (other.type, other.parent, other.child)
        ]
        return [*differing, *(one.name for one in self.package.joints if one.name not in known)]

    def _of_joints(self, aspect: str, values: _ValuesOfJoint) -> ComparedRow:
        named = self.renamed.joints
        pairs = [
            (one.name, values(one, named), values(other, {}))
            for one, other in self.joints
            if other is not None
        ]
        return self._numbers(aspect, "", "", pairs)

    def _of_links(
        self, aspect: str, source: str, package: str, values: _ValuesOfLink
    ) -> ComparedRow:
        pairs = [
            (one.name, values(one), values(other)) for one, other in self.links if other is not None
        ]
        return self._numbers(aspect, source, package, pairs)

    def _numbers(
        self, aspect: str, source: str, package: str, pairs: Sequence[tuple[str, _Values, _Values]]
    ) -> ComparedRow:
        """Compare numbers by the largest of each link or joint."""
        differing = [name for name, one, other in pairs if not _is_close(one, other)]
        count = sum(one is not None for _, one, _ in pairs)
        other_count = sum(other is not None for _, _, other in pairs)
        return self._row(aspect, source or str(count), package or str(other_count), differing)

    def _of_shapes(self, kind: str) -> ComparedRow:
        pairs = [
            (one.name, _shapes(one, kind), _shapes(other, kind) if other else None)
            for one, other in self.links
        ]
        differing = [
            name
            for name, one, other in pairs
            if other is None
            or len(one) != len(other)
            or not all(_is_same_shape(*both) for both in zip(one, other, strict=True))
        ]
        counts = [
            _count_shapes([shape for link in robot.links for shape in _shapes(link, kind)])
            for robot in (self.source, self.package)
        ]
        return self._row(kind, counts[0], counts[1], differing)

    def _poses(self) -> ComparedRow:
        """Link poses in random configurations of the joints."""
        chance = random.Random(_SEED)  # noqa: S311  no secret
        largest, differing = 0.0, dict[str, None]()
        for _ in range(CONFIGURATIONS):
            positions = {one.name: _position(one, chance) for one in self.source.joints}
            others = {
                self.renamed.joints.get(name, name): value for name, value in positions.items()
            }
            here = place_links(self.source, positions)
            there = place_links(self.package, others)
            for name, placed in here.items():
                other = there.get(self.renamed.links.get(name, name))
                distance = math.inf if other is None else _distance(placed, other)
                largest = max(largest, distance)
                if distance > TOLERANCE:
                    differing[name] = None
        shown = (
            "a link is missing" if largest == math.inf else f"up to {largest:.2g} m or rad apart"
        )
        return self._row(
            f"poses of links in {CONFIGURATIONS} random configurations", "", shown, [*differing]
        )


def compare_with(reference: Reference, robot: Robot, renamed: Renamed) -> ComparedRow:
    """Compare a robot with what another program has of it in random configurations."""
    links = {one.name: one for one in robot.links}
    largest, differing = 0.0, dict[str, None]()
    for one in reference.configurations:
        placed = place_links(
            robot,
            {renamed.joints.get(name, name): value for name, value in one.positions.items()},
        )
        for name, center in one.centers.items():
            here = renamed.links.get(name, name)
            inertial = links[here].inertial if here in links else None
            if inertial is None or here not in placed:
                differing[name] = None
                continue
            matrix, origin = placed[here]
            offset = rotate(matrix, inertial.pose_in_link.xyz)
            at = tuple(a + b for a, b in zip(origin, offset, strict=True))
            inertia = turned(about_link_axes(inertial), matrix)
            apart = math.dist(at, center)
            largest = max(largest, apart)
            share = tuple(moment / inertial.mass for moment in inertia)
            if apart > TOLERANCE or not _is_close(one.inertias[name], share):
                differing[name] = None
    mass = sum(one.inertial.mass for one in robot.links if one.inertial is not None)
    if abs(mass - reference.mass) > TOLERANCE * reference.mass:
        differing[robot.root] = None
    return ComparedRow(
        f"masses and inertias in {len(reference.configurations)} random configurations",
        f"{reference.mass:.9g} kg ({reference.program})",
        f"{mass:.9g} kg, centers up to {largest:.2g} m apart",
        not differing,
        tuple(differing),
    )


def place_links(robot: Robot, positions: Mapping[str, float]) -> dict[str, Placement]:
    """The frame of each link seen from that of the root, as matrix and vector (m).

    Args:
        robot: A tree of links.
        positions: Of the joints, rad or m; joints that mimic others follow those. Floating and
            planar joints stay at their origin.
    """
    below: dict[str, list[Joint]] = {}
    for joint in robot.joints:
        below.setdefault(joint.parent, []).append(joint)
    placed = {robot.root: (UNIT, (0.0, 0.0, 0.0))}
    queue = [robot.root]
    for parent in queue:
        matrix, (x, y, z) = placed[parent]
        for joint in below.get(parent, ()):
            dx, dy, dz = rotate(matrix, joint.pose_in_parent.xyz)
            turned = multiply(matrix, rotation_of_rpy(joint.pose_in_parent.rpy))
            value = positions.get(joint.name, 0.0)
            if joint.mimic is not None:
                value = joint.mimic.multiplier * positions.get(joint.mimic.joint, 0.0)
                value += joint.mimic.offset
            place = (x + dx, y + dy, z + dz)
            if joint.type is JointType.PRISMATIC:
                moved = rotate(turned, _scaled(joint.axis_in_joint, value))
                place = (place[0] + moved[0], place[1] + moved[1], place[2] + moved[2])
            elif joint.type in {JointType.REVOLUTE, JointType.CONTINUOUS}:
                turned = multiply(turned, _about(joint.axis_in_joint, value))
            placed[joint.child] = turned, place
            queue.append(joint.child)
    return placed


def _scaled(vector: Vector, factor: float) -> Vector:
    return (vector[0] * factor, vector[1] * factor, vector[2] * factor)


def _about(axis: Vector, angle: float) -> Matrix:
    """The rotation about an axis, rad (Rodrigues)."""
    length = math.hypot(*axis) or 1.0
    x, y, z = _scaled(axis, 1 / length)
    sine, cosine = math.sin(angle), math.cos(angle)
    rest = 1 - cosine
    return (
        (cosine + x * x * rest, x * y * rest - z * sine, x * z * rest + y * sine),
        (y * x * rest + z * sine, cosine + y * y * rest, y * z * rest - x * sine),
        (z * x * rest - y * sine, z * y * rest + x * sine, cosine + z * z * rest),
    )


def _position(joint: Joint, chance: random.Random) -> float:
    """A position within the limits."""
    low, high = -_WIDE, _WIDE
    if joint.type in {JointType.REVOLUTE, JointType.PRISMATIC} and joint.limit is not None:
        low, high = max(joint.limit.lower, -_LONGEST), min(joint.limit.upper, _LONGEST)
    if low >= high:  # limits of 0, which a fix may widen
        low, high = -_WIDE, _WIDE
    return chance.uniform(low, high)


def _distance(one: Placement, other: Placement) -> float:
    """The larger of the distance of two frames (m) and of the difference of their axes."""
    columns = (math.dist(left, right) for left, right in zip(one[0], other[0], strict=True))
    return max(math.dist(one[1], other[1]), *columns)


def _types(robot: Robot) -> str:
    """How many joints, by type."""
    counts: dict[str, int] = {}
    for joint in robot.joints:
        counts[joint.type.value] = counts.get(joint.type.value, 0) + 1
    return ", ".join(f"{count} {name}" for name, count in sorted(counts.items())) or "0"


_Values = tuple[float | str, ...] | None
if TYPE_CHECKING:
    from collections.abc import Callable

    _ValuesOfJoint = Callable[[Joint, Mapping[str, str]], _Values]
    _ValuesOfLink = Callable[[Link], _Values]


def _origin(joint: Joint, _: Mapping[str, str]) -> _Values:
    rotation = rotation_of_rpy(joint.pose_in_parent.rpy)
    return (*joint.pose_in_parent.xyz, *(number for row in rotation for number in row))


def _axis(joint: Joint, _: Mapping[str, str]) -> _Values:
    return joint.axis_in_joint if joint.is_movable else None


def _limits(joint: Joint, named: Mapping[str, str]) -> _Values:
    limit, mimic = joint.limit, joint.mimic
    if not joint.is_movable:
        return None
    values: list[float | str] = [joint.damping, joint.friction]
    if limit is not None:
        values += [limit.lower, limit.upper, limit.effort, limit.velocity]
    if mimic is not None:
        values += [named.get(mimic.joint, mimic.joint), mimic.multiplier, mimic.offset]
    return tuple(values)


def _mass(link: Link) -> _Values:
    return None if link.inertial is None else (link.inertial.mass,)


def _center(link: Link) -> _Values:
    return None if link.inertial is None else link.inertial.pose_in_link.xyz


def _inertia(link: Link) -> _Values:
    return None if link.inertial is None else about_link_axes(link.inertial)


def _is_close(one: _Values, other: _Values) -> bool:
    """Whether numbers are equal to a millionth of the largest, and everything else is equal."""
    if one is None or other is None or len(one) != len(other):
        return one is other
    size = max((abs(value) for value in one if isinstance(value, float)), default=0.0)
    return all(
        abs(left - right) <= TOLERANCE * size
        if isinstance(left, float) and isinstance(right, float) and math.isfinite(left - right)
        else left == right
        for left, right in zip(one, other, strict=True)
    )


_Shape = tuple["Geometry", tuple[float, ...]]


def _shapes(link: Link, kind: str) -> list[_Shape]:
    """The shapes of a link, with their placement in it."""
    shapes = link.visuals if kind == "visuals" else link.collisions
    return [
        (
            one.geometry,
            (
                *one.pose_in_link.xyz,
                *(number for row in rotation_of_rpy(one.pose_in_link.rpy) for number in row),
            ),
        )
        for one in shapes
    ]


def _count_shapes(shapes: Sequence[_Shape]) -> str:
    meshes = sum(isinstance(geometry, Mesh) for geometry, _ in shapes)
    return f"{len(shapes)} ({meshes} meshes)" if meshes else str(len(shapes))


def _is_same_shape(one: _Shape, other: _Shape) -> bool:
    (geometry, place), (other_geometry, other_place) = one, other
    if not _is_close(place, other_place):
        return False
    if isinstance(geometry, Mesh) and isinstance(other_geometry, Mesh):
        return _is_close(geometry.scale, other_geometry.scale) and _has_same_bytes(
            geometry.path, other_geometry.path
        )
    return geometry == other_geometry


def _has_same_bytes(one: str | None, other: str | None) -> bool:
    if one is None or other is None:
        return one == other
    first, second = Path(one), Path(other)
    return first.samefile(second) or first.read_bytes() == second.read_bytes()
