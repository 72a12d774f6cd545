"""ROS without ROS: messages that know their fields, nodes that remember what is published."""

from __future__ import annotations

import copy
import json
import math
import re
import sys
import types
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from live.nodes.sensor_texts import element
from simulation.fake_engine import FakeEngine
from simulation.robots import GROUND, body, joint, shape, tree
from wsgen.isolation.codec import decode, encode
from wsgen.model.devices import Devices
from wsgen.model.robot import Box, Cylinder, JointType, Sphere
from wsgen.model.transform import Pose
from wsgen.simulation.engine import State
from wsgen.simulation.live_runs import LiveScene
from wsgen.simulation.scene import Scene, SpawnedRobot

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    import pytest

    from wsgen.model.devices import Element
    from wsgen.model.robot import Robot
    from wsgen.simulation.engine import Engine

# Message -> its fields; after a colon what they are: a message of any package, `n` (number), `s`
# (text), `l` (list), `b` (truth value), `36` (that many zeros).
_MESSAGES = """
builtin_interfaces/Time sec:n nanosec:n
std_msgs/Header stamp:Time frame_id:s
std_msgs/Bool data:b
std_msgs/Float32 data:n
std_msgs/Float64 data:n
actuator_msgs/Actuators header:Header position:l velocity:l normalized:l
builtin_interfaces/Duration sec:n nanosec:n
trajectory_msgs/JointTrajectoryPoint positions:l velocities:l accelerations:l effort:l \
 time_from_start:Duration
trajectory_msgs/JointTrajectory header:Header joint_names:l points:l
std_msgs/String data:s
rosgraph_msgs/Clock clock:Time
geometry_msgs/Vector3 x:n y:n z:n
geometry_msgs/Point x:n y:n z:n
geometry_msgs/Quaternion x:n y:n z:n w:n
geometry_msgs/Pose position:Point orientation:Quaternion
geometry_msgs/PoseArray header:Header poses:l
geometry_msgs/PoseStamped header:Header pose:Pose
geometry_msgs/PoseWithCovariance pose:Pose covariance:36
geometry_msgs/Twist linear:Vector3 angular:Vector3
geometry_msgs/TwistStamped header:Header twist:Twist
geometry_msgs/TwistWithCovariance twist:Twist covariance:36
geometry_msgs/Wrench force:Vector3 torque:Vector3
geometry_msgs/WrenchStamped header:Header wrench:Wrench
geometry_msgs/Transform translation:Vector3 rotation:Quaternion
geometry_msgs/TransformStamped header:Header child_frame_id:s transform:Transform
nav_msgs/Odometry header:Header child_frame_id:s pose:PoseWithCovariance twist:TwistWithCovariance
sensor_msgs/Imu header:Header orientation:Quaternion angular_velocity:Vector3 \
 linear_acceleration:Vector3
sensor_msgs/JointState header:Header name:l position:l velocity:l effort:l
tf2_msgs/TFMessage transforms:l
gazebo_msgs/EntityState name:s pose:Pose twist:Twist reference_frame:s
gazebo_msgs/ModelStates name:l pose:l twist:l
gazebo_msgs/LinkStates name:l pose:l twist:l
gazebo_msgs/SpawnRequest name:s xml:s robot_namespace:s initial_pose:Pose reference_frame:s
ros_gz_interfaces/EntityFactory name:s allow_renaming:b sdf:s sdf_filename:s pose:Pose
ros_gz_interfaces/SpawnEntityRequest entity_factory:EntityFactory
gazebo_msgs/EntityRequest name:s reference_frame:s
gazebo_msgs/StateRequest state:EntityState
gazebo_msgs/Done success:b status_message:s
gazebo_msgs/StateAnswer header:Header state:EntityState success:b
gazebo_msgs/ListAnswer header:Header model_names:l success:b
"""
_SERVICES = {
    "std_srvs": ("Empty",),
    "ros_gz_interfaces": ("ControlWorld", "DeleteEntity", "SetEntityPose"),
    "gazebo_msgs": (
        *("DeleteEntity", "GetEntityState", "GetModelList", "SetEntityState", "SpawnEntity"),
    ),
}
_PLAIN: dict[str, Callable[[], Any]] = {"n": float, "s": str, "l": list, "b": bool}
_PLAIN["36"] = lambda: [0.0] * 36


class Message:
    """A message that has its fields and no others."""

    FIELDS: Mapping[str, Callable[[], Any]] = {}

    def __init__(self, **values: Any) -> None:
        for name, make in self.FIELDS.items():
            object.__setattr__(self, name, values.pop(name) if name in values else make())
        assert not values, values

    def __setattr__(self, name: str, value: Any) -> None:
        assert name in self.FIELDS, f"{type(self).__name__} has no field {name}"
        object.__setattr__(self, name, value)


