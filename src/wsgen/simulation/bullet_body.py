"""One tree of links in PyBullet, set up so that it moves as in Gazebo."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.isolation.child import scratch_folder
from wsgen.model.pose import Pose
from wsgen.model.robot import JointType
from wsgen.model.transform import (
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
from wsgen.simulation.bullet_damper import Dampers, is_stiff, stiffness_to_simulate, undamped
from wsgen.simulation.bullet_meshes import unread_mesh, without_missing_meshes
from wsgen.simulation.bullet_motors import set_motor
from wsgen.simulation.bullet_properties import ROOT, keep_apart, release_joints, set_links
from wsgen.simulation.surfaces import inner_apart, one_friction_a_link
from wsgen.simulation.urdf_writer import write_urdf

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.model.robot import Robot
    from wsgen.simulation.bullet_client import Client
    from wsgen.simulation.engine import Motor

PartBounds = tuple[str, int, Vector, Vector]  # see `BulletBody.boxes`


class BulletBody:
    """A tree of links; the poses it is given and gives are those of its root link's frame."""

    def __init__(
        self, client: Client, tree: Robot, pose_in_world: Pose, *, step_seconds: float
    ) -> None:
        """Load it.

        Raises:
            bullet_client.error: PyBullet does not take it.
        """
        self._client = client
        self.tree = _frozen(tree) if tree.is_static else tree
        stiff = [joint for joint in self.tree.joints if is_stiff(joint, self.tree, step_seconds)]
        self._parts, self._owner, self._inner = inner_apart(
            *one_friction_a_link(
                replace(
                    without_missing_meshes(self.tree),
                    joints=undamped(self.tree.joints, {joint.name for joint in stiff}),
                )
            )
        )
        self.number = self._load(pose_in_world)
        self._index_of = self._number_parts()
        self.indices = {link.name: self._index_of[link.name] for link in self.tree.links}
        self.movable = {
            joint.name: self._index_of[joint.child] for joint in self.tree.movable_joints
        }
        self._dynamics = {
            index: client.getDynamicsInfo(self.number, index) for index in self._index_of.values()
        }
        self._dampers = self.dampers = Dampers(
            indices=[self.movable[joint.name] for joint in stiff],
            damping=[joint.damping for joint in stiff],
            friction=[joint.friction for joint in stiff],
            speeds=[0.0] * len(stiff),
        )
        self._root_from_base = invert(_pose(*self._dynamics[ROOT][3:5]))
        self._set_properties()
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
        if any(link.self_collide for link in self.tree.links):
            keep_apart(client, self.number, self.tree, self._index_of, self._owner)

    def _load(self, pose: Pose) -> int:
        return load(self._client, self._parts, pose)

    def unread_mesh(self) -> str | None:
        """A mesh file that PyBullet left out without an error."""
        return unread_mesh(self._client, self.number, self._parts, self._index_of)

    def keep_inner_off(self, ground: int) -> None:
        """Let a level ground touch no more of it than its convex hull; see `inner_collisions`."""
        for name in self._inner:
            index = self._index_of[name]
            self._client.setCollisionFilterPair(ground, self.number, ROOT, index, 0)

    @property
    def mass(self) -> float:
        """What PyBullet takes it to weigh, kg; that of the description for what is static."""
        if self.tree.is_static:  # PyBullet gives what is fixed no mass
            return self.tree.mass
        return sum(float(dynamics[0]) for dynamics in self._dynamics.values())

    @property
    def pulls(self) -> bool:
        """Whether `pull` must be called before every step."""
        return bool(self._springs or self._weightless)

    def drive(self, motors: Mapping[str, Motor]) -> None:
        """Put motors into those of the joints that are in this tree."""
        for joint in self.tree.movable_joints:
            if joint.name in motors:
                index = self.movable[joint.name]
                is_stiff = index in self._dampers.indices
                rest = joint if is_stiff else replace(joint, damping=0.0)
                set_motor(self._client, self.number, index, rest, motors[joint.name])
        driven = {self.movable[name] for name in motors if name in self.movable}
        self.dampers = self.dampers.without(driven)

    def release(self) -> None:
        """Take all motors away."""
        release_joints(self._client, self.number, self.tree, self.movable)
        self.dampers = self._dampers

    def damp(self) -> None:
        """For the next steps, set what its stiff dampers do."""
        if self.dampers.indices:
            self.dampers.apply(self._client, self.number)

    def pull(self, gravity: Vector) -> None:
        """For the next step, apply what PyBullet has no notion of: springs, missing gravity."""
        client = self._client
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
            centre = self._centre(index)
            lift = tuple(-mass * part for part in gravity)
            client.applyExternalForce(self.number, index, lift, centre.xyz, client.WORLD_FRAME)

    def place(self, pose_in_world: Pose) -> None:
        """Put it somewhere, at rest, its joints at zero."""
        client = self._client
        base = compose(pose_in_world, invert(self._root_from_base))
        client.resetBasePositionAndOrientation(self.number, base.xyz, quaternion_of_rpy(base.rpy))
        client.resetBaseVelocity(self.number, (0, 0, 0), (0, 0, 0))
        for index in self.movable.values():
            client.resetJointState(self.number, index, 0.0)

    def root_pose(self) -> Pose:
        """The frame of the root link; PyBullet's base is the frame at its centre of mass."""
        return compose(self._centre(ROOT), self._root_from_base)

    def joint_states(self) -> list[tuple[float, float]]:
        """Position and speed of the movable joints, in their order."""
        if not self.movable:
            return []
        states = self._client.getJointStates(self.number, list(self.movable.values()))
        return [(state[0], state[1]) for state in states]

    def link_poses(self) -> dict[str, Pose]:
        """The frames of all links by name."""
        client, poses = self._client, {self.tree.root: self.root_pose()}
        for name, index in self.indices.items():
            if index != ROOT:
                state = client.getLinkState(self.number, index, computeForwardKinematics=1)
                poses[name] = _pose(state[4], state[5])
        return poses

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
            centre, linear, angular = self._motion(index)
            turning = rotate(transpose(rotation_of_rpy(centre.rpy)), angular)
            total += mass * (sum(part * part for part in linear) / 2)
            total += sum(m * w * w for m, w in zip(moments, turning, strict=True)) / 2
            if index not in self._weightless:
                total -= mass * sum(g * x for g, x in zip(gravity, centre.xyz, strict=True))
        return total

    def _motion(self, index: int) -> tuple[Pose, Vector, Vector]:
        """Pose and velocities of a link's centre of mass, along its principal axes."""
        client = self._client
        if index == ROOT:
            return (self._centre(ROOT), *client.getBaseVelocity(self.number))
        state = client.getLinkState(
            self.number, index, computeLinkVelocity=1, computeForwardKinematics=1
        )
        return _pose(state[0], state[1]), state[6], state[7]

    def _centre(self, index: int) -> Pose:
        if index == ROOT:
            return _pose(*self._client.getBasePositionAndOrientation(self.number))
        state = self._client.getLinkState(self.number, index, computeForwardKinematics=1)
        return _pose(state[0], state[1])

    def link_of(self, index: int) -> str:
        """The link of a part, by PyBullet's index."""
        return next(self._owner[name] for name, at in self._index_of.items() if at == index)

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
        bullet_client.error: PyBullet does not take it.
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
    with tempfile.TemporaryDirectory(prefix="wsgen-", dir=scratch_folder()) as folder:
        file = Path(folder, "robot.urdf")
        file.write_text(write_urdf(tree), encoding="utf-8")
        return int(
            client.loadURDF(
                str(file),
                basePosition=pose.xyz,
                baseOrientation=quaternion_of_rpy(pose.rpy),
                useFixedBase=tree.fixed_to_world or tree.is_static,
                flags=flags,
            )
        )


def _frozen(tree: Robot) -> Robot:
    """A static robot: nothing in it moves."""
    joints = tuple(replace(joint, type=JointType.FIXED) for joint in tree.joints)
    return replace(tree, joints=joints)


def _pose(xyz: Vector, xyzw: tuple[float, float, float, float]) -> Pose:
    return Pose(xyz=xyz, rpy=rpy_of_rotation(rotation_of_quaternion(xyzw)))
