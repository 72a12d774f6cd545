"""What plugins and sensors see of the simulator."""

from __future__ import annotations

import math
from dataclasses import field
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from wsgen.gazebo.plugins import REMAPPINGS, node_name
from wsgen.live.nodes.simulator.topics import GzTopics, Publisher, RosPublisher, written_qos
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    import numpy as np
    from numpy.typing import NDArray

    from wsgen.live.nodes.simulator.ros import Ros
    from wsgen.model.devices import Devices, Element, MountedSensor
    from wsgen.model.robot import Robot
    from wsgen.model.transform import Pose, Vector
    from wsgen.model.world import World
    from wsgen.simulation.engine import Contact, Engine, Motor, State
    from wsgen.simulation.scene import SpawnedRobot

T = TypeVar("T")

# Beyond these, robots fly apart in any engine: at such a speed, a joint makes more than a whole
# turn in a step of 1 ms.
FASTEST = 1e4  # rad/s or m/s
STRONGEST = 1e9  # N m or N

UPDATE = 0.01  # s, simulated, between two updates of a plugin that says nothing else


class View(NamedTuple):
    """What a picture of this moment needs."""

    world: World
    robots: tuple[SpawnedRobot, ...]  # static models as well
    poses: Mapping[str, Mapping[str, Pose]]  # by entity and link, in the world


class Host:
    """The simulator, as its plugins see it.

    Attributes:
        simulator: Whose plugins these are: "classic" or "gz".
        world: The name of the world.
        step_seconds: The step of the engine, s.
        update_seconds: Between two updates of a plugin without a period, s, simulated.
        gravity: m/s², in the world.
        surroundings: Elements of the world that its sensors measure, by their tags.
        rate: Simulated seconds that are to pass in one second; None: as many as possible.
        now: The simulated time, s: that of the state that the robots have.
        robots: Those that are in the world, static models as well, by entity.
    """

    def __init__(
        self, engine: Engine, ros: Ros, *, simulator: str, world: World, world_name: str
    ) -> None:
        self.simulator = simulator
        self.world = world_name
        self.step_seconds = engine.step_seconds
        self.update_seconds = max(UPDATE, engine.step_seconds)
        self.gravity = world.gravity
        self.rate: float | None = None
        self.surroundings: Mapping[str, Element] = {}
        self.now = 0.0
        self.robots: dict[str, RobotHandle] = {}
        self.ros = ros
        self.moment = 0  # counts the states that the engine has had
        self.engine = engine
        self._description = world
        self._count = 0  # of robots
        self._reported: set[str] = set()
        self._stamp: tuple[float, Any] | None = None
        self.gz = GzTopics(ros, self.warn)
        self._own: Any = None
        self._described: dict[int, Element] = {}  # by the identity of a node: its <ros>

    def count_robot(self) -> int:
        """A number that no other robot has."""
        self._count += 1
        return self._count

    @property
    def own_node(self) -> Any:
        """The node of the simulator itself."""
        if self._own is None:
            self._own = self.ros.own_node("gazebo")
        return self._own

    def stamp(self) -> Any:
        """The simulated time as `builtin_interfaces/Time`, which nobody may change."""
        if self._stamp is None or self._stamp[0] != self.now:
            self._stamp = self.now, self.ros.time(self.now)
        return self._stamp[1]

    def node(self, robot: RobotHandle | None, plugin: Element) -> Any:
        """The node of a plugin of Gazebo Classic, until its robot leaves the world.

        Its <ros> has a namespace, remappings, parameters and QoS, which are read as
        `gazebo_ros::Node::Get` does (gazebo_ros_pkgs, gazebo_ros/src/node.cpp).
        """
        ros, namespace = plugin.find("ros"), ""
        arguments: list[str] = []
        if ros is not None:
            namespace = ros.get("namespace")
            for kind in REMAPPINGS:
                for rule in ros.find_all(kind):
                    arguments += ["-r", rule.text] if ":=" in rule.text else []
            for parameter in ros.find_all("parameter"):
                arguments += ["-p", f"{parameter.attributes.get('name', '')}:={parameter.text}"]
        made = self.ros.node(
            node_name(plugin.attributes.get("name") or "gazebo"),
            "" if namespace == "/" else namespace,
            arguments,
        )
        self._keep(robot, lambda: self.ros.forget_node(made))
        self._described.pop(id(made), None)  # of a node that has ended
        if ros is not None and ros.find("qos") is not None:
            self._described[id(made)] = ros
        return made

    def _qos(self, node: Any, topic: str, depth: int, end: str) -> Any:
        """What the <ros> of a node's plugin says of a topic; the depth alone where it does not."""
        ros = self._described.get(id(node))
        return depth if ros is None else written_qos(ros, topic, depth, end)

    def publisher(  # noqa: PLR0913  what a publisher has
        self,
        robot: RobotHandle | None,
        message_type: type,
        topic: str,
        *,
        node: Any = None,
        depth: int = 10,
        qos: Any = None,
    ) -> Publisher:
        """Publish messages: on a topic of ROS (Classic), or of Gazebo (Sim), which a bridge reads.

        It ends with the robot. `is_wanted` says whether a message is worth its computation.
        """
        if self.simulator == "gz" and node is None:
            made = self.gz.publisher(message_type, topic)
            self._keep(robot, lambda: self.gz.forget(made))
            return made
        owner = node or self.own_node
        qos = qos or self._qos(node, topic, depth, "publisher")
        in_ros = self.ros.publisher(owner, message_type, topic, qos)
        self._keep(robot, lambda: self.ros.forget(owner, in_ros))
        return RosPublisher(in_ros, keeps=self.ros.keeps(qos))

    def subscription(  # noqa: PLR0913  likewise
        self,
        robot: RobotHandle | None,
        message_type: type,
        topic: str,
        callback: Callable[[Any], None],
        *,
        node: Any = None,
        depth: int = 10,
        qos: Any = None,
    ) -> None:
        """Have messages given to a function, between two steps; likewise, and as long."""
        if self.simulator == "gz" and node is None:
            reader = self.gz.subscription(message_type, topic, callback)
            self._keep(robot, lambda: self.gz.forget(reader))
            return
        owner = node or self.own_node
        qos = qos or self._qos(node, topic, depth, "subscription")
        made = self.ros.subscription(owner, message_type, topic, callback, qos)
        self._keep(robot, lambda: self.ros.forget(owner, made))

    def service(
        self,
        robot: RobotHandle | None,
        service_type: Any,
        name: str,
        callback: Callable[[Any, Any], Any],
        *,
        node: Any = None,
    ) -> None:
        """Offer a service of ROS; `callback` takes request and response and gives the response."""
        owner = node or self.own_node
        made = self.ros.service(owner, service_type, name, callback)
        self._keep(robot, lambda: self.ros.forget(owner, made))

    @staticmethod
    def _keep(robot: RobotHandle | None, end: Callable[[], None]) -> None:
        if robot is not None:
            robot.ends.append(end)

    def warn(self, text: str) -> None:
        """Print a warning, once."""
        self._notify("warning", text)

    def info(self, text: str) -> None:
        """Print what happened, once."""
        self._notify("info", text)

    def _notify(self, level: str, text: str) -> None:
        if text not in self._reported:
            self._reported.add(text)
            self.ros.log(level, "gazebo", text)

    def view(self) -> View:
        """What a picture of this moment needs."""
        return View(
            world=self._description,
            robots=tuple(robot.spawned for robot in self.robots.values()),
            poses={entity: robot.link_poses() for entity, robot in self.robots.items()},
        )


