"""One tree of links in PyBullet, set up so that it moves as in Gazebo.

Dampers and springs may be too stiff for PyBullet, which applies damping from the speed before a
step. Where that takes away more than all of the speed in one step, the joint is thrown back faster
than it came, and the robot explodes; of the public robots one in ten has such joints (TIAGo, TALOS,
iCub, xArm). Here a motor that wants to stand still, but is no stronger than the damper, does the
same and can only take energy away.
"""

from __future__ import annotations

import math
import tempfile
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.isolation.child import scratch_folder
from wsgen.model.kinematics import link_poses
from wsgen.model.robot import Capsule, Cylinder, JointType, Mesh, Sphere, Triangulated
from wsgen.model.transform import (
    IDENTITY,
    Pose,
    Vector,
    compose,
    invert,
    quaternion_of_rpy,
    rotate,
    rotation_of_quaternion,
    rotation_of_rpy,
    rpy_of_rotation,
    transpose,
)
from wsgen.simulation.bullet_contacts import contact_masses, spring_of
from wsgen.simulation.contact_shapes import inner_apart, one_friction_a_link
from wsgen.simulation.engine import STRONGEST, decays, is_stiff, may_touch, stiffness_to_simulate
from wsgen.simulation.urdf_writer import write_urdf
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping

    from wsgen.model.robot import Collision, Joint, Link, Robot
    from wsgen.model.world import World
    from wsgen.simulation.bullet import Client
    from wsgen.simulation.engine import Motor


STRIDE = 5  # steps from one setting of the motors to the next
SMOOTHING = 0.2  # how much of a new speed is taken over; the motor stops the joint now and then


@dataclass
class Dampers:
    """The stiffly damped joints of one body."""

    indices: list[int]  # PyBullet's, of the joints
    damping: list[float]  # N m s/rad or N s/m
    friction: list[float]  # N m or N
    speeds: list[float]  # rad/s or m/s, smoothed, against those below
    # rad/s or m/s; with an effort, the speed at which the damper takes all of it: so much faster is
    # what the damper would have stand still.
    targets: list[float]

    def without(self, driven: Collection[int]) -> Dampers:
        """Those of the other joints: one that has a motor cannot have a second one."""
        left = [place for place, index in enumerate(self.indices) if index not in driven]
        return Dampers(
            indices=[self.indices[place] for place in left],
            damping=[self.damping[place] for place in left],
            friction=[self.friction[place] for place in left],
            speeds=[self.speeds[place] for place in left],
            targets=[self.targets[place] for place in left],
        )

    def set_efforts(self, efforts: Mapping[int, float], frictions: Mapping[int, float]) -> None:
        """Have efforts act on those of the joints that are named, with these frictions."""
        for place, index in enumerate(self.indices):
            if index in efforts:
                self.friction[place] = frictions[index]
                self.targets[place] = efforts[index] / self.damping[place]

    def apply(self, client: Client, body: int) -> None:
        """Make the motors as strong as dampers and friction are at this speed."""
        states = client.getJointStates(body, self.indices)
        self.speeds = [
            before + SMOOTHING * (abs(state[1] - target) - before)
            for before, state, target in zip(self.speeds, states, self.targets, strict=True)
        ]
        client.setJointMotorControlArray(
            body,
            self.indices,
            client.VELOCITY_CONTROL,
            targetVelocities=self.targets,
            forces=[
                friction + damping * speed
                for friction, damping, speed in zip(
                    self.friction, self.damping, self.speeds, strict=True
                )
            ],
        )


def _sum(*vectors: Vector) -> Vector:
    x, y, z = (sum(parts) for parts in zip(*vectors, strict=True))
    return x, y, z


def _scaled(vector: Vector, factor: float) -> Vector:
    x, y, z = vector
    return factor * x, factor * y, factor * z


def undamped(joints: tuple[Joint, ...], names: set[str]) -> tuple[Joint, ...]:
    """The joints without the damping of those that are named."""
    return tuple(replace(joint, damping=0.0) if joint.name in names else joint for joint in joints)


def without_missing_meshes(tree: Robot) -> Robot:
    """The same tree without what nothing can touch: meshes without a file, unknown shapes."""
    links = []
    for link in tree.links:
        there = tuple(
            shape
            for shape in link.collisions
            if not isinstance(shape.geometry, Triangulated)
            and not (isinstance(shape.geometry, Mesh) and shape.geometry.path is None)
        )
        links.append(replace(link, collisions=there))
    return replace(tree, links=tuple(links))


