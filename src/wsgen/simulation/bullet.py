"""The PyBullet engine, set up so that it does what Gazebo's physics does.

It collides meshes as their convex hulls, where Gazebo takes the triangles. On level ground the two
are the same, for the corners of a hull are corners of its mesh; elsewhere `hull_gaps` measures how
far they differ.

No other module imports PyBullet; its functions are bound to one world.
"""

from __future__ import annotations

import math
import weakref
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pybullet

from wsgen.model.kinematics import split_trees
from wsgen.model.robot import MOST_LINKS, Box, Collision, Link, Mesh, Robot
from wsgen.model.transform import Pose, Vector, compose, quaternion_of_rpy
from wsgen.simulation import surfaces
from wsgen.simulation.bullet_body import ROOT, BulletBody, PartBounds, load
from wsgen.simulation.bullet_body import STRIDE as DAMPER_STRIDE
from wsgen.simulation.contact_shapes import most_parts
from wsgen.simulation.engine import (
    TOUCHING,
    Contact,
    HullGap,
    Loaded,
    Look,
    Overlap,
    Refused,
    State,
    Touch,
    contacts_of,
    deepest_overlaps,
    limit_share,
    meeting,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from numpy.typing import NDArray

    from wsgen.model.world import World
    from wsgen.simulation.engine import Motor, Place, Points
    from wsgen.simulation.scene import SpawnedRobot


error: type[Exception] = pybullet.error


class Client:
    """A world in PyBullet without a window.

    An attribute is PyBullet's function of that name for this world, or its constant.
    """

    def __init__(self) -> None:
        # Making a world costs as much as 300 steps of a robot; an emptied one is as good as new.
        self.number: int = _kept()
        self._give_back = weakref.finalize(self, _empty, self.number)
        self._give_back.atexit = False

    def __getattr__(self, name: str) -> Any:
        found = getattr(pybullet, name)
        if callable(found):
            found = partial(found, physicsClientId=self.number)
        setattr(self, name, found)  # the next time it is there at once
        return found

    @staticmethod
    def calculate(name: str) -> Callable[..., Any]:
        """A function of PyBullet that has nothing to do with a world."""
        function: Callable[..., Any] = getattr(pybullet, name)
        return function

    def close(self) -> None:
        """Give the world back, now instead of with the last reference; may be called again."""
        self._give_back()


_emptied: list[int] = []  # worlds that nobody has, at most one


def _kept() -> int:
    """An emptied world, or a new one."""
    if not _emptied:
        return int(pybullet.connect(pybullet.DIRECT))
    number = _emptied.pop()
    # PyBullet's functions have a default world, which this one may be: what other code in the
    # process put there is not ours.
    pybullet.resetSimulation(physicsClientId=number)
    return number


def _empty(number: int) -> None:
    """Empty a world, and keep it for the next client if no other one is kept."""
    with suppress(error):
        if not _emptied:
            pybullet.resetSimulation(physicsClientId=number)
            _emptied.append(number)
            return
    with suppress(error):
        pybullet.disconnect(physicsClientId=number)


# A box, because a plane of PyBullet has no thickness and lets fast things through.
GROUND_SIZE = (1000.0, 1000.0, 10.0)  # m
GROUND = Robot(
    name="ground",
    root="ground",
    links=(Link(name="ground", collisions=(Collision(geometry=Box(size=GROUND_SIZE)),)),),
    fixed_to_world=True,
)
# Heights are measured from another such box, which nothing touches: of what is in the ground
# PyBullet knows how far out of it the way is, not how deep its lowest point is.
PLUMB = -11.0  # m, z of its upper side

# What stands flat lands on one point at first, because PyBullet finds a cylinder's contacts with
# the ground one a step. After a fall of several meters that gives it a push: a flat cylinder that
# falls 5 m ends up 0.2 m aside, in DART, Gazebo's engine, under where it was spawned. No setting
# of PyBullet's fixes it for all heights; where a robot lies after a fall is not to be believed.

# How much of an overlap the contact solver removes in one step (PyBullet's default), and how fast
# two bodies may be pushed apart by that. PyBullet has no such bound: out of an overlap of 0.25 m it
# shoots a robot 20 m high. Gazebo's engines have one (max_vel of ODE, the largest error reduction
# velocity of DART). At this speed a robot leaves the ground with a hop of 3 mm, and 0.6 m of
# overlap are gone within the usual simulation.
OVERLAP_SHARE = 0.08
SEPARATION_SPEED = 0.25  # m/s
SEPARATION_FROM_TRIANGLES = 0.05  # m/s; their edges push in several directions at once
SEPARATION_STRIDE = 10  # steps between two looks at the overlap while it is large

STILL = (0.0, 0.0, 0.0)
MOST_SPHERES = 8  # that a ray begins in
BEYOND = 1e-9  # of a ray's way, behind a sphere that it begins in
MOST_RAYS = 16_000  # at a time; PyBullet takes a few more
FAR = 100.0  # m; no robot is as large


class BulletEngine:
    """A world in PyBullet, without a window."""

    def __init__(self, world: World) -> None:
        self.step_seconds = world.step
        self.client = Client()
        self._world = world
        self._gravity = world.gravity
        self._robots: dict[str, Robot] = {}
        self._bodies: dict[str, list[tuple[BulletBody, Pose]]] = {}  # with its pose in the robot
        self._pulled: list[BulletBody] = []
        self._damped: list[BulletBody] = []
        self._pushes: dict[tuple[str, str], Vector] = {}  # N, by entity and link
        self._triangles: set[int] = set()  # bodies that collide as the triangles of their meshes
        self._has_stepped = False  # since something was placed
        self._ground_friction: float | None = None  # None: there is no ground
        # Alike but for their friction along y and x; see `stand_on`.
        self._grounds: dict[tuple[float, float], int] = {}
        self._plumb: int | None = None
        self._separating = True  # there may be overlaps: something is new where it is
        self.client.setGravity(*world.gravity)
        self.client.setPhysicsEngineParameter(
            fixedTimeStep=world.step,
            # Without this a second robot from the same path would be the first one again.
            enableFileCaching=0,
            # The same scene must give the same simulation on every run.
            deterministicOverlappingPairs=1,
            # Friction along each of two directions by itself, as in DART and ODE. With the cone,
            # what stands still across keeps wheels that slip from pulling: robots with four wheels
            # turn by half as much as in Gazebo.
            enableConeFriction=0,
        )
        if world.has_ground_plane:
            self._ground_friction = world.ground_friction
            self._ground_of((min(1.0, world.ground_friction),) * 2)
            self._plumb = self._add_plumb()

    def _put_on_ground(self, entity: str) -> None:
        """Have the grounds that a robot needs; a new one concerns all that are there."""
        if self._ground_friction is None:
            return
        count = len(self._grounds)
        for body, _ in self._bodies[entity]:
            for friction in body.grounds_below(self._ground_friction).values():
                self._ground_of(friction)
        entities = [entity] if len(self._grounds) == count else list(self._bodies)
        for body in (body for one in entities for body, _ in self._bodies[one]):
            body.stand_on(self._grounds, self._ground_friction)

    def _ground_of(self, friction: tuple[float, float]) -> None:
        if friction not in self._grounds:
            ground = load(self.client, GROUND, Pose(xyz=(0.0, 0.0, -GROUND_SIZE[2] / 2)))
            along_y, along_x = friction
            most = max(friction)
            self.client.changeDynamics(ground, ROOT, lateralFriction=most)
            if along_y != along_x:
                shares = (along_x / most, along_y / most, 1.0)
                self.client.changeDynamics(ground, ROOT, anisotropicFriction=shares)
            self._grounds[friction] = ground

    def _add_plumb(self) -> int:
        plumb = load(self.client, GROUND, Pose(xyz=(0.0, 0.0, PLUMB - GROUND_SIZE[2] / 2)))
        self.client.setCollisionFilterGroupMask(plumb, ROOT, 0, 0)
        return plumb

    def spawn(self, robot: SpawnedRobot) -> Loaded | Refused:
        """Put a robot into the world, at rest, its joints passive."""
        model = robot.robot
        if not model.links:
            return Refused("no link of it has mass")
        parts = most_parts(model)
        if parts > MOST_LINKS:
            return Refused(
                f"it has {parts} links with different friction; PyBullet takes {MOST_LINKS}",
                hint="Install MuJoCo, which has no limit: pip install 'wsgen[mujoco]'",
            )
        bodies: list[tuple[BulletBody, Pose]] = []
        try:
            for tree, pose_in_robot in split_trees(model):
                pose = compose(robot.pose_in_world, pose_in_robot)
                body = BulletBody(self.client, tree, pose, world=self._world)
                bodies.append((body, pose_in_robot))
                unread = body.unread_mesh()
                if unread is not None:
                    raise error(f"it cannot read the mesh {unread}")  # noqa: TRY301  one way out
        except error as problem:
            for body, _ in bodies:
                self.client.removeBody(body.number)
            return Refused(str(problem))
        if any(joint.starts_beyond_limit for joint in model.joints):
            self._push_back_to_limits()
        self._robots[robot.entity] = model
        self._bodies[robot.entity] = bodies
        self._put_on_ground(robot.entity)
        self._separating = True
        if model.is_static and any(_has_mesh(link) for link in model.links):
            self._triangles |= {body.number for body, _ in bodies}
        self._pulled += [body for body, _ in bodies if body.pulls]
        self._damped += [body for body, _ in bodies if body.dampers.indices]
        links = sum(len(body.indices) for body, _ in bodies)
        return Loaded(
            # A root called `world` is a body for PyBullet; in Gazebo it is the world.
            links - 1 if model.fixed_to_world else links,
            sum(len(body.movable) for body, _ in bodies),
            sum(body.mass for body, _ in bodies),
        )

    def _push_back_to_limits(self) -> None:
        """Have joints that are beyond their limits pushed back, as fast as Gazebo does.

        Split impulses are not for multibodies: with them PyBullet leaves such a joint where it is.
        Without them it needs all iterations, or parts with tiny inertias explode.
        """
        self.client.setPhysicsEngineParameter(
            useSplitImpulse=0, erp=limit_share(self._world), solverResidualThreshold=0.0
        )

    def place(self, entity: str, pose_in_world: Pose) -> None:
        """Put a robot elsewhere, as if it had been spawned there."""
        for body, pose_in_robot in self._bodies[entity]:
            body.place(compose(pose_in_world, pose_in_robot))
        self._separating, self._has_stepped = True, False

    def remove(self, entity: str) -> None:
        """Take a robot out of the world; its name may be used again."""
        del self._robots[entity]
        removed = [body for body, _ in self._bodies.pop(entity)]
        for body in removed:
            self.client.removeBody(body.number)
        self._pulled = [body for body in self._pulled if body not in removed]
        self._damped = [body for body in self._damped if body not in removed]
        self._triangles -= {body.number for body in removed}
        self._pushes = {place: one for place, one in self._pushes.items() if place[0] != entity}

    def set_velocity(self, entity: str, linear: Vector, angular: Vector) -> None:
        """Have the root link move and turn like that now, seen from the world: m/s and rad/s."""
        self._bodies[entity][0][0].set_velocity(linear, angular)

    def set_joint_positions(self, entity: str, positions: Mapping[str, float]) -> None:
        """Put joints of a robot there, at rest."""
        for body, _ in self._bodies[entity]:
            body.set_joint_positions(positions)
        self._separating, self._has_stepped = True, False

    def drive(self, entity: str, motors: Mapping[str, Motor]) -> None:
        """Put motors into joints of a robot; those that are not named keep theirs."""
        for body, _ in self._bodies[entity]:
            body.drive(motors)

    def release(self, entity: str) -> None:
        """Take all motors out of a robot: its joints are passive again."""
        for body, _ in self._bodies[entity]:
            body.release()

    def set_efforts(self, entity: str, efforts: Mapping[str, float]) -> None:
        """From now on, have these efforts (N m or N) act in joints, which lose their motors."""
        for body, _ in self._bodies[entity]:
            body.set_efforts(efforts)
            if body.pulls and body not in self._pulled:
                self._pulled.append(body)

    def joint_efforts(self, entity: str) -> dict[str, float]:
        """What acted in the movable joints in the last step, by name, N m or N."""
        return {
            name: effort if self._has_stepped else 0.0
            for body, _ in self._bodies[entity]
            for name, effort in zip(body.movable, body.joint_efforts(), strict=True)
        }

    def joint_wrench(self, entity: str, joint: str) -> tuple[Vector, Vector]:
        """The force and the torque of the parent link on the child link of a joint."""
        for body, _ in self._bodies[entity]:
            wrench = body.joint_wrench(joint)
            if wrench is not None and self._has_stepped:
                return wrench
        return STILL, STILL

    def state(self, entity: str) -> State:
        """Where the robot is and how it moves."""
        return self.look(entity).state()

    def look(self, entity: str) -> Look:
        """The same, as far as it is looked at every few steps."""
        bodies = [body for body, _ in self._bodies[entity]]
        root = bodies[0]
        place = root.place_of_base()
        velocities = [self.client.getBaseVelocity(body.number) for body in bodies]
        speed = max([math.hypot(*linear) for linear, _ in velocities])
        turning = max([math.hypot(*angular) for _, angular in velocities])
        joint_speed = max([body.joint_speed() for body in bodies])
        (x, y, _), turn = place

        def state() -> State:
            pose = root.root_pose_at(place)
            return State(
                xyz=pose.xyz,
                xyzw=quaternion_of_rpy(pose.rpy),
                speed=speed,
                turning=turning,
                joint_speed=joint_speed,
            )

        height = root.root_height_at(place)
        return Look(
            height=height,
            speed=speed,
            turning=turning,
            joint_speed=joint_speed,
            # One sum instead of ten looks: what is not finite in it makes it not finite.
            is_finite=math.isfinite(x + y + height + sum(turn) + speed + turning + joint_speed),
            state=state,
        )

    def joint_positions(self, entity: str) -> dict[str, float]:
        """The positions of the movable joints by name, rad or m."""
        return {
            name: position
            for body, _ in self._bodies[entity]
            for name, (position, _) in zip(body.movable, body.joint_states(), strict=True)
        }

    def joint_velocities(self, entity: str) -> dict[str, float]:
        """The velocities of the movable joints by name, rad/s or m/s."""
        return {
            name: velocity
            for body, _ in self._bodies[entity]
            for name, (_, velocity) in zip(body.movable, body.joint_states(), strict=True)
        }

    def energy(self, entity: str) -> float:
        """Kinetic energy, and potential energy above z = 0 in the world's gravity, J."""
        return sum(body.energy(self._gravity) for body, _ in self._bodies[entity])

    def lowest_point(self, entity: str) -> float:
        """The z of the lowest point that can touch something, m; that of the root without any.

        Over or in the ground it is exact; elsewhere the robot's boxes along the axes decide.
        """
        boxes = [box for body, _ in self._bodies[entity] for box in body.boxes()]
        if not boxes:
            return self.state(entity).xyz[2]
        lowest = min(low[2] for _, _, low, _ in boxes)
        # Of the many triangles of what is static PyBullet finds the nearest late, or another one.
        if (
            self._robots[entity].is_static
            or self._plumb is None
            or not all(map(_is_over_ground, boxes))
        ):
            return lowest
        near = [
            PLUMB + float(point[8])
            for body, _ in self._bodies[entity]
            for point in self.client.getClosestPoints(
                body.number, self._plumb, distance=max(0.0, lowest) + FAR
            )
        ]
        # A mesh file without points has a box, and is near nothing.
        return min(near, default=lowest)

    def corners(self, entity: str) -> list[Vector]:
        """Corners of boxes along the world's axes around all that can touch something, m."""
        boxes = [box for body, _ in self._bodies[entity] for box in body.boxes()]
        corners = [corner for _, _, low, high in boxes for corner in (low, high)]
        return corners or [self.state(entity).xyz]

    def link_poses(self, entity: str) -> dict[str, Pose]:
        """The frames of all links of a robot by name, seen from the world."""
        return {
            name: pose
            for body, _ in self._bodies[entity]
            for name, pose in body.link_poses().items()
        }

    def link_velocities(self, entity: str) -> dict[str, tuple[Vector, Vector]]:
        """How the links of a robot move, by name, seen from the world: m/s and rad/s."""
        return {
            name: velocity
            for body, _ in self._bodies[entity]
            for name, velocity in body.link_velocities().items()
        }

    def cast_rays(self, starts: Points, ends: Points) -> NDArray[np.float64]:
        """How far rays get through what can touch something: fractions of their ways, shape (n,).

        Meshes of what moves are their convex hulls. The shape that a ray begins in it does not see.
        """
        origins, targets = (np.asarray(points, dtype=np.float64) for points in (starts, ends))
        fractions, at_once = self._hits(origins, targets)
        begun: dict[int, float] = {}  # how far rays have got through spheres that they begin in
        for _ in range(MOST_SPHERES):
            for place, body, link in at_once:
                through = self._through_sphere(body, link, origins[place], targets[place])
                if through > begun.get(place, 0.0):
                    begun[place] = through
                    fractions[place] = math.inf
            left = [place for place, _, _ in at_once if begun.get(place, 1.0) < 1.0]
            if not left:
                break
            shares = np.array([begun[place] for place in left])[:, np.newaxis]
            ways = targets[left] - origins[left]
            found, again = self._hits(origins[left] + shares * ways, targets[left])
            fractions[left] = shares[:, 0] + (1.0 - shares[:, 0]) * found
            at_once = [(left[place], body, link) for place, body, link in again]
        return fractions

    def _hits(
        self, starts: NDArray[np.float64], ends: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], list[tuple[int, int, int]]]:
        """How far rays get, and which of them hit something at once: its body and its link."""
        fractions: list[float] = []
        at_once: list[tuple[int, int, int]] = []
        for place in range(0, len(starts), MOST_RAYS):
            hits = self.client.rayTestBatch(
                starts[place : place + MOST_RAYS], ends[place : place + MOST_RAYS]
            )
            fractions += [hit[2] if hit[0] >= 0 else math.inf for hit in hits]
            at_once += [
                (place + index, hit[0], hit[1])
                for index, hit in enumerate(hits)
                if hit[2] <= 0.0 <= hit[0]
            ]
        return np.array(fractions, dtype=np.float64), at_once

    def _through_sphere(
        self, body: int, link: int, start: NDArray[np.float64], end: NDArray[np.float64]
    ) -> float:
        """Up to which fraction of its way a ray is in spheres of a link that it begins in.

        PyBullet has such a ray hit a sphere at once, if it goes towards the sphere's center.
        """
        client = self.client
        if link < 0:
            center, turn = client.getBasePositionAndOrientation(body)
        else:
            center, turn = client.getLinkState(body, link, computeForwardKinematics=1)[:2]
        way, fraction = end - start, 0.0
        for shape in client.getCollisionShapeData(body, link):
            if shape[2] != client.GEOM_SPHERE:
                continue
            middle, _ = client.multiplyTransforms(center, turn, shape[5], shape[6])
            away = start - np.array(middle)
            a, b, c = way @ way, away @ way, away @ away - shape[3][0] ** 2
            if c <= 0.0 < a:
                fraction = max(fraction, (math.sqrt(b * b - a * c) - b) / a + BEYOND)
        return fraction

    def overlaps(self) -> list[Overlap]:
        """Links in each other, of two robots or of one, whether or not they may collide."""
        return deepest_overlaps(self._found_in_each_other(), self._robots)

    def _found_in_each_other(self) -> Iterator[tuple[Place, Place, float]]:
        """The parts of two links whose boxes meet, with the depth of the deepest contact (m)."""
        boxes = [
            (low, high, ((entity, link), body.number, index))
            for entity, bodies in self._bodies.items()
            for body, _ in bodies
            for link, index, low, high in body.boxes()
        ]
        for (place, body, index), (other_place, other_body, other_index) in meeting(boxes):
            if place != other_place:
                near = self.client.getClosestPoints(body, other_body, 0.0, index, other_index)
                yield place, other_place, max((-point[8] for point in near), default=0.0)

    def hull_gaps(self, entity: str) -> list[HullGap]:
        """Where a robot touches something with the convex hulls of its meshes alone, right now."""
        if self._robots[entity].is_static:
            return []  # collides with its triangles
        others = {
            body.number: other for other, bodies in self._bodies.items() for body, _ in bodies
        }
        touched = [
            (body.link_of(contact[3]), others[contact[2]], tuple(contact[5]))
            for body, _ in self._bodies[entity]
            for contact in self.client.getContactPoints(bodyA=body.number)
            if contact[2] in others and contact[9] > 0  # presses on it
        ]
        return surfaces.hull_gaps(self._robots[entity], self.link_poses(entity), touched)

    def advance(self, steps: int) -> None:
        """Let time pass; overlapping bodies are pushed apart no faster than the bound."""
        while steps > 0:
            now = steps
            if self._separating:
                now = min(SEPARATION_STRIDE, steps)
                self._bound_separation()
            if self._damped:
                now = min(DAMPER_STRIDE, now)
                for body in self._damped:
                    body.damp()
            for _ in range(now):
                for body in self._pulled:
                    body.pull(self._gravity)
                for (entity, link), force in self._pushes.items():
                    for body, _ in self._bodies[entity]:
                        body.push(link, force)
                self.client.stepSimulation()
            steps -= now
            self._has_stepped = True

    def push(self, entity: str, link: str, force: Vector) -> None:
        """From now on, have a force (N, in the world) act on a link at its center of mass."""
        self._pushes.pop((entity, link), None)
        if any(force):
            self._pushes[entity, link] = force

    def contacts(self, entity: str) -> list[Contact]:
        """What a robot touched in the last step."""
        if not self._has_stepped:
            return []
        places = {
            (body.number, index): (other, link)
            for other, bodies in self._bodies.items()
            for body, _ in bodies
            for link, index in body.part_indices()
        }
        return contacts_of(
            entity,
            (
                Touch(
                    places.get((contact[1], contact[3])),
                    places.get((contact[2], contact[4])),
                    contact[5],
                    max(0.0, contact[9]),
                    contact[7],
                    max(0.0, -contact[8]),
                )
                for contact in self.client.getContactPoints()
                # PyBullet keeps points that are about to touch.
                if contact[8] <= TOUCHING or contact[9] > 0
            ),
        )

    def _bound_separation(self) -> None:
        """Let the solver remove so much of the deepest overlap that the bound is kept.

        The overlap shrinks until the next look, so the speed is below the bound in between.
        """
        self.client.performCollisionDetection()
        contacts = self.client.getContactPoints()
        depth = max((-contact[8] for contact in contacts), default=0.0)
        self._separating = depth * OVERLAP_SHARE > SEPARATION_SPEED * self.step_seconds
        is_in_triangles = any(not self._triangles.isdisjoint(contact[1:3]) for contact in contacts)
        speed = SEPARATION_FROM_TRIANGLES if is_in_triangles else SEPARATION_SPEED
        share = speed * self.step_seconds / depth if self._separating else OVERLAP_SHARE
        self.client.setPhysicsEngineParameter(contactERP=share)  # of what has no springs
        for bodies in self._bodies.values():
            for body, _ in bodies:
                body.soften_contacts(share)

    def close(self) -> None:
        """Give everything back; the engine is not used afterwards."""
        self.client.close()


def _has_mesh(link: Link) -> bool:
    return any(isinstance(shape.geometry, Mesh) for shape in link.collisions)


def _is_over_ground(box: PartBounds) -> bool:
    """Whether the ground's upper side is what is nearest to it."""
    _, _, low, high = box
    x, y, depth = (size / 2 for size in GROUND_SIZE)
    return -x < low[0] and high[0] < x and -y < low[1] and high[1] < y and low[2] > -depth
