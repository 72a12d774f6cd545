"""The DART engine, which Gazebo Sim uses, with Gazebo's settings; no other module imports DART."""

from __future__ import annotations

import math
from itertools import combinations
from typing import TYPE_CHECKING, Any

import dartpy
import numpy as np
from dartpy import dynamics, simulation, utils
from dartpy.math import Isometry3

from wsgen.model.inertia import about_link_axes, made_possible
from wsgen.model.kinematics import split_trees
from wsgen.model.robot import Box, Capsule, Cylinder, JointType, Mesh, Sphere, by_parent
from wsgen.model.transform import (
    IDENTITY,
    Pose,
    compose,
    quaternion_of_rpy,
    rotate,
    rotation_of_rpy,
    rpy_of_rotation,
)
from wsgen.simulation import surfaces
from wsgen.simulation.contact_shapes import inner_collisions
from wsgen.simulation.engine import (
    Contact,
    HullGap,
    Loaded,
    Overlap,
    Refused,
    State,
    Touch,
    contacts_of,
    decays,
    deepest_overlaps,
    look_at,
    may_touch,
)
from wsgen.simulation.urdf_writer import quoted

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from wsgen.model.robot import Collision, Geometry, Inertial, Joint, Link, Robot
    from wsgen.model.transform import Vector
    from wsgen.model.world import World
    from wsgen.simulation.engine import Look, Motor, Points
    from wsgen.simulation.scene import SpawnedRobot


# DART makes shapes of mesh files only where it reads a robot from text.
MESH_ROBOT = (
    '<robot name="mesh"><link name="mesh"><inertial><mass value="1"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    "<collision><geometry><mesh filename={file} scale={scale}/></geometry></collision>"
    "</link></robot>"
)


# m from the origin along an axis: ODE, which finds the contacts, ends the process about 2e8 m away.
FARTHEST = 1e7

# Of the shapes that collide only where a robot is not alone, by that of the shape that is measured.
TOUCHING_NAME = "{} touching"


