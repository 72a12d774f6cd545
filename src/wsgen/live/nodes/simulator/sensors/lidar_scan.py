"""What a lidar measures: its rays, and what becomes of their ranges. No ROS in here.

Sources: gazebo (Classic), gazebo/physics/MultiRayShape.cc (rays begin at the least range) and
gazebo/sensors/RaySensor.cc (ranges outside are infinite, as REP 117 says); gazebosim/gz-sensors,
src/Lidar.cc and src/GpuLidarSensor.cc (likewise).
"""

from __future__ import annotations

import math
from dataclasses import field
from typing import TYPE_CHECKING

import numpy as np

from wsgen.live.nodes.simulator.elements import number
from wsgen.live.nodes.simulator.host import CannotWorkError
from wsgen.live.nodes.simulator.sensors.mounting import Noise, rotation
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from wsgen.model.devices import Element
    from wsgen.model.transform import Pose

    Floats = NDArray[np.float64]
    CastRays = Callable[[Floats, Floats], Floats]
    # Where rays begin and end, and the shares of their ways that they get -> their intensities.
    Reflect = Callable[[Floats, Floats, Floats], Floats]

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
