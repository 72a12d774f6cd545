"""What a simulation needs of a physics engine, and which links of a robot may touch each other.

An engine that computes forces before a step has joints as stiff as its steps can follow: such a
force is that of the position before it. A spring that swings faster is made as soft as they can:
where it comes to rest is the same to the eye.
"""

from __future__ import annotations

import math
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple, Protocol, TypeVar

from wsgen.model.inertia import about_link_axes, moved
from wsgen.model.robot import JointType
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from wsgen.model.robot import Robot
    from wsgen.model.transform import Pose, Vector
    from wsgen.model.world import World
    from wsgen.simulation.scene import SpawnedRobot

    Points = Sequence[Sequence[float]] | NDArray[np.float64]
    from wsgen.model.robot import Inertial, Joint


STIFF = 0.5  # of the speed, in one step; PyBullet's own damping is exact far below
RESOLVED = 0.25  # of the resistance over the squared step; beyond 4 a swing grows
STRONGEST = 1e7  # N m or N; nothing on a robot resists it, and an engine can calculate with it


@dataclass(frozen=True)
class Loaded:
    """What the engine made of a robot."""

    links: int
    movable_joints: int
    mass: float  # kg


@dataclass(frozen=True)
class Refused:
    """The engine does not simulate the robot."""

    reason: str
    hint: str = "Check its collision meshes first: the engine reads STL, OBJ and DAE."


@dataclass(frozen=True)
class State:
    """How a robot is at this moment, seen from the world."""

    xyz: tuple[float, float, float]  # m, of the root link's frame
    xyzw: tuple[float, float, float, float]  # orientation of the root link, unit quaternion
    speed: float  # m/s, of the root link's center of mass; of loose parts that of the fastest
    turning: float  # rad/s, of the root link, likewise
    joint_speed: float  # rad/s or m/s, of the fastest joint; 0 without movable joints


class Look(NamedTuple):
    """What is looked at again and again while time passes: less than a state, and much cheaper."""

    height: float  # m, z of the root link's frame
    speed: float  # as those of the state
    turning: float
    joint_speed: float
    is_finite: bool  # no pose or speed is infinite or not-a-number
    state: Callable[[], State]  # at that moment, also when it is asked for later


def look_at(state: State) -> Look:
    """The look that shows a state."""
    numbers = (*state.xyz, *state.xyzw, state.speed, state.turning, state.joint_speed)
    return Look(
        height=state.xyz[2],
        speed=state.speed,
        turning=state.turning,
        joint_speed=state.joint_speed,
        is_finite=all(map(math.isfinite, numbers)),
        state=lambda: state,
    )


def is_finite(state: State) -> bool:
    """Whether no pose or speed of it is infinite or not-a-number."""
    return look_at(state).is_finite


class Overlap(NamedTuple):
    """Two links that are in each other."""

    entity: str
    link: str
    other_entity: str  # the same one for two links of one robot
    other_link: str
    depth: float  # m


@dataclass(frozen=True)
class HullGap:
    """A mesh that rests on something with its convex hull, where it has no triangle."""

    link: str
    other_entity: str  # what it touches
    gap: float  # m, from where it touches to the nearest triangle


@dataclass(frozen=True)
class Contact:
    """A point at which a link of a robot touches something."""

    link: str
    other_entity: str | None  # None: the ground; the same robot where it touches itself
    other_link: str | None
    point: tuple[float, float, float]  # m, in the world
    force: float  # N, that presses the two against each other: along the normal, never negative
    # Of length 1, in the world, from the other one to the link; all 0 where it is not known.
    normal: tuple[float, float, float] = (0.0, 0.0, 0.0)
    depth: float = 0.0  # m, that they are in each other


class Motor(NamedTuple):
    """What turns or slides a joint."""

    speed: float  # rad/s or m/s, that it keeps as far as it is strong enough
    effort: float  # N m or N, the most that it gives; may be infinite