RIM = 0.05  # of a wheel's width
PARALLEL = 0.999  # cosine of the angle between a wheel's axis and its axle


def with_rims(tree: Robot) -> Robot:
    """The same tree, its wheels with the outer rims alone; of one that is in the middle, both.

    Between the rims of a wheel that turns on the spot, friction holds it in balance wherever it
    stands still; in Gazebo Classic it is the outer one that does not slip. PyBullet lets a
    cylinder touch the ground in one point, about the middle.
    """
    axles = {joint.child: joint for joint in tree.joints if joint.type is JointType.CONTINUOUS}
    wheels = {link.name: link for link in tree.links if link.name in axles and link.collisions}
    if not wheels:
        return tree
    poses = link_poses(tree, IDENTITY)
    middle = _scaled(_sum(*(poses[name].xyz for name in wheels)), 1 / len(wheels))
    links = []
    for link in tree.links:
        if link.name in wheels:
            shapes = [
                part
                for shape in link.collisions
                for part in _outer_rims(shape, axles[link.name], poses[link.name], middle)
            ]
            links.append(replace(link, collisions=tuple(shapes)))
        else:
            links.append(link)
    return replace(tree, links=tuple(links))


def _outer_rims(shape: Collision, axle: Joint, wheel: Pose, middle: Vector) -> list[Collision]:
    """The rim of a cylinder on its axle that is farthest from the middle; other shapes as they are.

    Where the wheel is, and the middle, are seen from the root.
    """
    geometry, pose = shape.geometry, shape.pose_in_link
    along = rotate(rotation_of_rpy(pose.rpy), (0.0, 0.0, 1.0))
    lies_on_axle = abs(math.fsum(a * b for a, b in zip(along, axle.axis_in_joint, strict=True)))
    if not isinstance(geometry, Cylinder) or lies_on_axle < PARALLEL:
        return [shape]
    at = compose(wheel, pose)
    axis = rotate(rotation_of_rpy(at.rpy), (0.0, 0.0, 1.0))
    aside = math.fsum(a * (b - c) for a, b, c in zip(axis, at.xyz, middle, strict=True))
    width = RIM * geometry.length
    to_rim = (geometry.length - width) / 2
    rims = (to_rim, -to_rim) if abs(aside) < width else (math.copysign(to_rim, aside),)
    return [
        replace(
            shape,
            geometry=replace(geometry, length=width),
            pose_in_link=compose(pose, Pose((0.0, 0.0, z))),
        )
        for z in rims
    ]


def unread_mesh(client: Client, body: int, tree: Robot, index_of: Mapping[str, int]) -> str | None:
    """A file of the tree that PyBullet left out without an error; `index_of` is by link name."""
    for link in tree.links:
        shapes = [shape.geometry for shape in link.collisions]
        files = [str(shape.path) for shape in shapes if isinstance(shape, Mesh)]
        if files:
            loaded = client.getCollisionShapeData(body, index_of[link.name])
            if len(loaded) < len(shapes):
                read = {shape[4].decode(errors="replace") for shape in loaded}
                return next((file for file in files if file not in read), files[0])
    return None


def _at_rest(joint: Joint) -> float:
    """What resists a joint that is not driven, N m or N."""
    return STRONGEST if joint.is_held else joint.friction


def set_motor(client: Client, body: int, index: int, joint: Joint, motor: Motor) -> None:
    """Have a motor keep the joint's speed.

    A joint has one motor in PyBullet, which until now was its friction: that is taken from the
    motor's strength. `joint.damping` is what PyBullet does not do by itself.
    """
    left = min(motor.effort, STRONGEST) - joint.friction
    speed = motor.speed if left > 0 else 0.0
    if joint.damping and left > 0:  # no faster than damping lets it
        highest = left / joint.damping
        speed = min(highest, max(-highest, speed))
    client.setJointMotorControl2(
        body, index, client.VELOCITY_CONTROL, targetVelocity=speed, force=abs(left)
    )


# Gazebo damps links only where the description says so, and only Gazebo Classic does; PyBullet
# damps every link by 0.04 a second.
LINK_DAMPING = 0.0

# Gazebo has no speed limit for passive joints; PyBullet stops them at 100 rad/s.
HIGHEST_JOINT_SPEED = 1e6

