"""A launch file that really runs, as a test sees it: its robots, its time, its topics."""

from __future__ import annotations

import math
import time
from contextlib import ExitStack, contextmanager
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, TypeVar

from wsgen.errors import RequestError, SessionDiedError
from wsgen.live.prepare import RunRequest
from wsgen.live.session import open_live, shown_pose
from wsgen.pipeline.load_scene import load_scene, workspace_of
from wsgen.pipeline.plan_launch import package_of, select_launch_file
from wsgen.pipeline.requests import ValidateRequest
from wsgen.simulation.run import default_engine
from wsgen.testing.robot import without_traceback
from wsgen.text.suggestions import ask_for_nearest

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Mapping
    from pathlib import Path

    from wsgen.live.session import LiveSession
    from wsgen.model.transform import Pose
    from wsgen.pipeline.requests import SelectedLaunchFile

__tracebackhide__ = True  # the tracebacks of tests end where these call wsgen

T = TypeVar("T")

SECONDS_TO_MATCH = 10.0  # of the clock, until publishers and subscriptions have found each other
SECONDS_IN_FLIGHT = 0.5  # of the clock, for a message that was published
SECONDS_TO_ANSWER = 60.0  # of the clock, on a busy machine, beside those that a test gives
STEP = 0.01  # s, simulated, while an answer is awaited


class Message(SimpleNamespace):
    """A message with the fields of ROS as attributes; arrays are lists."""


class LiveRobot:
    """A robot of a live run.

    Attributes:
        name: Its entity in the simulator.
    """

    def __init__(self, session: LiveSession, name: str) -> None:
        self._session = session
        self.name = name

    def __repr__(self) -> str:
        return f"<robot {self.name}>"

    @property
    def pose(self) -> Pose:
        """The frame of its root link in the world, where the simulation is (not odometry).

        `x`, `y`, `z` in m; `roll`, `pitch`, `yaw` in rad; `xyz`, `rpy` are the same as tuples.

        Raises:
            RequestError: It is not in the world any more.
        """
        return _of_robot(self._session.state.poses, self.name)

    @property
    def positions(self) -> Mapping[str, float]:
        """Where its movable joints are, rad or m, by name.

        Raises:
            RequestError: It is not in the world any more.
        """
        return _of_robot(self._session.state.joints, self.name)


def _of_robot(found: Mapping[str, T], name: str) -> T:
    if name not in found:
        raise RequestError(
            f"The robot `{name}` is not in the world.",
            hint="Look at what the simulator prints: a node deleted it, or it exploded.",
        )
    return found[name]


class _Robots(dict[str, LiveRobot]):
    """Robots by entity."""

    def __missing__(self, name: str) -> LiveRobot:
        raise RequestError(
            f"No robot is spawned as `{name}`.",
            hint=f"{ask_for_nearest(name, self)}Robots: {', '.join(self) or 'none'}.",
        )