class Engine(Protocol):
    """A world in a physics engine; robots are addressed by their entity names.

    An engine makes its world when it is constructed, with the ground plane, gravity and step of a
    `World`.
    """

    step_seconds: float

    def spawn(self, robot: SpawnedRobot) -> Loaded | Refused:
        """Put a robot into the world, at rest, its joints passive."""

    def place(self, entity: str, pose_in_world: Pose) -> None:
        """Put a robot elsewhere, as if it had been spawned there."""

    def remove(self, entity: str) -> None:
        """Take a robot out of the world; its name may be used again."""

    def set_velocity(self, entity: str, linear: Vector, angular: Vector) -> None:
        """Have the root link move and turn like that now, seen from the world: m/s and rad/s.

        The first is the velocity of the origin of its frame. What is fixed to the world stays.
        """

    def state(self, entity: str) -> State:
        """Where the robot is and how it moves."""

    def look(self, entity: str) -> Look:
        """The same, as far as it is looked at every few steps."""

    def joint_positions(self, entity: str) -> dict[str, float]:
        """The positions of the movable joints by name, rad or m.

        That of a ball joint is the angle by which it has turned, from 0 to pi.
        """

    def joint_velocities(self, entity: str) -> dict[str, float]:
        """The velocities of the movable joints by name, rad/s or m/s.

        That of a ball joint is how fast it turns, whatever its axis; never negative.
        """

    def energy(self, entity: str) -> float:
        """Kinetic energy, and potential energy above z = 0 in the world's gravity, J."""

    def lowest_point(self, entity: str) -> float:
        """The z of the lowest point that can touch something, m; that of the root without any."""

    def overlaps(self) -> Sequence[Overlap]:
        """Links in each other, of two robots or of one, whether or not they may collide.

        Left out are links that a joint joins. The ground is not a link.
        """

    def hull_gaps(self, entity: str) -> Sequence[HullGap]:
        """Where a robot touches something with the convex hulls of its meshes alone, right now.

        Only what is several millimeters off; never on level ground, where it makes no difference.
        """

    def advance(self, steps: int) -> None:
        """Let time pass."""

    def push(self, entity: str, link: str, force: Vector) -> None:
        """From now on, have a force (N, in the world) act on a link at its center of mass.

        It replaces the one before; that of zero ends it. Links that the engine does not move, as a
        root that is the world, stay where they are.
        """

    def contacts(self, entity: str) -> list[Contact]:
        """What a robot touched in the last step; nothing before the first one after it was placed.

        Two links that touch each other are listed from either side.
        """

    def set_joint_positions(self, entity: str, positions: Mapping[str, float]) -> None:
        """Put joints of a robot there (rad or m), at rest; the others and the root stay.

        Motors and efforts stay, too. Ball joints are left alone.
        """

    def drive(self, entity: str, motors: Mapping[str, Motor]) -> None:
        """Put motors into joints of a robot; those that are not named keep theirs."""

    def release(self, entity: str) -> None:
        """Take all motors out of a robot: its joints are passive again."""

    def set_efforts(self, entity: str, efforts: Mapping[str, float]) -> None:
        """From now on, have these efforts (N m or N) act in joints, which lose their motors.

        Those that are not named keep theirs. A motor takes the place of an effort.
        """

    def joint_efforts(self, entity: str) -> dict[str, float]:
        """What acted in the movable joints in the last step, by name, N m or N.

        That is what a motor gave, or the effort that was set; 0 for passive joints.
        """

    def joint_wrench(self, entity: str, joint: str) -> tuple[Vector, Vector]:
        """The force (N) and the torque (N m) of the parent link on the child link of a joint.

        Those of the last step, seen from the world, the torque about the origin of the child's
        frame. A fixed joint that is left has one, too. Zero before the first step after it was
        asked for first, or after the robot was placed.
        """

    def link_poses(self, entity: str) -> dict[str, Pose]:
        """The frames of all links of a robot by name, seen from the world."""

    def link_velocities(self, entity: str) -> dict[str, tuple[Vector, Vector]]:
        """How the links of a robot move, by name, seen from the world.

        The first is the velocity of the origin of the link's frame (m/s), the second how it turns
        (rad/s).
        """

    def cast_rays(self, starts: Points, ends: Points) -> NDArray[np.float64]:
        """How far rays get through what can touch something, the ground too: their first hits.

        Both are points in the world (m), shape (n, 3). Of each ray the answer has the fraction of
        its way that it gets, infinity where it hits nothing. It does not see the shape that it
        begins in: the housing of a lidar is around it. Meshes of triangles have no inside.
        """

    def corners(self, entity: str) -> list[Vector]:
        """Corners of boxes along the world's axes around all that can touch something, m."""

    def close(self) -> None:
        """Give everything back; the engine is not used afterwards."""


TOUCHING = 1e-3  # m; PyBullet's margin around convex shapes: less than this is no overlap

Place = tuple[str, str]  # entity and link


def neighbors(robot: Robot) -> set[frozenset[str]]:
    """The pairs of links that a joint joins."""
    return {frozenset((joint.parent, joint.child)) for joint in (*robot.joints, *robot.loose)}


def may_touch(robot: Robot, *, is_one_enough: bool) -> set[frozenset[str]]:
    """The pairs of links that collide with each other.

    No joint joins them, and both have `self_collide`. In Gazebo Classic that of one is enough, as
    SDF says; Gazebo Sim takes the flag of the whole model alone.
    """
    joined = neighbors(robot)
    collide = {link.name for link in robot.links if link.self_collide}
    needed = 1 if is_one_enough else 2
    return {
        pair
        for one, other in combinations([link.name for link in robot.links], 2)
        if len((pair := frozenset((one, other))) & collide) >= needed and pair not in joined
    }


