"""The rays of a lidar: what they begin in and hit, and what becomes of their ranges. No ROS.

Sources: gazebo (Classic), gazebo/physics/MultiRayShape.cc (rays begin at the least range) and
gazebo/sensors/RaySensor.cc (ranges outside are infinite, as REP 117 says); gazebosim/gz-sensors,
src/Lidar.cc and src/GpuLidarSensor.cc (likewise).

The intensity is the <laser_retro> of the shape. Gazebo Classic's rays on the CPU have that of the
collision (gazebosim/gazebo-classic, gazebo/physics/ode/ODEMultiRayShape.cc, `UpdateCallback`; 0
where nothing is hit, as gazebo/physics/MultiRayShape.cc begins). Lidars on a GPU have that of the
visual, from 0 to 2000 (gazebosim/gz-rendering, ogre2/src/Ogre2GpuRays.cc; Classic's likewise).

Engines know the link that a ray hits, and not which of its shapes: rays are cast again, at those
shapes that are near the places that they have hit.

The rays of Gazebo Classic's `ray` begin at the least range, and hit the far side of what is around
that place, the housing of the lidar itself among it (tests/classic/test_sensors.py). Engines do not
see what a ray begins in (`Engine.cast_rays`).
"""

from __future__ import annotations

import math
from dataclasses import field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from wsgen.live.nodes.simulator.elements import number
from wsgen.live.nodes.simulator.host import CannotWorkError
from wsgen.live.nodes.simulator.sensors.mounting import Noise, rotation
from wsgen.model.robot import Box, Capsule, Cylinder, Mesh, Primitive, Sphere
from wsgen.model.transform import compose, rotation_of_rpy
from wsgen.simulation.contact_shapes import box_around
from wsgen.simulation.surfaces import UnreadError, cast_rays, triangles_of
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from wsgen.model.devices import Element
    from wsgen.model.robot import Geometry
    from wsgen.model.transform import Pose
    from wsgen.simulation.scene import SpawnedRobot

    Floats = NDArray[np.float64]
    CastRays = Callable[[Floats, Floats], Floats]
    Reflect = Callable[[Floats, Floats, Floats], Floats]
    Poses = Mapping[str, Mapping[str, Pose]]


FARTHEST = 1e4  # m; nothing in a world is farther
MOST_RAYS = 1_000_000  # of a scan; a lidar with more has a mistake in it


@dataclass(frozen=True, kw_only=True)
class Angles:
    """The rays along one direction, and the ranges that are given."""

    count: int  # of ranges
    least: float  # rad
    most: float  # rad
    rays: int | None = None  # whose ranges are interpolated; None: as many as ranges

    @property
    def step(self) -> float:
        """From one range to the next, rad; 0 of a single one."""
        return (self.most - self.least) / (self.count - 1) if self.count > 1 else 0.0

    @property
    def all(self) -> Floats:
        """The angle of each range, rad; a single one looks straight ahead."""
        return _spread(self.least, self.most, self.count)

    @property
    def of_rays(self) -> Floats:
        """Likewise of each ray."""
        return _spread(self.least, self.most, self.rays or self.count)

    @property
    def places(self) -> Floats:
        """Where among the rays each range is, from 0."""
        return np.linspace(0.0, (self.rays or self.count) - 1.0, self.count)


def _spread(least: float, most: float, count: int) -> Floats:
    return np.linspace(least, most, count) if count > 1 else np.zeros(1)


@dataclass(frozen=True, kw_only=True)
class LidarSpec:
    """What a <ray> or <lidar> says."""

    across: Angles
    up: Angles = field(default_factory=lambda: Angles(count=1, least=0.0, most=0.0))
    nearest: float  # m
    farthest: float  # m
    noise: Element | None = None

    @property
    def shape(self) -> tuple[int, int]:
        """Rows from low to high, and columns."""
        return self.up.count, self.across.count


