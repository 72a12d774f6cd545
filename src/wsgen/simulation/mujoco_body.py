"""A robot in MuJoCo, set up so that it moves as in Gazebo; no other module imports MuJoCo.

MuJoCo's constraints are springs. Of each two numbers say how much of an error, and how much of a
speed, goes in one step; a third one how rigid it is.
"""

from __future__ import annotations

import math
import os
import sys
from dataclasses import replace
from itertools import combinations
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

# MuJoCo looks for a window system when it is imported, in a process of its own: it draws nothing.
os.environ["MUJOCO_GL"] = "disable"
import mujoco
from mujoco import mjtGeom, mjtJoint

from wsgen.model.inertia import about_link_axes, made_possible
from wsgen.model.kinematics import split_trees
from wsgen.model.robot import Box, Capsule, Cylinder, JointType, Mesh, Sphere, by_parent
from wsgen.model.transform import Pose, compose, quaternion_of_rpy, rotation_of_rpy, rpy_of_rotation
from wsgen.simulation.contact_shapes import box_around, inner_collisions
from wsgen.simulation.engine import STRONGEST, decays, limit_share, may_touch, stiffness_to_simulate
from wsgen.simulation.surfaces import there, triangles_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from wsgen.model.robot import Collision, Joint, Link, Primitive, Robot
    from wsgen.model.world import World
    from wsgen.simulation.engine import Motor
    from wsgen.simulation.surfaces import Touchable


library = mujoco  # `mujoco.py` takes it from here: one module imports MuJoCo


def _warn(text: str) -> None:
    """What MuJoCo warns of; by itself it writes that into a file in the current folder."""
    print(text, file=sys.stderr, flush=True)  # noqa: T201


mujoco.set_mju_user_warning(_warn)

# How rigid constraints are, from 0 to 1. What stands sinks in by some micrometers; with less MuJoCo
# 3.9 takes the depth of a contact for another one. A held joint creeps by less than one a second.
RIGIDITY = 0.99
JOINT_RIGIDITY = 0.9999
OVERLAP_SHARE = 0.02  # of an overlap, in one step; with more, what falls hops
MOST_FRICTION = 10.0  # what has more stands on a slope of 84 degrees
FRICTION_STEPS = 10**6  # between a friction of 0 and of 1

ENDLESS = 1e9  # rad or m; a limit beyond it is none
NARROWEST = 1e-9  # rad or m, between two limits: MuJoCo takes none that are equal
LEAST_MOMENT = 1e-9  # of the sum of the moments, added to each: MuJoCo takes no rounded zero
SMALLEST_MOMENT = 1e-10  # kg m², likewise; of a point mass
THINNEST = 1e-4  # m; a flat mesh gets as thick, for hulls need a volume

GROUND_DEPTH = 10.0  # m; what is below falls, as below the box that Gazebo makes of a plane
GROUND_BIT = 1 << 30
MOST_BITS = 30  # that distinguish robots; all further ones share the last
ROBOT_BITS = (1 << MOST_BITS) - 1


def solver(rigidity: float, share: float, step: float) -> dict[str, tuple[float, ...]]:
    """MuJoCo's settings of a constraint that stops all motion in one step.

    This share of its error goes with it.
    """
    return {
        "solref": (-share * rigidity**2 / step**2, -rigidity / step),
        "solimp": (rigidity, rigidity, 0.001, 0.5, 2.0),  # the last three are MuJoCo's own
    }


def surface(mu: float, step: float) -> dict[str, Any]:
    """How something touches.

    The smaller of two frictions counts in Gazebo; in MuJoCo that of the higher priority.
    """
    mu = min(max(mu, 0.0), MOST_FRICTION)
    return {
        "condim": 3,
        "friction": (mu, 0.0, 0.0),
        "priority": round((MOST_FRICTION - mu) * FRICTION_STEPS),
        **solver(RIGIDITY, OVERLAP_SHARE, step),
    }


class Shape(NamedTuple):
    """Something that moves and can be touched."""

    link: str
    geometry: Touchable
    geom: Any
    collision: Collision


class StaticMesh(NamedTuple):
    """Something static that can be touched at its triangles."""

    link: str
    mesh: Mesh
    pose_in_link: Pose
    surface: dict[str, Any]


