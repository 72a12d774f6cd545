"""The static triangles of a world, of which MuJoCo gets those near what moves.

It goes through all triangles that it has in every step; and it finds one point where a shape
touches one, so that a foot on a large one would stand on a tip.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wsgen.simulation.mujoco_body import placed
from wsgen.simulation.surfaces import cast_rays, triangles_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from wsgen.model.transform import Pose
    from wsgen.simulation.engine import Place
    from wsgen.simulation.mujoco_body import MujocoBody

    Corners = NDArray[np.float64]  # of triangles, shape (n, 3, 3), m


RADIUS = 1e-4  # m, around triangles; with less, MuJoCo 3.9 throws what lies flat on them
FINEST = 0.03  # m; no triangle is cut into smaller ones
AROUND = 0.5  # m, around a shape: within it, triangles are in the model
NEAREST = 0.15  # m, likewise: those of another place are put into it before
LOOK_EVERY = 0.01  # s, simulated
MOST_TOGETHER = 4000  # triangles in a flex: MuJoCo 3 takes the square of it to compile


class StaticTriangles:
    """Those of all static robots."""

    def __init__(self) -> None:
        self.owners: list[Place] = []  # of the flexes in the specification
        self._all: list[tuple[Place, Corners, dict[str, Any]]] = []
        self._boxes = np.empty((0, 2, 3))  # m, within which they are in the specification

    def __bool__(self) -> bool:
        return bool(self._all)

    def put(self, entity: str, body: MujocoBody, poses: Mapping[str, Pose]) -> None:
        """Take in where those of one are; the poses of its links are seen from the world."""
        self._all = [one for one in self._all if one[0][0] != entity]
        for link, mesh, pose_in_link, surface in body.static_meshes:
            triangles = placed(placed(triangles_of(mesh), pose_in_link), poses[link])
            is_one = (triangles != np.roll(triangles, 1, axis=1)).any(axis=2).all(axis=1)
            self._all.append(((entity, link), triangles[is_one], surface))
        self._boxes = np.empty((0, 2, 3))

    def remove(self, entity: str) -> None:
        """Forget those of one."""
        self._all = [one for one in self._all if one[0][0] != entity]
        self._boxes = np.empty((0, 2, 3))

    def cast_rays(
        self, begins: NDArray[np.float64], ways: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """How far rays get, shape (n,), as `surfaces.cast_rays` says."""
        fractions = np.full(len(begins), np.inf)
        for _, triangles, _ in self._all:
            fractions = np.minimum(fractions, cast_rays(begins, ways, triangles))
        return fractions

    def have(self, boxes: NDArray[np.float64]) -> bool:
        """Whether those near these boxes, shape (m, 2, 3), are in the specification."""
        is_above = (boxes[:, None, 0] > self._boxes[:, 0] + NEAREST).all(axis=2)
        is_below = (boxes[:, None, 1] < self._boxes[:, 1] - NEAREST).all(axis=2)
        return bool(np.logical_and(is_above, is_below).any(axis=1).all())

    def surround(self, spec: Any, boxes: NDArray[np.float64], longest: float) -> bool:
        """Put those near these boxes into the specification; gives whether there are or were any.

        No edge is then longer than that.
        """
        self._boxes = boxes + np.array([[-AROUND], [AROUND]])
        before = list(spec.flexes)
        for flex in before:
            spec.delete(flex)
        self.owners.clear()
        for place, triangles, surface in self._all:
            near = cut(triangles, self._boxes, max(longest, FINEST))
            for first in range(0, len(near), MOST_TOGETHER):
                self._add(spec, near[first : first + MOST_TOGETHER], surface)
                self.owners.append(place)
        return bool(before or self.owners)

    def _add(self, spec: Any, triangles: Corners, surface: Mapping[str, Any]) -> None:
        points, indices = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
        name = f"triangles {len(self.owners)}"
        flex = spec.add_flex(name=name, dim=2, radius=RADIUS, **surface)
        flex.vertbody = ["world"]
        flex.vert, flex.elem = points.ravel(), indices.astype(np.int32).ravel()


def cut(triangles: Corners, boxes: NDArray[np.float64], longest: float) -> Corners:
    """Those that are in one of the boxes, shape (m, 2, 3), cut so that no edge is longer."""
    done = [np.empty((0, 3, 3))]
    while len(triangles):
        low, high = triangles.min(axis=1), triangles.max(axis=1)
        is_near = np.zeros(len(triangles), bool)
        for near_low, near_high in boxes:
            is_near |= ((low <= near_high) & (high >= near_low)).all(axis=1)
        triangles = triangles[is_near]
        edges = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2)
        is_long = edges.max(axis=1, initial=0.0) > longest
        done.append(triangles[~is_long])
        a, b, c = triangles[is_long].transpose(1, 0, 2)
        d, e, f = (a + b) / 2, (b + c) / 2, (c + a) / 2
        triangles = np.concatenate(
            [np.stack(three, axis=1) for three in ((a, d, f), (d, b, e), (f, e, c), (d, e, f))]
        )
    return np.concatenate(done)
