"""Writes the URDF that PyBullet loads: the lumped robot without its visuals.

One element a line: PyBullet reads lines in pieces of 8192 bytes and puts a line break between
them, which breaks a longer line in the middle of a word. Visuals are drawn from the model, so
that a missing mesh of one does not keep the robot from being simulated.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.model.inertia import made_possible
from wsgen.model.robot import Box, Capsule, Cylinder, JointLimit, JointType, Mesh, Sphere

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from wsgen.model.robot import Geometry, Joint, Link, Robot
    from wsgen.model.transform import Pose


# PyBullet demands <limit> of hinges and slides, and takes this one for none.
NO_LIMIT = JointLimit(lower=0.0, upper=-1.0)

MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def write_urdf(robot: Robot) -> str:
    """The robot's links and joints; a mesh that was not found is left out.

    The meshes of what is static are their triangles, as in Gazebo; PyBullet has no such shape for
    what moves, and takes the convex hull.
    """
    lines = [f"<robot name={quoted(robot.name)}>"]
    for link in robot.links:
        lines += _link(
            link,
            is_world=robot.fixed_to_world and link.name == robot.root,
            is_static=robot.is_static,
        )
    for joint in robot.joints:
        lines += _joint(joint)
    return "\n".join([*lines, "</robot>", ""])


def _link(link: Link, *, is_world: bool, is_static: bool) -> Iterator[str]:
    yield f"<link name={quoted(link.name)}>"
    if link.inertial is not None:
        yield "<inertial>"
        yield _origin(link.inertial.pose_in_link)
        yield f'<mass value="{link.inertial.mass!r}"/>'
        yield "<inertia"
        for name, value in zip(MOMENTS, made_possible(link.inertial.inertia), strict=True):
            yield f' {name}="{value!r}"'
        yield "/>"
        yield "</inertial>"
    elif is_world:  # without this PyBullet gives it 1 kg
        yield '<inertial><mass value="0"/>'
        yield '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>'
    for collision in link.collisions:
        shape = _shape(collision.geometry)
        if shape is not None:
            is_concave = is_static and isinstance(collision.geometry, Mesh)
            yield '<collision concave="yes">' if is_concave else "<collision>"
            yield _origin(collision.pose_in_link)
            yield f"<geometry>{shape}</geometry>"
            yield "</collision>"
    yield "</link>"


def _joint(joint: Joint) -> Iterator[str]:
    # PyBullet's own word.
    kind = "spherical" if joint.type is JointType.BALL else joint.type.value
    yield f"<joint name={quoted(joint.name)} type={quoted(kind)}>"
    yield _origin(joint.pose_in_parent)
    yield f"<parent link={quoted(joint.parent)}/>"
    yield f"<child link={quoted(joint.child)}/>"
    if joint.type is not JointType.FIXED:
        yield f'<axis xyz="{_numbers(joint.axis_in_joint)}"/>'
        yield f'<dynamics damping="{joint.damping!r}" friction="{joint.friction!r}"/>'
    if joint.type in (JointType.REVOLUTE, JointType.PRISMATIC):
        limit = joint.limit or NO_LIMIT
        yield f'<limit lower="{limit.lower!r}" upper="{limit.upper!r}"'
        yield f' effort="{limit.effort!r}" velocity="{limit.velocity!r}"/>'
    yield "</joint>"


def _shape(geometry: Geometry) -> str | None:
    if isinstance(geometry, Box):
        return f'<box size="{_numbers(geometry.size)}"/>'
    if isinstance(geometry, Sphere):
        return f'<sphere radius="{geometry.radius!r}"/>'
    if isinstance(geometry, Mesh):
        if geometry.path is None:
            return None
        return f'<mesh filename={quoted(geometry.path)} scale="{_numbers(geometry.scale)}"/>'
    if isinstance(geometry, Cylinder | Capsule):
        tag = "cylinder" if isinstance(geometry, Cylinder) else "capsule"
        return f'<{tag} radius="{geometry.radius!r}" length="{geometry.length!r}"/>'
    return None


def _origin(pose: Pose) -> str:
    return f'<origin xyz="{_numbers(pose.xyz)}" rpy="{_numbers(pose.rpy)}"/>'


def quoted(text: str) -> str:
    """As an attribute's value. `xml.sax.saxutils` would load all of urllib for this."""
    for character, reference in (("&", "&amp;"), ("<", "&lt;"), ('"', "&quot;")):
        text = text.replace(character, reference)
    return f'"{text}"'


def _numbers(values: Iterable[float]) -> str:
    return " ".join(repr(value) for value in values)
