"""Where rays leave the shapes that they begin in. No ROS in here.

The rays of Gazebo Classic's `ray` begin at the least range, and hit the far side of what is around
that place, the housing of the lidar itself among it (tests/classic/test_sensors.py). Engines do not
see what a ray begins in (`Engine.cast_rays`).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsgen.live.nodes.simulator.sensors.reflection import cast_at, shapes_of
from wsgen.model.robot import Mesh
from wsgen.model.transform import compose, rotation_of_rpy

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.live.nodes.simulator.sensors.reflection import Floats, Poses
    from wsgen.simulation.scene import SpawnedRobot


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
