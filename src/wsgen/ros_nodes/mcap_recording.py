"""The node that writes all topics into an MCAP file."""

from __future__ import annotations

import importlib
import signal
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import rclpy
from mcap.writer import Writer
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from ament_index_python.packages import get_package_share_directory
from wsgen.ros_nodes.message_definitions import definition_of
from wsgen.ros_nodes.signals import ENDING, ignore_ends
from wsgen.ros_nodes.simulator_time import SimulatorTime

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rclpy.duration import Duration
    from rclpy.endpoint_info import TopicEndpointInfo


LOOK_SECONDS = 0.2  # wall-clock, between two looks for new topics
DEPTH = 1000  # messages that wait for the recorder, at most; a full queue loses the oldest
LIBRARY = "wsgen"


class Recorder(Node):
    """Subscribes to every topic and writes what comes."""

    def __init__(
        self, writer: Writer, *, use_sim_time: bool, simulator: SimulatorTime | None = None
    ) -> None:
        super().__init__(
            "_wsgen_recorder",  # hidden, as its subscriptions are nobody's business
            parameter_overrides=[Parameter("use_sim_time", value=use_sim_time)],
            enable_rosout=False,
            start_parameter_services=False,
        )
        self._writer = writer
        self._simulator = simulator
        self._schemas: dict[str, int] = {}  # by type
        self._topics: set[str] = set()  # that are recorded, or cannot be
        self._sequences: dict[int, int] = {}  # by channel
        self._first: int | None = None  # ns, the time of the first message, and of the last one
        self._last = 0
        self.create_timer(LOOK_SECONDS, self._look, clock=rclpy.clock.Clock())
        self._look()

    def recorded(self) -> tuple[float, int]:
        """The time from the first message to the last one in seconds, and how many there are."""
        first = self._last if self._first is None else self._first
        return (self._last - first) * 1e-9, sum(self._sequences.values())

    def _look(self) -> None:
        for topic, types in self.get_topic_names_and_types():
            if topic not in self._topics:
                publishers = self.get_publishers_info_by_topic(topic)
                if publishers:
                    self._topics.add(topic)
                    self._record(topic, types, publishers)

    def _record(
        self, topic: str, types: Sequence[str], publishers: Sequence[TopicEndpointInfo]
    ) -> None:
        if len(types) > 1:
            self.get_logger().warning(f"{topic} is not recorded: it has the types {types}")
            return
        (type_name,) = types
        try:
            channel = self._channel(topic, type_name, publishers)
            message_type = _message_type(type_name)
        except (LookupError, OSError, ImportError, AttributeError) as error:
            self.get_logger().warning(f"{topic} is not recorded: {type_name}: {error}")
            return
        self.create_subscription(
            message_type,
            topic,
            lambda message, channel=channel: self._write(channel, message),
            _matching(publishers),
            raw=True,
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

    def _write(self, channel: int, message: bytes) -> None:
        now = self.get_clock().now().nanoseconds
        if now == 0 and self._simulator is not None:
            now = self._simulator.nanoseconds()
        self._first = now if self._first is None else min(now, self._first)
        self._last = max(now, self._last)
        sequence = self._sequences[channel] = self._sequences.get(channel, 0) + 1
        self._writer.add_message(channel, now, message, now, sequence)


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
) -> tuple[float, int]:
    """Record until a signal comes, which may be blocked until now.

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
        executor = SingleThreadedExecutor()
        recorder = Recorder(writer, use_sim_time=use_sim_time, simulator=simulator)
        executor.add_node(recorder)
        # An exception of a handler could be lost in a destructor.
        signals: list[int] = []
        for number in ENDING:
            signal.signal(number, lambda number, _frame: signals.append(number))
        when_ready()
        signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)
        while not signals:
            executor.spin_once(timeout_sec=LOOK_SECONDS)
        found = recorder.recorded()
    finally:
        ignore_ends()
        if simulator is not None:
            simulator.close()
        rclpy.try_shutdown()
    writer.finish()
    return found
