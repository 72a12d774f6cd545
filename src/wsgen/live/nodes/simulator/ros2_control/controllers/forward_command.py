"""Controllers that pass commands on as they come.

Source: ros-controls/ros2_controllers, forward_command_controller/src/forward_controllers_base.cpp,
position_controllers, velocity_controllers and effort_controllers.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from std_msgs.msg import Float64MultiArray

from wsgen.live.nodes.simulator.ros2_control.controllers.base import Controller, ControllerError
from wsgen.live.nodes.simulator.ros2_control.hardware import EFFORT, POSITION, VELOCITY

if TYPE_CHECKING:
    from collections.abc import Sequence


class ForwardCommandController(Controller):
    """`~/commands` (std_msgs/msg/Float64MultiArray): one number for each of its `joints`."""

    kind: str | None = None  # None: the parameter `interface_name` says
    _command: Sequence[float] | None = None

    def configure(self) -> None:
        """Read `joints` and `interface_name`."""
        self.commands = self.wanted()
        self.subscription(Float64MultiArray, "~/commands", self._take)
        self.info("configure successful")

    def wanted(self) -> tuple[str, ...]:
        """The interfaces that the numbers are for, in their order."""
        kind = self.kind or self.parameters.text("interface_name")
        if not kind:
            message = "'interface_name' parameter was empty"
            raise ControllerError(message)
        return tuple(f"{joint}/{kind}" for joint in self.require("joints"))

    def activate(self) -> None:
        """Forget what was sent before."""
        self._command = None
        self.info("activate successful")

    def deactivate(self) -> None:
        """Leave the joints to the hardware."""
        self._command = None
        if self.kind == VELOCITY or self.kind == EFFORT:  # noqa: PLR1714  one is enough
            self.interfaces.commands.update(dict.fromkeys(self.commands, 0.0))

    def _take(self, message: Any) -> None:
        if not all(map(math.isfinite, message.data)):
            self.warn_once("Non-finite value received. Dropping message")
        elif len(message.data) != len(self.commands):
            self.error(
                f"command size ({len(message.data)}) does not match number of interfaces "
                f"({len(self.commands)})"
            )
        else:
            self._command = message.data

    def update(self, now: float, elapsed: float) -> None:  # noqa: ARG002  it passes on
        """Pass the last command on."""
        if self._command is not None:
            self.interfaces.commands.update(zip(self.commands, self._command, strict=True))
            self._command = None  # it stays in the interfaces, which nobody else commands


class PositionController(ForwardCommandController):
    """Positions, rad or m."""

    kind = POSITION


class VelocityController(ForwardCommandController):
    """Velocities, rad/s or m/s."""

    kind = VELOCITY


class EffortController(ForwardCommandController):
    """Efforts, N m or N."""

    kind = EFFORT


class MultiInterfaceController(ForwardCommandController):
    """Several interfaces of one joint."""

    def wanted(self) -> tuple[str, ...]:
        """Of `joint`, those of `interface_names`."""
        joint = self.parameters.text("joint")
        if not joint:
            message = "'joint' parameter is empty"
            raise ControllerError(message)
        return tuple(f"{joint}/{kind}" for kind in self.require("interface_names"))
