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

from wsgen.ros_nodes.simulator.elements import number
from wsgen.ros_nodes.simulator.host import CannotWorkError
from wsgen.ros_nodes.simulator.sensors.mounting import rotation
from wsgen.ros_nodes.simulator.sensors.noise import Noise
from wsgen.values import dataclass

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
    """The rays along one direction."""

    count: int
    least: float  # rad
    most: float  # rad

    @property
    def step(self) -> float:
        """From one ray to the next, rad; 0 of a single one."""
        return (self.most - self.least) / (self.count - 1) if self.count > 1 else 0.0

    @property
    def all(self) -> Floats:
        """The angle of each ray, rad; a single one looks straight ahead."""
        return np.linspace(self.least, self.most, self.count) if self.count > 1 else np.zeros(1)


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


def read_lidar(element: Element) -> LidarSpec:
    """What a <ray> or <lidar> says.

    Raises:
        CannotWorkError: A number of it is none, or makes no scan.
    """
    across = _angles(element, "scan/horizontal", 640)
    up = _angles(element, "scan/vertical", 1)
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


def _angles(element: Element, path: str, samples: int) -> Angles:
    count = number(element, f"{path}/samples", samples) * number(element, f"{path}/resolution", 1.0)
    if not 1 <= count <= MOST_RAYS:
        raise CannotWorkError(f"its <{path}> has {count:g} rays. Write a number of <samples>.")
    return Angles(
        count=round(count),
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
        up, across = np.meshgrid(spec.up.all, spec.across.all, indexing="ij")
        self.directions = np.stack(
            [np.cos(up) * np.cos(across), np.cos(up) * np.sin(across), np.sin(up)], axis=-1
        )

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
        ways = self.directions.reshape(-1, 3) @ rotation(pose).T
        origin = np.array(pose.xyz)
        far = min(spec.farthest, FARTHEST)
        begins, ends = origin + ways * spec.nearest, origin + ways * far
        hits = cast_rays(begins, ends)
        ranges = spec.nearest + hits * (far - spec.nearest)
        measured = self.noise.apply(ranges)
        measured = np.clip(measured, spec.nearest, spec.farthest)
        measured = np.where(ranges >= spec.farthest, math.inf, measured)
        measured = np.where(ranges <= spec.nearest, -math.inf, measured)
        intensities = np.zeros(len(hits)) if reflect is None else reflect(begins, ends, hits)
        intensities[~np.isfinite(measured)] = 0.0
        return measured.reshape(spec.shape), intensities.reshape(spec.shape)

    def points(self, ranges: Floats) -> Floats:
        """The points that are seen, rows by columns by 3, in its frame, m, or not finite."""
        with np.errstate(invalid="ignore"):
            points: Floats = self.directions * ranges[..., None]
        return points
