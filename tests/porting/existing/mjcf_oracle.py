"""MuJoCo's own masses and kinematics, against those of a URDF that was made of an MJCF.

The URDF is read here with nothing of wsgen: what it says is calculated twice.
"""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import trimesh

os.environ["MUJOCO_GL"] = "disable"
import mujoco

from porting.existing.urdf_oracle import frame_of, poses, tensor, vector

if TYPE_CHECKING:
    from wsgen.porting.existing.description import Description

HIDDEN = 3  # the first group of geoms that viewers do not show


@dataclass
class Found:
    """The largest differences, and what is different altogether."""

    mass: float = 0.0  # of all bodies, a share
    position: float = 0.0  # m, of centers of mass
    turn: float = 0.0  # of inertia tensors in the world, a share
    shape: float = 0.0  # m, of points of shapes
    wrong: list[str] = field(default_factory=list)
    bodies: int = 0
    joints: int = 0
    shapes: int = 0


def load(found: Path | bytes, name: str) -> Any:
    data = found if isinstance(found, bytes) else found.read_bytes()
    mesh = trimesh.load(
        trimesh.util.wrap_as_stream(data), file_type=Path(name).suffix[1:], force="mesh"
    )
    vertices: Any = getattr(mesh, "vertices")  # noqa: B009
    return np.asarray(vertices)


def points_of(part: ET.Element, description: Description, cache: dict[str, Any]) -> Any:
    """Points that a shape of a URDF has, in its link."""
    shape = part.find("geometry")[0]  # type: ignore[index]
    frame = frame_of(part)
    if shape.tag == "box":
        x, y, z = vector(shape.get("size"), ()) / 2
        points = corners(x, y, z)
    elif shape.tag == "sphere":
        points = corners(*([float(shape.get("radius") or 0)] * 3))
        frame[:3, :3] = np.eye(3)
    elif shape.tag == "cylinder":
        radius, half = float(shape.get("radius") or 0), float(shape.get("length") or 0) / 2
        points = np.array([[0, 0, -half], [0, 0, half], [radius, 0, 0], [0, radius, 0]])
    else:
        name = str(shape.get("filename"))
        if name not in cache:
            cache[name] = load(description.meshes[name], name)
        points = cache[name] * vector(shape.get("scale"), (1.0, 1.0, 1.0))
    return points @ frame[:3, :3].T + frame[:3, 3]


def corners(x: float, y: float, z: float) -> Any:
    return np.array([[a * x, b * y, c * z] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)])


def box_of(points: Any) -> Any:
    return np.concatenate((points.min(0), points.max(0)))


def geom_points(model: Any, geom: int) -> list[Any]:
    """Points of the parts that a geom has in a URDF, in its body."""
    kind, size = mujoco.mjtGeom(int(model.geom_type[geom])), model.geom_size[geom]
    matrix = np.zeros(9)
    mujoco.mju_quat2Mat(matrix, model.geom_quat[geom])
    turn, at = matrix.reshape(3, 3), model.geom_pos[geom]
    kinds = mujoco.mjtGeom
    if kind == kinds.mjGEOM_SPHERE:
        return [corners(size[0], size[0], size[0]) + at]
    if kind == kinds.mjGEOM_BOX:
        return [corners(*size) @ turn.T + at]
    if kind == kinds.mjGEOM_ELLIPSOID:
        half = np.diag(np.sqrt(((turn * size) ** 2).sum(1)))
        return [np.vstack([half, -half]) + at]
    if kind in {kinds.mjGEOM_MESH, kinds.mjGEOM_SDF}:
        mesh = model.geom_dataid[geom]
        start = model.mesh_vertadr[mesh]
        points = model.mesh_vert[start : start + model.mesh_vertnum[mesh]]
        return [points @ turn.T + at]
    radius, half = size[0], size[1]
    tube = np.array([[0, 0, -half], [0, 0, half], [radius, 0, 0], [0, radius, 0]]) @ turn.T + at
    if kind == kinds.mjGEOM_CYLINDER:
        return [tube]
    ends = [corners(radius, radius, radius) + at + turn @ [0, 0, s * half] for s in (1, -1)]
    return [tube, *ends]


def compare(description: Description, configurations: int = 10, seed: int = 0) -> Found:
    """Compare a URDF with what MuJoCo reads from the MJCF it was made of."""
    comparison = Comparison(description)
    comparison.check_masses()
    check_limits(comparison.model, comparison.joints, comparison.used, comparison.found)
    check_shapes(comparison.model, comparison.here, comparison.links, description, comparison.found)
    random = np.random.default_rng(seed)
    for number in range(configurations):
        comparison.check_configuration(random if number else None)
    return comparison.found


