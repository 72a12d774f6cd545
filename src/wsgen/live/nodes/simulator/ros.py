"""The simulator's side of ROS: nodes, and messages that arrive, taken when it suits the simulator.

Nothing spins in a thread: the simulator takes what has arrived between two steps (`poll`), and
waits for messages while it has nothing to simulate (`wait`). An executor costs 30 times as much as
a look at a subscription, so that it is asked seldom while the simulator is busy.
"""

from __future__ import annotations

import time
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

import rclpy
import rclpy.logging
from builtin_interfaces.msg import Time
from rclpy.exceptions import NameValidationException, ParameterException
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from wsgen.live.nodes.simulator.topics import BadNameError, Endpoint, mixed_types

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

CLOCK = "/clock"
OF_NODES = ("/rosout", "/parameter_events")  # which each node publishes
EXECUTOR_EVERY = 0.02  # s of wall-clock time, between two calls of the executor while busy
MOST_AT_ONCE = 100  # messages of one topic that one look takes


class Ros:
    """The nodes of this process."""

    def __init__(self, arguments: Sequence[str] = ()) -> None:
        """Join the ROS domain; `arguments` are those of the process for its own node alone.

        A name among them would rename the nodes of all plugins if the process had them.
        """
        rclpy.init(args=[], **_no_handlers())
        self._own_arguments = tuple(arguments)
        self._executor = _executor()
        self._subscriptions: list[tuple[Any, Callable[[Any], None]]] = []
        self._services: list[tuple[Any, Callable[[Any, Any], Any]]] = []
        self.read: dict[str, str] = {}  # topics of commands: the types of their messages
        self.has_heard = False  # a message has come on one of them
        self.of_others: set[str] = set()  # those of them that another process publishes
        self._next_executor = 0.0
        self._nodes: list[Any] = []
        self._on_rosout: dict[str, Any] = {}  # the node that publishes there, by full name
        self._ending: dict[str, Any] = {}  # such nodes that are forgotten: a task after their end

    def node(
        self,
        name: str,
        namespace: str = "",
        arguments: Sequence[str] = (),
        parameters: Mapping[str, Any] | None = None,
    ) -> Any:
        """A node; `arguments` are some like `-r`, `a:=b`, that hold for it alone.

        With `parameters`, it has these, and services by which everybody reads and sets them and
        others. `use_sim_time` among them does not make it read `/clock`: it is in this process.

        Raises:
            BadNameError: ROS refuses the name, the namespace or an argument.
        """
        given = {key: one for key, one in (parameters or {}).items() if key != "use_sim_time"}
        # Several bridges may have one name. In ROS they are processes; in one, rcl would warn that
        # /rosout has this name already. What all of them log goes through the first.
        full_name = _full_name(namespace, name)
        is_first = full_name not in self._on_rosout and full_name not in self._ending
        with _refusing():
            node = rclpy.create_node(
                name,
                namespace=namespace,
                enable_rosout=is_first,
                cli_args=["--ros-args", *arguments] if arguments else None,
                start_parameter_services=parameters is not None,
                allow_undeclared_parameters=parameters is not None,
                parameter_overrides=parameters_of(given),
                automatically_declare_parameters_from_overrides=True,
            )
        self._executor.add_node(node)
        self._nodes.append(node)
        if is_first:  # its arguments may have given it another name
            self._on_rosout[_full_name(node.get_namespace(), node.get_name())] = node
        return node

    def own_node(self, name: str) -> Any:
        """The node of the process itself: it has that name, if its arguments do not give another.

        Raises:
            BadNameError: ROS refuses an argument.
        """
        return self.node(name, arguments=self._own_arguments)

    @staticmethod
    def publisher(node: Any, message_type: type, topic: str, qos: Any) -> Any:
        """Publish on a topic; `qos` may be the depth alone. Raises BadNameError."""
        with _refusing():
            return node.create_publisher(message_type, topic, qos)

    def subscription(
        self, node: Any, message_type: type, topic: str, callback: Callable[[Any], None], qos: Any
    ) -> Any:
        """Have messages of a topic given to a function, one by one. Raises BadNameError.

        What was kept for who comes later is a description of something, and no command.
        """
        is_command = not self.keeps(qos)

        def take(message: Any) -> None:
            self.has_heard |= is_command
            callback(message)

        with _refusing():
            made = node.create_subscription(message_type, topic, take, qos)
        self._subscriptions.append((made, take))
        if is_command:
            package, name = message_type.__module__.partition(".")[0], message_type.__name__
            self.read[made.topic_name] = f"{package}/msg/{name}"
        return made

    def service(
        self, node: Any, service_type: Any, name: str, callback: Callable[[Any, Any], Any]
    ) -> Any:
        """Answer requests; `callback` takes request and response and gives the response.

        Raises:
            BadNameError: ROS refuses the name.
        """
        with _refusing():
            made = node.create_service(service_type, name, callback)
        self._services.append((made, callback))
        return made

    def forget(self, node: Any, made: Any) -> None:
        """End a publisher, subscription or service of a node."""
        self._subscriptions = [one for one in self._subscriptions if one[0] is not made]
        self._services = [one for one in self._services if one[0] is not made]
        for destroy in (node.destroy_publisher, node.destroy_subscription, node.destroy_service):
            if destroy(made):  # it is of that kind
                return

    def forget_node(self, node: Any) -> None:
        """End a node with all that it has."""
        for made in (*node.subscriptions, *node.services):
            self.forget(node, made)
        self._executor.remove_node(node)
        self._nodes = [one for one in self._nodes if one is not node]
        node.destroy_node()
        for name in [name for name, one in self._on_rosout.items() if one is node]:
            del self._on_rosout[name]
            # The executor holds the node until its next turn. Then rcl takes the name from
            # /rosout, even if another node has it by then, which would not be heard any more.
            self._ending[name] = self._executor.create_task(_do_nothing)

    @staticmethod
    def time(seconds: float) -> Any:
        """A `builtin_interfaces/Time`."""
        whole, nanoseconds = divmod(round(seconds * 1e9), 1_000_000_000)
        return Time(sec=whole, nanosec=nanoseconds)

    @staticmethod
    def parameter(node: Any, name: str, default: float) -> float:
        """A number that the command line of the process gives to a node."""
        if not node.has_parameter(name):
            return default
        value = node.get_parameter(name).value
        return float(value) if isinstance(value, int | float) else default

    @staticmethod
    def clock_qos() -> QoSProfile:
        """That of `/clock`, as `rclcpp::ClockQoS`."""
        return QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)

    @staticmethod
    def kept_qos() -> QoSProfile:
        """For the last message of a topic, also one that came before."""
        return QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)

    @staticmethod
    def keeps(qos: Any) -> bool:
        """Whether those who subscribe later get the last messages, too."""
        return bool(getattr(qos, "durability", None) == DurabilityPolicy.TRANSIENT_LOCAL)

    @staticmethod
    def log(level: str, name: str, text: str) -> None:
        """Print a line as nodes do."""
        logger = rclpy.logging.get_logger(name)
        # In lines of their own: rclpy knows a caller by its line, and lets it keep to one level.
        if level == "info":
            logger.info(text)
        elif level == "warning":
            logger.warning(text)
        else:
            logger.error(text)

    def poll(self) -> None:
        """Take what has arrived."""
        for subscription, callback in tuple(self._subscriptions):
            for _ in range(MOST_AT_ONCE):
                with subscription.handle:
                    taken = subscription.handle.take_message(subscription.msg_type, False)
                if taken is None:
                    break
                callback(taken[0])
        for service, answer in tuple(self._services):
            with service.handle:
                request, header = service.handle.service_take_request(service.srv_type.Request)
            if header is not None:
                service.send_response(answer(request, service.srv_type.Response()), header)
                self._let_nodes_end()
        if self._ending or time.monotonic() >= self._next_executor:
            self.wait(0.0)

    def wait(self, seconds: float) -> None:
        """Wait for something to arrive, no longer than that; timers, actions and the like run."""
        self._executor.spin_once(timeout_sec=seconds)
        self._let_nodes_end()
        self._next_executor = time.monotonic() + EXECUTOR_EVERY

    def _let_nodes_end(self) -> None:
        """Have the executor let go of nodes that are forgotten; never called by a callback."""
        for _ in range(MOST_AT_ONCE):  # a turn may end with the callback of something else
            self._ending = {name: end for name, end in self._ending.items() if not end.done()}
            if not self._ending:
                break
            self._executor.spin_once(timeout_sec=0.0)

    def mixed_types(self) -> Iterator[str]:
        """Which messages do not arrive in this domain, because two types are on one topic."""
        if not self._nodes:
            return
        node = self._nodes[0]
        for topic, types in node.get_topic_names_and_types():
            if len(types) > 1:
                senders = node.get_publishers_info_by_topic(topic)
                readers = node.get_subscriptions_info_by_topic(topic)
                yield from mixed_types(topic, map(_endpoint, senders), map(_endpoint, readers))

    def has_unheard_topics(self) -> bool:
        """Whether nobody subscribes yet to a topic that this process publishes."""
        return any(
            publisher.get_subscription_count() == 0
            for node in self._nodes
            for publisher in node.publishers
            if not publisher.topic_name.startswith(OF_NODES)
        )

    def has_other_clock(self) -> bool:
        """Whether another process publishes /clock beside this one."""
        # Those of another simulator have the same names.
        own = [one for node in self._nodes for one in node.publishers if one.topic_name == CLOCK]
        return bool(own) and self._nodes[0].count_publishers(CLOCK) > len(own)

    def note_publishers(self) -> None:
        """Look which of the topics that are read another process publishes."""
        if not self._nodes:
            return
        own = {(node.get_name(), node.get_namespace()) for node in self._nodes}
        for topic in self.read.keys() - self.of_others:
            senders = self._nodes[0].get_publishers_info_by_topic(topic)
            # A bridge of both directions publishes what it reads.
            if any((one.node_name, one.node_namespace) not in own for one in senders):
                self.of_others.add(topic)

    def close(self) -> None:
        """Leave the domain."""
        self._executor.shutdown()
        for node in self._nodes:
            node.destroy_node()
        rclpy.try_shutdown()


