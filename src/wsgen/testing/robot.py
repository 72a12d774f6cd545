"""A robot in the simulation of a test: where it is, its commands, and what tests assert of it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from wsgen.checks.rules.behaviors import (
    check_behavior,
    command_beyond_limit,
    unknown_behavior_joint,
)
from wsgen.descriptions.urdf.diff_drive import NoDrive, find_diff_drive
from wsgen.diagnostics import Severity
from wsgen.errors import RequestError, WsgenError
from wsgen.model.behavior import Behavior, BehaviorRun, Drive, Reach
from wsgen.model.kinematics import fixed_frames
from wsgen.model.transform import compose
from wsgen.pipeline.run_robots import check_robot
from wsgen.reporting.words import render_text
from wsgen.simulation.scene import BehaviorMeasurement
from wsgen.text.suggestions import ask_for_nearest

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import DiffDrive
    from wsgen.model.robot import Joint as JointOfModel
    from wsgen.model.robot import Link as LinkOfModel
    from wsgen.model.robot import Robot as RobotModel
    from wsgen.model.transform import Pose, Vector
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.simulation.engine import Contact
    from wsgen.simulation.session import RobotState, Session
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


def assert_stands(robot: Robot, seconds: float = 3.0) -> None:
    """Let time pass, and check what `wsgen validate` checks of a robot that stands.

    It must stay upright and where it is, out of the ground and out of other robots, and come to
    rest. What commands it goes on doing so.

    Args:
        robot: The robot.
        seconds: How much simulated time passes.

    Raises:
        AssertionError: It does not; the message says why and what to do.
    """
    assert_simulated(robot)
    loaded = robot.simulation.loaded
    robot_run = robot.simulation.watch(seconds)[robot.name]
    runnable = [one for one in loaded.prepared if one.can_run]
    found = check_robot(loaded.world, runnable, robot.prepared, robot_run)
    _fail(f"The robot `{robot.name}` does not stand.", found)


def assert_reaches(
    robot: Robot, positions: Mapping[str, float], *, within: float = 0.05, seconds: float = 3.0
) -> None:
    """Have joints go to positions, and check that they get there.

    Args:
        robot: The robot; its joints go on holding the positions.
        positions: rad or m, by joint.
        within: How far from these they may be at the end, rad or m.
        seconds: How much simulated time passes.

    Raises:
        AssertionError: They do not get there.
        RequestError: A joint does not exist, or a position is beyond its limits.
    """
    task = Reach(positions=positions, within=within)
    behavior = Behavior(name="assert_reaches", task=task, seconds=seconds)
    model = robot.description
    for impossible in (
        *unknown_behavior_joint(behavior, positions, model, NO_FILE),
        *command_beyond_limit(behavior, positions, model.joints, NO_FILE),
    ):
        message = _without_name(impossible)
        raise RequestError(message[:1].upper() + message[1:], hint=impossible.hint or "")
    robot.hold(positions, seconds)
    _check(robot, behavior, BehaviorMeasurement(behavior.name, STILL, robot.positions))


def assert_drives(  # noqa: PLR0913  as a behavior
    robot: Robot,
    *,
    linear: float = 0.0,
    angular: float = 0.0,
    seconds: float = 2.0,
    x: float | None = None,
    y: float | None = None,
    yaw: float | None = None,
    tolerance: float = 0.1,
) -> Moved:
    """Drive as a Twist on /cmd_vel says, and check where the robot gets.

    Args:
        robot: The robot.
        linear: m/s, ahead.
        angular: rad/s, to the left.
        seconds: How much simulated time passes.
        x: Where it should be at the end, seen from where it began: m, ahead; None: not checked.
        y: Likewise, to the left.
        yaw: How far it should have turned, rad; whole turns included.
        tolerance: By what share of the way it may miss that.

    Returns:
        How far it came.

    Raises:
        AssertionError: It gets elsewhere.
        RequestError: It has no diff drive plugin that works.
    """
    task = Drive(linear=linear, angular=angular, x=x, y=y, yaw=yaw, tolerance=tolerance)
    behavior = Behavior(name="assert_drives", task=task, seconds=seconds)
    moved = robot.drive(linear=linear, angular=angular, seconds=seconds)
    _check(robot, behavior, BehaviorMeasurement(behavior.name, moved, robot.positions))
    return moved


NO_FILE = Path()  # a test is not written in wsgen.toml
STILL = (0.0, 0.0, 0.0)


def _check(robot: Robot, behavior: Behavior, behaved: BehaviorMeasurement) -> None:
    is_drive = isinstance(behavior.task, Drive)
    behavior_run = BehaviorRun(
        entity=robot.name, behavior=behavior, drive=robot.diff_drive if is_drive else None
    )
    if not robot.state.is_finite:
        raise AssertionError(f"The state of the robot `{robot.name}` is not finite any more.")
    problems = [
        f"{_without_name(found)}\n{found.hint}"
        for found in check_behavior(behavior_run, behaved, NO_FILE)
    ]
    if problems:
        raise AssertionError(f"The robot `{robot.name}`: " + "\n".join(problems))


def _without_name(found: Diagnostic) -> str:
    """The message of a diagnostic about a behavior, without the behavior's name."""
    return found.message.partition(": ")[2]


def _fail(summary: str, found: Sequence[Diagnostic]) -> None:
    errors = [one for one in found if one.severity is Severity.ERROR]
    if errors:
        raise AssertionError(f"{summary}\n{render_text(errors)}")
