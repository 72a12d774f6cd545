"""The MuJoCo engine, set up so that it does what Gazebo's physics does.

What moves collides as the convex hulls of its meshes, as in PyBullet; what is static as triangles.
"""

from __future__ import annotations

import math
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np

from wsgen.model.robot import Sphere
from wsgen.model.transform import quaternion_of_rpy
from wsgen.simulation import surfaces
from wsgen.simulation.engine import (
    Contact,
    HullGap,
    Loaded,
    Overlap,
    Refused,
    State,
    Touch,
    contacts_of,
    deepest_overlaps,
    look_at,
    meeting,
)
from wsgen.simulation.mujoco_body import (
    GROUND_BIT,
    GROUND_DEPTH,
    MOST_BITS,
    OVERLAP_SHARE,
    RIGIDITY,
    MujocoBody,
    dofs_of,
    library,
    places_of,
    solver,
    surface,
)
from wsgen.simulation.mujoco_contacts import LOOK_EVERY, StaticTriangles, TwoWayFriction

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from numpy.typing import NDArray

    from wsgen.model.transform import Pose, Vector
    from wsgen.model.world import World
    from wsgen.simulation.engine import Look, Motor, Place, Points
    from wsgen.simulation.scene import SpawnedRobot


STILL = (0.0, 0.0, 0.0)
BEHIND = 1e-6  # m, behind a surface that a ray has left
# How fast two bodies may be pushed apart, as in PyBullet; MuJoCo has no such bound either.
SEPARATION_SPEED = 0.25  # m/s
SEPARATION_FROM_TRIANGLES = 0.02  # m/s; their edges push in several directions at once
SEPARATION_STRIDE = 10  # steps between two looks at the overlap while it is large

# How far from the solution the solver may stop. With MuJoCo's 1e-8, robots explode some of whose
# links are a thousand times lighter than others (the character of gym-ignition-models).
TOLERANCE = 1e-12
# m; what touches a triangle by less than MuJoCo's 1e-6 may be pressed onto it instead of held up.
TOUCH_TOLERANCE = 1e-9

MEMORY = 1 << 28  # bytes, for contacts; what is not used costs nothing