class Live:
    """A launch file that runs; simulated time passes only while a test waits here."""

    def __init__(self, session: LiveSession) -> None:
        self._session = session

    def __repr__(self) -> str:
        return f"<live run of {', '.join(self.robots)} after {self.time:g} s>"

    @property
    def time(self) -> float:
        """The simulated time, s, as /clock has it."""
        return self._session.state.seconds

    @property
    def robots(self) -> Mapping[str, LiveRobot]:
        """The robots in the world, by entity."""
        return _Robots({name: LiveRobot(self._session, name) for name in self._session.state.poses})

    @property
    def robot(self) -> LiveRobot:
        """The only robot in the world.

        Raises:
            RequestError: Several are in it, or none.
        """
        robots = self.robots
        if len(robots) != 1:
            raise RequestError(
                f"{len(robots)} robots are in the world.",
                hint=f"Choose one: ros.robots[NAME], of {', '.join(robots)}."
                if robots
                else "Spawn one first.",
            )
        return next(iter(robots.values()))

    @property
    def output(self) -> str:
        """What the processes have printed, `[NAME] LINE`; the last 400 lines."""
        self._session.journal.read()
        return "\n".join(self._session.journal.lines)

    def run_for(self, seconds: float) -> None:
        """Let so much simulated time pass.

        Raises:
            SessionDiedError: A process has failed, the simulator has ended or hangs.
        """
        without_traceback(lambda: self._session.run_for(seconds))

    def wait_until(self, condition: Callable[[], T], seconds: float) -> T:
        """Let simulated time pass until a condition holds, which is looked at each 0.05 s.

        Args:
            condition: Gives something true when it holds; that is returned.
            seconds: How much simulated time may pass.

        Raises:
            AssertionError: It does not hold in time; the message says how robots are.
            SessionDiedError: A process has failed, the simulator has ended or hangs.
        """
        begun = self.time
        try:
            found: Any = self._session.run_for(seconds, until=condition)
        except SessionDiedError as error:
            raise error.with_traceback(None) from None
        if found:
            held: T = found
            return held
        poses = self._session.state.poses
        how = "\n".join(f"`{name}` is at {shown_pose(pose)}." for name, pose in poses.items())
        raise AssertionError(
            f"The condition does not hold within {seconds:g} simulated seconds, "
            f"from {begun:.2f} s to {self.time:.2f} s.\n{how}"
        )

    def publish(
        self,
        topic: str,
        message_type: str,
        values: Mapping[str, Any] | None = None,
        *,
        rate: float | None = None,
    ) -> None:
        """Publish a message, when somebody takes it; no simulated time passes.

        Args:
            topic: Such as "/cmd_vel".
            message_type: Such as "geometry_msgs/msg/Twist".
            values: Fields that are not 0, by name; "header": "auto" stamps it.
            rate: Messages a simulated second, from now until the next call for this topic; None:
                one message.

        Raises:
            RequestError: Nobody takes it, or the type has no such field.
        """
        if rate is not None and not (_is_number(rate) and rate > 0):
            raise RequestError(
                f"The rate {rate!r} is not a number above 0.",
                hint="Give messages a second, above 0.",
            )
        self._ask(
            "publish",
            topic=_from_root(topic),  # one with and one without `/` would be published twice
            type=message_type,
            values=dict(values or {}),
            rate=rate,
            now=self.time,
            seconds=SECONDS_TO_MATCH,
        )

    def message(self, topic: str, seconds: float = 5.0) -> Message:
        """The last message of a topic; the first call waits for one, and simulated time passes.

        Args:
            topic: Such as "/scan".
            seconds: How much simulated time may pass.

        Raises:
            AssertionError: None comes in time.
            RequestError: Nobody publishes on the topic.
            SessionDiedError: A process has failed, the simulator has ended or hangs.
        """
        topic = _from_root(topic)
        found = self._ask("subscribe", topic=topic, seconds=SECONDS_TO_MATCH)
        if not found["is_there"]:
            raise RequestError(
                f"No node publishes on {topic}.",
                hint=found["hint"] or "Look at what the nodes print.",
            )
        last: list[Any] = [None]

        def has_come() -> bool:
            last[0] = self._ask("message", topic=topic)["message"]
            return last[0] is not None

        def wait() -> None:
            self._session.run_for(seconds, until=has_come)

        without_traceback(wait)
        if last[0] is None:
            last[0] = self._ask("message", topic=topic, seconds=SECONDS_IN_FLIGHT)["message"]
        if last[0] is None:
            raise AssertionError(f"No message has come on {topic} in {seconds:g} simulated s.")
        message: Message = _message(last[0])
        return message

    def call(
        self,
        service: str,
        service_type: str,
        values: Mapping[str, Any] | None = None,
        *,
        seconds: float = 10.0,
    ) -> Message:
        """Call a service, and give its response; simulated time passes while it works.

        Args:
            service: Such as "/reset".
            service_type: Such as "std_srvs/srv/Empty".
            values: Fields of the request that are not 0, by name.
            seconds: Of the clock, that it may take.

        Raises:
            RequestError: No node offers it, it does not answer, or it has no such field.
            SessionDiedError: A process has failed, the simulator has ended or hangs.
        """
        messenger = self._session.messenger
        if not _is_number(seconds) or seconds < 0:
            raise RequestError(
                f"{seconds!r} is not a time in seconds.", hint="Give a number from 0."
            )
        end = time.monotonic() + seconds + SECONDS_TO_ANSWER

        def call() -> Any:
            number = messenger.send(
                "call",
                service=service,
                type=service_type,
                values=dict(values or {}),
                seconds=seconds,
            )
            while (answer := messenger.answer(number, STEP)) is None:
                if time.monotonic() >= end:  # the process with rclpy says so itself before
                    raise SessionDiedError(
                        f"Nothing was heard of {service} for {seconds + SECONDS_TO_ANSWER:g} s.",
                        hint="Check the load and the memory of the machine.",
                    )
                self._session.advance(STEP)
            return answer["response"]

        message: Message = _message(without_traceback(call))
        return message

    def _ask(self, do: str, **values: object) -> dict[str, Any]:
        return without_traceback(lambda: self._session.messenger.ask(do, **values))


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _from_root(topic: str) -> str:
    return topic if topic.startswith("/") else f"/{topic}"