def read_lidar(element: Element, *, interpolates: bool = False) -> LidarSpec:
    """What a <ray> or <lidar> says.

    Gazebo Classic's `ray` casts <samples> rays, and interpolates <resolution> times as many ranges.

    Raises:
        CannotWorkError: A number of it is none, or makes no scan.
    """
    across = _angles(element, "scan/horizontal", 640, interpolates=interpolates)
    up = _angles(element, "scan/vertical", 1, interpolates=interpolates)
    if across.count * up.count > MOST_RAYS:
        raise CannotWorkError(
            f"it has {across.count * up.count} rays; wsgen casts {MOST_RAYS} at most. "
            "Write fewer <samples>."
        )
    nearest = number(element, "range/min", 0.0)
    farthest = number(element, "range/max", 0.0) if element.get("range/max") != "inf" else FARTHEST
    if not 0 <= nearest < farthest:
        raise CannotWorkError(
            f"its <range> goes from {nearest:g} m to {farthest:g} m. Write a <max> above the <min>."
        )
    return LidarSpec(
        across=across, up=up, nearest=nearest, farthest=farthest, noise=element.find("noise")
    )


def _angles(element: Element, path: str, samples: int, *, interpolates: bool) -> Angles:
    rays = number(element, f"{path}/samples", samples)
    count = rays * number(element, f"{path}/resolution", 1.0)
    if not 1 <= count <= MOST_RAYS:
        raise CannotWorkError(f"its <{path}> has {count:g} rays. Write a number of <samples>.")
    return Angles(
        count=math.floor(count) if interpolates else round(count),
        rays=max(1, math.floor(rays)) if interpolates else None,
        least=number(element, f"{path}/min_angle", 0.0),
        most=number(element, f"{path}/max_angle", 0.0),
    )


class Scanner:
    """Measures with a lidar.

    Attributes:
        spec: What it is like.
        directions: Of its rays, rows by columns by 3, in its frame: x ahead, z up.
    """

    def __init__(self, spec: LidarSpec, random: np.random.Generator) -> None:
        """Aim the rays.

        Raises:
            CannotWorkError: A number of the noise is none.
        """
        self.spec = spec
        self.noise = Noise(spec.noise, random)
        self.directions = _directions(spec.up.all, spec.across.all)
        self._rays = _directions(spec.up.of_rays, spec.across.of_rays)
        self._interpolates = self._rays.shape != self.directions.shape

    def measure(self, pose: Pose, cast_rays: CastRays) -> Floats:
        """The ranges from a place in the world, rows by columns, m.

        What is nearer than the least range is -inf, what is farther than the most inf.
        """
        return self.scan(pose, cast_rays)[0]

    def scan(
        self, pose: Pose, cast_rays: CastRays, reflect: Reflect | None = None
    ) -> tuple[Floats, Floats]:
        """The ranges as `measure` has them, and the intensities, 0 where no range is measured."""
        spec = self.spec
        ways = self._rays.reshape(-1, 3) @ rotation(pose).T
        origin = np.array(pose.xyz)
        far = min(spec.farthest, FARTHEST)
        begins, ends = origin + ways * spec.nearest, origin + ways * far
        hits = cast_rays(begins, ends)
        ranges = spec.nearest + hits * (far - spec.nearest)
        intensities = np.zeros(len(hits)) if reflect is None else reflect(begins, ends, hits)
        if self._interpolates:
            ranges, intensities = self._interpolated(np.minimum(ranges, far), intensities)
        measured = self.noise.apply(ranges)
        measured = np.clip(measured, spec.nearest, spec.farthest)
        measured = np.where(ranges >= far, math.inf, measured)
        measured = np.where(ranges <= spec.nearest, -math.inf, measured)
        intensities[~np.isfinite(measured)] = 0.0
        return measured.reshape(spec.shape), intensities.reshape(spec.shape)

    def _interpolated(self, ranges: Floats, intensities: Floats) -> tuple[Floats, Floats]:
        """Ranges between those of rays, also where one of these hits nothing.

        Intensities are the means of the four rays around (gazebo, gazebo/sensors/RaySensor.cc).
        """
        shape = self._rays.shape[:2]
        rows, columns = self.spec.up.places[:, None], self.spec.across.places[None, :]
        row, column = np.floor(rows).astype(int), np.floor(columns).astype(int)
        up, across = rows - row, columns - column
        next_row = np.minimum(row + 1, shape[0] - 1)
        next_column = np.minimum(column + 1, shape[1] - 1)
        corners = [(row, column), (row, next_column), (next_row, column), (next_row, next_column)]
        shares = [(1 - up) * (1 - across), (1 - up) * across, up * (1 - across), up * across]
        grid, bright = ranges.reshape(shape), intensities.reshape(shape)
        between = sum(share * grid[at] for share, at in zip(shares, corners, strict=True))
        mean = sum(bright[at] for at in corners) / len(corners)
        return np.ravel(between), np.ravel(mean)

    def points(self, ranges: Floats) -> Floats:
        """The points that are seen, rows by columns by 3, in its frame, m, or not finite."""
        with np.errstate(invalid="ignore"):
            points: Floats = self.directions * ranges[..., None]
        return points


