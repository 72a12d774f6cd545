"""Time in ROS: `/clock`, and the services that pause, continue and reset.

Names, rates and QoS are those of gazebo_ros_init (gazebo_ros_pkgs,
gazebo_ros/src/gazebo_ros_init.cpp) and of gz-sim's SimulationRunner.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rosgraph_msgs.msg import Clock

from wsgen.ros_nodes.simulator.host import Due, Plugin

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.ros_nodes.simulator.host import Host
    from wsgen.ros_nodes.simulator.simulation import LiveSimulation

PUBLISH_RATE = 10.0  # Hz, of Gazebo Classic's /clock


class ClockPublisher(Plugin):
    """Publishes the simulated time."""

    def __init__(self, host: Host) -> None:
        self._host = host
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
        message = Clock(clock=self._host.stamp())
        for publisher in self._publishers:
            publisher.publish(message)


# Gazebo Sim publishes every step, 1 kHz, which costs every node in Python a tenth of a core. Timers
# and stamps are as exact with this.
GZ_PERIOD = 0.004  # s, simulated


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


def _answer(function: Callable[[], object]) -> Callable[[Any, Any], Any]:
    """A service that does something and answers nothing."""

    def answer(_: Any, response: Any) -> Any:
        function()
        return response

    return answer
