"""`libgazebo_ros2_control.so` and `gz_ros2_control-system`: ros2_control in the simulator.

Source: ros-controls/gazebo_ros2_control, gazebo_ros2_control/src/gazebo_ros2_control_plugin.cpp;
ros-controls/gz_ros2_control, gz_ros2_control/src/gz_ros2_control_plugin.cpp. Elements: `parameters`
(several), `controller_manager_name`, `hold_joints`, `position_proportional_gain` (Gazebo Sim),
`ros/namespace`, `ros/remapping`. The hardware is that of <ros2_control> in the URDF that was
spawned. That of an SDF is in the URDF that `robot_state_publisher` has: the plugins ask it for its
parameter, or wait for the topic `robot_description`. Here all wait for the topic.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from wsgen.descriptions.urdf.devices import hardware_of_urdf
from wsgen.live.nodes.simulator.elements import boolean, number, text
from wsgen.live.nodes.simulator.host import CannotWorkError, Plugin
from wsgen.live.nodes.simulator.ros2_control.hardware import Interfaces, read_hardware
from wsgen.live.nodes.simulator.ros2_control.joints import JointSystem, Settings
from wsgen.live.nodes.simulator.ros2_control.manager import ControllerManager, is_former
from wsgen.live.nodes.simulator.ros2_control.sensor_hardware import sensors_of

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.live.nodes.simulator.ros2_control.sensor_hardware import SensorHardware
    from wsgen.model.devices import Element

DESCRIPTION = "robot_description"  # the topic of robot_state_publisher
SECONDS_TO_COME = 5.0  # simulated, for a message there
NO_HARDWARE = "the URDF has no <ros2_control>. Add one with its joints."


class Ros2Control(Plugin):
    """Hardware and controller manager of one robot."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        """Read parameters and hardware, and begin; where the robot is an SDF, wait for a URDF."""
        self._host, self._robot, self._element = host, robot, element
        files = [one.text for one in element.find_all("parameters")]
        given = robot.devices.ros2_control
        if not given and robot.description is not None:
            raise CannotWorkError(NO_HARDWARE)
        if not files and host.simulator == "gz":
            raise CannotWorkError("it does not name a file of <parameters>. Write its path.")
        ros = element.find("ros")
        self._manager = ControllerManager(
            host.ros,
            name=text(element, "controller_manager_name", robot),
            namespace="/" if ros is None else f"/{ros.get('namespace').strip('/')}",
            arguments=[] if ros is None else _remappings(ros),
            files=files,
            clock=lambda: host.now,
            is_former=is_former(simulator=host.simulator),
        )
        robot.ends.append(self._manager.close)
        self._sensors: list[SensorHardware] = []
        self._system: JointSystem | None = None  # until the hardware is known
        self._urdf: str | None = None  # that has come, and is yet to be read
        if given:
            self._begin(given)
        else:
            self._report_at = host.now + SECONDS_TO_COME
            self._wait_for_urdf()

    def _wait_for_urdf(self) -> None:
        from std_msgs.msg import String  # noqa: PLC0415  few robots need it

        def take(message: Any) -> None:
            if self._system is None:
                self._urdf = message.data

        node, qos = self._manager.node, self._host.ros.kept_qos()
        self._host.subscription(self._robot, String, DESCRIPTION, take, node=node, qos=qos)

    def _read_urdf(self) -> None:
        """Begin with the hardware of the URDF that has come; say so if none comes."""
        text, self._urdf = self._urdf, None
        entity = self._robot.entity
        if text is not None:
            found = hardware_of_urdf(text)
            if found:
                self._begin(found)
            else:
                self._host.warn(f"`{entity}`: ros2_control does not work: {NO_HARDWARE}")
        elif self._host.now >= self._report_at:
            self._report_at = math.inf
            self._host.warn(
                f"`{entity}`: ros2_control waits for a URDF with <ros2_control> on the topic "
                f"{self._manager.node.resolve_topic_name(DESCRIPTION)}, since an SDF cannot have "
                "one. Start robot_state_publisher with it."
            )

    def _begin(self, elements: tuple[Element, ...]) -> None:
        """Have the hardware; put the joints where they begin."""
        host, robot = self._host, self._robot
        hardware = read_hardware(elements, robot.robot.movable_joints)
        for problem in hardware.problems:
            host.warn(f"`{robot.entity}`: {problem}")
        for component in hardware.components:
            if not component.is_simulated:
                host.warn(
                    f"`{robot.entity}`: the hardware `{component.plugin}` of <ros2_control> "
                    f"`{component.name}` is not the simulator's: its joints cannot be controlled."
                )
        self._period = self.period = max(host.step_seconds, 1.0 / self._manager.rate)
        interfaces = Interfaces(hardware.components)
        self._sensors = sensors_of(host, robot, hardware.components, interfaces)
        self._system = JointSystem(
            robot,
            hardware.components,
            interfaces,
            Settings(
                simulator=host.simulator,
                rate=1.0 / self._period,
                hold=boolean(self._element, "hold_joints"),
                gain=number(self._element, "position_proportional_gain"),
            ),
        )
        self._system.begin()
        self._manager.begin(
            hardware.components, interfaces, self._system, robot.robot.movable_joints
        )

    def update(self) -> None:
        """Read the joints, update the controllers, command the joints."""
        if self._system is None:
            self._read_urdf()
            return
        self._system.read()
        for sensor in self._sensors:
            sensor.update()
        self._manager.update(self._host.now)
        self._system.write(self._period)

    def reset(self) -> None:
        """Begin again."""
        if self._system is None:
            return
        self._system.begin()  # controllers begin where the joints are then
        for sensor in self._sensors:
            sensor.reset()
        self._manager.reset()


def _remappings(ros: Element) -> list[str]:
    """The arguments of <ros><remapping>, which hold for the manager and its controllers."""
    return [word for rule in ros.find_all("remapping") for word in ("-r", rule.text)]