def _directions(up: Floats, across: Floats) -> Floats:
    """Rows by columns by 3."""
    rows, columns = np.meshgrid(up, across, indexing="ij")
    return np.stack(
        [np.cos(rows) * np.cos(columns), np.cos(rows) * np.sin(columns), np.sin(rows)], axis=-1
    )


MOST_OF_GPU = 2000.0
# m, along a ray: how far the hit of an engine is off a collision; and how far before it something
# is that has a visual alone, like a line on the ground, or that is smaller than its collision.
OFF_COLLISION = 0.01
OFF_VISUAL = 0.02
GROUND = 1e-4  # m; what is hit no higher than that is the ground


class Shape(NamedTuple):
    """A shape that rays may hit."""

    entity: str
    link: str
    pose_in_link: Pose
    geometry: Primitive | Mesh
    radius: float  # m, around its frame
    retro: float
    is_hull: bool  # rays may hit the convex hull of its mesh
    reach: float  # m, around the frame of its link


class Reflection:
    """The shapes of all robots, static models among them, that rays may hit."""

    def __init__(
        self, robots: Sequence[SpawnedRobot], *, is_gpu: bool, has_ground: bool = False
    ) -> None:
        """Take in what rays may hit; the ground, the plane z = 0, does not reflect."""
        self._off = OFF_VISUAL if is_gpu else OFF_COLLISION
        self._has_ground = has_ground
        shapes = shapes_of(robots, is_gpu=is_gpu)
        self._shapes = shapes if any(shape.retro for shape in shapes) else []

    @property
    def is_any(self) -> bool:
        """Whether anything reflects."""
        return bool(self._shapes)

    def intensities(self, starts: Floats, ends: Floats, fractions: Floats, poses: Poses) -> Floats:
        """The intensities of rays, shape (n,); 0 where a ray hits nothing.

        Args:
            starts: Where they begin in the world, shape (n, 3), m.
            ends: Where they end.
            fractions: How far they have got, as `Engine.cast_rays` says.
            poses: Of the links in the world, by entity and link.
        """
        found = np.zeros(len(fractions))
        hits = np.flatnonzero(np.isfinite(fractions))
        if not self._shapes or not len(hits):
            return found
        begins, ways = starts[hits], ends[hits] - starts[hits]
        lengths = np.linalg.norm(ways, axis=1)
        points = begins + ways * fractions[hits, None]
        first = fractions[hits] + self._off / lengths  # the first shape near the hit counts
        least = fractions[hits] - self._off / lengths
        hulls = np.zeros(len(hits))  # those of what is around, where there is no such shape
        is_found = np.zeros(len(hits), dtype=np.bool_)
        if self._has_ground:
            is_found = np.abs(points[:, 2]) <= GROUND
            first[is_found] = fractions[hits][is_found]
        for shape in self._shapes:
            link = poses.get(shape.entity, {}).get(shape.link)
            if link is None or not link.is_finite:
                continue
            pose = compose(link, shape.pose_in_link)
            apart = points - np.array(pose.xyz)
            reach = shape.radius + self._off
            near = np.flatnonzero((apart * apart).sum(axis=1) <= reach * reach)
            if not len(near):
                continue
            rotation = np.array(rotation_of_rpy(pose.rpy))
            local = (begins[near] - np.array(pose.xyz)) @ rotation
            local_points = apart[near] @ rotation
            through = cast_at(shape.geometry, local, ways[near] @ rotation, local_points)
            is_hit = (through >= least[near]) & (through < first[near])
            where = near[is_hit]
            first[where] = through[is_hit]
            is_found[where] = True
            found[hits[where]] = shape.retro
            if shape.is_hull:
                hulls[near[_is_around(shape.geometry, local_points)]] = shape.retro
        found[hits[~is_found]] = hulls[~is_found]
        return found