def _do_nothing() -> None:
    """What a task does that reports when those before it have run."""


def _full_name(namespace: str, name: str) -> str:
    return "/".join(("", *filter(None, namespace.split("/")), name))


def _endpoint(info: Any) -> Endpoint:
    return Endpoint(node=info.node_name, type=info.topic_type)


@contextmanager
def _refusing() -> Iterator[None]:
    """What rclpy says of a name or an argument, as one kind of error, on one line."""
    try:
        yield
    except (NameValidationException, ParameterException, RuntimeError, ValueError) as error:
        # A name and a mark below it are on lines of their own, and the C library adds those of its
        # own source files.
        what, _, name = str(error).partition(":\n")
        named = f" {name.strip().partition(chr(10))[0]}" if name else ""
        text = what.partition(", at /")[0]
        raise BadNameError(f"ROS refuses{named or ' the arguments'}: {text}.") from error


def parameters_of(values: Mapping[str, Any]) -> list[Any]:
    """Parameters for a node; those of which ROS has no type are left out."""
    found = []
    for name, value in values.items():
        plain = value
        if isinstance(value, list):
            if not value:
                continue  # ROS cannot know of what it is a list
            numbers = [isinstance(one, (int, float)) and type(one) is not bool for one in value]
            if all(numbers) and any(isinstance(one, float) for one in value):
                plain = [float(one) for one in value]
        try:
            found.append(Parameter(name, value=plain))
        except (TypeError, ValueError):
            continue
    return found


def _no_handlers() -> dict[str, Any]:
    """The process handles its own signals."""
    with suppress(ImportError):
        from rclpy.signals import SignalHandlerOptions  # noqa: PLC0415  not in every release

        return {"signal_handler_options": SignalHandlerOptions.NO}
    return {}


def _executor() -> Any:
    """The cheapest that this release has: Kilted and later have one of C++."""
    with suppress(ImportError):
        from rclpy.experimental import EventsExecutor  # noqa: PLC0415  not in every release

        return EventsExecutor()
    return SingleThreadedExecutor()
