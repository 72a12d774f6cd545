"""The PyBullet engine, set up so that it does what Gazebo's physics does."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import pybullet

from wsgen.model.pose import Pose
from wsgen.model.transform import (
    compose,
    quaternion_of_rpy,
    rotation_of_quaternion,
    rpy_of_rotation,
)
from wsgen.simulation.engine import Loaded, Refused, State
from wsgen.simulation.urdf_writer import write_urdf

if TYPE_CHECKING:
    from wsgen.model.robot import Link, Robot, Visual
    from wsgen.model.transform import Vector
    from wsgen.model.world import World
    from wsgen.simulation.scene import SpawnedRobot

# MAX_DEGREE_OF_FREEDOM in PyBullet's SharedMemoryCommands.h; with more, reading a pose raises.
MOST_LINKS = 128

# Inertias come from the description, not from the collision shapes. Cylinders are exact: as
# polyhedra of 32 faces wheels do not roll and everything stands 1 mm higher. Gazebo lumps before
# and so do we: PyBullet's own merging of fixed links loses masses and turns inertias. Keeping the
# order of the links ends with SIGSEGV when a child is written before its parent.
LOAD_FLAGS = pybullet.URDF_USE_INERTIA_FROM_FILE | pybullet.URDF_USE_IMPLICIT_CYLINDER

# A box, because a plane of PyBullet has no thickness and lets fast things through.
GROUND_HALF_EXTENTS = (500.0, 500.0, 5.0)  # m

# What stands flat lands on one point at first, because PyBullet finds a cylinder's contacts with
# the ground one a step. After a fall of several metres that gives it a push: a flat cylinder that
# falls 5 m ends up 0.2 m aside, in DART, Gazebo's engine, under where it was spawned. No setting
# of PyBullet's mends it for all heights; where a robot lies after a fall is not to be believed.

# Gazebo's engine takes the smaller friction of two touching bodies, PyBullet the product: with 1
# on the ground the product is the robot's own, which the ground's 1 must not exceed.
GROUND_FRICTION = 1.0

# Gazebo damps neither links nor joints unless told so; PyBullet damps links by 0.04 a second.
LINK_DAMPING = 0.0

# Gazebo has no speed limit for passive joints; PyBullet stops them at 100 rad/s.
HIGHEST_JOINT_SPEED = 1e6

# How much of an overlap the contact solver removes in one step (PyBullet's default), and how fast
# two bodies may be pushed apart by that. PyBullet has no such bound: out of an overlap of 0.25 m it
# shoots a robot 20 m high. Gazebo's engines have one (max_vel of ODE, the largest error reduction
# velocity of DART). At this speed a robot leaves the ground with a hop of 3 mm, and 0.6 m of
# overlap are gone within the usual trial.
OVERLAP_SHARE = 0.08
SEPARATION_SPEED = 0.25  # m/s
SEPARATION_STRIDE = 10  # steps between two looks at the overlap while it is large


class BulletEngine:
    """A world in PyBullet, without a window."""

    def __init__(self, world: World) -> None:
        self.step_seconds = world.step
        self._client = pybullet.connect(pybullet.DIRECT)
        self._bodies: dict[str, int] = {}
        self._robots: dict[str, SpawnedRobot] = {}
        self._movable: dict[str, list[int]] = {}
        self._ground: int | None = None
        self._separating = True  # no step has been made yet: there may be overlaps
        pybullet.setGravity(*world.gravity, physicsClientId=self._client)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=world.step,
            # Without this a second robot from the same path would be the first one again.
            enableFileCaching=0,
            # The same scene must give the same trial on every run.
            deterministicOverlappingPairs=1,
            physicsClientId=self._client,
        )
        if world.has_ground_plane:
            self._ground = self._add_ground()

    def _add_ground(self) -> int:
        shape = pybullet.createCollisionShape(
            pybullet.GEOM_BOX, halfExtents=GROUND_HALF_EXTENTS, physicsClientId=self._client
        )
        ground = pybullet.createMultiBody(
            baseMass=0,
            baseCollisionShapeIndex=shape,
            basePosition=(0, 0, -GROUND_HALF_EXTENTS[2]),
            physicsClientId=self._client,
        )
        pybullet.changeDynamics(
            ground, -1, lateralFriction=GROUND_FRICTION, physicsClientId=self._client
        )
        return int(ground)

    def spawn(self, robot: SpawnedRobot) -> Loaded | Refused:
        """Put a robot into the world, at rest, its joints passive."""
        model = robot.robot
        if not model.links:
            return Refused("nothing of it has mass")
        if len(model.links) > MOST_LINKS:
            return Refused(f"it has {len(model.links)} links, PyBullet can do {MOST_LINKS}")
        with tempfile.TemporaryDirectory(prefix="wsgen-") as folder:
            file = Path(folder, "robot.urdf")
            file.write_text(write_urdf(model), encoding="utf-8")
            try:
                body = pybullet.loadURDF(
                    str(file),
                    basePosition=robot.pose_in_world.xyz,
                    baseOrientation=quaternion_of_rpy(robot.pose_in_world.rpy),
                    useFixedBase=model.fixed_to_world,
                    flags=_flags(model),
                    physicsClientId=self._client,
                )
            except pybullet.error as error:
                return Refused(str(error))
        self._bodies[robot.entity] = body
        self._robots[robot.entity] = robot
        self._movable[robot.entity] = self._release(body, model)
        return self._loaded(robot.entity)

    def _release(self, body: int, model: Robot) -> list[int]:
        """Give links and joints Gazebo's properties; gives the indices of the movable joints."""
        links = {link.name: link for link in model.links}
        joints = {joint.name: joint for joint in model.joints}
        movable = []
        self._set_dynamics(body, -1, links[model.root])
        for index in range(pybullet.getNumJoints(body, physicsClientId=self._client)):
            info = pybullet.getJointInfo(body, index, physicsClientId=self._client)
            joint = joints[info[1].decode()]
            self._set_dynamics(body, index, links[joint.child])
            if info[2] == pybullet.JOINT_FIXED:
                continue
            movable.append(index)
            # PyBullet puts a motor into every joint that holds it. Only friction may.
            pybullet.setJointMotorControl2(
                body,
                index,
                pybullet.VELOCITY_CONTROL,
                force=joint.friction,
                physicsClientId=self._client,
            )
        return movable

    def _set_dynamics(self, body: int, index: int, link: Link) -> None:
        pybullet.changeDynamics(
            body,
            index,
            lateralFriction=_friction(link),
            linearDamping=LINK_DAMPING,
            angularDamping=LINK_DAMPING,
            maxJointVelocity=HIGHEST_JOINT_SPEED,
            physicsClientId=self._client,
        )

    def _loaded(self, entity: str) -> Loaded:
        body, model = self._bodies[entity], self._robots[entity].robot
        count = pybullet.getNumJoints(body, physicsClientId=self._client)
        mass = sum(
            pybullet.getDynamicsInfo(body, index, physicsClientId=self._client)[0]
            for index in range(-1, count)
        )
        # A root called `world` is a body for PyBullet; in Gazebo it is the world.
        links = count if model.fixed_to_world else count + 1
        return Loaded(links, len(self._movable[entity]), mass)

    def state(self, entity: str) -> State:
        """Where the robot is and how it moves."""
        body = self._bodies[entity]
        xyz, xyzw = pybullet.getBasePositionAndOrientation(body, physicsClientId=self._client)
        linear, angular = pybullet.getBaseVelocity(body, physicsClientId=self._client)
        # PyBullet's base is the frame at the centre of mass along the principal axes.
        dynamics = pybullet.getDynamicsInfo(body, -1, physicsClientId=self._client)
        xyz, xyzw = pybullet.multiplyTransforms(
            xyz, xyzw, *pybullet.invertTransform(dynamics[3], dynamics[4])
        )
        joints = self._movable[entity]
        moving = (
            pybullet.getJointStates(body, joints, physicsClientId=self._client) if joints else ()
        )
        return State(
            xyz=xyz,
            xyzw=xyzw,
            speed=math.hypot(*linear),
            turning=math.hypot(*angular),
            joint_speed=max((abs(joint[1]) for joint in moving), default=0.0),
        )

    def lowest_point(self, entity: str) -> float:
        """The z of the lowest point that can touch something, m; that of the root without any.

        Over or in the ground it is exact; elsewhere the robot's boxes along the world's axes tell.
        """
        body = self._bodies[entity]
        root = self.state(entity).xyz[2]
        if self._ground is not None:
            near = pybullet.getClosestPoints(
                body, self._ground, distance=abs(root) + 100.0, physicsClientId=self._client
            )
            if near:
                return float(min(point[8] for point in near))
        return min(corner[2] for corner in self._corners(entity))

    def _corners(self, entity: str) -> list[Vector]:
        """Corners of boxes along the world's axes around everything that can touch."""
        body, links = self._bodies[entity], self._robots[entity].robot.links
        corners = [self.state(entity).xyz]
        for index in range(-1, pybullet.getNumJoints(body, physicsClientId=self._client)):
            corners += pybullet.getAABB(body, index, physicsClientId=self._client)
        return corners if any(link.collisions for link in links) else corners[:1]

    def _link_poses(self, entity: str) -> dict[str, Pose]:
        """The frames of all links, by name, seen from the world."""
        body, robot = self._bodies[entity], self._robots[entity].robot
        state = self.state(entity)
        poses = {robot.root: _pose(state.xyz, state.xyzw)}
        for index in range(pybullet.getNumJoints(body, physicsClientId=self._client)):
            name = pybullet.getJointInfo(body, index, physicsClientId=self._client)[12].decode()
            link = pybullet.getLinkState(
                body, index, computeForwardKinematics=1, physicsClientId=self._client
            )
            poses[name] = _pose(link[4], link[5])
        return poses

    def advance(self, steps: int) -> None:
        """Let time pass; overlapping bodies are pushed apart no faster than the bound."""
        while steps > 0:
            now = steps
            if self._separating:
                now = min(SEPARATION_STRIDE, steps)
                self._bound_separation()
            for _ in range(now):
                pybullet.stepSimulation(physicsClientId=self._client)
            steps -= now

    def _bound_separation(self) -> None:
        """Let the solver remove so much of the deepest overlap that the bound is kept.

        The overlap shrinks until the next look, so the speed is below the bound in between.
        """
        pybullet.performCollisionDetection(physicsClientId=self._client)
        contacts = pybullet.getContactPoints(physicsClientId=self._client)
        depth = max((-contact[8] for contact in contacts), default=0.0)
        bounded = SEPARATION_SPEED * self.step_seconds
        self._separating = depth * OVERLAP_SHARE > bounded
        pybullet.setPhysicsEngineParameter(
            contactERP=bounded / depth if self._separating else OVERLAP_SHARE,
            physicsClientId=self._client,
        )

    def draw(self, file: Path) -> float:
        """Write a PNG in which all robots are seen; gives the edge of the ground's squares, m."""
        # NumPy's and Pillow's loading would cost every trial as much as its simulation does.
        from wsgen.simulation import bullet_studio  # noqa: PLC0415

        seen: list[tuple[Visual, Pose]] = []
        corners: list[Vector] = []
        for entity, robot in self._robots.items():
            corners += self._corners(entity)
            for link, pose in self._link_poses(entity).items():
                seen += [
                    (visual, compose(pose, visual.pose_in_link))
                    for visual in robot.robot.link(link).visuals
                ]
        return bullet_studio.draw(pybullet, seen, corners, file)

    def close(self) -> None:
        """Give everything back; the engine is not used afterwards."""
        pybullet.disconnect(physicsClientId=self._client)


def _pose(xyz: Vector, xyzw: tuple[float, float, float, float]) -> Pose:
    return Pose(xyz=xyz, rpy=rpy_of_rotation(rotation_of_quaternion(xyzw)))


def _flags(robot: Robot) -> int:
    """Links of one robot touch each other only where Gazebo was told so."""
    collide = any(link.self_collide for link in robot.links)
    return int(LOAD_FLAGS | (pybullet.URDF_USE_SELF_COLLISION if collide else 0))


def _friction(link: Link) -> float:
    """The friction of a link; PyBullet has one for all of its shapes.

    Where shapes differ, the smallest counts: it is a caster's, lumped into the chassis, and the
    caster is what touches the ground.
    """
    return min((GROUND_FRICTION, *(shape.surface.mu1 for shape in link.collisions)))
