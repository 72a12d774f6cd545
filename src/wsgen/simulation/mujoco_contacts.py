"""What MuJoCo lacks of Gazebo's contacts: friction along two directions, and triangles.

Of the static triangles of a world it gets those near what moves.
It goes through all triangles that it has in every step; and it finds one point where a shape
touches one, so that a foot on a large one would stand on a tip.

On level ground the directions are y and x of the world; what has <fdir1>, as the rollers of mecanum
wheels, has that of the shape, or of the link that it is expressed in, projected onto the surface
that is touched. Of two shapes, the smaller coefficients count; of two directions, that of the shape
with the smaller second coefficient. Sources: gazebosim/gz-physics, dartsim/src/SDFFeatures.cc;
gazebo-forks/dart, dart/constraint/ContactConstraint.cpp; ODE's dxJointContact.

The forces of a contact are the sums of those along the four edges of a pyramid. MuJoCo's has its
edges in the two directions; here they are between them, so that its faces are across.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wsgen.model.transform import rotation_of_rpy
from wsgen.simulation.mujoco_body import MOST_FRICTION, library, placed
from wsgen.simulation.surfaces import cast_rays, triangles_of

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from numpy.typing import NDArray

    from wsgen.model.transform import Pose
    from wsgen.simulation.engine import Place
    from wsgen.simulation.mujoco_body import MujocoBody

    Corners = NDArray[np.float64]


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


LEAST = 1e-5  # the least friction that MuJoCo has
PARALLEL = 1e-6  # the sine between a direction and a normal; then none is left on the surface
NEXT, LAST = [1, 2, 0], [2, 0, 1]


class TwoWayFriction:
    """The friction of the shapes of a model."""

    def __init__(
        self, model: Any, bodies: Collection[MujocoBody], *, is_classic: bool = False
    ) -> None:
        self._directions = np.zeros((model.ngeom, 3))  # in the frame of a body; zero: none
        self._bodies = np.zeros(model.ngeom, dtype=int)
        self._first = np.clip(model.geom_friction[:, 0], LEAST, MOST_FRICTION)
        self._second = self._first.copy()
        for body in bodies:
            for shape in body.shapes:
                surface, number = shape.collision.surface, shape.geom.id
                self._second[number] = min(max(surface.mu2, LEAST), MOST_FRICTION)
                if surface.fdir1 is None:
                    continue
                link = surface.fdir1_in
                if link is None or link not in body.bodies:  # Gazebo takes that of the shape, too
                    rotation = np.array(rotation_of_rpy(shape.collision.pose_in_link.rpy))
                    direction, link = rotation @ np.array(surface.fdir1), shape.link
                else:
                    direction = np.array(surface.fdir1)
                self._directions[number] = direction / np.linalg.norm(direction)
                self._bodies[number] = body.bodies[link].id
        is_directed: NDArray[np.bool_] = (self._directions != 0.0).max(axis=1, initial=False)
        self._is_directed = is_directed
        self._is_uneven = is_directed | (self._first != self._second)
        self._has_some = bool(self._is_uneven.any())
        self._min_depths = np.zeros(model.ngeom)  # m, of contacts that nothing pushes out
        for body in bodies if is_classic else ():
            for shape in body.shapes:
                self._min_depths[shape.geom.id] = shape.collision.surface.min_depth or 0.0
        self._has_depths = bool((self._min_depths > 0.0).any())

    def turn(self, model: Any, data: Any) -> None:
        """Turn the pyramids of the contacts of this step, and make its constraints again."""
        contacts = data.contact
        frames, frictions = contacts.frame, contacts.friction
        if not len(frames):
            return
        first = second = frictions[:, 0]
        if self._has_some:
            second = first.copy()
            self._direct(data, second)
        if self._has_depths:
            depths = self._min_depths[contacts.geom] * (contacts.geom >= 0)
            contacts.dist[:] = np.minimum(contacts.dist + depths.max(axis=1), 0.0)
        across, along = first[:, None] * frames[:, 3:6], second[:, None] * frames[:, 6:]
        frames[:, 3:6], frames[:, 6:] = across + along, across - along
        frictions[:, :2] = 1.0
        library.mj_makeConstraint(model, data)
        library.mj_referenceConstraint(model, data)

    def _direct(self, data: Any, second: NDArray[np.float64]) -> None:
        """Turn the frames of contacts with directions; set first and second coefficients."""
        geoms = data.contact.geom
        # A flex, which is no shape, has the number -1.
        of_both = self._is_uneven[geoms] & (geoms.min(axis=1, keepdims=True) >= 0)
        uneven = of_both.any(axis=1).nonzero()[0]
        if not len(uneven):
            return
        data.contact.friction[uneven, 0] = self._first[geoms[uneven]].min(axis=1)
        second[uneven] = self._second[geoms[uneven]].min(axis=1)
        of_both &= self._is_directed[geoms]
        turned = of_both.any(axis=1).nonzero()[0]
        if not len(turned):
            return
        geoms, of_both = geoms[turned], of_both[turned]
        # Without a direction, a shape is not chosen.
        seconds = np.where(of_both, self._second[geoms], np.inf)
        chosen = geoms[np.arange(len(geoms)), seconds.argmin(axis=1)]
        rotations = data.xmat[self._bodies[chosen]].reshape(-1, 3, 3)
        directions = (rotations @ self._directions[chosen, :, None])[:, :, 0]
        normals = data.contact.frame[turned, :3]
        across = _cross(normals, directions)
        lengths = np.sqrt((across * across).sum(axis=1))
        is_there = lengths > PARALLEL
        if not is_there.all():
            turned, normals = turned[is_there], normals[is_there]
            across, lengths = across[is_there], lengths[is_there]
        across /= lengths[:, None]
        data.contact.frame[turned, 3:6] = _cross(across, normals)
        data.contact.frame[turned, 6:] = across


def _cross(one: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    """The vector products of rows; of few rows in a third of the time of NumPy's."""
    return one[:, NEXT] * other[:, LAST] - one[:, LAST] * other[:, NEXT]