def _message(value: Any) -> Any:
    """A message of the fields in a dictionary, and of those in it."""
    if isinstance(value, dict):
        return Message(**{name: _message(one) for name, one in value.items()})
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return [_message(one) for one in value]
    return value


@contextmanager
def run_live(  # noqa: PLR0913  what is run, and how
    package: str | None,
    launch_file: str | None,
    *,
    near: Path,
    arguments: Mapping[str, str],
    engine: str | None = None,
    rate: float | None = None,
    may_fail: Collection[str] = (),
    opened: Callable[[LiveSession], None] = lambda _session: None,
) -> Iterator[Live]:
    """Run a launch file; all that it starts ends with the context.

    Args:
        package: Its name; None: the one that `near` lies in.
        launch_file: The name of one of its launch files; None: the one that spawns robots.
        near: A file or folder. The workspace around it is sourced, as far as it is built.
        arguments: Of the launch file.
        engine: The physics engine.
        rate: Simulated seconds a second at most, while time passes; None: as many as possible.
        may_fail: Nodes and programs that may end with an error.
        opened: Is given the session before anything else happens in it.

    Raises:
        BrokenLaunchError: It cannot be started.
        WsgenError: It does not exist, something for it is missing, or a process has failed.
    """
    with ExitStack() as stack:
        selected = stack.enter_context(_select(package, launch_file, near, arguments))
        request = ValidateRequest(launch_arguments=arguments, engines=(engine or default_engine(),))
        how = RunRequest(prepared_as=request, rate=rate)
        session = stack.enter_context(open_live(selected, how, may_fail=may_fail, opened=opened))
        yield Live(session)


@contextmanager
def _select(
    package: str | None, launch_file: str | None, near: Path, arguments: Mapping[str, str]
) -> Iterator[SelectedLaunchFile]:
    """The launch file that is meant, with the workspace around a place."""
    workspace = workspace_of(near)
    name = package or package_of(near)
    if name is None:
        raise RequestError(
            f"{near} is not in a package: no package.xml is above it.",
            hint='Name the package: live("PACKAGE", "FILE.launch.py")',
        )
    root = None if workspace is None else str(workspace.root)
    if launch_file is None:
        launch_file = _only_launch_file(name, near, arguments)
    with select_launch_file((name, launch_file), root) as selected:
        yield selected


def _only_launch_file(package: str, near: Path, arguments: Mapping[str, str]) -> str:
    with load_scene(package, near=near, arguments=arguments) as loaded:
        return loaded.launch_file.name
