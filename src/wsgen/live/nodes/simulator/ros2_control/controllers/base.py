"""What all controllers have."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from wsgen.live.nodes.simulator.ros import Ros
    from wsgen.live.nodes.simulator.ros2_control.hardware import Interfaces
    from wsgen.live.nodes.simulator.ros2_control.parameters import Parameters
    from wsgen.live.nodes.simulator.topics import RosPublisher
    from wsgen.model.robot import Joint

T = TypeVar("T")
DEPTH = 10  # of the queues of topics: rclcpp::SystemDefaultsQoS() keeps what the middleware does


class ControllerError(Exception):
    """A controller cannot be configured or activated; says why."""


class Surroundings(NamedTuple):
    """What a controller sees."""

    node: Any  # its node of ROS
    ros: Ros  # takes its messages
    parameters: Parameters  # those of its node
    interfaces: Interfaces  # what it reads and commands
    joints: Iterable[Joint]  # of the robot
    clock: Callable[[], float]  # gives the simulated time, s
    is_former: bool  # whether it is of ROS 2 Humble or Iron, which differ in some topics


class Controller:
    """A controller; the controller manager calls it.

    Attributes:
        commands: The full names of the command interfaces that it claims, known when configured.
        states: Those of the state interfaces that it reads; None: all.
        is_active: Whether it is updated.
        period: s, between two updates.
    """

    def __init__(self, surroundings: Surroundings) -> None:
        self.node = surroundings.node
        self.ros = surroundings.ros
        self.parameters = surroundings.parameters
        self.interfaces = surroundings.interfaces
        self.joints = {joint.name: joint for joint in surroundings.joints}
        self.clock = surroundings.clock
        self.is_former = surroundings.is_former
        self.name: str = self.node.get_name()
        self.commands: tuple[str, ...] = ()
        self.states: tuple[str, ...] | None = ()
        self.is_active = False
        self.period = 0.01
        self._made: list[Any] = []  # publishers, subscriptions, services
        self._kept: list[Any] = []  # what ends by `destroy`
        self._reported: set[str] = set()

    def configure(self) -> None:
        """Read the parameters and open the topics; raises ControllerError."""

    def activate(self) -> None:
        """Begin; its interfaces are there. Raises ControllerError."""

    def deactivate(self) -> None:
        """Stop; the interfaces are still there."""

    def update(self, now: float, elapsed: float) -> None:
        """Read states and write commands; both times in simulated seconds."""

    def reset(self, now: float) -> None:
        """Begin again while it is active: the world was reset, and the time perhaps (s)."""

    def on_parameters(self) -> None:
        """Somebody has set parameters of its node."""

    def cleanup(self) -> None:
        """End its topics, services and actions."""
        for made in self._made:
            self.ros.forget(self.node, made)
        for kept in self._kept:
            kept.destroy()
        self._made, self._kept = [], []

    def publisher(self, message_type: type, topic: str, qos: Any = DEPTH) -> RosPublisher:
        """Publish on a topic, until it is cleaned up."""
        from wsgen.live.nodes.simulator.topics import RosPublisher  # noqa: PLC0415  with ROS alone

        made = self.ros.publisher(self.node, message_type, topic, qos)
        self._made.append(made)
        return RosPublisher(made, keeps=False)

    def subscription(
        self, message_type: type, topic: str, callback: Callable[[Any], None], qos: Any = DEPTH
    ) -> None:
        """Have messages given to a function, until it is cleaned up."""
        self._made.append(self.ros.subscription(self.node, message_type, topic, callback, qos))

    def service(self, service_type: Any, name: str, callback: Callable[[Any, Any], Any]) -> None:
        """Answer requests, until it is cleaned up."""
        self._made.append(self.ros.service(self.node, service_type, name, callback))

    def keep(self, made: Any) -> None:
        """End something with it, by its method `destroy`."""
        self._kept.append(made)

    def require(self, name: str) -> list[str]:
        """The texts of a parameter that must not be empty; raises ControllerError."""
        return _not_empty(name, self.parameters.texts(name))

    def require_text(self, name: str) -> str:
        """Likewise the one text of a parameter."""
        return _not_empty(name, self.parameters.text(name))

    def require_length(self, name: str, factor: float = 1.0) -> float:
        """A parameter, times a factor, that must be above 0; raises ControllerError."""
        value = self.parameters.number(name) * factor
        if value > 0.0:
            return value
        message = f"Invalid value '{value:f}' of the parameter '{name}': it must be above 0"
        raise ControllerError(message)

    def info(self, text: str) -> None:
        """Print what happened."""
        self.node.get_logger().info(text)

    def warn(self, text: str) -> None:
        """Print a warning."""
        self.node.get_logger().warning(text)

    def error(self, text: str) -> None:
        """Print an error."""
        self.node.get_logger().error(text)

    def warn_once(self, text: str) -> None:
        """Print a warning that would come again and again."""
        if text not in self._reported:
            self._reported.add(text)
            self.warn(text)


def _not_empty(name: str, found: T) -> T:
    if not found:
        message = f"'{name}' parameter was empty"
        raise ControllerError(message)
    return found
