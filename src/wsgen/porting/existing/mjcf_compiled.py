"""What MuJoCo makes of an MJCF, as a `Robot`; importing it loads MuJoCo: it runs in a child.

MuJoCo resolves default classes, included files, orientations, units and inertias itself. A body
becomes a link whose frame is at the last of its joints, along the axes of the body. SI units.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wsgen.descriptions.meshes.stl import write_stl
from wsgen.model.robot import (
    Box,
    Capsule,
    Collision,
    Cylinder,
    Ellipsoid,
    Inertial,
    Joint,
    JointLimit,
    JointType,
    Link,
    Mesh,
    Mimic,
    Robot,
    Sphere,
    Surface,
    Visual,
)
from wsgen.model.transform import Pose
from wsgen.porting.existing.mjcf import Compiled
from wsgen.porting.existing.mjcf_left_out import LeftOut, is_of, line_of
from wsgen.porting.existing.mjcf_reference import refer_to
from wsgen.porting.existing.urdf_text import FARTHEST, free
from wsgen.simulation.mujoco_body import library as mujoco

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

    from wsgen.model.robot import Geometry, Rgba

    Frame = NDArray[np.float64]  # 4 by 4


HIDDEN_GROUP = 3  # MuJoCo's viewers show the groups below it
DEFAULT_RGBA = (0.5, 0.5, 0.5, 1.0)
FILES = (".stl", ".obj")  # that others read as MuJoCo does
WORLD = "world"
MEASURED = (
    *("body_pos", "body_quat", "body_mass", "body_inertia", "body_ipos", "body_iquat"),
    *("jnt_pos", "jnt_axis", "jnt_range", "qpos0", "geom_pos", "geom_quat", "geom_size"),
)
UNNAMED = "MuJoCo Model"  # what it calls a model without a name
EYE = np.eye(4)


def compile_model(file: str, scratch: str) -> Compiled | str:
    """The robot of an MJCF; a text says why MuJoCo refuses it.

    Args:
        file: The MJCF.
        scratch: A folder for meshes that are not files, or that are changed when they are read.
    """
    try:
        spec = mujoco.MjSpec.from_file(file)
        # What is only seen belongs to the robot, and so do bodies without joints.
        for name in ("discardvisual", "fusestatic"):
            setattr(spec.compiler, name, False)
        model = spec.compile()
    except (ValueError, RuntimeError) as error:
        return str(error)
    if model.nbody == 1:
        return "it has no <body>"
    if not all(np.isfinite(getattr(model, name)).all() for name in MEASURED):
        return "a number in it is infinite or not a number"
    return _Reader(spec, model, Path(file), Path(scratch)).read()


class _Reader(LeftOut):
    def __init__(self, spec: Any, model: Any, file: Path, scratch: Path) -> None:
        super().__init__(spec, model)
        self.file = file
        self.scratch = scratch
        self.links: list[Link] = []
        self.crosses: list[str] = []
        self.in_link: dict[int, Frame] = {0: EYE}  # the frames of bodies in those of their links
        self.meshes: dict[int, tuple[Mesh, Frame]] = {}

    # ---- what is read -------------------------------------------------------------------------

    def read(self) -> Compiled:
        """The robot, and what is not in it."""
        model = self.model
        trees, loose = self._choose()
        self._name(trees)
        is_floating = any(self._is_free(body) for body in trees)
        if not is_floating:
            self.links.append(Link(name=WORLD))
        efforts = self._efforts()
        for body in range(1, model.nbody):
            if int(model.body_rootid[body]) in trees:
                self._add_body(body, efforts)
        self._add_sites()
        self._couple()
        self._say_about_bodies(loose)
        self._say_about_joints()
        self._say_about_the_rest(trees)
        robot = Robot(
            name=self.spec.modelname if self.spec.modelname != UNNAMED else self.file.stem,
            root=self.links[0].name,
            links=tuple(self.links),
            joints=tuple(self.joints),
            fixed_to_world=not is_floating,
        )
        bodies = {name: body for body, name in self.link_names.items()}
        joints = {name: joint for joint, name in self.joint_names.items()}
        reference = refer_to(model, robot, bodies, joints)
        return Compiled(robot, tuple(self.said), tuple(self.crosses), reference)

    def _choose(self) -> tuple[set[int], list[int]]:
        """The bodies of the world with which the robot begins, and those that are left out.

        It is what has the most joints: a tree that floats, or all that are fixed to the world.
        """
        model = self.model
        tops = [one for one in range(1, model.nbody) if model.body_parentid[one] == 0]
        count = Counter(int(model.body_rootid[body]) for body in model.jnt_bodyid)
        still = {one for one in tops if not self._is_free(one) and model.body_mocapid[one] < 0}
        floating = [one for one in tops if self._is_free(one)]
        largest = max(
            floating, key=lambda one: (count[one], model.body_subtreemass[one]), default=None
        )
        moved = sum(count[one] for one in still)
        # A free joint counts as one: what floats alone is an object beside an arm.
        if largest is not None and (count[largest] > moved + 1 or not moved):
            trees = {largest}
        else:
            trees = still
        return trees, [one for one in tops if one not in trees]

    def _name(self, trees: set[int]) -> None:
        """Names for all links and joints, each once: SDF has one namespace for both."""
        model, taken = self.model, {WORLD}
        names = {0: "body"}
        for body in range(1, model.nbody):
            parent = names[int(model.body_parentid[body])]
            names[body] = free(model.body(body).name or f"{parent}_1", taken)
            taken.add(names[body])
            if int(model.body_rootid[body]) in trees:
                self.link_names[body] = names[body]
        for joint in range(model.njnt):
            body = int(model.jnt_bodyid[joint])
            if body in self.link_names:
                written = model.joint(joint).name
                if not written or written in taken:
                    written = f"{written or self.link_names[body]}_joint"
                name = free(written, taken)
                taken.add(name)
                self.joint_names[joint] = name
        self.taken = taken

    def _add_body(self, body: int, efforts: dict[int, float]) -> None:
        model = self.model
        parent_body = int(model.body_parentid[body])
        parent = self.link_names.get(parent_body, WORLD)
        name = self.link_names[body]
        place = self.in_link[parent_body] @ _frame(model.body_pos[body], model.body_quat[body])
        first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
        joints = [] if self._is_free(body) else list(range(first, first + count))
        if not joints and not self._is_free(body):
            self._fix(parent, name, place)
        rest = EYE  # the frame of the body in that of the last joint
        for joint in joints:
            child = name
            if joint != joints[-1]:
                child = free(f"{self.joint_names[joint]}_link", self.taken)
                self.taken.add(child)
                self.links.append(Link(name=child))
                self.crosses.append(child)
            before, rest = self._around(joint)
            self.joints.append(self._joint(joint, parent, child, place @ before, efforts))
            place, parent = rest, child
        self.in_link[body] = rest
        self.links.append(self._link(body, name))

    def _around(self, joint: int) -> tuple[Frame, Frame]:
        """From the body to the joint at position 0, and from the joint to the body."""
        model = self.model
        axis = model.jnt_axis[joint]
        if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_SLIDE:
            return _frame(-axis * self._reference(joint)), EYE
        anchor = model.jnt_pos[joint]
        turned = np.zeros(4)
        mujoco.mju_axisAngle2Quat(turned, axis, -self._reference(joint))
        return _frame(anchor, turned), _frame(-anchor)

    def _joint(
        self, joint: int, parent: str, child: str, place: Frame, efforts: dict[int, float]
    ) -> Joint:
        model = self.model
        kind, dof = model.jnt_type[joint], model.jnt_dofadr[joint]
        is_limited = bool(model.jnt_limited[joint])
        effort = efforts.get(joint, FARTHEST)
        is_ball = kind == mujoco.mjtJoint.mjJNT_BALL
        lower, upper = map(float, model.jnt_range[joint])
        if is_ball:
            joint_type, lower = JointType.BALL, -upper
        elif kind == mujoco.mjtJoint.mjJNT_SLIDE:
            joint_type = JointType.PRISMATIC
            if not is_limited:
                lower, upper = -FARTHEST, FARTHEST
        else:
            joint_type = JointType.REVOLUTE if is_limited else JointType.CONTINUOUS
        # A limit of a joint that turns endlessly says its effort alone.
        has_limit = is_limited or (not is_ball and effort < FARTHEST)
        x, y, z = map(float, model.jnt_axis[joint])
        return Joint(
            name=self.joint_names[joint],
            type=joint_type,
            parent=parent,
            child=child,
            pose_in_parent=_pose(place),
            axis_in_joint=(x, y, z),
            limit=JointLimit(lower=lower, upper=upper, effort=effort, velocity=FARTHEST)
            if has_limit
            else None,
            damping=float(model.dof_damping[dof]),
            friction=float(model.dof_frictionloss[dof]),
            spring_stiffness=0.0 if is_ball else float(model.jnt_stiffness[joint]),
            spring_reference=0.0 if is_ball else float(model.qpos_spring[model.jnt_qposadr[joint]]),
        )

    def _link(self, body: int, name: str) -> Link:
        model, offset = self.model, self.in_link[body]
        inertial = None
        mass = float(model.body_mass[body])
        if mass > 0:
            xx, yy, zz = map(float, model.body_inertia[body])
            inertial = Inertial(
                mass=mass,
                pose_in_link=_pose(offset @ _frame(model.body_ipos[body], model.body_iquat[body])),
                inertia=(xx, 0.0, 0.0, yy, 0.0, zz),
            )
        visuals, collisions = [], []
        first = int(model.body_geomadr[body])
        for geom in range(first, first + int(model.body_geomnum[body])):
            shape = self._shape(geom)
            if shape is None:
                continue
            geometry, moved = shape
            pose = _pose(offset @ moved)
            rgba = self._rgba(geom)
            if rgba[3] > 0 and model.geom_group[geom] < HIDDEN_GROUP:
                visuals.append(Visual(geometry=geometry, pose_in_link=pose, rgba=rgba))
            if model.geom_contype[geom] or model.geom_conaffinity[geom]:
                sliding = float(model.geom_friction[geom][0])
                hull = self._hull(geom)
                if hull is not None:
                    geometry = hull
                    pose = _pose(offset @ _frame(model.geom_pos[geom], model.geom_quat[geom]))
                surface = Surface(mu1=sliding, mu2=sliding)
                collisions.append(Collision(geometry=geometry, pose_in_link=pose, surface=surface))
        return Link(
            name=name,
            inertial=inertial,
            visuals=tuple(visuals),
            collisions=tuple(collisions),
            gravity=bool(model.body_gravcomp[body] != 1),
            line=line_of(self._element("body", body)) or None,
        )

    def _add_sites(self) -> None:
        """Links for sites: frames of tools and sensors, not what tendons or skins of touch need."""
        model = self.model
        of_tendons = model.wrap_objid[model.wrap_type == mujoco.mjtWrap.mjWRAP_SITE]
        touching = model.sensor_objid[model.sensor_type == mujoco.mjtSensor.mjSENS_TOUCH]
        for site in sorted({*range(model.nsite)}.difference(of_tendons, touching)):
            name, body = model.site(site).name, int(model.site_bodyid[site])
            if not name or body not in self.link_names:
                continue
            link = free(f"{name}_site" if name in self.taken else name, self.taken)
            self.taken.add(link)
            place = self.in_link[body] @ _frame(model.site_pos[site], model.site_quat[site])
            self.links.append(Link(name=link))
            self._fix(self.link_names[body], link, place)

    def _fix(self, parent: str, child: str, place: Frame) -> None:
        name = free(f"{child}_fixed", self.taken)
        self.taken.add(name)
        self.joints.append(
            Joint(
                name=name,
                type=JointType.FIXED,
                parent=parent,
                child=child,
                pose_in_parent=_pose(place),
            )
        )

    def _rgba(self, geom: int) -> Rgba:
        own = _rgba(self.model.geom_rgba[geom])
        material = int(self.model.geom_matid[geom])
        # As MuJoCo draws it: a color that differs from the default is stronger than the material.
        if material >= 0 and own == DEFAULT_RGBA:
            return _rgba(self.model.mat_rgba[material])
        return own

    def _shape(self, geom: int) -> tuple[Geometry, Frame] | None:
        """The shape of a geom, and its frame in the body; None for one of the surroundings."""
        model = self.model
        kinds = mujoco.mjtGeom
        kind = kinds(int(model.geom_type[geom]))
        frame = _frame(model.geom_pos[geom], model.geom_quat[geom])
        a, b, c = map(float, model.geom_size[geom])
        solids: dict[Any, Geometry] = {
            kinds.mjGEOM_SPHERE: Sphere(radius=a),
            kinds.mjGEOM_BOX: Box(size=(2 * a, 2 * b, 2 * c)),
            kinds.mjGEOM_CYLINDER: Cylinder(radius=a, length=2 * b),
            kinds.mjGEOM_CAPSULE: Capsule(radius=a, length=2 * b),
            kinds.mjGEOM_ELLIPSOID: Ellipsoid(radii=(a, b, c)),
        }
        if kind in solids:
            return solids[kind], frame
        mesh = int(model.geom_dataid[geom])
        if kind in {kinds.mjGEOM_MESH, kinds.mjGEOM_SDF} and mesh >= 0:
            if mesh not in self.meshes:
                self.meshes[mesh] = self._mesh(mesh)
            found, moved = self.meshes[mesh]
            return found, frame @ moved
        word = "plane" if kind == kinds.mjGEOM_PLANE else "height field"
        self._say(
            "geom",
            geom,
            f"The {word} {self._called('geom', geom)} of the body "
            f"{self._called('body', int(model.geom_bodyid[geom]))} is left out.",
            "Put it into the world, if it is part of the surroundings.",
        )
        return None

    def _mesh(self, mesh: int) -> tuple[Mesh, Frame]:
        """A mesh, and its frame in that of a geom that has it.

        MuJoCo moves the points of a mesh to its center of mass and turns them to its principal
        axes: the file is as it was before that.
        """
        model, spec = self.model, self._element("mesh", mesh)
        name = model.mesh(mesh).name or f"mesh_{mesh + 1}"
        inverse = np.linalg.inv(_frame(model.mesh_pos[mesh], model.mesh_quat[mesh]))
        file = self._file_of_mesh(mesh)
        x, y, z = map(float, model.mesh_scale[mesh])
        refpos, refquat = (np.array(one, float) for one in (spec.refpos, spec.refquat))
        is_moved = refpos.any() or not np.allclose(np.abs(refquat), (1, 0, 0, 0))
        if file is not None and (not is_moved or x == y == z):
            # The file is first moved against its reference frame, then scaled.
            reference = np.linalg.inv(_frame(refpos, refquat))
            reference[:3, 3] *= x
            found = Mesh(uri=file.name, scale=(x, y, z), path=str(file))
            return found, inverse @ (reference if is_moved else EYE)
        points = _rows(model.mesh_vert, model.mesh_vertadr, model.mesh_vertnum, mesh)
        faces = _rows(model.mesh_face, model.mesh_faceadr, model.mesh_facenum, mesh)
        made = self.scratch / f"mesh_{mesh}.stl"
        write_stl(np.asarray(points, float)[faces], made)
        return Mesh(uri=name, path=str(made)), EYE

    def _hull(self, geom: int) -> Mesh | None:
        """The convex hull of a mesh, with which MuJoCo collides; None of what is convex itself."""
        model, mesh = self.model, int(self.model.geom_dataid[geom])
        if model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_MESH or model.mesh_graphadr[mesh] < 0:
            return None
        graph = model.mesh_graph[model.mesh_graphadr[mesh] :]
        corners, count = map(int, graph[:2])
        if corners == model.mesh_vertnum[mesh]:
            return None
        if mesh not in self.hulls:
            # Its faces come after two numbers of each corner, and one of each edge.
            faces = graph[2 + 3 * (corners + count) :][: 3 * count].reshape(-1, 3)
            points = _rows(model.mesh_vert, model.mesh_vertadr, model.mesh_vertnum, mesh)
            made = self.scratch / f"hull_{mesh}.stl"
            write_stl(np.asarray(points, float)[faces], made)
            name = model.mesh(mesh).name or f"mesh_{mesh + 1}"
            self.hulls[mesh] = Mesh(uri=f"{name}_hull", path=str(made))
        return self.hulls[mesh]

    def _file_of_mesh(self, mesh: int) -> Path | None:
        """The file of a mesh, if others read the same from it."""
        start = int(self.model.mesh_pathadr[mesh])
        if start < 0:
            return None
        written = self.model.paths[start:].split(b"\0", 1)[0].decode("utf-8", "replace")
        file = self.file.parent / written
        return file if file.suffix.lower() in FILES and file.is_file() else None

    # ---- actuators and couplings --------------------------------------------------------------

    def _actuated(self) -> Iterator[tuple[int, int]]:
        """Each actuator of a joint, and the joint."""
        model = self.model
        kinds = mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT
        for actuator in range(model.nu):
            if is_of(model.actuator_trntype[actuator], *kinds):
                yield actuator, int(model.actuator_trnid[actuator][0])

    def _efforts(self) -> dict[int, float]:
        """The force or torque that the actuators of a joint have together, where it is limited."""
        model = self.model
        total: dict[int, float] = {}
        for actuator, joint in self._actuated():
            strength = FARTHEST
            gear = abs(float(model.actuator_gear[actuator][0]))
            if model.actuator_forcelimited[actuator]:
                strength = gear * float(np.abs(model.actuator_forcerange[actuator]).max())
            elif (
                model.actuator_ctrllimited[actuator]
                and model.actuator_gaintype[actuator] == mujoco.mjtGain.mjGAIN_FIXED
                and model.actuator_biastype[actuator] == mujoco.mjtBias.mjBIAS_NONE
                and model.actuator_dyntype[actuator] == mujoco.mjtDyn.mjDYN_NONE
            ):
                gain = abs(float(model.actuator_gainprm[actuator][0]))
                strength = gear * gain * float(np.abs(model.actuator_ctrlrange[actuator]).max())
            total[joint] = total.get(joint, 0.0) + strength
        for joint in map(int, np.flatnonzero(model.jnt_actfrclimited)):
            bound = float(np.abs(model.jnt_actfrcrange[joint]).max())
            total[joint] = min(total.get(joint, FARTHEST), bound)
        return {joint: effort for joint, effort in total.items() if 0 < effort < FARTHEST}

    def _couple(self) -> None:
        """Equations of two joints become mimicking; others, and loops, are said."""
        model = self.model
        kinds = mujoco.mjtEq
        actuated = {joint for _, joint in self._actuated()}
        places = {joint.name: place for place, joint in enumerate(self.joints)}
        for number in range(model.neq):
            first, second = int(model.eq_obj1id[number]), int(model.eq_obj2id[number])
            if not model.eq_active0[number]:
                continue
            kind = model.eq_type[number]
            if kind == kinds.mjEQ_JOINT and self._mimic(number, first, second, actuated, places):
                continue
            self._say_equality(number, kind)

    def _mimic(
        self, number: int, first: int, second: int, actuated: set[int], places: dict[str, int]
    ) -> bool:
        """Have one joint mimic the other, if a URDF can say it."""
        constant, factor, *others = map(float, self.model.eq_data[number][:5])
        names = [self.joint_names.get(joint, "") for joint in (first, second)]
        if any(others) or not factor or not all(name in places for name in names):
            return False
        follower, leader = names
        offset = self._reference(first) + constant - factor * self._reference(second)
        if first in actuated and second not in actuated:
            follower, leader = leader, follower
            factor, offset = 1 / factor, -offset / factor
        above: str | None = leader
        while above is not None and above != follower:
            mimic = self.joints[places[above]].mimic
            above = None if mimic is None else mimic.joint
        joint = self.joints[places[follower]]
        if above == follower or joint.mimic is not None:
            return False
        mimic = Mimic(joint=leader, multiplier=factor, offset=offset)
        self.joints[places[follower]] = replace(joint, mimic=mimic)
        return True


def _rgba(values: Iterable[float]) -> Rgba:
    # MuJoCo keeps colors with seven digits.
    red, green, blue, alpha = (min(1.0, max(0.0, round(float(one), 6))) for one in values)
    return (red, green, blue, alpha)


def _rows(values: Any, starts: Any, counts: Any, mesh: int) -> Any:
    return values[starts[mesh] : starts[mesh] + counts[mesh]]


def _frame(xyz: Any, wxyz: Any = (1.0, 0.0, 0.0, 0.0)) -> Frame:
    """The matrix of a position and a quaternion (w x y z)."""
    matrix = np.zeros(9)
    unit = np.array(wxyz, float)
    mujoco.mju_normalize4(unit)
    mujoco.mju_quat2Mat(matrix, unit)
    frame = np.eye(4)
    frame[:3, :3] = matrix.reshape(3, 3)
    frame[:3, 3] = xyz
    return frame


def _pose(frame: Frame) -> Pose:
    """The frame as URDF has it, exact also where the pitch is 90 degrees."""
    turn = frame[:3, :3]
    roll = np.arctan2(turn[2, 1], turn[2, 2])
    pitch = np.arctan2(-turn[2, 0], np.hypot(turn[0, 0], turn[1, 0]))
    sine, cosine = np.sin(roll), np.cos(roll)
    # Without roll and pitch, which may be any of many at 90 degrees.
    yaw = np.arctan2(
        sine * turn[0, 2] - cosine * turn[0, 1], cosine * turn[1, 1] - sine * turn[1, 2]
    )
    x, y, z = map(float, frame[:3, 3])
    return Pose(xyz=(x, y, z), rpy=(float(roll), float(pitch), float(yaw)))