class DartBody:
    """All trees of a robot in one skeleton; poses are those of its root link's frame."""

    def __init__(self, robot: Robot, pose_in_world: Pose, entity: str) -> None:
        self.robot = robot
        self.skeleton = dynamics.Skeleton(entity)
        self.nodes: dict[str, Any] = {}  # by link name
        self._inner: list[tuple[str, Collision, Any]] = []  # what level ground need not touch
        self._touches_with_all = False
        self.joints: dict[str, Any] = {}  # the movable ones, by name
        self._shapes: list[tuple[str, Any]] = []  # with the names of their links
        self.unread: list[str] = []  # mesh files
        self.loose_nodes: list[Any] = []  # the root of every tree that is not fixed
        self._bases: list[tuple[Any, Pose]] = []  # of what is not fixed, with its pose in the robot
        self._pose_of_world = IDENTITY  # seen from the world, of a root that is the world
        self._speeds: dict[str, float] = {}  # rad/s or m/s, of the motors, by joint
        self._efforts: dict[str, float] = {}  # N m or N, by joint
        self.decays: dict[str, tuple[float, float]] = {}  # see `engine.decays`
        self._held: set[str] = set()  # joints that stay where they are, unless they are driven
        self._fixed: list[tuple[Any, Pose]] = []  # of what is fixed to the world, likewise
        for tree, pose_in_robot in split_trees(robot):
            self._add_tree(tree, pose_in_robot)
        if robot.is_static:
            self.skeleton.setMobile(False)
            self.joints.clear()
        elif any(link.self_collide for link in robot.links):
            self.skeleton.enableSelfCollisionCheck()  # links that a joint joins are left out
        self.place(pose_in_world)

    def _add_tree(self, tree: Robot, pose_in_robot: Pose) -> None:
        links = {link.name: link for link in tree.links}
        below = by_parent(tree.joints)
        if not tree.fixed_to_world:
            base, node = self.skeleton.createFreeJointAndBodyNodePair()
            self._bases.append((base, pose_in_robot))
            self.loose_nodes.append(node)
            self._fill(node, links[tree.root])
        queue = [tree.root]
        for parent in queue:
            for joint in below.get(parent, ()):
                is_first = tree.fixed_to_world and parent == tree.root
                made, node = self._add_joint(joint, None if is_first else self.nodes[parent])
                if is_first:
                    self._fixed.append((made, joint.pose_in_parent))
                self._fill(node, links[joint.child])
                queue.append(joint.child)

    def _add_joint(self, joint: Joint, parent: Any) -> tuple[Any, Any]:
        """A joint below a body, or below the world."""
        create = {
            JointType.FIXED: self.skeleton.createWeldJointAndBodyNodePair,
            JointType.PRISMATIC: self.skeleton.createPrismaticJointAndBodyNodePair,
            JointType.BALL: self.skeleton.createBallJointAndBodyNodePair,
        }.get(joint.type, self.skeleton.createRevoluteJointAndBodyNodePair)
        made, node = create() if parent is None else create(parent)
        made.setTransformFromParentBodyNode(matrix_of(joint.pose_in_parent))
        if joint.type is JointType.FIXED:
            return made, node
        self.joints[joint.name] = made
        if joint.type is JointType.BALL:
            return made, node
        made.setAxis(joint.axis_in_joint)
        made.setDampingCoefficient(0, joint.damping)
        made.setCoulombFriction(0, joint.friction)
        made.setSpringStiffness(0, joint.spring_stiffness)
        made.setRestPosition(0, joint.spring_reference)
        if joint.is_held:
            made.setActuatorType(dynamics.ActuatorType.SERVO)
            self._held.add(joint.name)
            self._speeds[joint.name] = 0.0
        if joint.limit is not None and joint.type is not JointType.CONTINUOUS:
            made.setPositionLowerLimit(0, joint.limit.lower)
            made.setPositionUpperLimit(0, joint.limit.upper)
            made.setLimitEnforcement(True)
        return made, node

    def _fill(self, node: Any, link: Link) -> None:
        """Give a body the mass and the shapes of a link."""
        self.nodes[link.name] = node
        node.setGravityMode(link.gravity)
        if link.inertial is not None:
            node.setInertia(_inertia_of(link.inertial))
        inner = set() if self.robot.is_static else inner_collisions(link)
        for number, collision in enumerate(link.collisions):
            shape = _shape_of(collision.geometry)
            if shape is None:
                if isinstance(collision.geometry, Mesh) and collision.geometry.path is not None:
                    self.unread.append(collision.geometry.path)
                continue
            if number in inner:
                # Not a part of the body: a thousand that turn with it are a millisecond a step.
                frame = dynamics.SimpleFrame(dynamics.Frame.World(), self._shape_name())
                frame.setShape(shape)
                self._inner.append((link.name, collision, frame))
            else:
                frame = add_shape(node, shape, collision.surface.mu1, self._shape_name())
                frame.setRelativeTransform(matrix_of(collision.pose_in_link))
            self._shapes.append((link.name, frame))

    @property
    def shapes(self) -> list[tuple[str, Any]]:
        """All that can touch something: the names of the links, and the frames in the world."""
        for link, collision, frame in self._inner:
            pose = compose(self.link_pose(link), collision.pose_in_link)
            frame.setRelativeTransform(matrix_of(pose))
        return self._shapes

    def touch_with_all(self) -> None:
        """Let what level ground need not touch collide, too: something else may touch it."""
        if not self._touches_with_all:
            self._touches_with_all = True
            for link, collision, measured in self._inner:
                name = TOUCHING_NAME.format(measured.getName())
                shape, mu = measured.getShape(), collision.surface.mu1
                frame = add_shape(self.nodes[link], shape, mu, name)
                frame.setRelativeTransform(matrix_of(collision.pose_in_link))

    def _shape_name(self) -> str:
        """One that no shape of another robot has."""
        return f"{self.skeleton.getName()} {len(self._shapes)}"

    def place(self, pose_in_world: Pose) -> None:
        """Put it somewhere, at rest, its joints at zero."""
        self.skeleton.resetPositions()
        self.skeleton.resetVelocities()
        for joint, pose in self._fixed:
            joint.setTransformFromParentBodyNode(matrix_of(compose(pose_in_world, pose)))
        for base, pose in self._bases:
            place = matrix_of(compose(pose_in_world, pose))
            base.setPositions(dynamics.FreeJoint.convertToPositions(place))
        self._pose_of_world = pose_in_world

    def is_far(self) -> bool:
        """Whether a link is so far away that its contacts cannot be looked for, or nowhere."""
        places = (node.getWorldTransform().translation().tolist() for node in self.nodes.values())
        return not all(abs(part) < FARTHEST for place in places for part in place)

    def set_velocity(self, linear: Vector, angular: Vector) -> None:
        """Have the root move (m/s, the origin of its frame) and turn (rad/s), in the world."""
        if not self.robot.fixed_to_world and not self.robot.is_static:
            base, _ = self._bases[0]
            base.setLinearVelocity(linear)
            base.setAngularVelocity(angular)

    def set_joint_positions(self, positions: Mapping[str, float]) -> None:
        """Put joints there, rad or m, at rest."""
        for name, position in positions.items():
            joint = self.joints[name]
            if joint.getNumDofs() == 1:
                joint.setPosition(0, position)
                joint.setVelocity(0, 0.0)

    def drive(self, motors: Mapping[str, Motor]) -> None:
        """Put motors into joints, as Gazebo Sim does for a velocity command."""
        for name, motor in motors.items():
            joint = self.joints[name]
            joint.setActuatorType(dynamics.ActuatorType.SERVO)
            joint.setForceLowerLimit(0, -motor.effort)
            joint.setForceUpperLimit(0, motor.effort)
            self._speeds[name] = motor.speed
            self._efforts.pop(name, None)

    def release(self) -> None:
        """Take all motors away."""
        for name in (*self._speeds, *self._efforts):
            kind = dynamics.ActuatorType
            self._set_actuator(name, kind.SERVO if name in self._held else kind.FORCE)
        self._speeds, self._efforts = dict.fromkeys(self._held, 0.0), {}

    def set_efforts(self, efforts: Mapping[str, float]) -> None:
        """Have efforts act in joints, instead of motors."""
        for name, effort in efforts.items():
            if name not in self._efforts:
                self._set_actuator(name, dynamics.ActuatorType.FORCE)
                self._speeds.pop(name, None)
            self._efforts[name] = effort

    def _set_actuator(self, name: str, kind: Any) -> None:
        joint = self.joints[name]
        joint.setActuatorType(kind)
        joint.setForceLowerLimit(0, -math.inf)
        joint.setForceUpperLimit(0, math.inf)

    def decay(self, step_seconds: float) -> None:
        """For the next step, apply what takes a share of speeds away."""
        for link, shares in self.decays.items():
            node = self.nodes[link]
            linear, angular = (share / step_seconds for share in shares)
            center, turn = node.getLocalCOM(), node.getWorldTransform().rotation()
            turning = node.getInertia().getMoment() @ turn.T @ node.getAngularVelocity()
            force = -linear * node.getMass() * node.getCOMLinearVelocity()
            node.addExtForce(force, center, False, True)
            node.addExtTorque(-angular * turn @ turning, False)

    def command(self) -> None:
        """Give the motors their speeds and efforts for the next step; DART forgets commands."""
        for name, speed in self._speeds.items():
            self.joints[name].setCommand(0, speed)
        for name, effort in self._efforts.items():
            self.joints[name].setCommand(0, effort)

    def efforts(self, step_seconds: float) -> dict[str, float]:
        """What motors and efforts gave in the last step, by joint, N m or N."""
        impulses = {name: self.joints[name].getConstraintImpulse(0) for name in self._speeds}
        given = {name: float(impulse) / step_seconds for name, impulse in impulses.items()}
        return dict.fromkeys(self.joints, 0.0) | given | self._efforts

    def link_pose(self, link: str) -> Pose:
        """The frame of a link, seen from the world."""
        node = self.nodes.get(link)
        return self._pose_of_world if node is None else pose_of(node)


