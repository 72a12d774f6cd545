"""The node that writes all topics into an MCAP file."""

from __future__ import annotations

import importlib
import signal
import struct
import time
from collections import Counter, deque
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, NamedTuple

import rclpy
from mcap.writer import Writer
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from ament_index_python.packages import get_package_share_directory
from wsgen.live.nodes.messages import definition_of
from wsgen.live.nodes.signals import ENDING, ignore_ends
from wsgen.live.nodes.simulator_client import SimulatedTimes, SimulatorTime

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from rclpy.duration import Duration
    from rclpy.endpoint_info import TopicEndpointInfo


LOOK_SECONDS = 0.2  # wall-clock, between two looks for new topics
POLL_SECONDS = 0.02  # wall-clock, between two looks for messages where none waits
DEPTH = 1000  # messages that wait for the recorder, at most; a full queue loses the oldest
LIBRARY = "wsgen"
CLOCK = ("/clock", "rosgraph_msgs/msg/Clock")
SECONDS_AT_ONCE = 0.05  # wall-clock, in which messages of one topic are written
SECONDS_TO_COME = 0.5  # wall-clock, for messages that are on their way when the recording ends
SECONDS_TO_KNOW = 5.0  # wall-clock, for one of /clock: Fast DDS sends again after 3 s what was lost
SECONDS_OF_SILENCE = 1.0  # wall-clock, in which what waits is written before that is said
SECONDS_TO_SAY_AGAIN = 5.0  # wall-clock
TIME, HEADER = struct.Struct("<iI"), 4  # of serialized messages, behind the order of their bytes


class _Recording(NamedTuple):
    """A topic that is recorded."""

    topic: str
    channel: int
    profile: QoSProfile
    subscription: Any
    is_clock: bool


class _Held(NamedTuple):
    """A message whose simulated time is not known yet."""

    until: float  # s of the monotonic clock
    channel: int
    message: bytes
    sent: int  # ns since 1970


