"""Writes the URDF of a robot that was read from another format, with its meshes beside it.

A `Robot` has what URDF lacks: ball joints, several trees, and shapes that become meshes.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.descriptions.meshes.inspection import inspect_meshes
from wsgen.descriptions.meshes.shape_meshes import build_shapes
from wsgen.model.robot import (
    STOP,
    Box,
    Capsule,
    Collision,
    Cylinder,
    JointLimit,
    JointType,
    Link,
    Mesh,
    Sphere,
    Surface,
)
from wsgen.model.transform import IDENTITY, Pose, compose
from wsgen.porting.existing.description import Description
from wsgen.porting.ported import Unported
from wsgen.simulation.urdf_writer import MOMENTS, quoted

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Geometry, Inertial, Joint, Rgba, Robot, Visual


# Between two joints of one body is a link with this share of its mass. Simulators drop a link of 0;
# with 0.0001 % Gazebo Classic pulls the joints apart by meters, with 0.1 % by a millimeter.
SHARE = 0.01
LARGEST_SHARE = 0.2
LEAST_MASS = 2e-6  # kg; Gazebo Classic takes half of it for 0
FARTHEST = 1e6  # rad, m, rad/s, m/s, N m, N: written for a limit that there is not
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
DECIMALS = 12  # of lengths (m), angles (rad) and directions: what is behind them is rounding


def free(name: str, taken: Collection[str]) -> str:
    """The name, with a number behind it if it is taken."""
    number = 2
    found = name
    while found in taken:
        found, number = f"{name}_{number}", number + 1
    return found


def describe(  # noqa: PLR0913  what a reader knows
    robot: Robot,
    *,
    file: Path,
    notes: Iterable[Unported],
    scratch: Path,
    crosses: Collection[str] = (),
    extensions: Iterable[str] = (),
) -> Description:
    """The robot as a URDF.

    Args:
        robot: The robot; the names of its links and joints are those to write.
        file: It was read from.
        notes: What is known already not to be in the URDF.
        scratch: A folder for files that are made; meshes that are in it become bytes.
        crosses: The names of links between two joints of one body; they get a share of its mass.
        extensions: `<gazebo>` elements to add, as they are written.
    """
    robot, between = _without_balls(robot)
    robot = _with_shares(robot, {*crosses, *between})
    robot, of_shapes = build_shapes(robot, file=file, folder=scratch)
    robot, of_parts = _with_parts(robot, file, scratch)
    writer = _Writer(robot, scratch)
    text = "\n".join((*writer.lines(extensions), ""))
    return Description(
        name=robot.name,
        text=text,
        file=file,
        meshes=writer.meshes,
        notes=(*notes, *(as_note(one, file) for one in (*of_shapes, *of_parts))),
    )


def as_note(diagnostic: Diagnostic, file: Path) -> Unported:
    """What a reader reports, as something that is not as it was."""
    return Unported(
        file=Path(diagnostic.file or file),
        line=diagnostic.line or 1,
        what=diagnostic.message,
        advice=diagnostic.hint or "",
    )


def _without_balls(robot: Robot) -> tuple[Robot, list[str]]:
    """The robot with three revolute joints, about x, y and z, in the place of each ball joint.

    Beside it are the names of the links between them.
    """
    joints: list[Joint] = []
    crosses: list[str] = []
    for joint in robot.joints:
        if joint.type is not JointType.BALL:
            joints.append(joint)
            continue
        between = [f"{joint.name}_x_link", f"{joint.name}_y_link"]
        crosses += between
        ends = [joint.parent, *between, joint.child]
        for number, (letter, axis) in enumerate(AXES.items()):
            joints.append(
                replace(
                    joint,
                    name=f"{joint.name}_{letter}",
                    type=JointType.REVOLUTE if joint.limit else JointType.CONTINUOUS,
                    parent=ends[number],
                    child=ends[number + 1],
                    pose_in_parent=IDENTITY if number else joint.pose_in_parent,
                    axis_in_joint=axis,
                )
            )
    links = (*robot.links, *(Link(name=name) for name in crosses))
    return replace(robot, links=links, joints=tuple(joints)), crosses


def _with_parts(robot: Robot, file: Path, scratch: Path) -> tuple[Robot, tuple[Diagnostic, ...]]:
    """The robot with a mesh of its own for each part of a file that it takes alone."""
    shapes = [one.geometry for link in robot.links for one in link.visuals]
    shapes += [one.geometry for link in robot.links for one in link.collisions]
    parts = dict.fromkeys(one for one in shapes if isinstance(one, Mesh) and one.part and one.path)
    if not parts:
        return robot, ()
    asked = {f"{number}": mesh for number, mesh in enumerate(parts)}
    links = (Link(name=name, collisions=(Collision(geometry=one),)) for name, one in asked.items())
    answered, found = inspect_meshes(replace(robot, links=tuple(links)), file=file, folder=scratch)
    alone = {}
    for link in answered.links:
        mesh = asked[link.name]
        shape = link.collisions[0].geometry
        path = shape.path if isinstance(shape, Mesh) else None
        name = mesh.part.name if mesh.part else ""
        alone[mesh] = replace(mesh, part=None, path=path, uri=f"{Path(mesh.uri).stem}_{name}")

    def own(geometry: Geometry) -> Geometry:
        return alone.get(geometry, geometry) if isinstance(geometry, Mesh) else geometry

    links = (
        replace(
            link,
            visuals=tuple(replace(one, geometry=own(one.geometry)) for one in link.visuals),
            collisions=tuple(replace(one, geometry=own(one.geometry)) for one in link.collisions),
        )
        for link in robot.links
    )
    return replace(robot, links=tuple(links)), found


def _with_shares(robot: Robot, crosses: Collection[str]) -> Robot:
    """The robot with a share of a body in each link between the joints before it.

    They have one center of mass, and what they have together is the inertia of the body, as long
    as the joints between them are at 0.
    """
    above = {joint.child: joint for joint in robot.joints}
    links = {link.name: link for link in robot.links}
    for name in list(links):
        pose, before = IDENTITY, []
        joint = None if name in crosses else above.get(name)
        while joint is not None and joint.parent in crosses:
            pose = compose(joint.pose_in_parent, pose)
            before.append((joint.parent, pose))
            joint = above.get(joint.parent)
        found = _giver(robot, links, name) if before else None
        if found is not None:
            giver, inertial, place_in_link = found
            share = min(LARGEST_SHARE, max(SHARE, LEAST_MASS / inertial.mass))
            for cross, place in before:
                at = compose(compose(place, place_in_link), inertial.pose_in_link)
                part = replace(_scaled(inertial, share), pose_in_link=at)
                links[cross] = replace(links[cross], inertial=part)
            rest = _scaled(inertial, 1 - share * len(before))
            links[giver] = replace(links[giver], inertial=rest)
    return replace(robot, links=tuple(links.values()))


def _giver(robot: Robot, links: Mapping[str, Link], name: str) -> tuple[str, Inertial, Pose] | None:
    """A link or the first with a mass that is fixed to it, with its inertia and its pose in it."""
    waiting = [(name, IDENTITY)]
    for link, pose in waiting:
        inertial = links[link].inertial
        if inertial is not None and inertial.mass > 0:
            return link, inertial, pose
        waiting += (
            (joint.child, compose(pose, joint.pose_in_parent))
            for joint in robot.joints
            if joint.parent == link and joint.type is JointType.FIXED
        )
    return None


def _scaled(inertial: Inertial, factor: float) -> Inertial:
    xx, xy, xz, yy, yz, zz = (moment * factor for moment in inertial.inertia)
    return replace(inertial, mass=inertial.mass * factor, inertia=(xx, xy, xz, yy, yz, zz))


class _Writer:
    def __init__(self, robot: Robot, scratch: Path) -> None:
        self.robot = robot
        self.scratch = scratch
        self.meshes: dict[str, Path | bytes] = {}
        self._name_of: dict[str, str] = {}  # of a mesh, by its path
        self._colors: dict[Rgba, str] = {}

    def lines(self, extensions: Iterable[str]) -> Iterator[str]:
        robot = self.robot
        body = [line for link in robot.links for line in self._link(link)]
        yield '<?xml version="1.0"?>'
        yield f"<robot name={quoted(robot.name)}>"
        for rgba, name in self._colors.items():
            yield f'  <material name="{name}">'
            yield f'    <color rgba="{_numbers(rgba)}"/>'
            yield "  </material>"
        yield from body
        for joint in (*robot.joints, *robot.loose):
            yield from _joint(joint)
        if robot.is_static:
            yield from ("  <gazebo>", "    <static>true</static>", "  </gazebo>")
        for link in robot.links:
            yield from _gazebo(link.name, _of_link(link))
        for joint in robot.joints:
            yield from _gazebo(joint.name, _of_joint(joint))
        yield from extensions
        yield "</robot>"

    def _link(self, link: Link) -> Iterator[str]:
        parts = [
            *_inertial(link.inertial),
            *(line for visual in link.visuals for line in self._visual(visual)),
            *(line for collision in link.collisions for line in self._collision(collision)),
        ]
        if not parts:
            yield f"  <link name={quoted(link.name)}/>"
            return
        yield f"  <link name={quoted(link.name)}>"
        yield from parts
        yield "  </link>"

    def _visual(self, visual: Visual) -> Iterator[str]:
        for geometry, pose in _parts(visual.geometry, visual.pose_in_link):
            yield "    <visual>"
            yield from _origin(pose, "      ")
            yield f"      <geometry>{self._shape(geometry)}</geometry>"
            if visual.rgba is not None:
                name = self._colors.setdefault(visual.rgba, f"color_{len(self._colors) + 1}")
                yield f'      <material name="{name}"/>'
            yield "    </visual>"

    def _collision(self, collision: Collision) -> Iterator[str]:
        for geometry, pose in _parts(collision.geometry, collision.pose_in_link):
            yield "    <collision>"
            yield from _origin(pose, "      ")
            yield f"      <geometry>{self._shape(geometry)}</geometry>"
            yield "    </collision>"

    def _shape(self, geometry: Geometry) -> str:
        if isinstance(geometry, Box):
            return f'<box size="{_numbers(geometry.size)}"/>'
        if isinstance(geometry, Sphere):
            return f'<sphere radius="{_number(geometry.radius)}"/>'
        if isinstance(geometry, Cylinder):
            size = f'radius="{_number(geometry.radius)}" length="{_number(geometry.length)}"'
            return f"<cylinder {size}/>"
        assert isinstance(geometry, Mesh)  # noqa: S101  others have become meshes
        scale = "" if geometry.scale == (1.0, 1.0, 1.0) else f' scale="{_numbers(geometry.scale)}"'
        return f"<mesh filename={quoted(self._file_of(geometry))}{scale}/>"

    def _file_of(self, mesh: Mesh) -> str:
        """The name of its file; that of one that is missing as its source has it."""
        if mesh.path is None:
            return mesh.uri
        if mesh.path not in self._name_of:
            path = Path(mesh.path)
            is_made = path.is_relative_to(self.scratch)
            stem, suffix = (Path(mesh.uri).stem, ".stl") if is_made else (path.stem, path.suffix)
            taken = {name.removesuffix(suffix) for name in self.meshes}
            name = f"{free(stem, taken)}{suffix}"
            self._name_of[mesh.path] = name
            self.meshes[name] = path.read_bytes() if is_made else path
        return self._name_of[mesh.path]


def _parts(geometry: Geometry, pose: Pose) -> Iterator[tuple[Geometry, Pose]]:
    """The shapes of URDF that a shape is: a capsule is a cylinder and two spheres."""
    if not isinstance(geometry, Capsule):
        yield geometry, pose
        return
    yield Cylinder(radius=geometry.radius, length=geometry.length), pose
    for end in (geometry.length / 2, -geometry.length / 2):
        place = compose(pose, Pose(xyz=(0.0, 0.0, end)))
        yield Sphere(radius=geometry.radius), Pose(place.xyz)


def _inertial(inertial: Inertial | None) -> Iterator[str]:
    if inertial is None:
        return
    yield "    <inertial>"
    yield from _origin(inertial.pose_in_link, "      ")
    yield f'      <mass value="{_number(inertial.mass)}"/>'
    moments = [
        f'{name}="{_number(moment)}"'
        for name, moment in zip(MOMENTS, inertial.inertia, strict=True)
    ]
    yield f"      <inertia {' '.join(moments)}/>"
    yield "    </inertial>"


def _joint(joint: Joint) -> Iterator[str]:
    yield f'  <joint name={quoted(joint.name)} type="{joint.type.value}">'
    yield from _origin(joint.pose_in_parent, "    ")
    yield f"    <parent link={quoted(joint.parent)}/>"
    yield f"    <child link={quoted(joint.child)}/>"
    if joint.type not in {JointType.FIXED, JointType.FLOATING}:
        yield f'    <axis xyz="{_rounded(joint.axis_in_joint)}"/>'
        yield from _limit(joint)
        if joint.damping or joint.friction:
            damping, friction = _number(joint.damping), _number(joint.friction)
            yield f'    <dynamics damping="{damping}" friction="{friction}"/>'
        if joint.mimic is not None:
            factors = _number(joint.mimic.multiplier), _number(joint.mimic.offset)
            leader = f"joint={quoted(joint.mimic.joint)}"
            yield f'    <mimic {leader} multiplier="{factors[0]}" offset="{factors[1]}"/>'
    yield "  </joint>"


def _limit(joint: Joint) -> Iterator[str]:
    limit = joint.limit
    bounds = ""
    if joint.type is not JointType.CONTINUOUS:
        limit = limit or JointLimit(
            lower=-FARTHEST, upper=FARTHEST, effort=FARTHEST, velocity=FARTHEST
        )
        bounds = f'lower="{_bound(limit.lower)}" upper="{_bound(limit.upper)}" '
    if limit is not None:
        effort, velocity = (
            _bound(FARTHEST if one < 0 else one) for one in (limit.effort, limit.velocity)
        )
        yield f'    <limit {bounds}effort="{effort}" velocity="{velocity}"/>'


def _of_link(link: Link) -> Iterator[str]:
    """What Gazebo alone reads of a link; the surface of its first collision is that of all."""
    if link.collisions:
        surface = link.collisions[0].surface
        for tag, value, default in (
            ("mu1", surface.mu1, Surface.mu1),
            ("mu2", surface.mu2, Surface.mu2),
            ("kp", surface.kp, None),
            ("kd", surface.kd, None),
            ("minDepth", surface.min_depth, None),
            ("maxContacts", surface.max_contacts, None),
        ):
            if value is not None and value != default:
                yield f"<{tag}>{_number(value)}</{tag}>"
        if surface.fdir1 is not None and surface.fdir1_in is None:
            yield f"<fdir1>{_numbers(surface.fdir1)}</fdir1>"
    if link.self_collide:
        yield "<selfCollide>true</selfCollide>"
    if not link.gravity:
        yield "<turnGravityOff>true</turnGravityOff>"


def _of_joint(joint: Joint) -> Iterator[str]:
    if joint.spring_stiffness:
        yield f"<springStiffness>{_number(joint.spring_stiffness)}</springStiffness>"
        yield f"<springReference>{_number(joint.spring_reference)}</springReference>"
    if joint.stop is not None and joint.stop != STOP:
        yield f"<stopErp>{_number(joint.stop[0])}</stopErp>"
        yield f"<stopCfm>{_number(joint.stop[1])}</stopCfm>"


def _gazebo(reference: str, lines: Iterable[str]) -> Iterator[str]:
    written = [f"    {line}" for line in lines]
    if written:
        yield f"  <gazebo reference={quoted(reference)}>"
        yield from written
        yield "  </gazebo>"


def pose_text(pose: Pose) -> str:
    """The six numbers of a pose, as SDF has them."""
    return f"{_rounded(pose.xyz)} {_rounded(pose.rpy)}"


def _origin(pose: Pose, indent: str) -> Iterator[str]:
    xyz, rpy = _rounded(pose.xyz), _rounded(pose.rpy)
    if (xyz, rpy) != ("0 0 0", "0 0 0"):
        yield f'{indent}<origin xyz="{xyz}" rpy="{rpy}"/>'


def _rounded(values: Iterable[float]) -> str:
    return _numbers(round(value, DECIMALS) for value in values)


def _numbers(values: Iterable[float]) -> str:
    return " ".join(map(_number, values))


def _bound(value: float) -> str:
    return _number(min(FARTHEST, max(-FARTHEST, value)))


def _number(value: float) -> str:
    return repr(value + 0.0).removesuffix(".0")  # + 0.0: no -0