# Contact normals of round shapes are off by about 4e-4, at random: on even ground wheels without
# motors start to roll at 4 mm/s², where DART's stand. A rolling resistance as of a slope of one in
# a thousand keeps them, and slows what rolls by no more than 1 cm/s².
ROLLING_RESISTANCE = 1e-3  # times the radius: PyBullet's rolling friction is a length

OWN_FRICTION = 1.0  # of a link at most; see `BulletBody.stand_on`

NOT_TURNED = (0.0, 0.0, 0.0, 1.0)  # x, y, z, w

ROOT = -1  # PyBullet's index of a body's root


def set_links(client: Client, body: int, parts: Robot, index_of: Mapping[str, int]) -> None:
    """Give every part its friction, and take PyBullet's damping from all."""
    # In a call of its own: with one of these, PyBullet takes all the rest of a call for the root's,
    # whichever link is named.
    client.changeDynamics(
        body,
        ROOT,
        linearDamping=LINK_DAMPING,
        angularDamping=LINK_DAMPING,
        maxJointVelocity=HIGHEST_JOINT_SPEED,
    )
    for part in parts.links:
        index = index_of[part.name]
        client.changeDynamics(
            body,
            index,
            lateralFriction=min(OWN_FRICTION, max(_friction_of(part))),
            rollingFriction=0.0
            if parts.is_static
            else ROLLING_RESISTANCE * _radius(client, body, index, part),
        )


def _friction_of(part: Link) -> tuple[float, float]:
    """The coefficients of a part along y and along x of the world; of several, the least."""
    ways = zip(*(shape.surface.along_world for shape in part.collisions), strict=True)
    along_y, along_x = (min(one) for one in ways) if part.collisions else (OWN_FRICTION,) * 2
    return along_y, along_x


def _radius(client: Client, body: int, index: int, part: Link) -> float:
    """The largest radius of what can roll, m; a mesh may be a wheel."""
    radii = [
        shape.geometry.radius
        for shape in part.collisions
        if isinstance(shape.geometry, Cylinder | Sphere | Capsule)
    ]
    if any(isinstance(shape.geometry, Mesh) for shape in part.collisions):
        low, high = client.getAABB(body, index)
        # The edges of the box around a wheel: its width, and twice its radius.
        radii.append(sorted(b - a for a, b in zip(low, high, strict=True))[1] / 2)
    return max(radii, default=0.0)


def release_joints(client: Client, body: int, tree: Robot, movable: Mapping[str, int]) -> None:
    """Take the motors that PyBullet puts into all joints to hold them, if Gazebo has none."""
    for joint in tree.joints:
        if joint.type is JointType.BALL:
            client.setJointMotorControlMultiDof(
                body,
                movable[joint.name],
                client.POSITION_CONTROL,
                targetPosition=NOT_TURNED,
                force=(0.0, 0.0, 0.0),
            )
        elif joint.name in movable:
            client.setJointMotorControl2(
                body, movable[joint.name], client.VELOCITY_CONTROL, force=_at_rest(joint)
            )


def strengthen_stops(client: Client, body: int, tree: Robot, movable: Mapping[str, int]) -> None:
    """Have the ends of joints stop whatever comes: PyBullet's give way to 100 N s in a step.

    A body of 500 kg that slides down to its stop swings up again by centimeters.
    """
    for joint in tree.movable_joints:
        if joint.limit is not None and joint.type in (JointType.REVOLUTE, JointType.PRISMATIC):
            # Without the limits PyBullet does not take the force.
            client.changeDynamics(
                body,
                movable[joint.name],
                jointLowerLimit=joint.limit.lower,
                jointUpperLimit=joint.limit.upper,
                jointLimitForce=STRONGEST,
            )


def keep_apart(
    client: Client,
    body: int,
    touching: Collection[frozenset[str]],
    index_of: Mapping[str, int],
    owner: Mapping[str, str],
) -> None:
    """Let only those links touch each other that touch each other in Gazebo."""
    parts = list(index_of.items())
    for place, (name, index) in enumerate(parts):
        for other_name, other_index in parts[:place]:
            touches = frozenset((owner[name], owner[other_name])) in touching
            client.setCollisionFilterPair(body, body, index, other_index, int(touches))


# Position of a body's base (m) and its orientation (unit quaternion x, y, z, w), in the world.
Place = tuple[Vector, tuple[float, float, float, float]]
PartBounds = tuple[str, int, Vector, Vector]  # see `BulletBody.boxes`


