"""The DART engine: the one that Gazebo Sim uses, with Gazebo's settings."""

from __future__ import annotations

import math
from itertools import combinations
from typing import TYPE_CHECKING, Any

from wsgen.model.pose import Pose
from wsgen.model.transform import quaternion_of_rpy
from wsgen.simulation.dart_body import DartBody, add_shape, corners_of, matrix_of, pose_of
from wsgen.simulation.dart_library import collision, dynamics, simulation
from wsgen.simulation.engine import GROUND_FRICTION, HullGap, Loaded, Overlap, Refused, State
from wsgen.simulation.extents import lowest_point
from wsgen.simulation.pairs import deepest_overlaps, may_touch

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.model.transform import Vector
    from wsgen.model.world import World
    from wsgen.simulation.engine import Motor
    from wsgen.simulation.scene import SpawnedRobot

# A large box, as Gazebo makes of a plane.
GROUND_SIZE = (1000.0, 1000.0, 10.0)  # m

MOST_CONTACTS = 10_000  # of a search for overlaps; no robot has as many shapes in each other
BISECTIONS = 40  # of the height at which a mesh begins; from 1 km they lead to 1e-9 m


class DartEngine:
    """A world in DART."""

    def __init__(self, world: World) -> None:
        self.step_seconds = world.step
        self._robots: dict[str, DartBody] = {}
        self._driven: dict[str, DartBody] = {}  # those with motors
        self._world = simulation.World()
        self._world.setTimeStep(world.step)
        self._world.setGravity(world.gravity)
        # The detector that Gazebo takes; DART's own knows fewer shapes.
        self._detector = collision.OdeCollisionDetector()
        self._world.getConstraintSolver().setCollisionDetector(self._detector)
        # Gazebo puts nothing to sleep: what tips slowly must go on tipping.
        sleep = self._world.getDeactivationOptions()
        sleep.mEnabled = False
        self._world.setDeactivationOptions(sleep)
        if world.has_ground_plane:
            self._add_ground()

    def _add_ground(self) -> None:
        skeleton = dynamics.Skeleton("ground")
        joint, body = skeleton.createWeldJointAndBodyNodePair()
        joint.setTransformFromParentBodyNode(matrix_of(Pose(xyz=(0, 0, -GROUND_SIZE[2] / 2))))
        add_shape(body, dynamics.BoxShape(GROUND_SIZE), GROUND_FRICTION, "ground")
        skeleton.setMobile(False)
        self._world.addSkeleton(skeleton)

    def spawn(self, robot: SpawnedRobot) -> Loaded | Refused:
        """Put a robot into the world, at rest, its joints passive."""
        model = robot.robot
        if not model.links:
            return Refused("nothing of it has mass")
        body = DartBody(model, robot.pose_in_world, robot.entity)
        if body.unread:
            return Refused(f"it cannot read the mesh {body.unread[0]}")
        self._world.addSkeleton(body.skeleton)
        self._keep_apart(body)
        self._robots[robot.entity] = body
        if len(self._robots) > 1 or body.skeleton.isEnabledSelfCollisionCheck():
            for one in self._robots.values():
                one.touch_with_all()
        return Loaded(len(body.nodes), len(body.joints), float(body.skeleton.getMass()))

    def _keep_apart(self, body: DartBody) -> None:
        """Let only such links touch each other as Gazebo was told to let touch."""
        if not body.skeleton.isEnabledSelfCollisionCheck():
            return
        touching = may_touch(body.robot)
        apart = self._world.getConstraintSolver().getCollisionOption().collisionFilter
        for one, other in combinations(body.nodes, 2):
            if frozenset((one, other)) not in touching:
                apart.addBodyNodePairToBlackList(body.nodes[one], body.nodes[other])

    def place(self, entity: str, pose_in_world: Pose) -> None:
        """Put a robot elsewhere, as if it had been spawned there."""
        self._robots[entity].place(pose_in_world)

    def drive(self, entity: str, motors: Mapping[str, Motor]) -> None:
        """Put motors into joints of a robot; those that are not named keep theirs."""
        self._driven[entity] = self._robots[entity]
        self._driven[entity].drive(motors)

    def release(self, entity: str) -> None:
        """Take all motors out of a robot: its joints are passive again."""
        self._robots[entity].release()
        self._driven.pop(entity, None)

    def state(self, entity: str) -> State:
        """Where the robot is and how it moves."""
        body = self._robots[entity]
        pose = body.link_pose(body.robot.root)
        roots = body.loose_nodes  # none of a root that is the world
        return State(
            xyz=pose.xyz,
            xyzw=quaternion_of_rpy(pose.rpy),
            speed=max(
                (math.hypot(*node.getCOMLinearVelocity().tolist()) for node in roots), default=0.0
            ),
            turning=max(
                (math.hypot(*node.getAngularVelocity().tolist()) for node in roots), default=0.0
            ),
            joint_speed=max(
                (abs(float(joint.getVelocity(0))) for joint in body.joints.values()), default=0.0
            ),
        )

    def joint_positions(self, entity: str) -> dict[str, float]:
        """The positions of the movable joints by name, rad or m."""
        joints = self._robots[entity].joints
        return {name: float(joint.getPosition(0)) for name, joint in joints.items()}

    def energy(self, entity: str) -> float:
        """Kinetic energy, and potential energy above z = 0 in the world's gravity, J."""
        body = self._robots[entity]
        energy = body.skeleton.computeKineticEnergy() + body.skeleton.computePotentialEnergy()
        # DART counts the weight also of what it lets float.
        for link in body.robot.links:
            if not link.gravity and link.name in body.nodes:
                energy -= body.nodes[link.name].computePotentialEnergy(self._world.getGravity())
        return float(energy)

    def lowest_point(self, entity: str) -> float:
        """The z of the lowest point that can touch something, m; that of the root without any."""
        lowest = []
        for _, geometry, frame in self._robots[entity].shapes:
            z = lowest_point(geometry, pose_of(frame))
            lowest.append(self._lowest_of_mesh(frame) if z is None else z)
        return min(lowest, default=self.state(entity).xyz[2])

    def _lowest_of_mesh(self, frame: Any) -> float:
        """Where a box that comes up from below first meets it: DART does not give its points."""
        corners = corners_of(frame)
        low, high = (pick(z for _, _, z in corners) for pick in (min, max))
        edge = 4 * max(math.dist(corners[0], corners[-1]), 1e-3)  # it holds all of the mesh
        x, y, _ = corners[0]
        probe = dynamics.SimpleFrame(dynamics.Frame.World())
        probe.setShape(dynamics.BoxShape((edge, edge, edge)))
        group, other = self._detector.createCollisionGroup(), self._detector.createCollisionGroup()
        group.addShapeFrame(frame)
        other.addShapeFrame(probe)
        option = collision.CollisionOption(False, 1)
        for _ in range(BISECTIONS):
            middle = (low + high) / 2
            probe.setRelativeTransform(matrix_of(Pose(xyz=(x, y, middle - edge / 2))))
            if group.collide(other, option):
                high = middle
            else:
                low = middle
        return high

    def corners(self, entity: str) -> list[Vector]:
        """Corners of boxes along the world's axes around all that can touch something, m."""
        shapes = self._robots[entity].shapes
        boxes = [corner for _, _, frame in shapes for corner in corners_of(frame)]
        return boxes or [self.state(entity).xyz]

    def link_poses(self, entity: str) -> dict[str, Pose]:
        """The frames of all links of a robot by name, seen from the world."""
        body = self._robots[entity]
        return {link.name: body.link_pose(link.name) for link in body.robot.links}

    def overlaps(self) -> list[Overlap]:
        """Links in each other, of two robots or of one, whether or not they may collide."""
        group = self._detector.createCollisionGroup()
        place: dict[str, tuple[str, str]] = {}
        for entity, body in self._robots.items():
            for link, _, frame in body.shapes:
                group.addShapeFrame(frame)
                place[frame.getName()] = (entity, link)
        result = collision.CollisionResult()
        group.collide(collision.CollisionOption(True, MOST_CONTACTS), result)
        found = (
            (
                place[contact.collisionObject1.getShapeFrame().getName()],
                place[contact.collisionObject2.getShapeFrame().getName()],
                float(contact.penetrationDepth),
            )
            for contact in result.getContacts()
        )
        robots = {entity: body.robot for entity, body in self._robots.items()}
        return deepest_overlaps(found, robots)

    def hull_gaps(self, entity: str) -> list[HullGap]:  # noqa: ARG002  of no robot
        """None: DART collides triangles."""
        return []

    def advance(self, steps: int) -> None:
        """Let time pass."""
        for _ in range(steps):
            for body in self._driven.values():
                body.command()
            self._world.step()

    def close(self) -> None:
        """Nothing: the world goes with its last reference."""