class Recorder(Node):
    """Subscribes to every topic and writes what comes.

    It takes all that waits of a topic at once, without an executor, which takes one message of each
    topic a turn: those of quick topics would pile up on a busy machine. Messages have the time at
    which they were sent, not that at which they are written.
    """

    def __init__(
        self, writer: Writer, *, use_sim_time: bool, simulator: SimulatorTime | None = None
    ) -> None:
        super().__init__(
            "_wsgen_recorder",  # hidden, as its subscriptions are nobody's business
            enable_rosout=False,
            start_parameter_services=False,
        )
        self._writer = writer
        self._simulator = simulator  # None: it is not asked, because there is a /clock
        self._schemas: dict[str, int] = {}  # by type
        self._recordings: dict[str, _Recording | None] = {}  # by topic; None: it cannot be
        self._sequences: dict[int, int] = {}  # by channel
        self._heard: dict[tuple[str, bytes], int] = {}  # the last number of a topic and publisher
        self._lost: Counter[str] = Counter()  # by topic
        self._first: int | None = None  # ns, the time of the first message, and of the last one
        self._last = 0
        self._times = SimulatedTimes() if use_sim_time else None
        self._held: deque[_Held] = deque()

    def recorded(self) -> tuple[float, int, dict[str, int]]:
        """The time from the first message to the last one in seconds, how many there are; lost.

        Those that were lost are counted by topic.
        """
        first = self._last if self._first is None else self._first
        lost = {topic: count for topic, count in sorted(self._lost.items()) if count}
        return (self._last - first) * 1e-9, sum(self._sequences.values()), lost

    def write_until(self, is_over: Callable[[], bool]) -> None:
        """Write what comes."""
        next_look = 0.0
        while not is_over():
            if time.monotonic() >= next_look:
                self._look()
                next_look = time.monotonic() + LOOK_SECONDS
            written = [self._write_waiting(one) for one in self._known()]
            self._write_held()
            if not any(written):
                time.sleep(POLL_SECONDS)

    def write_rest(self, is_wanted: Callable[[], bool]) -> None:
        """Write what has been sent until now, and waits.

        Where that is not wanted any more, what waits is counted as lost.
        """
        end, said = time.time_ns(), time.monotonic() + SECONDS_OF_SILENCE
        unfinished, came = self._known(), time.monotonic()
        while unfinished and time.monotonic() - came < SECONDS_TO_COME:
            sent = {
                one.topic: self._write_waiting(one, is_wanted=is_wanted()) for one in unfinished
            }
            unfinished = [one for one in unfinished if sent[one.topic] < end]  # others go on
            behind = min(filter(None, sent.values()), default=0)
            if not behind:
                time.sleep(POLL_SECONDS)
                continue
            came = time.monotonic()
            if came > said and is_wanted():
                said = came + SECONDS_TO_SAY_AGAIN
                self.get_logger().info(
                    f"what was sent in the last {(end - behind) * 1e-9:.1f} s is still to be "
                    "written; Ctrl-C leaves it out"
                )
        self._write_held(is_over=True)

    def _known(self) -> list[_Recording]:
        return [one for one in self._recordings.values() if one is not None]

    def _write_waiting(self, one: _Recording, *, is_wanted: bool = True) -> int:
        """Write messages of a topic that wait; when the last one was sent, ns; 0 without one."""
        until, sent = time.monotonic() + SECONDS_AT_ONCE, 0
        while time.monotonic() < until and (taken := _take(one.subscription)) is not None:
            message, info = taken
            sent = info["source_timestamp"]
            self._count_lost(one.topic, info)
            if one.is_clock and self._times is not None:
                seconds, nanoseconds = TIME.unpack_from(message, HEADER)
                self._times.note(sent, seconds * 10**9 + nanoseconds)
                self._simulator = None
            if is_wanted:
                self._write(one.channel, message, sent)
            else:
                self._lost[one.topic] += 1
        return sent

    def _look(self) -> None:
        for topic, types in self.get_topic_names_and_types():
            one = self._recordings.get(topic)
            if topic in self._recordings and one is None:
                continue
            publishers = self.get_publishers_info_by_topic(topic)
            if one is None and publishers:
                self._recordings[topic] = self._record(topic, types, publishers)
            elif one is not None and publishers:
                self._recordings[topic] = self._hear_all(one, publishers)

    def _record(
        self, topic: str, types: Sequence[str], publishers: Sequence[TopicEndpointInfo]
    ) -> _Recording | None:
        if len(types) > 1:
            self.get_logger().warning(f"{topic} is not recorded: it has the types {types}")
            return None
        (type_name,) = types
        try:
            channel = self._channel(topic, type_name, publishers)
            message_type = _message_type(type_name)
        except (LookupError, OSError, ImportError, AttributeError) as error:
            self.get_logger().warning(f"{topic} is not recorded: {type_name}: {error}")
            return None
        profile = _matching(publishers)
        subscription = self._subscribe(topic, message_type, profile)
        return _Recording(topic, channel, profile, subscription, (topic, type_name) == CLOCK)

    def _hear_all(self, one: _Recording, publishers: Sequence[TopicEndpointInfo]) -> _Recording:
        """Subscribe anew where a publisher that has come since offers less than the others."""
        profile = _matching(publishers)
        if profile.reliability in (one.profile.reliability, ReliabilityPolicy.RELIABLE):
            return one
        subscription = self._subscribe(one.topic, one.subscription.msg_type, profile)
        self._write_waiting(one)
        self.destroy_subscription(one.subscription)
        return one._replace(profile=profile, subscription=subscription)

    def _subscribe(self, topic: str, message_type: Any, profile: QoSProfile) -> Any:
        return self.create_subscription(
            message_type, topic, lambda _message: None, profile, raw=True
        )

    def _channel(self, topic: str, type_name: str, publishers: Sequence[TopicEndpointInfo]) -> int:
        if type_name not in self._schemas:
            text = definition_of(type_name, lambda name: Path(get_package_share_directory(name)))
            self._schemas[type_name] = self._writer.register_schema(
                name=type_name, encoding="ros2msg", data=text.encode()
            )
        return self._writer.register_channel(
            topic=topic,
            message_encoding="cdr",
            schema_id=self._schemas[type_name],
            metadata={"offered_qos_profiles": _as_yaml(publishers)},
        )

    def _write(self, channel: int, message: bytes, sent: int) -> None:
        """Write a message, or hold it until a later message of /clock has come."""
        if self._held or self._awaits_clock(sent):
            until = time.monotonic() + SECONDS_TO_KNOW
            self._held.append(_Held(until, channel, message, sent))
        else:
            self._add(channel, message, sent)

    def _write_held(self, *, is_over: bool = False) -> None:
        """Write messages whose time is known by now, or will not be known."""
        while self._held:
            one = self._held[0]
            if not is_over and time.monotonic() < one.until and self._awaits_clock(one.sent):
                break
            self._held.popleft()
            self._add(one.channel, one.message, one.sent)

    def _awaits_clock(self, sent: int) -> bool:
        clock = self._recordings.get(CLOCK[0])
        if self._times is None or clock is None or not clock.is_clock or self._times.reach(sent):
            return False
        self._write_waiting(clock)
        return not self._times.reach(sent)

    def _add(self, channel: int, message: bytes, sent: int) -> None:
        now = self._time(sent)
        self._first = now if self._first is None else min(now, self._first)
        self._last = max(now, self._last)
        sequence = self._sequences[channel] = self._sequences.get(channel, 0) + 1
        self._writer.add_message(channel, now, message, now, sequence)

    def _time(self, sent: int) -> int:
        """The time of a message that was sent then."""
        if self._times is None:
            return sent
        if self._simulator is not None:
            self._times.note(time.time_ns(), self._simulator.nanoseconds())
        return self._times.at(sent)

    def _count_lost(self, topic: str, info: Mapping[str, Any]) -> None:
        """Count what a publisher has sent since its last message; ROS Humble does not say it."""
        number, publisher = info.get("publication_sequence_number"), info.get("publisher_gid")
        if number is None or publisher is None:
            return
        key = topic, bytes(publisher["data"])
        self._lost[topic] += max(0, number - self._heard.get(key, number - 1) - 1)
        self._heard[key] = number


