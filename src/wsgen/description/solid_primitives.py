"""Ellipsoids and cones as triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsgen.model.robot import Cone, Ellipsoid

AROUND = 48  # corners of a circle: what rolls deviates by 0.2 % of the radius
UP = 24  # steps from pole to pole


def ellipsoid_triangles(ellipsoid: Ellipsoid) -> NDArray[Any]:
    """Its surface, shape (n, 3, 3), m; the ends of its axes are corners."""
    latitudes = np.linspace(-np.pi / 2, np.pi / 2, UP + 1)
    triangles = _turned(np.cos(latitudes), np.sin(latitudes))
    triangles *= ellipsoid.radii
    return triangles


def cone_triangles(cone: Cone) -> NDArray[Any]:
    """Its surface, shape (n, 3, 3), m."""
    half = cone.length / 2
    return _turned(np.array([0.0, cone.radius, 0.0]), np.array([-half, -half, half]))


def _turned(radii: NDArray[Any], heights: NDArray[Any]) -> NDArray[Any]:
    """A profile, from below upwards, turned about z; triangles without extent are left out."""
    angles = np.linspace(0.0, 2 * np.pi, AROUND, endpoint=False)
    rings = np.empty((len(radii), AROUND, 3))
    rings[..., 0] = radii[:, None] * np.cos(angles)
    rings[..., 1] = radii[:, None] * np.sin(angles)
    rings[..., 2] = heights[:, None]
    rings[radii < 1e-9 * radii.max(), :, :2] = 0.0  # a pole is one point
    low, high = rings[:-1], rings[1:]
    next_low, next_high = np.roll(low, -1, axis=1), np.roll(high, -1, axis=1)
    triangles = np.concatenate(
        [np.stack([low, next_low, next_high], axis=2), np.stack([low, next_high, high], axis=2)]
    ).reshape(-1, 3, 3)
    edges = np.diff(triangles, axis=1)
    return triangles[np.cross(edges[:, 0], edges[:, 1]).any(axis=1)]