def _position(joint: Any) -> float:
    """The position of a joint, rad or m; of a ball the angle by which it has turned."""
    positions = joint.getPositions().tolist()
    return float(positions[0]) if len(positions) == 1 else math.hypot(*positions)


def _velocity(joint: Any) -> float:
    """The velocity of a joint, rad/s or m/s; of a ball how fast it turns."""
    velocities = joint.getVelocities().tolist()
    return float(velocities[0]) if len(velocities) == 1 else math.hypot(*velocities)


def add_shape(node: Any, shape: Any, friction: float, name: str) -> Any:
    """Give a body something to touch; gives the shape's frame."""
    frame = node.createShapeNode(shape, name)
    frame.createCollisionAspect()
    frame.createDynamicsAspect().setFrictionCoeff(friction)
    return frame


def matrix_of(pose: Pose) -> Any:
    """The pose as DART's homogeneous matrix."""
    rotation = rotation_of_rpy(pose.rpy)
    rows = tuple((*row, part) for row, part in zip(rotation, pose.xyz, strict=True))
    return Isometry3((*rows, (0.0, 0.0, 0.0, 1.0)))


def pose_of(frame: Any) -> Pose:
    """The pose of a frame of DART in the world."""
    rows = frame.getWorldTransform().matrix().tolist()
    (a, b, c, x), (d, e, f, y), (g, h, i, z), _ = rows
    return Pose(xyz=(x, y, z), rpy=rpy_of_rotation(((a, b, c), (d, e, f), (g, h, i))))