def install_messages(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have the packages of messages imported from here, and what imports them anew."""
    made: dict[str, Any] = {}
    for line in _MESSAGES.strip().splitlines():
        name, *fields = line.split()
        package, _, short = name.partition("/")
        pairs = (field.split(":") for field in fields)
        kinds = {field: _PLAIN.get(kind) or made[kind] for field, kind in pairs}
        made[short] = type(short, (Message,), {"FIELDS": kinds, "__module__": f"{package}.msg"})
        module = sys.modules.get(f"{package}.msg")
        if module is None:
            module = types.ModuleType(f"{package}.msg")
            monkeypatch.setitem(sys.modules, package, types.ModuleType(package))
            monkeypatch.setitem(sys.modules, f"{package}.msg", module)
        setattr(module, short, made[short])
    for package, names in _SERVICES.items():
        services = types.ModuleType(f"{package}.srv")
        for name in names:
            setattr(services, name, type(name, (), {}))
        if package not in sys.modules:
            monkeypatch.setitem(sys.modules, package, types.ModuleType(package))
        monkeypatch.setitem(sys.modules, f"{package}.srv", services)
    for name in list(sys.modules):
        if name.startswith("wsgen.live.nodes.simulator."):
            monkeypatch.delitem(sys.modules, name)


class FakePublisher:
    """Remembers what is published."""

    def __init__(self, topic: str, kind: type) -> None:
        self.topic, self.kind = topic, kind
        self.messages: list[Any] = []
        self.subscribers = 1

    def get_subscription_count(self) -> int:
        return self.subscribers

    def publish(self, message: Any) -> None:
        assert isinstance(message, self.kind)
        self.messages.append(copy.deepcopy(message))


class FakeNode:
    """A node of a namespace, with remappings."""

    def __init__(self, name: str, namespace: str, arguments: Sequence[str]) -> None:
        self.name, self.namespace = name, namespace.strip("/")
        self.arguments = list(arguments)
        self.publishers: dict[str, FakePublisher] = {}

    def resolve_topic_name(self, topic: str) -> str:
        rules = dict(rule.split(":=") for rule in self.arguments if ":=" in rule)
        topic = rules.get(topic, topic)
        inside = f"/{self.namespace}" if self.namespace else ""
        return topic if topic.startswith("/") else f"{inside}/{topic}"

    def create_publisher(self, kind: type, topic: str, _: Any) -> FakePublisher:
        made = FakePublisher(self.resolve_topic_name(topic), kind)
        self.publishers[made.topic] = made
        return made


def _refuse(name: str) -> None:
    """What is no name of ROS."""
    from wsgen.live.nodes.simulator.topics import BadNameError  # noqa: PLC0415  imported anew

    if re.search(r"[^A-Za-z0-9_/~{}]", name):
        raise BadNameError(f"ROS refuses `{name}`.")


class FakeRos:
    """What the simulator needs of ROS."""

    def __init__(self) -> None:
        self.nodes: list[FakeNode] = []
        self.readers: dict[str, list[Callable[[Any], None]]] = {}
        self.services: dict[str, Callable[[Any, Any], Any]] = {}
        self.lines: list[tuple[str, str]] = []
        self.read: dict[str, str] = {}
        self.has_heard = False
        self.of_others: set[str] = set()
        self.senders: set[str] = set()  # topics that others publish

    def note_publishers(self) -> None:
        self.of_others |= self.senders & self.read.keys()

    def node(self, name: str, namespace: str = "", arguments: Sequence[str] = ()) -> FakeNode:
        _refuse(name)
        _refuse(namespace)
        self.nodes.append(FakeNode(name, namespace, arguments))
        return self.nodes[-1]

    def own_node(self, name: str) -> FakeNode:
        return self.node(name)

    @staticmethod
    def publisher(node: FakeNode, kind: type, topic: str, qos: Any) -> FakePublisher:
        _refuse(topic)
        return node.create_publisher(kind, topic, qos)

    def subscription(
        self, node: FakeNode, _: type, topic: str, callback: Callable[[Any], None], __: Any
    ) -> Any:
        _refuse(topic)
        self.readers.setdefault(node.resolve_topic_name(topic), []).append(callback)
        return callback

    def service(self, node: FakeNode, _: Any, name: str, callback: Callable[..., Any]) -> Any:
        _refuse(name)
        self.services[node.resolve_topic_name(name)] = callback
        return callback

    def forget(self, node: FakeNode, made: Any) -> None:
        for readers in self.readers.values():
            readers[:] = [one for one in readers if one is not made]
        node.publishers = {topic: one for topic, one in node.publishers.items() if one is not made}

    def forget_node(self, node: FakeNode) -> None:
        self.nodes.remove(node)

    def log(self, level: str, _: str, text: str) -> None:
        self.lines.append((level, text))

    def parameter(self, _: Any, __: str, default: float) -> float:
        return default

    def clock_qos(self) -> Any:
        return None

    @staticmethod
    def keeps(_: Any) -> bool:
        return False

    @staticmethod
    def time(seconds: float) -> Any:
        from builtin_interfaces.msg import Time  # noqa: PLC0415  a fake of a test

        whole = int(seconds)
        return Time(sec=whole, nanosec=round((seconds - whole) * 1e9))

    def send(self, topic: str, message: Any) -> None:
        """Publish on a topic of ROS, as another process does."""
        for callback in tuple(self.readers.get(topic, ())):
            callback(message)

    def published(self, topic: str) -> list[Any]:
        """What was published there."""
        return [
            message
            for node in self.nodes
            for name, publisher in node.publishers.items()
            if name == topic
            for message in publisher.messages
        ]

    @property
    def warnings(self) -> list[str]:
        return [text for level, text in self.lines if level == "warning"]


# Its axle is in the middle; behind it slides a ball.
BASE = body(Box(size=(0.4, 0.3, 0.1)), mass=5.0)
BALL = shape(Sphere(radius=0.05), mu=0.0, at=Pose((-0.15, 0.0, -0.05)))
ROVER = tree(
    replace(BASE, collisions=(*BASE.collisions, BALL)),
    *(
        (
            joint(
                "base",
                f"{side}_wheel",
                JointType.CONTINUOUS,
                Pose((0.0, y, 0.0)),
                name=side,
                axis_in_joint=(0.0, 1.0, 0.0),
            ),
            body(
                Cylinder(radius=0.1, length=0.02),
                name=f"{side}_wheel",
                at=Pose(rpy=(math.pi / 2, 0.0, 0.0)),
            ),
        )
        for side, y in (("left", 0.2), ("right", -0.2))
    ),
)


def plugin(filename: str, content: str = "", name: str = "p") -> Element:
    """A <plugin>."""
    return element(f'<plugin filename="{filename}" name="{name}">{content}</plugin>')


def live_scene(
    *plugins: Element,
    simulator: str = "classic",
    robot: Robot = ROVER,
    height: float = 0.1,
    **more: Any,
) -> LiveScene:
    """A scene with a rover that has these plugins; it has gone through JSON, as scenes do."""
    pose = Pose((0.0, 0.0, height))
    scene = Scene(
        world=GROUND, robots=(SpawnedRobot(entity="rover", robot=robot, pose_in_world=pose),)
    )
    made = LiveScene(
        scene=scene,
        simulator=simulator,
        world="w",
        devices={"rover": Devices(plugins=plugins)},
        **more,
    )
    return decode(json.loads(encode(made)), LiveScene)


def still_at(x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> Callable[[float], State]:
    """A robot that stands there."""
    return lambda _: State(
        xyz=(x, y, 0.1),
        xyzw=(0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)),
        speed=0.0,
        turning=0.0,
        joint_speed=0.0,
    )


class Rover(FakeEngine):
    """A fake engine with the links of the rover; its root moves as it is told."""

    velocity = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

    def link_poses(self, entity: str) -> dict[str, Pose]:
        root = Pose(xyz=self.state(entity).xyz)
        return {link.name: root for link in ROVER.links}

    def link_velocities(self, entity: str) -> dict[str, Any]:  # noqa: ARG002  as that of the fake
        return {link.name: self.velocity for link in ROVER.links}


def simulation_of(
    scene: LiveScene, engine: Engine | None = None, ros: FakeRos | None = None
) -> tuple[Any, FakeRos]:
    """The simulation of a scene with the rover in it, and its ROS."""
    from wsgen.live.nodes.simulator.simulation import LiveSimulation  # noqa: PLC0415

    ros = ros or FakeRos()
    made = LiveSimulation(scene, engine or rover_engine(), ros, lambda _: None)  # type: ignore[arg-type]
    return made, ros


def rover_engine(
    motion: Callable[[float], State] | None = None,
    positions: Callable[[float], Mapping[str, float]] = lambda _: {"left": 0.0, "right": 0.0},
) -> Rover:
    """An engine in which the rover stands still, unless a script says something else."""
    return Rover(motion or still_at(), positions=positions)