def limit_share(world: World) -> float:
    """How much of the way back to a joint's limit goes in one step.

    That is ODE's error reduction parameter in Gazebo Classic, and DART's in Gazebo Sim.
    """
    return 0.2 if world.is_classic else 0.01


def decays(robot: Robot, world: World) -> dict[str, tuple[float, float]]:
    """The shares of speed and turning that links lose after each step, by name.

    ODE takes them off before the joints pull in the next step. That is what a force does then which
    would take as much off a free body.
    """
    if robot.is_static or not world.is_classic:
        return {}
    return {
        link.name: link.velocity_decay
        for link in robot.links
        if any(link.velocity_decay) and link.inertial is not None
    }


def deepest_overlaps(
    found: Iterable[tuple[Place, Place, float]], robots: Mapping[str, Robot]
) -> list[Overlap]:
    """One overlap for each pair of links, of all that an engine finds between their shapes (m).

    Left out are the shapes of one link, links that a joint joins, and what only touches.
    """
    joined = {entity: neighbors(robot) for entity, robot in robots.items()}
    deepest: dict[tuple[Place, Place], float] = {}
    for one, other, depth in found:
        (entity, link), (other_entity, other_link) = pair = min(one, other), max(one, other)
        is_one = entity == other_entity and link == other_link
        is_joined = entity == other_entity and frozenset((link, other_link)) in joined[entity]
        if depth > TOUCHING and not (is_one or is_joined):
            deepest[pair] = max(depth, deepest.get(pair, 0.0))
    return [Overlap(*one, *other, depth=depth) for (one, other), depth in deepest.items()]


class Touch(NamedTuple):
    """Where two places touch each other, as an engine has it; None is the ground."""

    one: Place | None
    other: Place | None
    point: Sequence[float]  # m, in the world
    force: float  # N
    normal: Sequence[float]  # from the other to the one
    depth: float  # m


def contacts_of(entity: str, found: Iterable[Touch]) -> list[Contact]:
    """The contacts of a robot, of all that an engine has; two links of it are seen from either."""
    contacts = []
    for one, other, (x, y, z), force, (a, b, c), depth in found:
        for place, met, sign in ((one, other, 1.0), (other, one, -1.0)):
            if place is not None and place[0] == entity:
                other_entity, other_link = met or (None, None)
                normal = (sign * a, sign * b, sign * c)
                contacts.append(
                    Contact(place[1], other_entity, other_link, (x, y, z), force, normal, depth)
                )
    return contacts


T = TypeVar("T")


def meeting(boxes: Iterable[tuple[Sequence[float], Sequence[float], T]]) -> Iterator[tuple[T, T]]:
    """What is in boxes that meet, found by a sweep along x; each is given by two corners."""
    open_ones: list[tuple[Sequence[float], Sequence[float], T]] = []  # that reach to the sweep
    for box in sorted(boxes, key=lambda box: box[0][0]):
        low, high, one = box
        open_ones = [other for other in open_ones if other[1][0] >= low[0]]
        for near, far, other in open_ones:
            if all(near[axis] <= high[axis] and low[axis] <= far[axis] for axis in (1, 2)):
                yield other, one
        open_ones.append(box)


def stiffness_to_simulate(joint: Joint, tree: Robot, step_seconds: float) -> float:
    """The stiffness of a joint's spring, or what the step can follow (N m/rad or N/m)."""
    most = RESOLVED * _least_resistance(joint, tree) / step_seconds**2
    return min(joint.spring_stiffness, most)


def is_stiff(joint: Joint, tree: Robot, step_seconds: float) -> bool:
    """Whether the damper stops the lighter side of the joint within about a step."""
    if not (joint.damping and joint.is_movable):
        return False
    return joint.damping * step_seconds > STIFF * _least_resistance(joint, tree)


def _least_resistance(joint: Joint, tree: Robot) -> float:
    """That of the side of the joint that is easier to move, kg m² or kg."""
    resistances = [
        _resistance(inertial, joint)
        for inertial in (tree.link(joint.child).inertial, tree.link(joint.parent).inertial)
        if inertial is not None and inertial.mass > 0
    ]
    return min(resistances, default=0.0)


def _resistance(inertial: Inertial, joint: Joint) -> float:
    """How hard a body is to move by a joint at its frame's origin: kg m² or kg.

    Of the parent, which hangs on the joint by another point, it is an estimate.
    """
    if joint.type is JointType.PRISMATIC:
        return inertial.mass
    x, y, z = joint.axis_in_joint
    xx, xy, xz, yy, yz, zz = moved(
        about_link_axes(inertial), inertial.mass, inertial.pose_in_link.xyz
    )
    return xx * x * x + yy * y * y + zz * z * z + 2 * (xy * x * y + xz * x * z + yz * y * z)