def _inertia_of(inertial: Inertial) -> Any:
    xx, xy, xz, yy, yz, zz = made_possible(about_link_axes(inertial))
    return dynamics.Inertia(
        inertial.mass, inertial.pose_in_link.xyz, ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
    )


def _shape_of(geometry: Geometry) -> Any:
    """The shape; None for a mesh that is missing or not read, and for what DART does not have."""
    if isinstance(geometry, Box):
        return dynamics.BoxShape(geometry.size)
    if isinstance(geometry, Sphere):
        return dynamics.SphereShape(geometry.radius)
    if isinstance(geometry, Cylinder):
        return dynamics.CylinderShape(geometry.radius, geometry.length)
    if isinstance(geometry, Capsule):
        return dynamics.CapsuleShape(geometry.radius, geometry.length)
    if not isinstance(geometry, Mesh) or geometry.path is None:
        return None
    text = MESH_ROBOT.format(
        file=quoted(f"file://{geometry.path}"), scale=quoted(" ".join(map(repr, geometry.scale)))
    )
    mesh_robot = utils.DartLoader().parseSkeletonString(text, "file:///")
    node = mesh_robot.getBodyNode(0) if mesh_robot is not None else None
    return node.getShapeNode(0).getShape() if node is not None and node.getNumShapeNodes() else None


# A large box, as Gazebo makes of a plane.
GROUND_SIZE = (1000.0, 1000.0, 10.0)  # m

STILL = (0.0, 0.0, 0.0)
NOWHERE = (math.nan, math.nan, math.nan)
MOST_CONTACTS = 10_000  # of a search for overlaps; no robot has as many shapes in each other