class BulletBody:
    """A tree of links; the poses it is given and gives are those of its root link's frame."""

    def __init__(self, client: Client, tree: Robot, pose_in_world: Pose, *, world: World) -> None:
        """Load it.

        Raises:
            pybullet.error: PyBullet does not take it.
        """
        self._client = client
        step_seconds, self._is_classic = world.step, world.is_classic
        self.tree = _frozen(tree) if tree.is_static else tree
        shapes = without_missing_meshes(self.tree)
        stiff = [joint for joint in self.tree.joints if is_stiff(joint, self.tree, step_seconds)]
        self._parts, self._owner, self._inner = inner_apart(
            *one_friction_a_link(
                replace(
                    with_rims(shapes) if self._is_classic else shapes,
                    joints=undamped(self.tree.joints, {joint.name for joint in stiff}),
                )
            )
        )
        self._step_seconds = step_seconds
        self.number = self._load(pose_in_world)
        self._index_of = self._number_parts()
        self.indices = {link.name: self._index_of[link.name] for link in self.tree.links}
        self.movable = {
            joint.name: self._index_of[joint.child] for joint in self.tree.movable_joints
        }
        self._moving = list(self.movable.values())
        self._held = {
            self.movable[joint.name] for joint in self.tree.movable_joints if joint.is_held
        }
        self._balls = {
            self.movable[joint.name]
            for joint in self.tree.movable_joints
            if joint.type is JointType.BALL
        }
        self._dynamics = {
            index: client.getDynamicsInfo(self.number, index) for index in self._index_of.values()
        }
        self._dampers = self.dampers = Dampers(
            indices=[self.movable[joint.name] for joint in stiff],
            damping=[joint.damping for joint in stiff],
            friction=[_at_rest(joint) for joint in stiff],
            speeds=[0.0] * len(stiff),
            targets=[0.0] * len(stiff),
        )
        self._efforts: dict[int, float] = {}  # N m or N, by index, of joints without a motor
        self._torques: dict[int, float] = {}  # those that no damper takes into account
        self._motors: set[int] = set()  # indices of joints
        self._measured: set[int] = set()  # whose forces PyBullet keeps
        names = {joint.name for joint in self.tree.joints}
        self._without_damping = {joint.name: joint for joint in undamped(self.tree.joints, names)}
        self._root_from_base = invert(_pose(*self._dynamics[ROOT][3:5]))
        self._set_properties()
        # Contacts with what is static are as soft as the other one's.
        self._contact_masses = {} if tree.is_static else contact_masses(self._parts)
        self._share: float | None = None  # of an overlap, that its contacts take
        self._springs = [
            (
                self.movable[joint.name],
                stiffness_to_simulate(joint, self.tree, step_seconds),
                joint.spring_reference,
            )
            for joint in self.tree.movable_joints
            if joint.spring_stiffness
        ]
        self._weightless = [
            self.indices[link.name]
            for link in self.tree.links
            if not link.gravity and link.inertial is not None and not tree.is_static
        ]
        self._decays = [
            (self.indices[link], *shares) for link, shares in decays(tree, world).items()
        ]

    def _number_parts(self) -> dict[str, int]:
        """PyBullet's indices of the parts; every part has one joint above it, and its index."""
        client = self._client
        count = client.getNumJoints(self.number)
        infos = [client.getJointInfo(self.number, index) for index in range(count)]
        names = {info[12].decode(): index for index, info in enumerate(infos)}
        return {self.tree.root: ROOT} | names

    def _set_properties(self) -> None:
        client = self._client
        set_links(client, self.number, self._parts, self._index_of)
        release_joints(client, self.number, self.tree, self.movable)
        strengthen_stops(client, self.number, self.tree, self.movable)
        if any(link.self_collide for link in self.tree.links):
            touching = may_touch(self.tree, is_one_enough=self._is_classic)
            keep_apart(client, self.number, touching, self._index_of, self._owner)

    def _load(self, pose: Pose) -> int:
        return load(self._client, self._parts, pose)

    def unread_mesh(self) -> str | None:
        """A mesh file that PyBullet left out without an error."""
        return unread_mesh(self._client, self.number, self._parts, self._index_of)

    def grounds_below(self, friction: float) -> dict[str, tuple[float, float]]:
        """The friction of the ground for each part to feel one of this friction, by its name.

        Along y and along x of the world, in which the friction of a ground may differ.
        """
        below = {}
        for part in self._parts.links:
            along_y, along_x = _friction_of(part)
            own = min(OWN_FRICTION, max(along_y, along_x))
            if own > 0.0:
                below[part.name] = min(along_y, friction) / own, min(along_x, friction) / own
            else:
                below[part.name] = (min(1.0, friction),) * 2
        return below

    def stand_on(self, grounds: Mapping[tuple[float, float], int], friction: float) -> None:
        """Let each part touch one of the grounds alone, so that it feels one of this friction.

        Gazebo takes the smaller friction of two that touch each other, PyBullet the product. Two
        links get along with products of at most 1; the ground makes up for what a link lacks.
        A level ground touches no more than the convex hull, see `inner_collisions`.
        """
        if len(grounds) == 1 and not self._inner:
            return
        below = self.grounds_below(friction)
        for name, index in self._index_of.items():
            for own, ground in grounds.items():
                touches = name not in self._inner and below[name] == own
                self._client.setCollisionFilterPair(ground, self.number, ROOT, index, int(touches))

    def soften_contacts(self, share: float) -> None:
        """Have its contacts spread its weight, and take this share of an overlap in one step."""
        if share == self._share:  # asked in each step where somebody moves an obstacle
            return
        self._share = share
        for name, mass in self._contact_masses.items():
            stiffness, damping = spring_of(mass, share, self._step_seconds)
            self._client.changeDynamics(
                self.number,
                self._index_of[name],
                contactStiffness=stiffness,
                contactDamping=damping,
            )

    @property
    def mass(self) -> float:
        """What PyBullet takes it to weigh, kg; that of the description for what is static."""
        if self.tree.is_static:  # PyBullet gives what is fixed no mass
            return self.tree.mass
        return sum(float(dynamics[0]) for dynamics in self._dynamics.values())

    @property
    def pulls(self) -> bool:
        """Whether `pull` must be called before every step."""
        return bool(self._springs or self._weightless or self._torques or self._decays)

    def drive(self, motors: Mapping[str, Motor]) -> None:
        """Put motors into those of the joints that are in this tree."""
        for joint in self.tree.movable_joints:
            if joint.name in motors:
                index = self.movable[joint.name]
                is_stiff = index in self._dampers.indices
                rest = joint if is_stiff else self._without_damping[joint.name]
                set_motor(self._client, self.number, index, rest, motors[joint.name])
        driven = {self.movable[name] for name in motors if name in self.movable}
        self.dampers = self.dampers.without(driven)
        self._motors |= driven
        if self._efforts:
            for left in (self._efforts, self._torques):
                for index in driven & left.keys():
                    del left[index]

    def release(self) -> None:
        """Take all motors and efforts away."""
        release_joints(self._client, self.number, self.tree, self.movable)
        self.dampers = self._dampers
        self._motors, self._efforts, self._torques = set(), {}, {}

    def set_efforts(self, efforts: Mapping[str, float]) -> None:
        """Have efforts act in those of the joints that are in this tree, instead of motors."""
        given = {
            self.movable[joint.name]: joint
            for joint in self.tree.movable_joints
            if joint.name in efforts
        }
        new = given.keys() - self._efforts.keys()
        self._efforts |= {index: efforts[joint.name] for index, joint in given.items()}
        for index in new:
            self._client.setJointMotorControl2(
                self.number, index, self._client.VELOCITY_CONTROL, force=given[index].friction
            )
        if new & self._motors:
            self._motors -= new
            self.dampers = self._dampers.without(self._motors)
        elif self._dampers.indices and self.dampers is self._dampers:
            self.dampers = self._dampers.without(())
        frictions = {index: joint.friction for index, joint in given.items()}
        self.dampers.set_efforts({index: self._efforts[index] for index in given}, frictions)
        stiff = set(self.dampers.indices)
        self._torques = {
            index: effort for index, effort in self._efforts.items() if index not in stiff
        }

    def joint_efforts(self) -> list[float]:
        """What motors and efforts gave in the last step, of the movable joints in their order."""
        # Of joints that have a motor, or that one holds.
        moving = list(self._motors | (self._held - self._efforts.keys()))
        states = self._client.getJointStates(self.number, moving) if moving else ()
        given = {index: float(state[3]) for index, state in zip(moving, states, strict=True)}
        given |= self._efforts
        return [given.get(index, 0.0) for index in self.movable.values()]

    def joint_wrench(self, name: str) -> tuple[Vector, Vector] | None:
        """What the parent exerts on the child of a joint, if that is in this tree: N and N m.

        Seen from the world, about the origin of the child's frame; zero before the next step where
        it is asked for first. PyBullet gives it at the center of mass, without the motor's effort,
        and without what holds a joint at its end.
        """
        joint = next((one for one in self.tree.joints if one.name == name), None)
        if joint is None:
            return None
        client, index = self._client, self._index_of[joint.child]
        if index not in self._measured:
            client.enableJointForceTorqueSensor(self.number, index, enableSensor=True)
            self._measured.add(index)
            return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        state = client.getJointState(self.number, index)
        link = client.getLinkState(self.number, index, computeForwardKinematics=1)
        turn = rotation_of_quaternion(link[1])  # of the center of mass
        force, about_center = rotate(turn, state[2][:3]), rotate(turn, state[2][3:])
        x, y, z = (there - here for there, here in zip(link[0], link[4], strict=True))
        a, b, c = force
        moment = (y * c - z * b, z * a - x * c, x * b - y * a)
        axis = rotate(rotation_of_quaternion(link[5]), joint.axis_in_joint)
        is_slide = joint.type is JointType.PRISMATIC
        pushes = state[3] if is_slide else 0.0
        turns = 0.0 if is_slide or index in self._balls else state[3]
        return _sum(force, _scaled(axis, pushes)), _sum(about_center, moment, _scaled(axis, turns))

    def damp(self) -> None:
        """For the next steps, set what its stiff dampers do."""
        if self.dampers.indices:
            self.dampers.apply(self._client, self.number)

    def pull(self, gravity: Vector) -> None:
        """For the next step, apply what PyBullet forgets or has no notion of.

        That are efforts, springs, missing gravity and lost speed.
        """
        client = self._client
        if self._torques:
            client.setJointMotorControlArray(
                self.number,
                list(self._torques),
                client.TORQUE_CONTROL,
                forces=list(self._torques.values()),
            )
        for index, stiffness, reference in self._springs:
            position = client.getJointState(self.number, index)[0]
            client.setJointMotorControl2(
                self.number,
                index,
                client.TORQUE_CONTROL,
                force=-stiffness * (position - reference),
            )
        for index in self._weightless:
            mass = self._dynamics[index][0]
            center = self._center(index)
            lift = tuple(-mass * part for part in gravity)
            client.applyExternalForce(self.number, index, lift, center.xyz, client.WORLD_FRAME)
        for index, linear_share, angular_share in self._decays:
            mass, moments = self._dynamics[index][0], self._dynamics[index][2]
            center, linear, angular = self._motion(index)
            rotation = rotation_of_rpy(center.rpy)
            x, y, z = rotate(transpose(rotation), angular)
            momentum = rotate(rotation, (moments[0] * x, moments[1] * y, moments[2] * z))
            force = _scaled(linear, -linear_share * mass / self._step_seconds)
            torque = _scaled(momentum, -angular_share / self._step_seconds)
            client.applyExternalForce(self.number, index, force, center.xyz, client.WORLD_FRAME)
            client.applyExternalTorque(self.number, index, torque, client.WORLD_FRAME)

    def push(self, link: str, force: Vector) -> None:
        """For the next step, apply a force (N, in the world) to a link, if it is in this tree."""
        index = self.indices.get(link)
        if index is not None:
            center = self._center(index).xyz
            self._client.applyExternalForce(
                self.number, index, force, center, self._client.WORLD_FRAME
            )

    def place(self, pose_in_world: Pose) -> None:
        """Put it somewhere, at rest, its joints at zero."""
        client = self._client
        base = compose(pose_in_world, invert(self._root_from_base))
        client.resetBasePositionAndOrientation(self.number, base.xyz, quaternion_of_rpy(base.rpy))
        client.resetBaseVelocity(self.number, (0, 0, 0), (0, 0, 0))
        for index in self.movable.values():
            if index in self._balls:
                client.resetJointStateMultiDof(self.number, index, NOT_TURNED, (0.0, 0.0, 0.0))
            else:
                client.resetJointState(self.number, index, 0.0)

    def set_velocity(self, linear: Vector, angular: Vector) -> None:
        """Have the root move (m/s, the origin of its frame) and turn (rad/s), in the world."""
        if self.tree.fixed_to_world or self.tree.is_static:
            return
        center, _ = self.place_of_base()
        x, y, z = (there - here for there, here in zip(center, self.root_pose().xyz, strict=True))
        a, b, c = angular
        of_center = (
            linear[0] + b * z - c * y,
            linear[1] + c * x - a * z,
            linear[2] + a * y - b * x,
        )
        self._client.resetBaseVelocity(self.number, of_center, angular)

    def set_joint_positions(self, positions: Mapping[str, float]) -> None:
        """Put those of the joints that are in this tree there, rad or m, at rest."""
        for name, position in positions.items():
            index = self.movable.get(name)
            if index is not None and index not in self._balls:
                self._client.resetJointState(self.number, index, position)

    def root_pose(self) -> Pose:
        """The frame of the root link; PyBullet's base is the frame at its center of mass."""
        return self.root_pose_at(self.place_of_base())

    def place_of_base(self) -> Place:
        """Where the base is, as PyBullet has it."""
        place: Place = self._client.getBasePositionAndOrientation(self.number)
        return place

    def root_pose_at(self, place: Place) -> Pose:
        """The frame of the root link when the base is there."""
        return compose(_pose(*place), self._root_from_base)

    def root_height_at(self, place: Place) -> float:
        """The z of that frame, m; but for rounding."""
        (_, _, height), (x, y, z, w) = place
        a, b, c = self._root_from_base.xyz
        return (
            height + 2 * ((x * z - y * w) * a + (y * z + x * w) * b) + c - 2 * c * (x * x + y * y)
        )

    def joint_speed(self) -> float:
        """The speed of the fastest joint, rad/s or m/s; 0 without movable joints."""
        if self._balls:
            return max(abs(speed) for _, speed in self.joint_states())
        if not self._moving:
            return 0.0
        states = self._client.getJointStates(self.number, self._moving)
        return max([abs(float(state[1])) for state in states])

    def joint_states(self) -> list[tuple[float, float]]:
        """Position and speed of the movable joints, in their order."""
        indices = list(self.movable.values())
        if not self._balls:
            states = self._client.getJointStates(self.number, indices) if indices else ()
            return [(state[0], state[1]) for state in states]
        turns = self._client.getJointStatesMultiDof(self.number, indices)
        return [
            (2 * math.atan2(math.hypot(*turn[0][:3]), abs(turn[0][3])), math.hypot(*turn[1]))
            if index in self._balls
            else (turn[0][0], turn[1][0])
            for index, turn in zip(indices, turns, strict=True)
        ]

    def link_poses(self) -> dict[str, Pose]:
        """The frames of all links by name."""
        client, poses = self._client, {self.tree.root: self.root_pose()}
        for name, index in self.indices.items():
            if index != ROOT:
                state = client.getLinkState(self.number, index, computeForwardKinematics=1)
                poses[name] = _pose(state[4], state[5])
        return poses

    def link_velocities(self) -> dict[str, tuple[Vector, Vector]]:
        """How the frames of all links move, by name: m/s and rad/s, in the world."""
        client, velocities = self._client, {}
        for name, index in self.indices.items():
            if index == ROOT:
                linear, angular = client.getBaseVelocity(self.number)
                (center, _), origin = self.place_of_base(), self.root_pose().xyz
            else:
                state = client.getLinkState(
                    self.number, index, computeLinkVelocity=1, computeForwardKinematics=1
                )
                center, origin, linear, angular = state[0], state[4], state[6], state[7]
            # PyBullet has the velocity of the center of mass.
            x, y, z = (there - here for there, here in zip(origin, center, strict=True))
            a, b, c = angular
            velocities[name] = (
                (
                    linear[0] + b * z - c * y,
                    linear[1] + c * x - a * z,
                    linear[2] + a * y - b * x,
                ),
                angular,
            )
        return velocities

    def energy(self, gravity: Vector) -> float:
        """Kinetic and potential energy, that of its springs included, J."""
        total = 0.0
        for index, stiffness, reference in self._springs:
            position = self._client.getJointState(self.number, index)[0]
            total += stiffness * (position - reference) ** 2 / 2
        for index in self.indices.values():
            mass, moments = self._dynamics[index][0], self._dynamics[index][2]
            if not mass:
                continue
            center, linear, angular = self._motion(index)
            turning = rotate(transpose(rotation_of_rpy(center.rpy)), angular)
            total += mass * (sum(part * part for part in linear) / 2)
            total += sum(m * w * w for m, w in zip(moments, turning, strict=True)) / 2
            if index not in self._weightless:
                total -= mass * sum(g * x for g, x in zip(gravity, center.xyz, strict=True))
        return total

    def _motion(self, index: int) -> tuple[Pose, Vector, Vector]:
        """Pose and velocities of a link's center of mass, along its principal axes."""
        client = self._client
        if index == ROOT:
            return (self._center(ROOT), *client.getBaseVelocity(self.number))
        state = client.getLinkState(
            self.number, index, computeLinkVelocity=1, computeForwardKinematics=1
        )
        return _pose(state[0], state[1]), state[6], state[7]

    def _center(self, index: int) -> Pose:
        if index == ROOT:
            return _pose(*self._client.getBasePositionAndOrientation(self.number))
        state = self._client.getLinkState(self.number, index, computeForwardKinematics=1)
        return _pose(state[0], state[1])

    def link_of(self, index: int) -> str:
        """The link of a part, by PyBullet's index."""
        return next(self._owner[name] for name, at in self._index_of.items() if at == index)

    def part_indices(self) -> list[tuple[str, int]]:
        """The links with PyBullet's indices of their parts."""
        return [(self._owner[name], index) for name, index in self._index_of.items()]

    def boxes(self) -> list[PartBounds]:
        """The boxes along the world's axes around all that can touch something.

        Each with the name of its link, the index of the part in PyBullet, and two corners (m).
        """
        return [
            (
                self._owner[part.name],
                self._index_of[part.name],
                *self._client.getAABB(self.number, self._index_of[part.name]),
            )
            for part in self._parts.links
            if part.collisions
        ]


