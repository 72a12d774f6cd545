"""A robot in PyBullet whose joints a controller commands, without ROS."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from live.nodes.fake_ros import FakeNode, live_scene, simulation_of
from simulation.robots import GROUND
from wsgen.simulation.bullet import BulletEngine

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from live.nodes.fake_ros import FakeRos
    from wsgen.model.robot import Robot

PERIOD = 0.01  # s, between updates


class Node(FakeNode):
    """That of a controller; remembers what it says."""

    def __init__(self, name: str) -> None:
        super().__init__(name, "", [])
        self.said: list[str] = []

    def get_name(self) -> str:
        return self.name

    def get_namespace(self) -> str:
        return f"/{self.namespace}"

    def get_logger(self) -> Node:
        return self

    def info(self, text: str) -> None:
        self.said.append(text)

    warning = error = info


class Controlled:
    """A controller, its hardware, and the simulation that both are in."""

    def __init__(
        self, simulation: Any, ros: FakeRos, node: Node, controller: Any, system: Any
    ) -> None:
        self.simulation, self.ros, self.node = simulation, ros, node
        self.controller, self.system = controller, system

    @property
    def robot(self) -> Any:
        """The handle of the robot."""
        return self.simulation.host.robots["rover"]

    def run(self, seconds: float) -> None:
        """Let time pass."""
        begin = self.simulation.host.now
        for count in range(round(seconds / PERIOD)):
            self.system.read()
            self.controller.update(self.simulation.host.now, PERIOD)
            self.system.write(PERIOD)
            self.simulation.advance(begin + (count + 1) * PERIOD)

    def stamp(self) -> Any:
        """The time as in a header."""
        return self.ros.time(self.simulation.host.now)

    def published(self, topic: str) -> list[Any]:
        """What the controller published on a topic of its own, `~/odom`."""
        return self.ros.published(f"/{topic}")


@contextmanager
def controlled(
    robot: Robot,
    kind: str,
    parameters: Mapping[str, Any],
    interfaces: Mapping[str, Sequence[str]],
    *,
    height: float = 0.1,
    is_former: bool = False,
    activates: bool = True,
) -> Iterator[Controlled]:
    """A robot with a controller of a type; `interfaces` are the commands of its joints."""
    from wsgen.live.nodes.simulator.ros2_control.controllers import (  # noqa: PLC0415  with fakes
        controller_class,
    )
    from wsgen.live.nodes.simulator.ros2_control.controllers.base import (  # noqa: PLC0415
        Surroundings,
    )
    from wsgen.live.nodes.simulator.ros2_control.hardware import (  # noqa: PLC0415
        OF_JOINTS,
        Component,
        ControlledJoint,
        Interfaces,
    )
    from wsgen.live.nodes.simulator.ros2_control.joints import (  # noqa: PLC0415
        JointSystem,
        Settings,
    )
    from wsgen.live.nodes.simulator.ros2_control.parameters import Parameters  # noqa: PLC0415

    simulation, ros = simulation_of(
        live_scene(simulator="gz", robot=robot, height=height), BulletEngine(GROUND)
    )
    try:
        simulation.spawn("rover")
        joints = tuple(
            ControlledJoint(name=name, commands=tuple(commands), states=OF_JOINTS, initial={})
            for name, commands in interfaces.items()
        )
        component = Component(
            name="all", kind="system", plugin="gz_ros2_control/GazeboSimSystem", joints=joints
        )
        values = Interfaces((component,))
        handle = simulation.host.robots["rover"]
        system = JointSystem(handle, (component,), values, Settings("gz", 1 / PERIOD))
        system.begin()
        node = Node("controller")
        ros.nodes.append(node)
        found = controller_class(kind)
        assert found is not None, kind
        controller = found(
            Surroundings(
                node,
                ros,  # type: ignore[arg-type]
                Parameters(parameters),
                values,
                robot.movable_joints,
                clock=lambda: simulation.host.now,
                is_former=is_former,
            )
        )
        made = Controlled(simulation, ros, node, controller, system)
        controller.configure()
        values.claim("controller", controller.commands)
        system.switch(controller.commands, ())
        system.read()
        if activates:
            controller.activate()
            controller.is_active = True
        yield made
    finally:
        simulation.close()
