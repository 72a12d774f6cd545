"""How plugins of Gazebo Sim are commanded: by actuators, by PID controllers.

Commands for one of several actuators come in one message: gz.msgs.Actuators, in ROS
actuator_msgs/Actuators. Source: gazebosim/gz-sim, `OnActuatorPos`, `OnActuatorVel` and
`OnActuatorAng` of src/systems/joint_position_controller, joint_controller and ackermann_steering.

Of a PID controller (gazebosim/gz-math, src/PID.cc) the error is where it is less where it should
be, the gain of the integral is applied as it grows, and a bound counts where the upper one is not
below the lower.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

from wsgen.live.nodes.simulator.elements import boolean, number
from wsgen.live.nodes.simulator.host import CannotWorkError
from wsgen.text.values import dataclass

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


@dataclass(frozen=True, kw_only=True)
class Gains:
    """What <p_gain> and the like say."""

    p: float
    i: float
    d: float
    i_max: float = -1.0  # below `i_min`: none
    i_min: float = 0.0
    most: float = -1.0  # of the output; below `least`: none
    least: float = 0.0
    offset: float = 0.0  # of the output


class GzPid:
    """A PID controller."""

    def __init__(self, gains: Gains) -> None:
        self._gains = gains
        self.reset()

    def reset(self) -> None:
        """Begin again."""
        self._integral = self._last = 0.0

    def command(self, error: float, seconds: float) -> float:
        """What to do about an error, that time after the last one."""
        if seconds <= 0.0 or not math.isfinite(error):
            return 0.0
        gains = self._gains
        self._integral += gains.i * seconds * error
        if gains.i_max >= gains.i_min:
            self._integral = min(gains.i_max, max(gains.i_min, self._integral))
        rate, self._last = (error - self._last) / seconds, error
        command = gains.offset - gains.p * error - self._integral - gains.d * rate
        if gains.most >= gains.least:
            command = min(gains.most, max(gains.least, command))
        return command