class Comparison:
    """A URDF and the model of MuJoCo; bodies and links have the same names."""

    def __init__(self, description: Description) -> None:
        spec = mujoco.MjSpec.from_file(str(description.file))
        spec.compiler.discardvisual = spec.compiler.fusestatic = False
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.robot = ET.fromstring(description.text)
        self.links = {str(link.get("name")): link for link in self.robot.findall("link")}
        self.joints = {str(joint.get("name")): joint for joint in self.robot.findall("joint")}
        self.found = Found()
        bodies = self._names()
        self.here = {n: name for n, name in bodies.items() if name in self.links}
        tops = {self.model.body_rootid[n] for n in self.here}
        self.found.wrong += [
            f"no link {name}"
            for n, name in bodies.items()
            if self.model.body_rootid[n] in tops and n not in self.here
        ]
        self.used: dict[int, str] = {}  # the names of the joints
        named: list[str] = []  # the same, without what makes them unique
        for number in range(self.model.njnt):
            body = self.model.jnt_bodyid[number]
            name = self.model.joint(number).name or f"{bodies[body]}_joint"
            if body in self.here and self.model.jnt_type[number] != 0:
                name = f"{name}_joint" if name in self.links else name
                alike = sum(other == name for other in named)
                named.append(name)
                self.used[number] = f"{name}_{alike + 1}" if alike else name
        self.parts = {name: [name, *self._before(name)] for name in self.here.values()}

    def _names(self) -> dict[int, str]:
        """The names of the bodies, as wsgen calls those without one."""
        bodies: dict[int, str] = {}
        for n in range(1, self.model.nbody):
            parent = bodies.get(self.model.body_parentid[n], "body")
            name, count = f"{parent}_1", 2
            while name in bodies.values():
                name, count = f"{parent}_1_{count}", count + 1
            bodies[n] = self.model.body(n).name or name
        return bodies

    def _before(self, name: str) -> list[str]:
        """The links between the joints of a body."""
        parents = {
            one.find("child").get("link"): one.find("parent").get("link")  # type: ignore[union-attr]
            for one in self.joints.values()
        }
        found: list[str] = []
        parent = parents.get(name)
        while parent is not None and parent not in self.here.values() and parent != "world":
            found.append(parent)
            parent = parents.get(parent)
        return found

    def check_masses(self) -> None:
        """Compare the sum of the masses."""
        weights = self.robot.iterfind("link/inertial/mass")
        total = sum(float(one.get("value") or 0) for one in weights)
        meant = sum(self.model.body_mass[n] for n in self.here)
        self.found.mass = abs(total - meant) / max(meant, 1e-9)
        self.found.bodies = len(self.here)
        self.found.joints = sum(one.get("type") != "fixed" for one in self.joints.values())

    def check_configuration(self, random: Any) -> None:
        """Compare where all masses are; with None, all joints are at 0."""
        model, data = self.model, self.data
        positions = self._set_joints(random)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        base = np.eye(4)
        if "world" not in self.links:
            root = next(n for n in self.here if model.body_parentid[n] == 0)
            base[:3, :3], base[:3, 3] = data.xmat[root].reshape(3, 3), data.xpos[root]
        frames = {name: base @ frame for name, frame in poses(self.robot, positions).items()}
        for n, name in self.here.items():
            if model.body_mass[n] > 0:
                # Parts of a body that joints join are together only at rest.
                self._check_body(n, self.parts[name] if random is None else [name], frames)

    def _set_joints(self, random: Any) -> dict[str, float]:
        model, data = self.model, self.data
        positions: dict[str, float] = {}
        data.qpos[:] = model.qpos0
        for number, name in self.used.items():
            at = model.jnt_qposadr[number]
            if model.jnt_type[number] != mujoco.mjtJoint.mjJNT_BALL:
                bounds = model.jnt_range[number] if model.jnt_limited[number] else (-3.0, 3.0)
                positions[name] = 0.0 if random is None else random.uniform(*bounds)
                data.qpos[at] = positions[name]
            elif random is not None:
                set_ball(data.qpos[at : at + 4], positions, name, random)
        return positions

    def _check_body(self, n: int, parts: list[str], frames: dict[str, Any]) -> None:
        found, data = self.found, self.data
        axes = data.ximat[n].reshape(3, 3)
        theirs = axes @ np.diag(self.model.body_inertia[n]) @ axes.T
        ours, mass = np.zeros((3, 3)), 0.0
        for part in parts:
            inertial = self.links[part].find("inertial")
            if inertial is None:
                found.wrong.append(f"no inertial in {part}")
                return
            frame = frames[part] @ frame_of(inertial)
            found.position = max(found.position, np.abs(frame[:3, 3] - data.xipos[n]).max())
            moments = tensor(inertial.find("inertia"))  # type: ignore[arg-type]
            ours += frame[:3, :3] @ moments @ frame[:3, :3].T
            mass += float(inertial.find("mass").get("value"))  # type: ignore[union-attr, arg-type]
        share = mass / self.model.body_mass[n]
        if len(parts) == len(self.parts[parts[0]]) and abs(share - 1) > 1e-9:
            found.wrong.append(f"mass of {parts[0]}")
        difference = np.abs(ours - theirs * share).max()
        found.turn = max(found.turn, difference / max(np.abs(theirs).max(), 1e-12))


