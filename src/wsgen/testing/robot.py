"""A robot in the simulation of a test: what it is, where it is, and the commands that it takes."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, TypeVar

from wsgen.descriptions.urdf.diff_drive import NoDrive, find_diff_drive
from wsgen.errors import RequestError, WsgenError
from wsgen.model.kinematics import fixed_frames
from wsgen.model.transform import compose
from wsgen.text.suggestions import ask_for_nearest

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from wsgen.model.behavior import DiffDrive
    from wsgen.model.robot import Joint as JointOfModel
    from wsgen.model.robot import Link as LinkOfModel
    from wsgen.model.robot import Robot as RobotModel
    from wsgen.model.transform import Pose, Vector
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.simulation.engine import Contact
    from wsgen.simulation.session import Session
    from wsgen.simulation.session_state import RobotState
    from wsgen.testing.simulation import Simulation

__tracebackhide__ = True  # the tracebacks of tests end where these call wsgen

T = TypeVar("T")


def without_traceback(task: Callable[[], T]) -> T:
    """What the task gives; its errors end the tracebacks of tests here."""
    try:
        return task()
    except WsgenError as error:
        raise error.with_traceback(None) from None


class Limits(NamedTuple):
    """What a joint can do: rad, rad/s, N m for rotation; m, m/s, N for translation."""

    lower: float
    upper: float
    effort: float
    velocity: float


class Moved(NamedTuple):
    """How far a robot has come, seen from where it began."""

    x: float  # m, ahead: along the x axis of its root link
    y: float  # m, to the left
    yaw: float  # rad, to the left; whole turns included


class Link:
    """A link, as the description names it."""

    def __init__(self, robot: Robot, link: LinkOfModel) -> None:
        self._robot = robot
        self._link = link
        self.name = link.name

    def __repr__(self) -> str:
        return f"<link {self.name}>"

    @property
    def mass(self) -> float:
        """Its mass, kg, as the description gives it; 0 without <inertial>."""
        return 0.0 if self._link.inertial is None else self._link.inertial.mass

    @property
    def pose_in_world(self) -> Pose:
        """Its frame now: `xyz` in m, `rpy` in rad.

        Raises:
            RequestError: Gazebo drops the link.
        """
        return self._robot.pose_of(self.name)

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """What it touched in the last step, with the links that are fixed to it."""
        carrier = self._robot.carrier_of(self.name)
        return tuple(contact for contact in self._robot.contacts if contact.link == carrier)


class Joint:
    """A movable joint."""

    def __init__(self, robot: Robot, joint: JointOfModel) -> None:
        self._robot = robot
        self._joint = joint
        self.name = joint.name
        self.type: str = joint.type.value
        self.parent, self.child = joint.parent, joint.child

    def __repr__(self) -> str:
        return f"<joint {self.name}>"

    @property
    def limits(self) -> Limits | None:
        """Its <limit>, if it has one."""
        limit = self._joint.limit
        if limit is None:
            return None
        return Limits(limit.lower, limit.upper, limit.effort, limit.velocity)

    @property
    def position(self) -> float:
        """Where it is now, rad or m."""
        return self._robot.state.joint_positions[self.name]

    @property
    def velocity(self) -> float:
        """How fast it moves now, rad/s or m/s."""
        return self._robot.state.joint_velocities[self.name]


class Robot:
    """A robot that the launch file spawns.

    Attributes:
        name: Its entity in the simulator.
        simulation: The simulation that it is in.
        links: By name, as the description has them.
        joints: The movable ones by name.
    """

    def __init__(
        self, simulation: Simulation, prepared: PreparedRobot, simulator: str | None
    ) -> None:
        self.name = prepared.entity
        self.simulation = simulation
        self.prepared = prepared
        self.links: Mapping[str, Link] = {
            link.name: Link(self, link) for link in prepared.written.links
        }
        self.joints: Mapping[str, Joint] = {
            joint.name: Joint(self, joint) for joint in prepared.lumped.movable_joints
        }
        self._simulator = simulator
        self._carriers: Mapping[str, tuple[str, Pose]] | None = None

    def __repr__(self) -> str:
        return f"<robot {self.name}>"

    @property
    def description(self) -> RobotModel:
        """The robot as Gazebo has it: fixed joints lumped."""
        return self.prepared.lumped

    @property
    def mass(self) -> float:
        """The mass of all links that Gazebo simulates, kg."""
        return self.prepared.lumped.mass

    def link(self, name: str) -> Link:
        """The link of that name.

        Raises:
            RequestError: None is called so.
        """
        return self._one_of("link", name, self.links)

    def joint(self, name: str) -> Joint:
        """The movable joint of that name.

        Raises:
            RequestError: None is called so.
        """
        return self._one_of("movable joint", name, self.joints)

    def _one_of(self, kind: str, name: str, known: Mapping[str, T]) -> T:
        found = known.get(name)
        if found is None:
            raise RequestError(
                f"The robot `{self.name}` has no {kind} `{name}`.",
                hint=f"{ask_for_nearest(name, known)}It has: {', '.join(known) or 'none'}.",
            )
        return found

    @property
    def state(self) -> RobotState:
        """How it is now.

        Raises:
            RequestError: The engine does not simulate it.
            SessionDiedError: The engine dies of it.
        """
        session = self.simulation.session
        refused = session.refused.get(self.name)
        if refused is not None:
            raise RequestError(
                f"The physics engine does not simulate `{self.name}`: {refused.reason}.",
                hint=refused.hint,
            )
        return session.states[self.name]

    @property
    def pose_in_world(self) -> Pose:
        """The frame of its root link now: `xyz` in m, `rpy` in rad."""
        return self.state.pose_in_world

    @property
    def tilt(self) -> float:
        """How far it leans from how it was spawned, rad."""
        return self.state.tilt

    @property
    def speed(self) -> float:
        """The speed of its root link's center of mass, m/s."""
        return self.state.speed

    @property
    def positions(self) -> Mapping[str, float]:
        """Where its movable joints are now, rad or m, by name."""
        return self.state.joint_positions

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """What it touched in the last step; links that Gazebo lumps have the name of the first.

        `other_entity` of a contact is None for the ground.
        """
        assert_simulated(self)
        return without_traceback(lambda: self.simulation.session.contacts(self.name))

    @property
    def lowest_point(self) -> float:
        """The z of its lowest point that can touch something, m."""
        assert_simulated(self)
        return without_traceback(lambda: self.simulation.session.lowest_point(self.name))

    def carrier_of(self, link: str) -> str:
        """The link that Gazebo lumps a link into; the link itself, where it is not lumped.

        Raises:
            RequestError: Gazebo drops it.
        """
        return self._carrier(link)[0]

    def pose_of(self, link: str) -> Pose:
        """The frame of a link in the world now.

        Raises:
            RequestError: Gazebo drops it.
        """
        carrier, pose = self._carrier(link)
        return compose(self.state.links[carrier], pose)

    def _carrier(self, link: str) -> tuple[str, Pose]:
        if self._carriers is None:
            self._carriers = fixed_frames(self.prepared.written, self.prepared.lumped)
        found = self._carriers.get(link)
        if found is None:
            raise RequestError(
                f"Gazebo drops the link `{link}` of `{self.name}`.",
                hint="Give it an <inertial>; `wsgen check` says which links are dropped.",
            )
        return found

    def drive(
        self, *, linear: float = 0.0, angular: float = 0.0, seconds: float | None = None
    ) -> Moved:
        """Drive as a Twist on /cmd_vel says, through the robot's diff drive plugin.

        Args:
            linear: m/s, ahead.
            angular: rad/s, to the left.
            seconds: How much simulated time passes; then the robot is stopped. None: no time
                passes, and it is driven until it gets another command.

        Returns:
            How far the robot came in this time.

        Raises:
            RequestError: It has no diff drive plugin that works.
        """
        session, drive = self._ready(), self._diff_drive()
        without_traceback(lambda: session.measure(self.name))
        without_traceback(lambda: session.drive(self.name, drive, linear=linear, angular=angular))
        if seconds is None:
            return Moved(0.0, 0.0, 0.0)
        self.simulation.step(seconds)
        moved = Moved(*without_traceback(lambda: session.moved(self.name)))
        without_traceback(lambda: session.drive(self.name, drive))
        return moved

    def _diff_drive(self) -> DiffDrive:
        drive = find_diff_drive(self.prepared.lumped, simulator=self._simulator)
        if isinstance(drive, NoDrive):
            raise RequestError(
                f"The robot `{self.name}` cannot be driven: {drive.reason}.", hint=drive.hint
            )
        return drive

    @property
    def diff_drive(self) -> DiffDrive:
        """Its differential drive.

        Raises:
            RequestError: It has no diff drive plugin that works.
        """
        return self._diff_drive()

    def hold(self, positions: Mapping[str, float], seconds: float | None = None) -> None:
        """Have joints go to positions (rad or m) and hold them, within their limits.

        As in a behavior, all other joints with limits hold what is nearest to 0. It goes on until
        the robot gets another command.

        Args:
            positions: By joint.
            seconds: How much simulated time passes; None: none.

        Raises:
            RequestError: A joint does not exist.
        """
        session = self._ready()
        without_traceback(lambda: session.hold(self.name, positions))
        if seconds is not None:
            self.simulation.step(seconds)

    def release(self) -> None:
        """Take all commands back: joints are passive, as when spawned."""
        session = self._ready()
        without_traceback(lambda: session.release(self.name))

    def push(self, force: Vector, seconds: float, link: str | None = None) -> None:
        """Push it with a force (N, in the world) while so many simulated seconds pass.

        Args:
            force: N, along x, y and z of the world.
            seconds: How long.
            link: At whose center of mass it acts; None: the root link. A link that is fixed to
                another one is pushed with it, as one body.

        Raises:
            RequestError: The link does not exist.
        """
        session = self._ready()
        carrier = None if link is None else self.carrier_of(self.link(link).name)
        without_traceback(lambda: session.push(self.name, force, seconds, carrier))
        self.simulation.step(seconds)

    def _ready(self) -> Session:
        assert_simulated(self)
        return self.simulation.session


def assert_simulated(robot: Robot) -> None:
    """Stop where the engine does not have the robot.

    Raises:
        RequestError: It does not.
    """
    _ = robot.state
