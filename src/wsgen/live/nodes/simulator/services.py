"""Time in ROS: `/clock`, and the services that pause, continue and reset.

Names, rates and QoS are those of gazebo_ros_init (gazebo_ros_pkgs,
gazebo_ros/src/gazebo_ros_init.cpp) and of gz-sim's SimulationRunner.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from rosgraph_msgs.msg import Clock

from wsgen.gazebo.systems import plugin_of
from wsgen.live.nodes.simulator.host import Due, Plugin
from wsgen.live.nodes.simulator.messages import NOT_FINITE, move, pose_of
from wsgen.live.nodes.simulator.simulation import RefusedError
from wsgen.live.nodes.simulator.topics import message_class
from wsgen.simulation.live_runs import NewEntity

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.live.nodes.simulator.host import Host
    from wsgen.live.nodes.simulator.simulation import LiveSimulation
    from wsgen.live.nodes.simulator.topics import Rule

PUBLISH_RATE = 10.0  # Hz, of Gazebo Classic's /clock


class ClockPublisher(Plugin):
    """Publishes the simulated time."""

    def __init__(self, host: Host) -> None:
        self._host = host
        self._message = Clock()
        if host.simulator == "classic":
            node = host.own_node
            rate = host.ros.parameter(node, "publish_rate", PUBLISH_RATE)
            self.period = 1 / rate if rate > 0 else host.step_seconds
            self._publishers = [
                host.publisher(None, Clock, "/clock", node=node, qos=host.ros.clock_qos())
            ]
        else:
            self.period = GZ_PERIOD
            self._publishers = [
                host.publisher(None, Clock, topic)
                for topic in ("/clock", f"/world/{host.world}/clock")
            ]

    def update(self) -> None:
        """Publish it."""
        self._message.clock = self._host.stamp()
        for publisher in self._publishers:
            publisher.publish(self._message)


# Gazebo Sim publishes every step, 1 kHz, which costs every node in Python a tenth of a core. Timers
# and stamps are as exact with this.
GZ_PERIOD = 0.005  # s, simulated


def offer_services(simulation: LiveSimulation) -> None:
    """Publish the time, and offer the services of the simulator."""
    control, host = simulation.control, simulation.host
    clock = ClockPublisher(host)
    simulation.add(Due(plugin=clock, robot=None, name="clock"))
    if host.simulator == "classic":
        from std_srvs.srv import Empty  # noqa: PLC0415  only Classic has them

        def pause() -> None:
            control.is_paused = True

        def unpause() -> None:
            control.is_paused = False

        for name, function in (
            ("reset_simulation", lambda: simulation.reset(with_time=True)),
            ("reset_world", lambda: simulation.reset(with_time=False)),
            ("pause_physics", pause),
            ("unpause_physics", unpause),
        ):
            host.service(None, Empty, name, _answer(function))
        # Its messages are there where nodes of the user use them.
        if message_class("gazebo_msgs/ModelStates") is not None:
            from wsgen.live.nodes.simulator.world_state import offer_factory  # noqa: PLC0415

            offer_factory(simulation)


def _answer(function: Callable[[], object]) -> Callable[[Any, Any], Any]:
    """A service that does something and answers nothing."""

    def answer(_: Any, response: Any) -> Any:
        function()
        return response

    return answer


SERVICE = "service"  # the direction of a rule of a bridge
_PACKAGE = "ros_gz_interfaces/srv/"


class GzServices:
    """The services of Gazebo Sim that bridges offer to ROS.

    Source: gazebosim/ros_gz, ros_gz_bridge/src/service_factories/ros_gz_interfaces.cpp; gz-sim,
    src/SimulationRunner.cc (control) and src/systems/user_commands/UserCommands.cc (the others).
    """

    def __init__(self, simulation: LiveSimulation) -> None:
        self._simulation = simulation
        world = f"/world/{simulation.host.world}"
        self._known: dict[str, tuple[str, Callable[[Any, Any], Any]]] = {
            f"{world}/control": ("ControlWorld", self._control),
            f"{world}/remove": ("DeleteEntity", self._remove),
            f"{world}/set_pose": ("SetEntityPose", self._set_pose),
            f"{world}/create": ("SpawnEntity", self._create),
        }

    def problem_of(self, rule: Rule) -> str | None:
        """Why a rule about a service cannot be followed, and what to do; None where it can."""
        name = self._known.get(rule.gz_topic, ("", None))[0]
        if not name or rule.ros_type != _PACKAGE + name:
            known = ", ".join(f"{one}@{_PACKAGE}{kind}" for one, (kind, _) in self._known.items())
            return f"wsgen's simulator has no service {rule.gz_topic} of that type. It has {known}."
        if name != "ControlWorld" and not self._simulation.has("UserCommands"):
            return (
                f"Gazebo has no service {rule.gz_topic}: the world does not load the system "
                f"UserCommands. Add {plugin_of('UserCommands')} to the <world>."
            )
        if service_class(name) is None:
            return "The ROS package ros_gz_interfaces is not installed. Build it in the workspace."
        return None

    def offer(self, rule: Rule, node: Any) -> None:
        """Offer a service without a problem; it ends with the node."""
        name, answer = self._known[rule.gz_topic]
        self._simulation.host.ros.service(node, service_class(name), rule.ros_topic, answer)

    def _control(self, request: Any, response: Any) -> Any:
        simulation, wanted = self._simulation, request.world_control
        control = simulation.control
        control.is_paused = wanted.pause
        steps = wanted.multi_step or int(wanted.step)
        control.seconds = steps * simulation.host.step_seconds
        if steps:
            control.is_paused = True
        reset = wanted.reset
        if reset.all or reset.model_only or reset.time_only:
            simulation.reset(with_time=reset.all or reset.time_only)
        response.success = True
        return response

    def _remove(self, request: Any, response: Any) -> Any:
        try:
            self._simulation.delete(request.entity.name)
        except RefusedError as error:
            self._simulation.host.warn(f"{error.message} {error.hint}")
            response.success = False
        else:
            response.success = True
        return response

    def _create(self, request: Any, response: Any) -> Any:
        """Spawn by text or file; what it cannot do is reported as by Gazebo, in the log."""
        wanted, host = request.entity_factory, self._simulation.host
        pose = pose_of(wanted.pose)
        response.success = False
        if pose is None:
            host.warn(f"SpawnEntity: {NOT_FINITE}")
            return response
        if not (wanted.sdf or wanted.sdf_filename):
            host.warn(
                "SpawnEntity: the request has neither sdf nor sdf_filename, all that wsgen spawns."
            )
            return response
        new = NewEntity(
            entity=wanted.name,
            text=wanted.sdf,
            model_uri=None if wanted.sdf else wanted.sdf_filename,
            pose_in_world=pose,
        )
        try:
            self._simulation.spawn_new(new, renames=wanted.allow_renaming)
        except RefusedError as error:
            host.warn(f"{error.message} {error.hint}")
        else:
            response.success = True
        return response

    def _set_pose(self, request: Any, response: Any) -> Any:
        robot = self._simulation.host.robots.get(request.entity.name)
        pose = pose_of(request.pose)
        response.success = robot is not None and pose is not None
        if robot is not None and pose is not None:
            move(robot, pose)
        elif pose is None:
            self._simulation.host.warn(f"SetEntityPose: {NOT_FINITE}")
        return response


def service_class(name: str) -> Any:
    """The class of a service of ros_gz_interfaces; None where that is not installed."""
    try:
        return getattr(importlib.import_module("ros_gz_interfaces.srv"), name, None)
    except ImportError:
        return None