def load(client: Client, tree: Robot, pose: Pose) -> int:
    """Put a tree of links into PyBullet; gives the number of its body.

    Raises:
        pybullet.error: PyBullet does not take it.
    """
    # Inertias come from the description, not from the collision shapes. Cylinders are exact: as
    # polyhedra of 32 faces wheels do not roll and everything stands 1 mm higher. Gazebo lumps
    # before and so do we: PyBullet's own merging of fixed links loses masses and turns inertias.
    # Keeping the order of the links ends with SIGSEGV when a child is written before its parent.
    flags = client.URDF_USE_INERTIA_FROM_FILE | client.URDF_USE_IMPLICIT_CYLINDER
    # With the faces of hulls and boxes PyBullet finds where these touch; without, it lets convex
    # hulls touch 1 mm above their surface. It has no setting for that of a link.
    flags |= client.URDF_INITIALIZE_SAT_FEATURES
    if any(link.self_collide for link in tree.links):
        flags |= client.URDF_USE_SELF_COLLISION
    with _written(write_urdf(tree)) as file:
        return int(
            client.loadURDF(
                file,
                basePosition=pose.xyz,
                baseOrientation=quaternion_of_rpy(pose.rpy),
                useFixedBase=tree.fixed_to_world or tree.is_static,
                flags=flags,
            )
        )