class MujocoEngine:
    """A world in MuJoCo."""

    def __init__(self, world: World) -> None:
        self.step_seconds = world.step
        self._world = world
        self._robots: dict[str, MujocoBody] = {}
        self._triangles = StaticTriangles()
        self._speeds: NDArray[np.float64] = np.empty(0)  # of the joints with friction
        self._pushes: dict[tuple[str, str], Vector] = {}  # N, by entity and link
        self._has_stepped = False  # since contacts were looked for in another way
        self._separating = True  # there may be overlaps: something is new where it is
        self._is_current = False  # where everything is, as against how it moves
        self._spec = library.MjSpec()
        self._spec.memory = MEMORY
        self._spec.compiler.degree = False
        self._spec.compiler.inertiafromgeom = 0
        option = self._spec.option
        option.timestep = world.step
        option.gravity = world.gravity
        option.tolerance = TOLERANCE
        option.ccd_tolerance = TOUCH_TOLERANCE
        option.cone = library.mjtCone.mjCONE_PYRAMIDAL
        option.integrator = library.mjtIntegrator.mjINT_IMPLICITFAST
        disabled = library.mjtDisableBit
        # A state that is not finite is to be seen. MuJoCo 3.9 finds no islands among triangles.
        option.disableflags |= disabled.mjDSBL_AUTORESET | disabled.mjDSBL_ISLAND
        # To it, what is fixed to a parent is the parent.
        option.disableflags |= disabled.mjDSBL_FILTERPARENT
        if world.has_ground_plane:
            self._spec.worldbody.add_geom(
                type=library.mjtGeom.mjGEOM_PLANE,
                size=(0.0, 0.0, 1.0),  # without end
                contype=GROUND_BIT,
                conaffinity=0,
                **surface(world.ground_friction, world.step),
            )
        self._model = self._spec.compile()
        self._data = library.MjData(self._model)
        self._friction = TwoWayFriction(self._model, ())
        self._stops: dict[int, tuple[float, float]] = {}  # see `MujocoBody.stops`

    def spawn(self, robot: SpawnedRobot) -> Loaded | Refused:
        """Put a robot into the world, at rest, its joints passive."""
        model, spec = robot.robot, self._spec
        if not model.links:
            return Refused("no link of it has mass")
        before = {kind: len(getattr(spec, kind)) for kind in ("excludes", "meshes")}
        bases = len(spec.worldbody.bodies)
        used = {body.bit for body in self._robots.values()}
        bit = next(
            1 << place
            for place in range(MOST_BITS)
            if 1 << place not in used or place == MOST_BITS - 1
        )
        try:
            body = MujocoBody(
                spec, model, robot.pose_in_world, robot.entity, bit, world=self._world
            )
            self._compile()
        except (ValueError, surfaces.UnreadError) as problem:
            for kind, count in before.items():
                for element in list(getattr(spec, kind))[count:]:
                    spec.delete(element)
            for element in list(spec.worldbody.bodies)[bases:]:
                spec.delete(element)
            return Refused(str(problem).partition("\n")[0])
        self._robots[robot.entity] = body
        self._set_model()
        if body.static_meshes:
            self._triangles.put(robot.entity, body, self.link_poses(robot.entity))
        masses = [self._model.body_mass[one.id] for one in body.bodies.values()]
        mass = model.mass if model.is_static else float(sum(masses))
        return Loaded(len(body.bodies), len(body.joints), mass)

    def _compile(self) -> None:
        """Make the model of the specification; what is in it already stays as it is.

        Raises:
            ValueError: MuJoCo does not take it.
        """
        model = self._spec.compile()
        data = library.MjData(model)
        for name in ("qpos", "qvel", "qacc_warmstart"):
            before = getattr(self._data, name)
            getattr(data, name)[: len(before)] = before
        self._model, self._data = model, data
        self._separating, self._is_current = True, False

    def _set_model(self) -> None:
        """Set what is not in the specification."""
        self._set_motors()
        self._set_pushes()
        for body in self._robots.values():
            # MuJoCo's plane has all inside that is below it, however deep.
            highest = self._boxes_around(body)[:, 1, 2].max(initial=-math.inf)
            is_below = highest < -GROUND_DEPTH
            for shape in body.shapes:
                geom = shape.geom
                bits = geom.conaffinity & ~GROUND_BIT if is_below else geom.conaffinity
                self._model.geom_conaffinity[geom.id] = bits
        self._friction = TwoWayFriction(
            self._model, self._robots.values(), is_classic=self._world.is_classic
        )
        self._stops = {}
        for body in self._robots.values():
            self._stops |= body.stops

    def _set_motors(self) -> None:
        losses, speeds = self._model.dof_frictionloss, np.zeros(self._model.nv)
        for body in self._robots.values():
            for joint, strength, speed in body.motors_of():
                dof = dofs_of(self._model, joint)
                losses[dof], speeds[dof] = strength, speed
        self._speeds = speeds[losses > 0]
        self._data.qfrc_applied[:] = 0.0
        for body in self._robots.values():
            for name, effort in body.efforts.items():
                self._data.qfrc_applied[dofs_of(self._model, body.joints[name])] = effort

    def _set_pushes(self) -> None:
        self._data.xfrc_applied[:] = 0.0
        for (entity, link), force in self._pushes.items():
            body = self._robots[entity].bodies.get(link)
            if body is not None:
                self._data.xfrc_applied[body.id, :3] = force

    def _boxes_around(self, body: MujocoBody) -> NDArray[np.float64]:
        """Two corners each of boxes around what moves of a robot and can touch something, m."""
        geoms = np.array([shape.geom.id for shape in body.shapes], dtype=int)
        centers, radii = self._here().geom_xpos[geoms], self._model.geom_rbound[geoms, None]
        return np.stack([centers - radii, centers + radii], axis=1)

    def place(self, entity: str, pose_in_world: Pose) -> None:
        """Put a robot elsewhere, as if it had been spawned there."""
        body = self._robots[entity]
        body.place(self._model, self._data, pose_in_world)
        self._separating, self._is_current, self._has_stepped = True, False, False
        self._set_model()
        if body.static_meshes:
            self._triangles.put(entity, body, self.link_poses(entity))

    def remove(self, entity: str) -> None:
        """Take a robot out of the world; its name may be used again."""
        body, model, data = self._robots.pop(entity), self._model, self._data
        self._pushes = {place: one for place, one in self._pushes.items() if place[0] != entity}
        joints = [
            joint
            for other in self._robots.values()
            for joint in (*other.free, *other.joints.values())
        ]
        before = [
            (data.qpos[positions].copy(), data.qvel[dofs].copy(), data.qacc_warmstart[dofs].copy())
            for positions, dofs in (places_of(model, joint) for joint in joints)
        ]
        body.remove()
        if body.static_meshes:
            self._triangles.remove(entity)
            self._triangles.surround(self._spec, np.empty((0, 2, 3)), 1.0)
        self._model = model = self._spec.compile()
        self._data = data = library.MjData(model)
        for joint, (qpos, qvel, warm) in zip(joints, before, strict=True):
            positions, dofs = places_of(model, joint)
            data.qpos[positions], data.qvel[dofs], data.qacc_warmstart[dofs] = qpos, qvel, warm
        self._separating, self._is_current, self._has_stepped = True, False, False
        self._set_model()

    def set_velocity(self, entity: str, linear: Vector, angular: Vector) -> None:
        """Have the root link move and turn like that now, seen from the world: m/s and rad/s."""
        body = self._robots[entity]
        if body.robot.fixed_to_world or body.robot.is_static:
            return
        _, dofs = places_of(self._model, body.free[0])
        rotation = self._here().xmat[body.bodies[body.robot.root].id].reshape(3, 3)
        # MuJoCo's free joints turn as seen from the body.
        self._data.qvel[dofs] = (*linear, *(rotation.T @ np.array(angular)))
        self._is_current = False

    def set_joint_positions(self, entity: str, positions: Mapping[str, float]) -> None:
        """Put joints of a robot there, at rest."""
        model, joints = self._model, self._robots[entity].joints
        for name, position in positions.items():
            number = joints[name].id
            if model.jnt_type[number] != library.mjtJoint.mjJNT_BALL:
                self._data.qpos[model.jnt_qposadr[number]] = position
                self._data.qvel[model.jnt_dofadr[number]] = 0.0
        self._separating, self._is_current, self._has_stepped = True, False, False

    def drive(self, entity: str, motors: Mapping[str, Motor]) -> None:
        """Put motors into joints of a robot; those that are not named keep theirs."""
        body = self._robots[entity]
        body.motors.update(motors)
        if body.efforts:
            body.efforts = {name: one for name, one in body.efforts.items() if name not in motors}
        self._set_motors()

    def release(self, entity: str) -> None:
        """Take all motors out of a robot: its joints are passive again."""
        self._robots[entity].motors.clear()
        self._robots[entity].efforts.clear()
        self._set_motors()

    def set_efforts(self, entity: str, efforts: Mapping[str, float]) -> None:
        """From now on, have these efforts (N m or N) act in joints, which lose their motors."""
        body = self._robots[entity]
        body.efforts.update(efforts)
        for name in efforts:
            body.motors.pop(name, None)
        self._set_motors()

    def joint_efforts(self, entity: str) -> dict[str, float]:
        """What acted in the movable joints in the last step, by name, N m or N."""
        body, data = self._robots[entity], self._data
        rows = data.efc_type == library.mjtConstraint.mjCNSTR_FRICTION_DOF
        forces = dict(zip(data.efc_id[rows].tolist(), data.efc_force[rows].tolist(), strict=True))
        efforts = dict.fromkeys(body.joints, 0.0)
        for joint in body.robot.movable_joints:
            moves = joint.name in body.motors or joint.is_held
            if moves and joint.name in body.joints:
                dof = int(self._model.jnt_dofadr[body.joints[joint.name].id])
                efforts[joint.name] = forces.get(dof, 0.0)
        return efforts | body.efforts

    def joint_wrench(self, entity: str, joint: str) -> tuple[Vector, Vector]:
        """The force and the torque of the parent link on the child link of a joint."""
        body, model, data = self._robots[entity], self._model, self._data
        child = next((one.child for one in body.robot.joints if one.name == joint), "")
        if child not in body.bodies or not self._has_stepped:
            return STILL, STILL
        library.mj_rnePostConstraint(model, data)
        number = body.bodies[child].id
        # First the torque, then the force, about the center of mass of the whole tree.
        torque, force = data.cfrc_int[number][:3], data.cfrc_int[number][3:]
        away = data.subtree_com[model.body_rootid[number]] - data.xpos[number]
        (a, b, c), (d, e, f) = force.tolist(), (torque + np.cross(away, force)).tolist()
        return (a, b, c), (d, e, f)

    def advance(self, steps: int) -> None:
        """Let time pass; overlapping bodies are pushed apart no faster than the bound."""
        slowing = [body for body in self._robots.values() if body.slows_down]
        while steps > 0:
            now = steps
            if self._triangles:
                now = min(max(1, round(LOOK_EVERY / self.step_seconds)), now)
                self._surround()
            if self._separating:
                now = min(SEPARATION_STRIDE, now)
                self._bound_separation()
            for _ in range(now):
                library.mj_step1(self._model, self._data)
                if slowing:
                    self._set_pushes()
                    for body in slowing:
                        body.decay(self._model, self._data)
                self._friction.turn(self._model, self._data)
                self._correct()
                library.mj_step2(self._model, self._data)
            steps -= now
            self._is_current, self._has_stepped = False, True

    def push(self, entity: str, link: str, force: Vector) -> None:
        """From now on, have a force (N, in the world) act on a link at its center of mass."""
        self._pushes.pop((entity, link), None)
        if any(force):
            self._pushes[entity, link] = force
        self._set_pushes()

    def contacts(self, entity: str) -> list[Contact]:
        """What a robot touched in the last step."""
        if not self._has_stepped:
            return []
        places, owners = self._places(), self._triangles.owners
        found, force = [], np.zeros(6)
        for number, contact in enumerate(self._data.contact):
            touching = [places.get(geom) for geom in contact.geom.tolist() if geom >= 0]
            touching += [owners[flex] for flex in contact.flex.tolist() if flex >= 0]
            one, other = touching
            library.mj_contactForce(self._model, self._data, number, force)
            # From the first to the second; what is a flex comes last here.
            is_turned = contact.geom[0] < 0 <= contact.geom[1]
            normal = (contact.frame[:3] * (1.0 if is_turned else -1.0)).tolist()
            depth = max(0.0, -float(contact.dist))
            pressure = abs(float(force[0]))
            found.append(Touch(one, other, contact.pos.tolist(), pressure, normal, depth))
        return contacts_of(entity, found)

    def _places(self) -> dict[int, Place]:
        """Which link of which robot a shape belongs to, by MuJoCo's number."""
        return {
            shape.geom.id: (entity, shape.link)
            for entity, body in self._robots.items()
            for shape in body.shapes
        }

    def _correct(self) -> None:
        """Change the accelerations that the constraints of this step aim at.

        What is driven aims at the speed of its motor: the first constraints are friction in joints.

        The last are contacts, of four numbers each: along the edges of a pyramid, two and two of
        which are opposite to each other. To MuJoCo's solver it is as good to leave a contact, as
        fast as friction would brake, as to brake: what slides hops. With so much less of an aim to
        leave, it slides. That is too much by what it gains in speed: casters would carry the load
        of wheels that spin, and mecanum wheels that roll that of those that slide. How much that
        was is known of the last step.
        """
        data, speeds = self._data, self._speeds
        if len(speeds):
            data.efc_aref[: len(speeds)] += data.efc_KBIP[: len(speeds), 1] * speeds
        if self._stops and data.nl:
            self._soften_stops()
        if data.ncon:
            aims = data.efc_aref[data.ne + data.nf + data.nl :].reshape(-1, 4)
            gained = np.zeros(len(data.efc_aref))
            library.mj_mulJacVec(self._model, data, gained, data.qacc_warmstart)
            slips = aims - gained[data.ne + data.nf + data.nl :].reshape(-1, 4)
            aims -= np.abs(slips[:, ::2] - slips[:, 1::2]).max(axis=1, keepdims=True) / 2

    def _soften_stops(self) -> None:
        """Have stops give way as those of ODE, where the description says how.

        ODE's have, after a step, a speed of ERP times the way beyond the limit in a step, less CFM
        times the force that it takes.
        """
        data, step = self._data, self.step_seconds
        for row in range(data.ne + data.nf, data.ne + data.nf + data.nl):
            stop = self._stops.get(int(data.efc_id[row]))
            if stop is None or data.efc_type[row] != library.mjtConstraint.mjCNSTR_LIMIT_JOINT:
                continue
            share, softness = stop
            data.efc_aref[row] = (-share / step * data.efc_pos[row] - data.efc_vel[row]) / step
            if softness > 0:
                data.efc_R[row], data.efc_D[row] = softness / step, step / softness

    def _surround(self) -> None:
        """Have the static triangles in the model that are near what moves."""
        moving = [one for one in self._robots.values() if one.shapes and not one.robot.is_static]
        if not moving:
            return
        seconds = max(LOOK_EVERY, self.step_seconds)  # to the next look
        speed = np.abs(self._here().cvel[:, 3:]).max()
        speed += np.linalg.norm(self._model.opt.gravity) * seconds
        aside = speed * seconds * np.array([[-1.0], [1.0]])
        boxes = np.concatenate([self._boxes_around(body) for body in moving]) + aside
        if self._triangles.have(boxes):
            return
        edged = [
            self._model.geom_rbound[shape.geom.id]
            for body in moving
            for shape in body.shapes
            if not isinstance(shape.geometry, Sphere)
        ]
        if self._triangles.surround(self._spec, boxes, min(edged, default=math.inf)):
            for body in moving:
                body.meet_triangles()
            separating = self._separating
            self._compile()
            self._set_model()
            self._separating = separating

    def _bound_separation(self) -> None:
        """Let so much of the deepest overlap go in a step that the bound is kept."""
        model, data, step = self._model, self._data, self.step_seconds
        library.mj_fwdPosition(model, data)
        depth = -float(data.contact.dist.min(initial=0.0))
        is_in_triangles = (data.contact.flex >= 0).any()
        speed = SEPARATION_FROM_TRIANGLES if is_in_triangles else SEPARATION_SPEED
        self._separating = depth * OVERLAP_SHARE > speed * step
        share = speed * step / depth if self._separating else OVERLAP_SHARE
        model.geom_solref[:] = model.flex_solref[:] = solver(RIGIDITY, share, step)["solref"]

    def _here(self) -> Any:
        """The data, with everything where it is now: a step leaves what was before it."""
        if not self._is_current:
            for update in (library.mj_kinematics, library.mj_comPos, library.mj_comVel):
                update(self._model, self._data)
            self._is_current = True
        return self._data

    def state(self, entity: str) -> State:
        """Where the robot is and how it moves."""
        body, model, data = self._robots[entity], self._model, self._here()
        pose = body.link_pose(data, body.robot.root)
        velocities = np.zeros((max(1, len(body.free)), 6))
        for velocity, joint in zip(velocities, body.free, strict=False):
            kind = library.mjtObj.mjOBJ_BODY  # about its center of mass
            library.mj_objectVelocity(model, data, kind, joint.parent.id, velocity, 0)
        return State(
            xyz=pose.xyz,
            xyzw=quaternion_of_rpy(pose.rpy),
            speed=max(math.hypot(*velocity[3:]) for velocity in velocities),
            turning=max(math.hypot(*velocity[:3]) for velocity in velocities),
            joint_speed=max(
                (math.hypot(*data.qvel[dofs_of(model, joint)]) for joint in body.joints.values()),
                default=0.0,
            ),
        )

    def look(self, entity: str) -> Look:
        """The same, as far as it is looked at every few steps."""
        return look_at(self.state(entity))

    def joint_positions(self, entity: str) -> dict[str, float]:
        """The positions of the movable joints by name, rad or m."""
        body = self._robots[entity]
        return {
            name: body.position(self._model, self._data, joint)
            for name, joint in body.joints.items()
        }

    def joint_velocities(self, entity: str) -> dict[str, float]:
        """The velocities of the movable joints by name, rad/s or m/s."""
        velocities = {
            name: self._data.qvel[dofs_of(self._model, joint)].tolist()
            for name, joint in self._robots[entity].joints.items()
        }
        return {
            name: one[0] if len(one) == 1 else math.hypot(*one) for name, one in velocities.items()
        }

    def energy(self, entity: str) -> float:
        """Kinetic energy, and potential energy above z = 0 in the world's gravity, J."""
        body, model, data = self._robots[entity], self._model, self._here()
        speeds, momenta = np.zeros(model.nv), np.zeros(model.nv)
        energy = 0.0
        for joint in chain(body.joints.values(), body.free):
            speeds[dofs_of(model, joint)] = data.qvel[dofs_of(model, joint)]
            at = model.jnt_qposadr[joint.id]  # of a ball, which has no spring, it means nothing
            turned = data.qpos[at] - model.qpos_spring[at]
            energy += float(model.jnt_stiffness[joint.id] * turned**2) / 2
        library.mj_crb(model, data)
        library.mj_mulM(model, data, momenta, speeds)
        energy += float(speeds @ momenta) / 2
        if not body.robot.is_static:
            for link in body.robot.links:
                if link.gravity and link.name in body.bodies:
                    number = body.bodies[link.name].id
                    height = float(model.opt.gravity @ data.xipos[number])
                    energy -= float(model.body_mass[number]) * height
        return energy

    def lowest_point(self, entity: str) -> float:
        """The z of the lowest point that can touch something, m; that of the root without any."""
        return surfaces.lowest_point(self._robots[entity].robot, self.link_poses(entity))

    def corners(self, entity: str) -> list[Vector]:
        """Corners of boxes along the world's axes around all that can touch something, m."""
        return surfaces.corners(self._robots[entity].robot, self.link_poses(entity))

    def link_poses(self, entity: str) -> dict[str, Pose]:
        """The frames of all links of a robot by name, seen from the world."""
        body, data = self._robots[entity], self._here()
        return {link.name: body.link_pose(data, link.name) for link in body.robot.links}

    def link_velocities(self, entity: str) -> dict[str, tuple[Vector, Vector]]:
        """How the links of a robot move, by name, seen from the world: m/s and rad/s."""
        body, model, data = self._robots[entity], self._model, self._here()
        kind = library.mjtObj.mjOBJ_XBODY  # at the origin of the frame
        velocities: dict[str, tuple[Vector, Vector]] = {}
        for link in body.robot.links:
            velocity = np.zeros(6)
            if link.name in body.bodies:
                number = body.bodies[link.name].id
                library.mj_objectVelocity(model, data, kind, number, velocity, 0)
            a, b, c, x, y, z = velocity.tolist()
            velocities[link.name] = (x, y, z), (a, b, c)
        return velocities

    def cast_rays(self, starts: Points, ends: Points) -> NDArray[np.float64]:
        """How far rays get through what can touch something: fractions of their ways, shape (n,).

        Meshes of what moves are their convex hulls. The shape that a ray begins in it does not see.
        """
        model, data = self._model, self._here()
        begins, ways = np.asarray(starts, dtype=np.float64), np.asarray(ends, dtype=np.float64)
        ways = ways - begins
        geom = np.zeros(1, dtype=np.int32)
        found, geoms = [], []
        for begin, way in zip(begins, ways, strict=True):
            found.append(library.mj_ray(model, data, begin, way, None, 1, -1, geom))
            geoms.append(geom[0])
        fractions, hit = np.array(found, dtype=np.float64), np.array(geoms, dtype=np.int64)
        hits = np.flatnonzero((fractions >= 0.0) & (hit >= 0))
        distances = np.linalg.norm(begins[hits] - data.geom_xpos[hit[hits]], axis=1)
        # Level ground has no bounding sphere.
        for index in hits[distances <= model.geom_rbound[hit[hits]]]:
            fractions[index] = self._cast_out(begins[index], ways[index])
        fractions[(fractions < 0.0) | (fractions > 1.0)] = math.inf
        return np.minimum(fractions, self._triangles.cast_rays(begins, ways))

    def _cast_out(self, begin: NDArray[np.float64], way: NDArray[np.float64]) -> float:
        """How far a ray gets that may begin in shapes, which it does not see; -1 without a hit."""
        model, data = self._model, self._data
        geom, far = np.zeros(1, dtype=np.int32), 0.0
        while far <= 1.0:
            more = library.mj_ray(model, data, begin + far * way, way, None, 1, -1, geom)
            if more < 0.0:
                break
            far += more
            if not self._is_in(begin, way, int(geom[0])):
                return float(far)
            far += BEHIND / float(np.linalg.norm(way))
        return -1.0

    def _is_in(self, point: NDArray[np.float64], way: NDArray[np.float64], geom: int) -> bool:
        """Whether a point is in a shape, which is convex, if a ray from there hits it."""
        model, data = self._model, self._data
        if model.geom_type[geom] == library.mjtGeom.mjGEOM_PLANE:
            return False
        if model.geom_type[geom] == library.mjtGeom.mjGEOM_MESH:
            return bool(library.mj_rayMesh(model, data, geom, point, -way) >= 0.0)
        place, turn = data.geom_xpos[geom], data.geom_xmat[geom]
        size, kind = model.geom_size[geom], model.geom_type[geom]
        return bool(library.mju_rayGeom(place, turn, size, point, -way, kind) >= 0.0)

    def overlaps(self) -> list[Overlap]:
        """Links in each other, of two robots or of one, whether or not they may collide."""
        robots = {entity: body.robot for entity, body in self._robots.items()}
        return deepest_overlaps(self._found_in_each_other(), robots)

    def _found_in_each_other(self) -> Iterator[tuple[Place, Place, float]]:
        if self._triangles:
            self._surround()
        model, data = self._model, self._here()
        boxes = [
            (*self._box(shape.geom.id), ((entity, shape.link), shape.geom.id))
            for entity, body in self._robots.items()
            for shape in body.shapes
        ]
        for (place, geom), (other_place, other) in meeting(boxes):
            if place != other_place:
                distance = library.mj_geomDistance(model, data, geom, other, 1.0, None)
                yield place, other_place, -distance
        for place, other_place, depth, _ in self._contacts():
            yield place, other_place, depth

    def _box(self, geom: int) -> tuple[list[float], list[float]]:
        """Two corners of the box along the world's axes around a shape, m."""
        rotation = self._data.geom_xmat[geom].reshape(3, 3)
        center, half = self._model.geom_aabb[geom].reshape(2, 3)
        middle, reach = self._data.geom_xpos[geom] + rotation @ center, np.abs(rotation) @ half
        return (middle - reach).tolist(), (middle + reach).tolist()

    def _contacts(self) -> Iterator[tuple[Place, Place, float, Vector]]:
        """What touches now, with the depth of the overlap (m), and where; not the ground."""
        places = self._places()
        self._has_stepped = False
        owners = self._triangles.owners
        library.mj_fwdPosition(self._model, self._data)
        for contact in self._data.contact:
            touching = [places[geom] for geom in contact.geom.tolist() if geom in places]
            touching += [owners[flex] for flex in contact.flex.tolist() if flex >= 0]
            if len(touching) > 1:
                x, y, z = contact.pos.tolist()
                yield touching[0], touching[1], -float(contact.dist), (x, y, z)

    def hull_gaps(self, entity: str) -> list[HullGap]:
        """Where a robot touches something with the convex hulls of its meshes alone, right now."""
        robot = self._robots[entity].robot
        if robot.is_static:
            return []  # collides with its triangles
        touched = [
            (one[1], other[0], point)
            for place, other_place, _, point in self._contacts()
            for one, other in ((place, other_place), (other_place, place))
            if one[0] == entity
        ]
        return surfaces.hull_gaps(robot, self.link_poses(entity), touched)

    def close(self) -> None:
        """Nothing: the world goes with its last reference."""