class RobotHandle:
    """A robot that is in the world. SI units; poses and velocities are seen from the world.

    Attributes:
        entity: Its name in the simulator.
        robot: As the simulator has it: lumped.
        devices: What it carries.
        description: The text of its URDF, if it has one.
        spawned: As it was put into the world.
        ends: What is called when it leaves the world.
        number: Counts robots: no other one of this simulation has had it.
        times_placed: Counts how often it was put somewhere.
    """

    def __init__(
        self, host: Host, spawned: SpawnedRobot, devices: Devices, description: str | None = None
    ) -> None:
        self.entity = spawned.entity
        self.robot: Robot = spawned.robot
        self.devices = devices
        self.description = description
        self.spawned = spawned
        self.ends: list[Callable[[], None]] = []
        self.number = host.count_robot()
        self.times_placed = 0
        self._host = host
        self._engine = host.engine
        self._motors: dict[str, Motor] = {}  # that were put in and are there still
        self._efforts: dict[str, float] = {}  # likewise, N m or N
        self._moment = -1
        self._known: dict[str, Any] = {}

    def state(self) -> State:
        """Where it is and how it moves."""
        return self._once("state", lambda: self._engine.state(self.entity))

    def link_poses(self) -> Mapping[str, Pose]:
        """The frames of its links."""
        return self._once("poses", lambda: self._engine.link_poses(self.entity))

    def link_velocities(self) -> Mapping[str, tuple[Vector, Vector]]:
        """How the origins of its links' frames move (m/s), and how these turn (rad/s)."""
        return self._once("velocities", lambda: self._engine.link_velocities(self.entity))

    def root_velocity(self) -> tuple[Vector, Vector]:
        """That of its root link, of these."""
        return self.link_velocities()[self.robot.root]

    def joint_positions(self) -> Mapping[str, float]:
        """The positions of its movable joints, rad or m."""
        return self._once("positions", lambda: self._engine.joint_positions(self.entity))

    def joint_velocities(self) -> Mapping[str, float]:
        """Their velocities, rad/s or m/s."""
        return self._once("speeds", lambda: self._engine.joint_velocities(self.entity))

    def joint_efforts(self) -> Mapping[str, float]:
        """What their motors gave in the last step, N m or N."""
        return self._once("efforts", lambda: self._engine.joint_efforts(self.entity))

    def joint_wrench(self, joint: str) -> tuple[Vector, Vector]:
        """The force (N) and torque (N m) of the parent link on the child of a joint.

        In the last step, about the origin of the child's frame.
        """
        return self._once(f"wrench {joint}", lambda: self._engine.joint_wrench(self.entity, joint))

    def contacts(self) -> list[Contact]:
        """What it touched in the last step."""
        return self._once("contacts", lambda: self._engine.contacts(self.entity))

    def _once(self, what: str, compute: Callable[[], T]) -> T:
        """What was computed at this moment already, or is now."""
        if self._moment != self._host.moment:
            self._moment = self._host.moment
            self._known = {}
        if what not in self._known:
            self._known[what] = compute()
        found: T = self._known[what]
        return found

    def drive(self, motors: Mapping[str, Motor]) -> None:
        """Put motors into joints: speeds that they keep, as far as they are strong enough."""
        new = {
            name: self._sane(name, motor)
            for name, motor in motors.items()
            if self._motors.get(name) != motor  # setting one costs as much as a step
        }
        if new:
            self._motors |= new
            for name in new:
                self._efforts.pop(name, None)
            self._engine.drive(self.entity, new)

    @property
    def is_driven(self) -> bool:
        """Whether a joint has a command to move: by a motor that turns, or by an effort."""
        return any(motor.speed for motor in self._motors.values()) or any(self._efforts.values())

    def release(self, joints: Iterable[str]) -> None:
        """Take the motors out of these joints."""
        self.set_efforts(dict.fromkeys(joints, 0.0))

    def set_efforts(self, efforts: Mapping[str, float]) -> None:
        """Have efforts (N m or N) act on joints, which lose their motors, until the next call."""
        for name in efforts:
            self._motors.pop(name, None)
        if not all(-STRONGEST <= effort <= STRONGEST for effort in efforts.values()):
            efforts = {
                name: self._within(name, effort, STRONGEST, "an effort of more than {:g} N m or N")
                for name, effort in efforts.items()
            }
        self._efforts |= efforts
        self._engine.set_efforts(self.entity, efforts)

    def _sane(self, name: str, motor: Motor) -> Motor:
        """A motor without a speed that an engine cannot compute with."""
        shown = "a speed of more than {:g} rad/s or m/s"
        speed = self._within(name, motor.speed, FASTEST, shown)
        return motor if speed == motor.speed else motor._replace(speed=speed)

    def _within(self, joint: str, command: float, most: float, shown: str) -> float:
        """A command for a joint; 0 for NaN, and for too much for an engine, which is reported."""
        if abs(command) <= most:
            return command
        if not math.isnan(command):
            self._host.warn(
                f"`{self.entity}`: the joint `{joint}` is commanded {shown.format(most)}, which no "
                "engine can follow: it gets 0. Send smaller commands."
            )
        return 0.0

    def set_joint_positions(self, positions: Mapping[str, float]) -> None:
        """Put joints there (rad or m), at rest."""
        self._engine.set_joint_positions(self.entity, positions)
        self._host.moment += 1

    def set_velocity(self, linear: Vector, angular: Vector) -> None:
        """Have its root link move (m/s, of the frame's origin) and turn (rad/s) like that now."""
        self._engine.set_velocity(self.entity, linear, angular)

    def place(self, pose: Pose) -> None:
        """Put it elsewhere, at rest, its joints at zero."""
        self._engine.place(self.entity, pose)
        self.times_placed += 1
        self._host.moment += 1

    def cast_rays(
        self, starts: NDArray[np.float64], ends: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """How far rays get: shape (n,), the share of the way to the first hit, inf without one.

        Starts and ends have the shape (n, 3), m. A ray does not hit what it begins in.
        """
        return self._engine.cast_rays(starts, ends)


class Plugin:
    """A plugin or a sensor of a robot.

    Attributes:
        period: Simulated seconds between two updates; None: every `Host.update_seconds`. It is read
            after each update.
    """

    period: float | None = None

    def __init__(self, host: Host, robot: RobotHandle, element: Element | MountedSensor) -> None:
        """Begin; `element` is the <plugin>, or the sensor."""

    def update(self) -> None:
        """Do what is due; it is `host.now`."""

    def reset(self) -> None:
        """Begin again: the world was reset, and the time perhaps."""

    def close(self) -> None:
        """End what ends not with the robot: threads, nodes."""


class CannotWorkError(Exception):
    """A plugin cannot work; raised by its constructor, printed as a warning."""


@dataclass
class Due:
    """A plugin, and when it is to be updated."""

    plugin: Plugin
    robot: RobotHandle | None
    name: str  # for messages
    next: float = field(default=0.0)  # s, simulated
