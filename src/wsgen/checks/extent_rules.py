"""Rules over how large and how heavy a robot is: what is absurd is surely in other units.

The parameters are facts in SI units; a rule yields what it finds.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.pose import IDENTITY
from wsgen.model.robot import Box, JointType, Mesh, Primitive, Sphere, Triangulated
from wsgen.model.transform import compose

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.model.pose import Pose
    from wsgen.model.robot import Geometry, Joint, Link

# Doubles have 16 digits: beyond it a metre, a kilogram is lost in rounding, and squares overflow.
BEYOND = 1e15
LARGEST = 100.0  # m; a ship, a crane
SMALLEST = 1e-3  # m; contacts of engines are as thick
HEAVIEST = 1e6  # kg; the largest mining trucks have 600,000
# kg; before sdformat 12.7.2, as in Gazebo Classic, a link of less was one without mass.
LIGHTEST = 1e-6


def number_beyond_engines(
    links: Iterable[Link], joints: Iterable[Joint], file: Path | None
) -> Iterator[Diagnostic]:
    """A number is so large that no physics engine can compute with it.

    ## What it does
    Looks for masses, moments, positions, sizes, damping and friction beyond 1e15 in SI units.
    Limits of joints may be as large as they like: that is how "no limit" is written.

    ## Why is this bad?
    Next to such a number every other one is lost in rounding, and its square may overflow: the
    state of the whole robot becomes not-a-number in the first step.

    ## Example
    `<mass value="1e308"/>`.

    ## Use instead
    Kilograms and metres.
    """
    for link in links:
        for what, numbers in _numbers_of_link(link):
            yield from _beyond(what, numbers, f"link[@name='{link.name}']", link.line, file)
    for joint in joints:
        place = f"joint[@name='{joint.name}']"
        dynamics = (joint.damping, joint.friction, joint.spring_stiffness)
        for what, joint_numbers in (
            ("origin", joint.pose_in_parent.xyz),
            ("dynamics", dynamics),
        ):
            yield from _beyond(what, joint_numbers, place, joint.line, file)


def implausible_size(
    links: Sequence[Link], joints: Iterable[Joint], file: Path | None
) -> Iterator[Diagnostic]:
    """The robot is larger than a ship or smaller than a grain of sand.

    ## What it does
    Measures the robot with all joints at zero: the frames of its links and its primitive shapes.
    Meshes are not measured.

    ## Why is this bad?
    Lengths of a URDF are metres. Written in millimetres, the robot is a thousand times too large,
    and falls as slowly as a mountain would; too small, and it is thinner than the contacts of the
    engine.

    ## Example
    `<box size="400 300 200"/>` for a box of 40 cm.

    ## Use instead
    Metres; for a mesh in millimetres scale="0.001 0.001 0.001".
    """
    extent = _extent(links, joints)
    has_meshes = any(isinstance(geometry, Mesh) for link in links for geometry, _ in _shapes(link))
    is_small = 0 < extent < SMALLEST and not has_meshes
    if links and (LARGEST < extent < math.inf or is_small):
        yield Diagnostic(
            code="ROB048",
            severity=Severity.WARNING,
            message=f"The robot measures {extent:.3g} m.",
            file=file,
            line=links[0].line,
            element="robot",
            hint="Lengths of a URDF are in metres: divide millimetres by 1000."
            if extent > LARGEST
            else "Lengths of a URDF are in metres; a physics engine needs some millimetres.",
        )


def implausible_mass(
    links: Sequence[Link], joints: Iterable[Joint], file: Path | None
) -> Iterator[Diagnostic]:
    """The robot is heavier than a mining truck, or a moving part lighter than a milligram.

    ## What it does
    Adds up the masses, and looks for links that have next to none and that nothing is fixed to.

    ## Why is this bad?
    Masses of a URDF are kilograms. Between very light and heavy parts joints shake or tear, and
    older versions of Gazebo drop a link below a milligram with all that hangs on it.

    ## Example
    `<mass value="1e-9"/>` on a wheel.

    ## Use instead
    The mass in kilograms.
    """
    mass = sum(link.inertial.mass for link in links if link.inertial is not None)
    if HEAVIEST < mass <= BEYOND:
        yield Diagnostic(
            code="ROB049",
            severity=Severity.WARNING,
            message=f"The robot weighs {mass:.3g} kg.",
            file=file,
            line=links[0].line,
            element="robot",
            hint="Masses of a URDF are in kilograms: divide grams by 1000.",
        )
    fixed = {
        end
        for joint in joints
        if joint.type is JointType.FIXED
        for end in (joint.parent, joint.child)
    }
    for link in links:
        if (
            link.inertial is not None
            and 0 < link.inertial.mass < LIGHTEST
            and link.name not in fixed
        ):
            yield Diagnostic(
                code="ROB049",
                severity=Severity.WARNING,
                message=f"The link `{link.name}` weighs {link.inertial.mass:.3g} kg: Gazebo "
                "Classic takes that for nothing, and drops the link with all that hangs on it.",
                file=file,
                line=link.line,
                element=f"link[@name='{link.name}']/inertial/mass",
                hint="Masses of a URDF are in kilograms.",
            )


def _beyond(
    what: str, numbers: Iterable[float], place: str, line: int | None, file: Path | None
) -> Iterator[Diagnostic]:
    largest = max(map(abs, numbers), default=0.0)
    if largest > BEYOND:
        yield Diagnostic(
            code="ROB056",
            severity=Severity.ERROR,
            message=f"{largest:.3g} is too large a number for any physics engine.",
            file=file,
            line=line,
            element=f"{place}/{what}",
            hint="Write it in metres, kilograms and seconds.",
        )


def _numbers_of_link(link: Link) -> Iterator[tuple[str, tuple[float, ...]]]:
    if link.inertial is not None:
        inertial = link.inertial
        yield "inertial", (inertial.mass, *inertial.inertia, *inertial.pose_in_link.xyz)
    for geometry, pose in _shapes(link):
        yield "geometry", (*pose.xyz, *_sizes(geometry))


def largest_size(shape: Primitive) -> float:
    """The longest of its edges, diameter and length, m."""
    return max(_sizes(shape))


def _sizes(geometry: Geometry) -> tuple[float, ...]:
    if isinstance(geometry, Box):
        return geometry.size
    if isinstance(geometry, Mesh):
        return geometry.scale
    if isinstance(geometry, Sphere):
        return (2 * geometry.radius,)
    if isinstance(geometry, Triangulated):  # of SDF, and told by its reader
        return ()
    return (2 * geometry.radius, geometry.length)


def _shapes(link: Link) -> Iterator[tuple[Geometry, Pose]]:
    for collision in link.collisions:
        yield collision.geometry, collision.pose_in_link
    for visual in link.visuals:
        yield visual.geometry, visual.pose_in_link


def _extent(links: Iterable[Link], joints: Iterable[Joint]) -> float:
    """The longest edge of the box along the root's axes around frames and primitives, m."""
    poses = _poses(joints)
    corners: list[tuple[tuple[float, float, float], float]] = []
    for link in links:
        pose = poses.get(link.name, IDENTITY)
        corners.append((pose.xyz, 0.0))
        corners += (
            (compose(pose, place).xyz, max(_sizes(geometry)) / 2)
            for geometry, place in _shapes(link)
            if isinstance(geometry, Primitive)
        )
    return max(
        (
            max(xyz[axis] + reach for xyz, reach in corners)
            - min(xyz[axis] - reach for xyz, reach in corners)
            for axis in range(3)
            if corners
        ),
        default=0.0,
    )


def _poses(joints: Iterable[Joint]) -> dict[str, Pose]:
    """The poses of all links but the root, in the root's frame; the joints make a tree."""
    below: dict[str, list[Joint]] = {}
    children = set()
    for joint in joints:
        below.setdefault(joint.parent, []).append(joint)
        children.add(joint.child)
    poses: dict[str, Pose] = {}
    queue = [name for name in below if name not in children]
    for name in queue:
        for joint in below.get(name, ()):
            poses[joint.child] = compose(poses.get(name, IDENTITY), joint.pose_in_parent)
            queue.append(joint.child)
    return poses