MOST_FILES = 64  # of robots that a child keeps
_files: dict[str, str] = {}  # by the text in them


@contextmanager
def _written(text: str) -> Iterator[str]:
    """A file with a text; a child, whose folder is removed with it, has one file for each text."""
    folder = scratch_folder()
    if folder is None:
        with tempfile.TemporaryDirectory(prefix="wsgen-") as own:
            file = Path(own, "robot.urdf")
            file.write_text(text, encoding="utf-8")
            yield str(file)
        return
    if text not in _files:
        if len(_files) >= MOST_FILES:
            oldest = next(iter(_files))
            Path(_files.pop(oldest)).unlink(missing_ok=True)
        number, name = tempfile.mkstemp(prefix="wsgen-", suffix=".urdf", dir=folder)
        with open(number, "w", encoding="utf-8") as stream:  # noqa: PTH123  it is open already
            stream.write(text)
        _files[text] = name
    yield _files[text]


def _frozen(tree: Robot) -> Robot:
    """A static robot: nothing in it moves."""
    joints = tuple(replace(joint, type=JointType.FIXED) for joint in tree.joints)
    return replace(tree, joints=joints)


def _pose(xyz: Vector, xyzw: tuple[float, float, float, float]) -> Pose:
    return Pose(xyz=xyz, rpy=rpy_of_rotation(rotation_of_quaternion(xyzw)))