def set_ball(qpos: Any, positions: dict[str, float], name: str, random: Any) -> None:
    angles = random.uniform(-1.2, 1.2, 3)
    qpos[:] = (1.0, 0.0, 0.0, 0.0)
    for letter, angle, axis in zip("xyz", angles, np.eye(3), strict=True):
        turned, before = np.zeros(4), qpos.copy()
        mujoco.mju_axisAngle2Quat(turned, axis, angle)
        mujoco.mju_mulQuat(qpos, before, turned)
        positions[f"{name}_{letter}"] = angle


def check_limits(
    model: Any, joints: dict[str, ET.Element], used: dict[int, str], found: Found
) -> None:
    for number, name in used.items():
        if model.jnt_type[number] == mujoco.mjtJoint.mjJNT_BALL:
            if f"{name}_z" not in joints:
                found.wrong.append(f"no joints for the ball {name}")
            continue
        joint = joints.get(name)
        if joint is None:
            found.wrong.append(f"no joint {name}")
            continue
        is_slide = model.jnt_type[number] == mujoco.mjtJoint.mjJNT_SLIDE
        limited = bool(model.jnt_limited[number])
        kind = "prismatic" if is_slide else "revolute" if limited else "continuous"
        if joint.get("type") != kind:
            found.wrong.append(f"{name} is {joint.get('type')}, not {kind}")
        limit = joint.find("limit")
        if limited and (
            limit is None
            or abs(float(limit.get("lower") or 0) - model.jnt_range[number][0]) > 1e-9
            or abs(float(limit.get("upper") or 0) - model.jnt_range[number][1]) > 1e-9
        ):
            found.wrong.append(f"limits of {name}")
        dynamics = joint.find("dynamics")
        damping = 0.0 if dynamics is None else float(dynamics.get("damping") or 0)
        if abs(damping - model.dof_damping[model.jnt_dofadr[number]]) > 1e-9:
            found.wrong.append(f"damping of {name}")


def check_shapes(
    model: Any,
    here: dict[int, str],
    links: dict[str, ET.Element],
    description: Description,
    found: Found,
) -> None:
    cache: dict[str, Any] = {}
    for n, name in here.items():
        in_link = np.zeros(3)  # of the body
        last = model.body_jntadr[n] + model.body_jntnum[n] - 1
        if model.body_jntnum[n] and model.jnt_type[last] in (1, 3):  # ball, hinge
            in_link = -model.jnt_pos[last]
        for tag in ("visual", "collision"):
            theirs: list[Any] = []
            for g in map(int, np.flatnonzero(model.geom_bodyid == n)):
                is_seen = model.geom_group[g] < HIDDEN and not is_invisible(model, g)
                is_touched = model.geom_contype[g] or model.geom_conaffinity[g]
                if is_seen if tag == "visual" else is_touched:
                    theirs += geom_points(model, g)
            ours = [points_of(part, description, cache) for part in links[name].findall(tag)]
            if len(ours) != len(theirs):
                found.wrong.append(f"{name}: {len(ours)} {tag}s, not {len(theirs)}")
                continue
            found.shapes += len(ours)
            for mine, other in zip(ours, theirs, strict=True):
                difference = np.abs(box_of(mine) - box_of(other + in_link)).max()
                if len(other) != len(mine) and difference > 1e-6:
                    # An ellipsoid has become a mesh, whose corners are on it.
                    difference *= 0.01
                found.shape = max(found.shape, difference)


def is_invisible(model: Any, geom: int) -> bool:
    material = model.geom_matid[geom]
    own = model.geom_rgba[geom]
    if material >= 0 and np.allclose(own, (0.5, 0.5, 0.5, 1)):
        return bool(model.mat_rgba[material][3] == 0)
    return bool(own[3] == 0)