class MujocoBody:
    """All trees of a robot in a world; poses are those of its root link's frame.

    What it adds to the specification of the world knows its number in the model, when that has been
    compiled.
    """

    def __init__(  # noqa: PLR0913  what it adds, and where
        self,
        spec: Any,
        robot: Robot,
        pose_in_world: Pose,
        name: str,
        bit: int,
        *,
        world: World,
    ) -> None:
        """Add it to the specification.

        Raises:
            UnreadError: A mesh cannot be used.
            ValueError: MuJoCo does not take it.
        """
        self.robot = robot
        self.pose = pose_in_world
        self.bodies: dict[str, Any] = {}  # by link name
        self.joints: dict[str, Any] = {}  # the movable ones, by name
        self.shapes: list[Shape] = []
        self.static_meshes: list[StaticMesh] = []
        self.free: list[Any] = []  # the joints above the trees that are not fixed
        self.motors: dict[str, Motor] = {}
        self.efforts: dict[str, float] = {}  # N m or N, by joint
        self._bases: list[tuple[Any, Pose]] = []  # bodies below the world, with their poses in it
        self._excludes: list[Any] = []
        self._meshes: list[Any] = []
        self._spec, self._name, self.bit = spec, name, bit
        self._step, self._world = world.step, world
        self._decays = decays(robot, world)
        self._meets_own = bit > ROBOT_BITS // 2 or any(link.self_collide for link in robot.links)
        for tree, pose_in_robot in split_trees(robot):
            self._add_tree(tree, pose_in_robot)
        if self._meets_own and not robot.is_static:
            self._keep_apart()

    def _add_tree(self, tree: Robot, pose_in_robot: Pose) -> None:
        links = {link.name: link for link in tree.links}
        below = by_parent(tree.joints)
        world = self._spec.worldbody
        if not tree.fixed_to_world:
            base = self._add_body(world, links[tree.root], pose_in_robot)
            if not tree.is_static:
                self.free.append(base.add_freejoint())
        queue = [tree.root]
        for parent in queue:
            for joint in below.get(parent, ()):
                above = self.bodies.get(parent, world)
                body = self._add_body(above, links[joint.child], joint.pose_in_parent)
                if joint.is_movable and not tree.is_static:
                    self.joints[joint.name] = self._add_joint(body, joint, tree)
                queue.append(joint.child)

    def _add_body(self, above: Any, link: Link, pose: Pose) -> Any:
        body = self.bodies[link.name] = above.add_body(name=self._unique(link.name))
        if above is self._spec.worldbody:
            self._bases.append((body, pose))
            pose = compose(self.pose, pose)
        set_pose(body, pose)
        body.gravcomp = 0.0 if link.gravity else 1.0
        if link.inertial is not None:
            xx, xy, xz, yy, yz, zz = made_possible(about_link_axes(link.inertial))
            more = LEAST_MOMENT * (xx + yy + zz) + SMALLEST_MOMENT
            body.explicitinertial = True
            body.mass = link.inertial.mass
            body.ipos = link.inertial.pose_in_link.xyz
            body.fullinertia = (xx + more, yy + more, zz + more, xy, xz, yz)
        inner = set() if self.robot.is_static else inner_collisions(link)
        outer = {id(shape) for number, shape in enumerate(link.collisions) if number not in inner}
        for geometry, collision in there(link):
            self._add_shape(body, link.name, geometry, collision, is_outer=id(collision) in outer)
        return body

    def _unique(self, name: str) -> str:
        return f"{name} of {self._name}"

    def _add_joint(self, body: Any, joint: Joint, tree: Robot) -> Any:
        if joint.type is JointType.BALL:
            return body.add_joint(type=mjtJoint.mjJNT_BALL)
        is_slide = joint.type is JointType.PRISMATIC
        more: dict[str, Any] = {}
        if joint.limit is not None and joint.type is not JointType.CONTINUOUS:
            lower, upper = max(joint.limit.lower, -ENDLESS), min(joint.limit.upper, ENDLESS)
            more = {"limited": 1, "range": (lower, max(upper, lower + NARROWEST))}
        for kind in ("friction", "limit"):
            settings = solver(JOINT_RIGIDITY, limit_share(self._world), self._step)
            more |= {f"{name}_{kind}": value for name, value in settings.items()}
        return body.add_joint(
            type=mjtJoint.mjJNT_SLIDE if is_slide else mjtJoint.mjJNT_HINGE,
            axis=joint.axis_in_joint,
            damping=joint.damping,
            stiffness=stiffness_to_simulate(joint, tree, self._step),
            springref=joint.spring_reference,
            **more,
        )

    def _add_shape(
        self, body: Any, link: str, geometry: Touchable, collision: Collision, *, is_outer: bool
    ) -> None:
        meets = ROBOT_BITS if self._meets_own else ROBOT_BITS & ~self.bit
        if is_outer:
            meets |= GROUND_BIT
        how = surface(collision.surface.mu1, self._step) | {
            "contype": self.bit,
            "conaffinity": meets,
        }
        pose, parts = collision.pose_in_link, [0.0]
        if isinstance(geometry, Mesh) and self.robot.is_static:
            triangles_of(geometry)  # now, when it can be refused
            self.static_meshes.append(StaticMesh(link, geometry, pose, how))
            return
        if isinstance(geometry, Cylinder) and not self._world.is_classic:
            # A wheel that turns on the spot would turn about its outer edge, as in Gazebo Classic:
            # MuJoCo lets the two rims carry all. Of two halves the rims in the middle carry as
            # much as the others.
            geometry = replace(geometry, length=geometry.length / 2)
            parts = [geometry.length / 2, -geometry.length / 2]
        for z in parts:
            geom = body.add_geom(name=self._unique(f"shape {len(self.shapes)}"), **how)
            if isinstance(geometry, Mesh):
                self._make_hull(geom, _with_volume(triangles_of(geometry).reshape(-1, 3)))
            else:
                geom.type, geom.size = _type_and_size(geometry)
            set_pose(geom, compose(pose, Pose(xyz=(0.0, 0.0, z))))
            self.shapes.append(Shape(link, geometry, geom, collision))

    def _make_hull(self, geom: Any, points: NDArray[np.float64]) -> None:
        mesh = self._spec.add_mesh(
            name=f"hull of {geom.name}", inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX
        )
        self._meshes.append(mesh)
        mesh.uservert = np.unique(points.astype(np.float32), axis=0).ravel()
        geom.type, geom.meshname = mjtGeom.mjGEOM_MESH, mesh.name

    def meet_triangles(self) -> None:
        """Make hulls of boxes: those of MuJoCo fall through triangles."""
        for _, geometry, geom, _ in self.shapes:
            if isinstance(geometry, Box) and geom.type == mjtGeom.mjGEOM_BOX:
                self._make_hull(geom, np.array(list(box_around(geometry))))

    def remove(self) -> None:
        """Take it out of the specification, which must be compiled then."""
        for exclude in self._excludes:
            self._spec.delete(exclude)
        for base, _ in self._bases:
            self._spec.delete(base)
        for mesh in self._meshes:
            self._spec.delete(mesh)

    def _keep_apart(self) -> None:
        """Let only those links touch each other that touch each other in Gazebo."""
        touching = may_touch(self.robot, is_one_enough=self._world.is_classic)
        for one, other in combinations(self.bodies, 2):
            if frozenset((one, other)) not in touching:
                self._excludes.append(
                    self._spec.add_exclude(
                        bodyname1=self._unique(one), bodyname2=self._unique(other)
                    )
                )

    def place(self, model: Any, data: Any, pose_in_world: Pose) -> None:
        """Put it somewhere, at rest, its joints at zero."""
        self.pose = pose_in_world
        free = {joint.parent.id: joint for joint in self.free}
        for base, pose in self._bases:
            set_pose(base, compose(pose_in_world, pose))
            model.body_pos[base.id], model.body_quat[base.id] = base.pos, base.quat
            if base.id in free:
                at, dof = model.jnt_qposadr[free[base.id].id], model.jnt_dofadr[free[base.id].id]
                data.qpos[at : at + 7] = (*base.pos, *base.quat)
                data.qvel[dof : dof + 6] = data.qacc_warmstart[dof : dof + 6] = 0.0
        for joint in self.joints.values():
            at, dofs = model.jnt_qposadr[joint.id], dofs_of(model, joint)
            if joint.type == mjtJoint.mjJNT_BALL:
                data.qpos[at : at + 4] = (1.0, 0.0, 0.0, 0.0)
            else:
                data.qpos[at] = 0.0
            data.qvel[dofs] = data.qacc_warmstart[dofs] = 0.0

    @property
    def stops(self) -> dict[int, tuple[float, float]]:
        """What ODE has of the stops of joints in Gazebo Classic, by MuJoCo's number."""
        if not self._world.is_classic:
            return {}
        said = ((joint.name, joint.stop) for joint in self.robot.movable_joints)
        return {
            self.joints[name].id: stop
            for name, stop in said
            if stop is not None and name in self.joints
        }

    def decay(self, model: Any, data: Any) -> None:
        """Add to the forces of the next step what takes a share of speeds away."""
        for link, shares in self._decays.items():
            number, velocity = self.bodies[link].id, np.zeros(6)
            mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, number, velocity, 0)
            linear, angular = (share / self._step for share in shares)
            axes = data.ximat[number].reshape(3, 3)
            momentum = axes @ (model.body_inertia[number] * (axes.T @ velocity[:3]))
            data.xfrc_applied[number, :3] -= linear * model.body_mass[number] * velocity[3:]
            data.xfrc_applied[number, 3:] -= angular * momentum

    @property
    def slows_down(self) -> bool:
        """Whether `decay` does anything."""
        return bool(self._decays)

    def motors_of(self) -> Iterator[tuple[Any, float, float]]:
        """The joints that something resists, how strongly (N m or N), and at what speed.

        A motor is friction on what moves as fast; so is one that holds, on what stands. What
        resists the joint by itself is taken from its strength.
        """
        for joint in self.robot.movable_joints:
            if joint.name not in self.joints or joint.type is JointType.BALL:
                continue
            made, motor = self.joints[joint.name], self.motors.get(joint.name)
            if motor is None:
                is_held = joint.is_held and joint.name not in self.efforts
                yield made, STRONGEST if is_held else joint.friction, 0.0
            else:
                left = min(motor.effort, STRONGEST) - joint.friction
                yield made, abs(left), motor.speed if left > 0 else 0.0

    def link_pose(self, data: Any, link: str) -> Pose:
        """The frame of a link, seen from the world."""
        if link not in self.bodies:
            return self.pose
        number = self.bodies[link].id
        a, b, c, d, e, f, g, h, i = data.xmat[number].tolist()
        x, y, z = data.xpos[number].tolist()
        return Pose(xyz=(x, y, z), rpy=rpy_of_rotation(((a, b, c), (d, e, f), (g, h, i))))

    def position(self, model: Any, data: Any, joint: Any) -> float:
        """The position of a joint, rad or m; of a ball the angle by which it has turned."""
        at = model.jnt_qposadr[joint.id]
        if joint.type != mjtJoint.mjJNT_BALL:
            return float(data.qpos[at])
        w, *xyz = data.qpos[at : at + 4].tolist()
        return 2 * math.atan2(math.hypot(*xyz), abs(w))