class DartEngine:
    """A world in DART."""

    def __init__(self, world: World) -> None:
        self.step_seconds = world.step
        self._described = world
        self._robots: dict[str, DartBody] = {}
        self._driven: dict[str, DartBody] = {}  # those with motors
        self._movable: dict[str, DartBody] = {}  # those that time can move
        self._exploded: set[str] = set()  # those that DART no longer has: they were too far away
        self._pushes: dict[tuple[str, str], Vector] = {}  # N, by entity and link
        self._has_stepped = False  # since something was placed
        self._ground: Any = None  # the frame of its shape
        self._rays_group: Any = None  # all shapes, for rays
        self._world = simulation.World()
        self._world.setTimeStep(world.step)
        self._world.setGravity(world.gravity)
        # The detector that Gazebo takes; DART's own knows fewer shapes.
        self._detector = dartpy.collision.OdeCollisionDetector()
        self._world.getConstraintSolver().setCollisionDetector(self._detector)
        # Gazebo puts nothing to sleep: what tips slowly must go on tipping.
        sleep = self._world.getDeactivationOptions()
        sleep.mEnabled = False
        self._world.setDeactivationOptions(sleep)
        if world.has_ground_plane:
            self._add_ground(world.ground_friction)

    def _add_ground(self, friction: float) -> None:
        skeleton = dynamics.Skeleton("ground")
        joint, body = skeleton.createWeldJointAndBodyNodePair()
        joint.setTransformFromParentBodyNode(matrix_of(Pose(xyz=(0, 0, -GROUND_SIZE[2] / 2))))
        shape = dynamics.BoxShape(GROUND_SIZE)
        self._ground = add_shape(body, shape, friction, "ground")
        skeleton.setMobile(False)
        self._world.addSkeleton(skeleton)

    def spawn(self, robot: SpawnedRobot) -> Loaded | Refused:
        """Put a robot into the world, at rest, its joints passive."""
        model = robot.robot
        if not model.links:
            return Refused("no link of it has mass")
        body = DartBody(model, robot.pose_in_world, robot.entity)
        body.decays = decays(model, self._described)
        if body.unread:
            return Refused(f"it cannot read the mesh {body.unread[0]}")
        self._world.addSkeleton(body.skeleton)
        self._rays_group = None
        self._keep_apart(body)
        self._robots[robot.entity] = body
        if not model.is_static and body.skeleton.getNumDofs():
            self._movable[robot.entity] = body
        if len(self._robots) > 1 or body.skeleton.isEnabledSelfCollisionCheck():
            for one in self._robots.values():
                one.touch_with_all()
        return Loaded(len(body.nodes), len(body.joints), float(body.skeleton.getMass()))

    def _keep_apart(self, body: DartBody) -> None:
        """Let only those links touch each other that touch each other in Gazebo."""
        if not body.skeleton.isEnabledSelfCollisionCheck():
            return
        touching = may_touch(body.robot, is_one_enough=self._described.is_classic)
        apart = self._world.getConstraintSolver().getCollisionOption().collisionFilter
        for one, other in combinations(body.nodes, 2):
            if frozenset((one, other)) not in touching:
                apart.addBodyNodePairToBlackList(body.nodes[one], body.nodes[other])

    def place(self, entity: str, pose_in_world: Pose) -> None:
        """Put a robot elsewhere, as if it had been spawned there."""
        self._robots[entity].place(pose_in_world)
        if entity in self._exploded:
            self._exploded.remove(entity)
            self._movable[entity] = self._robots[entity]
            self._world.addSkeleton(self._robots[entity].skeleton)
            self._rays_group = None
        self._has_stepped = False

    def remove(self, entity: str) -> None:
        """Take a robot out of the world; its name may be used again."""
        body = self._robots.pop(entity)
        if entity in self._exploded:
            self._exploded.remove(entity)
        else:
            self._world.removeSkeleton(body.skeleton)
        self._rays_group = None
        self._driven.pop(entity, None)
        self._movable.pop(entity, None)
        self._pushes = {place: one for place, one in self._pushes.items() if place[0] != entity}

    def set_velocity(self, entity: str, linear: Vector, angular: Vector) -> None:
        """Have the root link move and turn like that now, seen from the world: m/s and rad/s."""
        self._robots[entity].set_velocity(linear, angular)

    def set_joint_positions(self, entity: str, positions: Mapping[str, float]) -> None:
        """Put joints of a robot there, at rest."""
        self._robots[entity].set_joint_positions(positions)
        self._has_stepped = False

    def drive(self, entity: str, motors: Mapping[str, Motor]) -> None:
        """Put motors into joints of a robot; those that are not named keep theirs."""
        self._driven[entity] = self._robots[entity]
        self._driven[entity].drive(motors)

    def release(self, entity: str) -> None:
        """Take all motors out of a robot: its joints are passive again."""
        self._robots[entity].release()
        self._driven.pop(entity, None)

    def set_efforts(self, entity: str, efforts: Mapping[str, float]) -> None:
        """From now on, have these efforts (N m or N) act in joints, which lose their motors."""
        self._driven[entity] = self._robots[entity]
        self._driven[entity].set_efforts(efforts)

    def joint_efforts(self, entity: str) -> dict[str, float]:
        """What acted in the movable joints in the last step, by name, N m or N."""
        efforts = self._robots[entity].efforts(self.step_seconds)
        return efforts if self._has_stepped else dict.fromkeys(efforts, 0.0)

    def joint_wrench(self, entity: str, joint: str) -> tuple[Vector, Vector]:
        """The force and the torque of the parent link on the child link of a joint."""
        body = self._robots[entity]
        child = next((one.child for one in body.robot.joints if one.name == joint), "")
        node = body.nodes.get(child)
        if node is None or not self._has_stepped:
            return STILL, STILL
        # First the torque, then the force, about the origin of the child's frame and seen from it.
        a, b, c, d, e, f = node.getBodyForce().tolist()
        rotation = rotation_of_rpy(pose_of(node).rpy)
        return rotate(rotation, (d, e, f)), rotate(rotation, (a, b, c))

    def state(self, entity: str) -> State:
        """Where the robot is and how it moves."""
        body = self._robots[entity]
        pose = body.link_pose(body.robot.root)
        roots = body.loose_nodes  # none of a root that is the world
        return State(
            xyz=NOWHERE if entity in self._exploded else pose.xyz,
            xyzw=quaternion_of_rpy(pose.rpy),
            speed=max(
                (math.hypot(*node.getCOMLinearVelocity().tolist()) for node in roots), default=0.0
            ),
            turning=max(
                (math.hypot(*node.getAngularVelocity().tolist()) for node in roots), default=0.0
            ),
            joint_speed=max(
                (math.hypot(*joint.getVelocities().tolist()) for joint in body.joints.values()),
                default=0.0,
            ),
        )

    def look(self, entity: str) -> Look:
        """The same, as far as it is looked at every few steps."""
        return look_at(self.state(entity))

    def joint_positions(self, entity: str) -> dict[str, float]:
        """The positions of the movable joints by name, rad or m."""
        return {name: _position(joint) for name, joint in self._robots[entity].joints.items()}

    def joint_velocities(self, entity: str) -> dict[str, float]:
        """The velocities of the movable joints by name, rad/s or m/s."""
        return {name: _velocity(joint) for name, joint in self._robots[entity].joints.items()}

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
        return surfaces.lowest_point(self._robots[entity].robot, self.link_poses(entity))

    def corners(self, entity: str) -> list[Vector]:
        """Corners of boxes along the world's axes around all that can touch something, m."""
        return surfaces.corners(self._robots[entity].robot, self.link_poses(entity))

    def link_poses(self, entity: str) -> dict[str, Pose]:
        """The frames of all links of a robot by name, seen from the world."""
        body = self._robots[entity]
        return {link.name: body.link_pose(link.name) for link in body.robot.links}

    def link_velocities(self, entity: str) -> dict[str, tuple[Vector, Vector]]:
        """How the links of a robot move, by name, seen from the world: m/s and rad/s."""
        body = self._robots[entity]
        velocities: dict[str, tuple[Vector, Vector]] = {}
        for link in body.robot.links:
            node = body.nodes.get(link.name)
            velocities[link.name] = (
                (STILL, STILL)
                if node is None
                else (
                    tuple(node.getLinearVelocity().tolist()),
                    tuple(node.getAngularVelocity().tolist()),
                )
            )
        return velocities

    def cast_rays(self, starts: Points, ends: Points) -> NDArray[np.float64]:
        """How far rays get through what can touch something: fractions of their ways, shape (n,).

        The shape that a ray begins in it does not see.
        """
        group = self._rays_group
        # Asked for also where they are known: that puts what level ground need not touch in place.
        shapes = [
            frame
            for entity, body in self._robots.items()
            if entity not in self._exploded
            for _, frame in body.shapes
        ]
        if group is None:
            # ODE's detector, which the world has, casts none.
            detector = dartpy.collision.BulletCollisionDetector()
            group = self._rays_group = detector.createCollisionGroup()
            for frame in (*shapes, *([] if self._ground is None else [self._ground])):
                group.addShapeFrame(frame)
        option, result = dartpy.collision.RaycastOption(), dartpy.collision.RaycastResult()
        fractions = []
        for start, end in zip(starts, ends, strict=True):
            result.clear()
            is_hit = group.raycast(start, end, option, result)
            fractions.append(result.mRayHits[0].mFraction if is_hit else math.inf)
        return np.array(fractions, dtype=np.float64)

    def overlaps(self) -> list[Overlap]:
        """Links in each other, of two robots or of one, whether or not they may collide."""
        group = self._detector.createCollisionGroup()
        place: dict[str, tuple[str, str]] = {}
        for entity, body in self._robots.items():
            for link, frame in body.shapes:
                group.addShapeFrame(frame)
                place[frame.getName()] = (entity, link)
        result = dartpy.collision.CollisionResult()
        group.collide(dartpy.collision.CollisionOption(True, MOST_CONTACTS), result)
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
        slowing = [body for body in self._movable.values() if body.decays]
        for _ in range(steps):
            for entity, body in tuple(self._movable.items()):
                positions = body.skeleton.getPositions()  # m, and rad, but that is quick
                if not positions.dot(positions) < FARTHEST**2 and body.is_far():
                    self._take_out(entity)
            for body in self._driven.values():
                body.command()
            self._has_stepped = True
            for body in slowing:
                body.decay(self.step_seconds)
            for (entity, link), force in self._pushes.items():
                node = self._robots[entity].nodes.get(link)
                if node is not None:  # DART forgets forces, too
                    node.addExtForce(force, node.getLocalCOM(), False, True)
            self._world.step()

    def _take_out(self, entity: str) -> None:
        """Go on without a robot that has exploded: its state is not finite from now on."""
        self._world.removeSkeleton(self._movable.pop(entity).skeleton)
        self._exploded.add(entity)
        self._rays_group = None

    def push(self, entity: str, link: str, force: Vector) -> None:
        """From now on, have a force (N, in the world) act on a link at its center of mass."""
        self._pushes.pop((entity, link), None)
        if any(force):
            self._pushes[entity, link] = force

    def contacts(self, entity: str) -> list[Contact]:
        """What a robot touched in the last step."""
        if not self._has_stepped:
            return []
        places: dict[str, tuple[str, str]] = {}
        for other, body in self._robots.items():
            for link, frame in body.shapes:
                for name in (frame.getName(), TOUCHING_NAME.format(frame.getName())):
                    places[name] = other, link
        found = []
        for contact in self._world.getLastCollisionResult().getContacts():
            one, met = (
                places.get(touching.getShapeFrame().getName())
                for touching in (contact.collisionObject1, contact.collisionObject2)
            )
            force = abs(float(contact.force @ contact.normal))
            point, normal = contact.point.tolist(), contact.normal.tolist()
            depth = max(0.0, float(contact.penetrationDepth))
            found.append(Touch(one, met, point, force, normal, depth))
        return contacts_of(entity, found)

    def close(self) -> None:
        """Nothing: the world goes with its last reference."""