def _take(subscription: Any) -> tuple[bytes, Mapping[str, Any]] | None:
    """Take a message that waits, as an executor does."""
    with subscription.handle:
        taken: tuple[bytes, Mapping[str, Any]] | None = subscription.handle.take_message(
            subscription.msg_type, subscription.raw
        )
        return taken


def _message_type(type_name: str) -> Any:
    package, kind, name = type_name.split("/")
    module = importlib.import_module(f"{package}.{kind}")
    action = name.removesuffix("_FeedbackMessage")  # which is no name in the module
    if kind == "action" and action != name:
        return getattr(module, action).Impl.FeedbackMessage
    return getattr(module, name)


def _matching(publishers: Sequence[TopicEndpointInfo]) -> QoSProfile:
    """What all publishers of a topic can offer."""
    profiles = [one.qos_profile for one in publishers]
    is_reliable = all(one.reliability == ReliabilityPolicy.RELIABLE for one in profiles)
    is_kept = all(one.durability == DurabilityPolicy.TRANSIENT_LOCAL for one in profiles)
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=DEPTH,
        reliability=(ReliabilityPolicy.RELIABLE if is_reliable else ReliabilityPolicy.BEST_EFFORT),
        durability=(DurabilityPolicy.TRANSIENT_LOCAL if is_kept else DurabilityPolicy.VOLATILE),
    )


def _as_yaml(publishers: Sequence[TopicEndpointInfo]) -> str:
    """What `ros2 bag play` publishes with: YAML, as rosbag2 writes it since its version 9."""
    return "".join(_profile_as_yaml(one.qos_profile) for one in publishers)


def _profile_as_yaml(profile: QoSProfile) -> str:
    return f"""\
- history: {profile.history.short_key}
  depth: {profile.depth}
  reliability: {profile.reliability.short_key}
  durability: {profile.durability.short_key}
  deadline: {_duration_as_yaml(profile.deadline)}
  lifespan: {_duration_as_yaml(profile.lifespan)}
  liveliness: {profile.liveliness.short_key}
  liveliness_lease_duration: {_duration_as_yaml(profile.liveliness_lease_duration)}
  avoid_ros_namespace_conventions: {str(profile.avoid_ros_namespace_conventions).lower()}
"""


def _duration_as_yaml(duration: Duration) -> str:
    seconds, nanoseconds = divmod(duration.nanoseconds, 10**9)
    return f"{{sec: {seconds}, nsec: {nanoseconds}}}"


def record(
    stream: IO[bytes],
    *,
    use_sim_time: bool,
    live_folder: Path | None = None,
    when_ready: Callable[[], None],
) -> tuple[float, int, dict[str, int]]:
    """Record until a signal comes, which may be blocked until now, and then what has been sent.

    A second signal has it leave out what is not written yet.

    It gives what `Recorder.recorded` gives.

    Args:
        stream: receives the file.
        use_sim_time: messages get the time of /clock.
        live_folder: of the live run whose simulator is asked for it until there is a /clock.
        when_ready: is called when topics are looked for.

    Raises:
        OSError: the file cannot be written.
    """
    writer = Writer(stream)
    writer.start(profile="ros2", library=LIBRARY)
    simulator = SimulatorTime(live_folder) if live_folder is not None else None
    rclpy.init(args=[], signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
    try:
        recorder = Recorder(writer, use_sim_time=use_sim_time, simulator=simulator)
        # An exception of a handler could be lost in a destructor.
        signals: list[int] = []
        for number in ENDING:
            signal.signal(number, lambda number, _frame: signals.append(number))
        when_ready()
        signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)
        recorder.write_until(lambda: bool(signals))
        recorder.write_rest(lambda: len(signals) == 1)
        found = recorder.recorded()
    finally:
        ignore_ends()
        if simulator is not None:
            simulator.close()
        rclpy.try_shutdown()
    writer.finish()
    return found