def shapes_of(robots: Sequence[SpawnedRobot], *, is_gpu: bool) -> list[Shape]:
    """Collisions, or visuals for lidars on a GPU; not those that no ray finds."""
    shapes = []
    for robot in robots:
        for link in robot.robot.links:
            for shape in link.visuals if is_gpu else link.collisions:
                radius = _radius(shape.geometry)
                if radius is None or not isinstance(shape.geometry, Primitive | Mesh):
                    continue
                retro = shape.laser_retro
                if is_gpu:
                    retro = min(max(0.0, retro), MOST_OF_GPU)
                is_hull = isinstance(shape.geometry, Mesh) and not robot.robot.is_static
                place = (robot.entity, link.name, shape.pose_in_link)
                reach = radius + math.hypot(*shape.pose_in_link.xyz)
                shapes.append(Shape(*place, shape.geometry, radius, retro, is_hull, reach))
    return shapes


def _radius(geometry: Geometry) -> float | None:
    """Of the ball around the frame of a shape that it lies in, m; None of what no ray finds."""
    if isinstance(geometry, Primitive):
        return max(math.hypot(*corner) for corner in box_around(geometry))
    if not isinstance(geometry, Mesh) or geometry.path is None:
        return None
    try:
        corners = triangles_of(geometry)
    except UnreadError:
        return None
    return float(np.sqrt((corners * corners).sum(axis=2).max()))


def _is_around(geometry: Primitive | Mesh, points: Floats) -> NDArray[np.bool_]:
    """Which points are in the box around a mesh, seen from its frame."""
    assert isinstance(geometry, Mesh)  # noqa: S101  primitives have no hull
    corners = triangles_of(geometry)
    low, high = corners.min(axis=(0, 1)) - OFF_COLLISION, corners.max(axis=(0, 1)) + OFF_COLLISION
    is_around: NDArray[np.bool_] = ((points >= low) & (points <= high)).all(axis=1)
    return is_around


def cast_at(geometry: Primitive | Mesh, begins: Floats, ways: Floats, points: Floats) -> Floats:
    """Where rays enter a shape, as fractions of their ways, shape (n,); infinite where they do not.

    All is seen from the frame of the shape. A ray that begins inside does not enter. Of meshes
    those triangles count that are near the points.
    """
    if isinstance(geometry, Mesh):
        triangles = triangles_of(geometry)
        low, high = points.min(axis=0) - OFF_VISUAL, points.max(axis=0) + OFF_VISUAL
        is_near = (triangles.max(axis=1) >= low).all(axis=1)
        is_near &= (triangles.min(axis=1) <= high).all(axis=1)
        return cast_rays(begins, ways, triangles[is_near])
    if isinstance(geometry, Box):
        return _into_slabs(begins, ways, np.array(geometry.size) / 2)
    if isinstance(geometry, Sphere):
        return _into_ball(begins, ways, geometry.radius)
    side = _into_round(begins, ways, geometry.radius)
    if isinstance(geometry, Cylinder):
        top = _into_slabs(begins[:, 2:], ways[:, 2:], np.array([geometry.length / 2]))
        side_at = np.abs(begins[:, 2] + ways[:, 2] * np.where(np.isfinite(side), side, 0.0))
        top_at = begins[:, :2] + ways[:, :2] * np.where(np.isfinite(top), top, 0.0)[:, None]
        is_on_top = (top_at * top_at).sum(axis=1) <= geometry.radius**2
        return np.minimum(
            np.where(side_at <= geometry.length / 2, side, np.inf),
            np.where(is_on_top, top, np.inf),
        )
    assert isinstance(geometry, Capsule)  # noqa: S101  the last of the primitives
    half = np.array([0.0, 0.0, geometry.length / 2])
    side_at = np.abs(begins[:, 2] + ways[:, 2] * np.where(np.isfinite(side), side, 0.0))
    ends = (_into_ball(begins - sign * half, ways, geometry.radius) for sign in (-1.0, 1.0))
    entered: Floats = np.minimum.reduce([np.where(side_at <= half[2], side, np.inf), *ends])
    return entered