def places_of(model: Any, joint: Any) -> tuple[slice, slice]:
    """Where the position of a joint is, and where its speeds are."""
    first = int(model.jnt_qposadr[joint.id])
    count = {int(mjtJoint.mjJNT_FREE): 7, int(mjtJoint.mjJNT_BALL): 4}.get(int(joint.type), 1)
    return slice(first, first + count), dofs_of(model, joint)


def dofs_of(model: Any, joint: Any) -> slice:
    """Where the speeds of a joint are."""
    first = int(model.jnt_dofadr[joint.id])
    count = {int(mjtJoint.mjJNT_FREE): 6, int(mjtJoint.mjJNT_BALL): 3}.get(int(joint.type), 1)
    return slice(first, first + count)


def set_pose(element: Any, pose: Pose) -> None:
    """Give it to an element of the specification."""
    x, y, z, w = quaternion_of_rpy(pose.rpy)
    element.pos, element.quat = pose.xyz, (w, x, y, z)


def placed(points: NDArray[np.float64], pose: Pose) -> NDArray[np.float64]:
    """Points of a frame, shape (..., 3), seen from where its pose is seen from."""
    turned: NDArray[np.float64] = points @ np.array(rotation_of_rpy(pose.rpy)).T + pose.xyz
    return turned


def _type_and_size(geometry: Primitive) -> tuple[Any, tuple[float, ...]]:
    if isinstance(geometry, Box):
        return mjtGeom.mjGEOM_BOX, tuple(edge / 2 for edge in geometry.size)
    if isinstance(geometry, Sphere):
        return mjtGeom.mjGEOM_SPHERE, (geometry.radius, 0.0, 0.0)
    is_capsule = isinstance(geometry, Capsule)
    kind = mjtGeom.mjGEOM_CAPSULE if is_capsule else mjtGeom.mjGEOM_CYLINDER
    return kind, (geometry.radius, geometry.length / 2, 0.0)


def _with_volume(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """The points, shape (n, 3), with more of them where they are flat."""
    middle = points.mean(axis=0)
    for axis in np.linalg.eigh((points - middle).T @ (points - middle))[1].T:
        if np.ptp(points @ axis) < THINNEST:
            aside = axis * THINNEST / 2
            points = np.concatenate([points - aside, points + aside])
    return points
