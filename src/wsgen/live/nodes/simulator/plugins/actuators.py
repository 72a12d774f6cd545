"""Commands for one of several actuators, which come in one message.

Source: gazebosim/gz-sim, `OnActuatorPos`, `OnActuatorVel` and `OnActuatorAng` of
src/systems/joint_position_controller, joint_controller and ackermann_steering; the message is
gz.msgs.Actuators, actuator_msgs/Actuators in ROS.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

from wsgen.live.nodes.simulator.elements import boolean, number
from wsgen.live.nodes.simulator.host import CannotWorkError

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.devices import Element


def actuator_number(host: Host, robot: RobotHandle, element: Element) -> tuple[Element, int | None]:
    """The plugin, and the place of its actuator in the messages; None if it takes others.

    Raises:
        CannotWorkError: It is no place.
    """
    if not boolean(element, "use_actuator_msg"):
        return element, None
    if not element.get("actuator_number"):
        host.warn(
            f"`{robot.entity}`: the plugin `{element.attributes.get('filename', '')}` has "
            "<use_actuator_msg>, which Gazebo ignores without <actuator_number>. Add it."
        )
        others = tuple(one for one in element.children if one.tag != "use_actuator_msg")
        return replace(element, children=others), None
    place = number(element, "actuator_number")
    if place < 0 or place % 1:
        raise CannotWorkError(f"its <actuator_number> is {place:g}. Write 0, 1, 2 or so on.")
    return element, int(place)


def listen_to_actuator(
    host: Host,
    robot: RobotHandle,
    topic: str,
    which: tuple[Literal["position", "velocity"], int],
    take: Callable[[float], None],
) -> None:
    """Have one of the values of messages given to a function: that of a kind, at a place."""
    values, place = which
    from actuator_msgs.msg import Actuators  # noqa: PLC0415  few robots need them

    def choose(message: Any) -> None:
        found = getattr(message, values)
        if place < len(found):
            take(found[place])
        else:
            host.warn(
                f"`{robot.entity}`: a message on {topic} has {len(found)} values of `{values}`; "
                f"the actuator {place} is not one of them."
            )

    host.subscription(robot, Actuators, topic, choose)
