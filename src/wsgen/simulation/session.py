"""A scene that lives in a child process and executes one command at a time.

    with Session(scene) as session:
        session.step(2.0)
        session.states["my_robot"].pose_in_world

The same commands give the same states, bit by bit, in one engine. What the engine does to the child
is reported by `SessionDiedError`, and never ends or blocks this process.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Mapping
from dataclasses import replace
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from wsgen.errors import RequestError, SessionDiedError
from wsgen.isolation.channel import Channel
from wsgen.isolation.codec import decode
from wsgen.isolation.result import Died
from wsgen.model.engines import ENGINES
from wsgen.model.transform import Pose  # noqa: TC001  the type hints of answers are read
from wsgen.simulation.engine import Contact, Loaded, Refused
from wsgen.simulation.run import explain_death
from wsgen.simulation.scene import NotDrawn, Picture, RobotRun, Video
from wsgen.text.suggestions import ask_for_nearest
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from types import TracebackType

    from wsgen.model.behavior import DiffDrive
    from wsgen.model.robot import Robot
    from wsgen.model.transform import Vector
    from wsgen.simulation.engine import Motor
    from wsgen.simulation.scene import Scene


T = TypeVar("T")

# CPU time that a command may take. Large robots are slower than real time; the limit is for an
# engine that hangs.
COMMAND_SECONDS = 60.0
SECONDS_A_SECOND = 20.0  # more for each that is simulated
AXES = 3


class Session(contextlib.AbstractContextManager["Session"]):
    """A scene in its engine; robots are addressed by their entity names.

    Attributes:
        scene: What is simulated. Its seconds, behavior runs, pushes and files mean nothing here.
        loaded: What the engine made of the robots that it accepted, by entity.
        spawn_poses: Where those were spawned: the root links' frames in the world.
        refused: Why it refused the others.
        step_seconds: The engine's step, s.
        seconds: The simulated time since the beginning, s.
        states: How all robots are now, by entity; the value is replaced by each command that lets
            time pass.
    """

    scene: Scene
    loaded: Mapping[str, Loaded]
    spawn_poses: Mapping[str, Pose]
    refused: Mapping[str, Refused]
    step_seconds: float
    seconds: float
    states: Mapping[str, RobotState]

    def __init__(self, scene: Scene, *, remembered: float = 1.0) -> None:
        """Start the engine and spawn the robots.

        Args:
            scene: The world, the robots and the engine.
            remembered: How many of the last simulated seconds `record` can draw; 0 is faster.

        Raises:
            SessionDiedError: The engine is not loaded, or dies of a robot.
            NotReadableError: The child process cannot be started.
        """
        self.scene = scene
        self._robots = {one.entity: one.robot for one in scene.robots}
        self._ended: SessionDiedError | None = None
        self._is_closed = False
        self._channel = Channel(f"{ENGINES[scene.engine].tasks}:serve", scene, remembered)
        try:
            self._take(self._call("open", doing="", kind=Opened))
        except BaseException:
            self.close()
            raise

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """End the engine; may be called again."""
        self._is_closed = True
        self._channel.close()

    def reset(self) -> None:
        """Begin again: everything is as it was spawned, and nothing commands a robot.

        What follows is the same, bit by bit, as in a new session.
        """
        self._take(self._call("reset", doing="", kind=Opened))

    def step(self, seconds: float) -> Mapping[str, RobotState]:
        """Let simulated time pass; gives the states then.

        It ends early where the state of a robot is not finite any more (`is_finite`).
        """
        seconds = _checked(seconds)
        doing = f"simulating {seconds:g} s after {self.seconds:g} s"
        self._go_on(self._call("step", seconds, doing=doing, kind=Moment, simulated=seconds))
        return self.states

    def watch(self, seconds: float) -> tuple[RobotRun, ...]:
        """Let simulated time pass, and measure what `wsgen validate` measures.

        As for it, the robots that the engine refused are left out.
        """
        seconds = _checked(seconds)
        doing = f"simulating {seconds:g} s after {self.seconds:g} s"
        watched = self._call("watch", seconds, doing=doing, kind=Watched, simulated=seconds)
        self._go_on(watched.moment)
        return watched.robot_runs

    def drive(
        self, entity: str, drive: DiffDrive, *, linear: float = 0.0, angular: float = 0.0
    ) -> None:
        """From now on, drive as a Twist on /cmd_vel says, until the next one.

        Args:
            entity: The robot.
            drive: Its differential drive (`wsgen.descriptions.urdf.diff_drive.find_diff_drive`).
            linear: m/s, ahead.
            angular: rad/s, about z.

        Raises:
            RequestError: A joint does not exist, or a velocity is not a finite number.
        """
        linear = _finite(linear, "The linear velocity", "m/s")
        angular = _finite(angular, "The angular velocity", "rad/s")
        self._check_joints(
            entity, (name for pair in drive.pairs for name in (pair.left, pair.right))
        )
        self._notify("drive", entity, drive, linear, angular, doing=f"driving `{entity}`")

    def hold(self, entity: str, positions: Mapping[str, float]) -> None:
        """From now on, have joints go to positions (rad or m) and hold them, within their limits.

        As in a behavior, joints with limits that are never named hold what is nearest to 0. What
        was named before goes on.

        Raises:
            RequestError: A joint does not exist, or a position is not a finite number.
        """
        if not isinstance(positions, Mapping):
            raise RequestError(
                f"The positions of joints are {positions!r}, not a dict.",
                hint="Name the joints: {'JOINT': POSITION}.",
            )
        self._check_joints(entity, positions)
        given = {
            joint: _finite(position, f"The position of `{joint}`", "rad or m")
            for joint, position in positions.items()
        }
        self._notify("hold", entity, given, doing=f"holding joints of `{entity}`")

    def set_motors(self, entity: str, motors: Mapping[str, Motor]) -> None:
        """From now on, have these motors in joints, whatever else commands them."""
        self._check_joints(entity, motors)
        given = {joint: tuple(motor) for joint, motor in motors.items()}
        for joint, motor in motors.items():
            _finite(motor.speed, f"The speed of the motor of `{joint}`", "rad/s or m/s")
            if motor.effort != math.inf:
                _finite(motor.effort, f"The effort of the motor of `{joint}`", "N m or N")
        self._notify("set_motors", entity, given, doing=f"setting motors of `{entity}`")

    def release(self, entity: str) -> None:
        """Take away all that commands a robot: its joints are as when it was spawned.

        They are passive, but for wheels that a diff drive plugin keeps still.
        """
        self._robot(entity)
        self._notify("release", entity, doing=f"releasing the joints of `{entity}`")

    def push(self, entity: str, force: Vector, seconds: float, link: str | None = None) -> None:
        """From now on, have a force act on a robot for so many simulated seconds.

        Args:
            entity: The robot.
            force: N, in the world.
            seconds: How long; no time passes until `step`. Several pushes add up.
            link: Of the lumped robot, at whose center of mass it acts; None: the root link.

        Raises:
            RequestError: The link does not exist, or the force is not three finite numbers.
        """
        robot = self._robot(entity)
        known = [one.name for one in robot.links]
        if link is None:
            link = robot.root
        elif link not in known:
            raise RequestError(
                f"`{entity}` has no link `{link}` that the engine simulates.",
                hint=f"{ask_for_nearest(link, known)}Links: {', '.join(known)}.",
            )
        seconds, given = _checked(seconds), _vector(force)
        self._notify("push", entity, link, given, seconds, doing=f"pushing `{entity}`")

    def measure(self, entity: str) -> None:
        """From now on, measure how far a robot moves."""
        self._robot(entity)
        self._measured.add(entity)
        self._notify("measure", entity, doing=f"measuring where `{entity}` is")

    def moved(self, entity: str) -> tuple[float, float, float]:
        """How far a robot has moved since `measure`, as behaviors say it: m, m, rad.

        It is that of the root link's frame, along its x and y axes on the ground as they were then,
        and how far it has turned, whole turns included.
        """
        if entity not in self._measured:
            raise RequestError(
                f"The distance traveled by `{entity}` is not measured.",
                hint="Call `measure` first.",
            )
        doing = f"measuring where `{entity}` is"
        return self._call("moved", entity, doing=doing, kind=tuple[float, float, float])

    def contacts(self, entity: str) -> tuple[Contact, ...]:
        """What a robot touched in the last step; nothing before the first one."""
        self._robot(entity)
        doing = f"looking for contacts of `{entity}`"
        return self._call("contacts", entity, doing=doing, kind=tuple[Contact, ...])

    def lowest_point(self, entity: str) -> float:
        """The z of the lowest point of a robot that can touch something, m."""
        self._robot(entity)
        doing = f"looking for the lowest point of `{entity}`"
        return self._call("lowest_point", entity, doing=doing, kind=float)

    def picture(self, file: Path | str) -> Picture | NotDrawn:
        """Draw the robots as they are now, as a PNG; its folder must exist."""
        return self._draw("picture", file, Picture | NotDrawn)  # type: ignore[arg-type]

    def record(self, file: Path | str) -> Video | NotDrawn:
        """Draw the last seconds that are remembered as a video, .gif or .mp4."""
        return self._draw("record", file, Video | NotDrawn)  # type: ignore[arg-type]

    def _draw(self, command: str, file: Path | str, kind: type[T]) -> T:
        place = Path(file).absolute()
        doing = f"drawing {place.name}"
        return self._call(command, place, doing=doing, kind=kind)

    def _take(self, opened: Opened) -> None:
        self.loaded, self.refused = opened.loaded, opened.refused
        self.spawn_poses, self.step_seconds = opened.spawn_poses, opened.step_seconds
        self.seconds = 0.0
        self._measured: set[str] = set()
        self.states = {state.entity: state for state in opened.states}

    def _go_on(self, moment: Moment) -> None:
        self.seconds = moment.seconds
        self.states = {**self.states, **{state.entity: state for state in moment.states}}

    def _notify(self, command: str, *arguments: object, doing: str) -> None:
        self._call(command, *arguments, doing=doing, kind=type(None))

    def _call(
        self,
        command: str,
        *arguments: object,
        doing: str,
        kind: type[T],
        simulated: float = 0.0,
    ) -> T:
        if self._is_closed:
            raise ValueError("The session is closed.")
        if self._ended is not None:
            raise self._ended
        limit = COMMAND_SECONDS + SECONDS_A_SECOND * simulated
        outcome = self._channel.call(command, *arguments, seconds=limit)
        if isinstance(outcome, Died):
            # While robots are spawned the child says which one.
            diagnostic = explain_death(self.scene, replace(outcome, step=doing or outcome.step))
            self._ended = SessionDiedError(diagnostic.message, hint=diagnostic.hint or "")
            raise self._ended
        return decode(outcome.value, kind)

    def _robot(self, entity: str) -> Robot:
        """The robot of that name, which the engine has."""
        if entity not in self.loaded:
            raise RequestError(
                f"The engine does not simulate a robot `{entity}`.",
                hint=f"{ask_for_nearest(entity, self.loaded)}"
                f"Robots: {', '.join(self.loaded) or 'none'}.",
            )
        return self._robots[entity]

    def _check_joints(self, entity: str, joints: Iterable[str]) -> None:
        known = [joint.name for joint in self._robot(entity).movable_joints]
        for name in joints:
            if name not in known:
                raise RequestError(
                    f"`{entity}` has no movable joint `{name}`.",
                    hint=f"{ask_for_nearest(name, known)}Movable joints: "
                    f"{', '.join(known) or 'none'}.",
                )


def _checked(seconds: float) -> float:
    """A time that can pass."""
    if not isinstance(seconds, Real) or not 0 <= seconds < math.inf:
        raise RequestError(
            f"{seconds} s of simulated time cannot pass.", hint="Give a number of 0 or more."
        )
    return float(seconds)


def _finite(value: float, what: str, unit: str) -> float:
    """A number as the channel takes it, of any library that has numbers."""
    if not isinstance(value, Real) or not math.isfinite(value):
        raise RequestError(
            f"{what} is {value!r}, not a finite number.", hint=f"Give a number in {unit}."
        )
    return float(value)


def _vector(force: Vector) -> Vector:
    """A force as the channel takes it, of a tuple, a list or an array."""
    numbers: Sequence[float]
    try:
        numbers = tuple(force)
    except TypeError:  # one number
        numbers = ()
    if len(numbers) != AXES:
        raise RequestError(
            f"The force is {force!r}, not three numbers.",
            hint="Give a force in N along x, y and z of the world: (20.0, 0.0, 0.0).",
        )
    x, y, z = (_finite(number, "A part of the force", "N") for number in numbers)
    return x, y, z


@dataclass(frozen=True, kw_only=True)
class RobotState:
    """How a robot is at a moment."""

    entity: str
    pose_in_world: Pose  # of the root link's frame
    links: Mapping[str, Pose]  # the frames of the lumped links in the world, by name
    joint_positions: Mapping[str, float]  # rad or m, of the movable joints
    joint_velocities: Mapping[str, float]  # rad/s or m/s
    speed: float  # m/s, of the root link's center of mass
    turning: float  # rad/s, of the root link
    tilt: float  # rad, between what was up in the robot when spawned and up
    is_finite: bool  # no pose or speed is infinite or not-a-number

    @property
    def joint_speed(self) -> float:
        """The velocity of the fastest joint, rad/s or m/s, never negative; 0 without any."""
        return max(map(abs, self.joint_velocities.values()), default=0.0)


@dataclass(frozen=True, kw_only=True)
class Moment:
    """How the robots are that can move."""

    seconds: float  # simulated, since the beginning
    states: tuple[RobotState, ...]


@dataclass(frozen=True, kw_only=True)
class Opened:
    """What the engine made of a scene, and how all robots are, also the static ones."""

    loaded: Mapping[str, Loaded]  # by entity
    spawn_poses: Mapping[str, Pose]  # of the root links' frames
    refused: Mapping[str, Refused]
    step_seconds: float
    states: tuple[RobotState, ...]


@dataclass(frozen=True, kw_only=True)
class Watched:
    """What was measured while time passed, and how the robots are then."""

    robot_runs: tuple[RobotRun, ...]
    moment: Moment
