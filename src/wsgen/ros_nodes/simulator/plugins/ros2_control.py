"""`libgazebo_ros2_control.so` and `gz_ros2_control-system`: ros2_control in the simulator.

Source: ros-controls/gazebo_ros2_control, gazebo_ros2_control/src/gazebo_ros2_control_plugin.cpp;
ros-controls/gz_ros2_control, gz_ros2_control/src/gz_ros2_control_plugin.cpp. Elements: `parameters`
(several), `controller_manager_name`, `hold_joints`, `position_proportional_gain` (Gazebo Sim),
`ros/namespace`, `ros/remapping`. The hardware is that of <ros2_control> in the URDF that was
spawned.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.ros_nodes.simulator.elements import boolean, number
from wsgen.ros_nodes.simulator.host import CannotWorkError, Plugin
from wsgen.ros_nodes.simulator.ros2_control.hardware import Interfaces, read_hardware
from wsgen.ros_nodes.simulator.ros2_control.joints import JointSystem, Settings
from wsgen.ros_nodes.simulator.ros2_control.manager import ControllerManager, is_former
from wsgen.ros_nodes.simulator.ros2_control.sensor_hardware import sensors_of

if TYPE_CHECKING:
    from wsgen.model.devices import Element
    from wsgen.ros_nodes.simulator.host import Host, RobotHandle

SLOWEST = 1.0  # s, of an update; `update_rate` is in Hz


class Ros2Control(Plugin):
    """Hardware and controller manager of one robot."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        """Read hardware and parameters; put the joints where they begin."""
        self._host = host
        files = [one.text for one in element.find_all("parameters")]
        if not robot.devices.ros2_control:
            raise CannotWorkError("the URDF has no <ros2_control>. Add one with its joints.")
        if not files and host.simulator == "gz":
            raise CannotWorkError("it names no file of <parameters>. Write its path.")
        hardware = read_hardware(robot.devices.ros2_control, robot.robot.movable_joints)
        for problem in hardware.problems:
            host.warn(f"`{robot.entity}`: {problem}")
        for component in hardware.components:
            if not component.is_simulated:
                host.warn(
                    f"`{robot.entity}`: the hardware `{component.plugin}` of <ros2_control> "
                    f"`{component.name}` is not the simulator's: its joints cannot be controlled."
                )
        ros = element.find("ros")
        namespace = "/" if ros is None else f"/{ros.get('namespace').strip('/')}"
        arguments = [] if ros is None else _remappings(ros)
        self._manager = ControllerManager(
            host.ros,
            name=element.get("controller_manager_name") or "controller_manager",
            namespace=namespace,
            arguments=arguments,
            files=files,
            clock=lambda: host.now,
            is_former=is_former(simulator=host.simulator),
        )
        robot.ends.append(self._manager.close)
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
                hold=boolean(element, "hold_joints", default=True),
                gain=number(element, "position_proportional_gain", 0.1),
            ),
        )
        self._system.begin()
        self._manager.begin(
            hardware.components, interfaces, self._system, robot.robot.movable_joints
        )

    def update(self) -> None:
        """Read the joints, update the controllers, command the joints."""
        now = self._host.now
        self._system.read()
        for sensor in self._sensors:
            sensor.update()
        self._manager.update(now)
        self._system.write(self._period)

    def reset(self) -> None:
        """Begin again."""
        self._system.begin()  # controllers begin where the joints are then
        for sensor in self._sensors:
            sensor.reset()
        self._manager.reset()


def _remappings(ros: Element) -> list[str]:
    """The arguments of <ros><remapping>, which hold for the manager and its controllers."""
    return [word for rule in ros.find_all("remapping") for word in ("-r", rule.text)]