def _into_slabs(begins: Floats, ways: Floats, half: Floats) -> Floats:
    """Where rays enter what is between planes, so far from the origin along each axis."""
    with np.errstate(divide="ignore", invalid="ignore"):
        one, other = (-half - begins) / ways, (half - begins) / ways
    # Along a plane: always between, or never.
    is_between = np.abs(begins) <= half
    is_along = ways == 0.0
    enter = np.where(is_along, np.where(is_between, -np.inf, np.inf), np.minimum(one, other))
    leave = np.where(is_along, np.where(is_between, np.inf, -np.inf), np.maximum(one, other))
    first, last = enter.max(axis=1), leave.min(axis=1)
    entered: Floats = np.where((first >= 0.0) & (first <= last), first, np.inf)
    return entered


def _into_round(begins: Floats, ways: Floats, radius: float) -> Floats:
    """Where rays enter an endless cylinder along z."""
    return _into_ball(begins[:, :2], ways[:, :2], radius)


def _into_ball(begins: Floats, ways: Floats, radius: float) -> Floats:
    """Where rays enter a ball around the origin; a circle, if they have two coordinates."""
    a = (ways * ways).sum(axis=1)
    b = (begins * ways).sum(axis=1)
    c = (begins * begins).sum(axis=1) - radius**2
    with np.errstate(divide="ignore", invalid="ignore"):
        entered = (-b - np.sqrt(b * b - a * c)) / a
    into: Floats = np.where(np.isfinite(entered) & (entered >= 0.0), entered, np.inf)
    return into


class Housings:
    """The shapes of all robots, static models among them, that rays may begin in."""

    def __init__(self, robots: Sequence[SpawnedRobot], *, has_ground: bool) -> None:
        """Take in what rays may begin in; the ground is the plane z = 0, seen from below, too."""
        self._shapes = shapes_of(robots, is_gpu=False)
        self._has_ground = has_ground

    def leave(self, starts: Floats, ends: Floats, poses: Poses) -> Floats:
        """How far rays get until they leave a shape, as fractions of their ways, shape (n,).

        Infinite where they begin in none, or end in it. Starts and ends are in the world, shape
        (n, 3), m; poses are those of the links in the world, by entity and link.
        """
        found = np.full(len(starts), np.inf)
        if self._has_ground:
            rises = (starts[:, 2] < 0.0) & (ends[:, 2] > 0.0)
            low, high = starts[rises, 2], ends[rises, 2]
            found[rises] = low / (low - high)
        middle = starts.mean(axis=0)
        center = middle.tolist()
        spread = float(np.sqrt(((starts - middle) ** 2).sum(axis=1).max()))
        for shape in self._shapes:
            link = poses.get(shape.entity, {}).get(shape.link)
            if link is None or math.dist(link.xyz, center) > shape.reach + spread:
                continue
            if not link.is_finite:
                continue
            pose = compose(link, shape.pose_in_link)
            apart = starts - np.array(pose.xyz)
            near = np.flatnonzero((apart * apart).sum(axis=1) <= shape.radius**2)
            if not len(near):
                continue
            rotation = np.array(rotation_of_rpy(pose.rpy))
            begins, ways = apart[near] @ rotation, (ends[near] - starts[near]) @ rotation
            if isinstance(shape.geometry, Mesh):
                out = cast_at(shape.geometry, begins, ways, begins + ways)
            else:  # what begins inside enters from its other end alone
                enters = cast_at(shape.geometry, begins, ways, begins)
                out = 1.0 - cast_at(shape.geometry, begins + ways, -ways, begins)
                out = np.where(np.isfinite(enters) | ~np.isfinite(out) | (out < 0), np.inf, out)
                out[enters <= 0.0] = 0.0  # it begins at the surface
            found[near] = np.minimum(found[near], out)
        return found
