"""`gz-sim-linearbatteryplugin-system`: a battery whose voltage falls with its charge.

Source: gazebosim/gz-sim, src/systems/battery_plugin/LinearBatteryPlugin.cc. Its state is
gz.msgs.BatteryState on `/model/MODEL/battery/NAME/state`, at most 50 times a second. It begins to
drain when a joint is driven, or at once with <start_draining>, and then drains for ever: so do the
versions that know <start_draining>. That of Fortress drains only in steps in which a joint is
driven. Without <fix_issue_225> it loses its charge a hundred times too fast and publishes it as a
share of 1, as Gazebo's does.

Not here: <power_draining_topic> and <stop_power_draining_topic>, and loads of other systems.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from sensor_msgs.msg import BatteryState
from std_msgs.msg import Bool

from wsgen.live.nodes.simulator.elements import boolean, number, topics_of
from wsgen.live.nodes.simulator.host import CannotWorkError, Plugin
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from typing import Any

    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.devices import Element

HOUR = 3600.0  # s
REMEMBERED = 100  # steps, whose currents are taken from the charge in each step
FULL = 0.9  # the share of the capacity from which on it is not charged any more
EMPTY = 1e-3  # V
PERIOD = 0.02  # s


@dataclass(frozen=True, kw_only=True)
class Cell:
    """What a battery is made of."""

    voltage: float  # V, at the beginning
    constant: float = 0.0  # V
    linear: float = 0.0  # V, that are added when it is empty
    capacity: float  # A h
    charge: float  # A h, at the beginning
    resistance: float = 0.0  # Ohm
    smoothing: float = 1.0  # s
    load: float = 0.0  # W
    charging_hours: float | None = None  # until it is full; None: it cannot be charged
    is_fixed: bool = False  # <fix_issue_225>


class Battery:
    """A battery, step by step.

    Attributes:
        voltage: V.
        current: A, smoothed.
        charge: A h.
        share: Of its capacity; below 0 when it is empty.
        is_draining: Whether its load is there.
        is_charging: Whether it is charged.
    """

    def __init__(self, cell: Cell) -> None:
        self._cell = cell
        self.voltage, self.charge = cell.voltage, cell.charge
        self.current, self.share = 0.0, cell.charge / cell.capacity
        self.is_draining = self.is_charging = False
        self._currents: deque[float] = deque(maxlen=REMEMBERED)

    def step(self, seconds: float) -> None:
        """Let a step of the simulation pass."""
        cell = self._cell
        if not (self.is_draining or self.is_charging):
            return
        if not self.is_charging and (abs(self.voltage) < EMPTY or self.share < 0.0):
            return
        raw = cell.load / self.voltage if self.is_draining and self.voltage else 0.0
        if self.is_charging and cell.charging_hours and self.share < FULL:
            raw -= cell.capacity / cell.charging_hours
        self.current += seconds / max(cell.smoothing, seconds) * (raw - self.current)
        self.charge -= seconds * self.current / HOUR
        self.voltage = (
            cell.constant
            + cell.linear * (1 - self.charge / cell.capacity)
            - cell.resistance * self.current
        )
        if cell.is_fixed:
            self.share = self.charge / cell.capacity
        else:
            self._currents.append(self.current)
            self.share -= sum(self._currents) * seconds / HOUR / cell.capacity


class LinearBattery(Plugin):
    """The plugin."""

    period = PERIOD

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        self._host, self._robot = host, robot
        name = element.get("battery_name")
        if not name or not element.get("voltage"):
            raise CannotWorkError("it has no <battery_name> or no <voltage>. Write both.")
        capacity = number(element, "capacity")
        if not capacity > 0.0:
            raise CannotWorkError(f"its <capacity> is {capacity:g}. Write ampere hours.")
        can_charge = boolean(element, "enable_recharge")
        if can_charge and not number(element, "charging_time") > 0.0:
            raise CannotWorkError("it has <enable_recharge>, but no <charging_time> in hours.")
        smoothing = number(element, "smooth_current_tau")
        self._cell = Cell(
            voltage=number(element, "voltage"),
            constant=number(element, "open_circuit_voltage_constant_coef"),
            linear=number(element, "open_circuit_voltage_linear_coef"),
            capacity=capacity,
            charge=min(capacity, max(0.0, number(element, "initial_charge", capacity))),
            resistance=number(element, "resistance"),
            smoothing=smoothing if smoothing > 0.0 else 1.0,
            load=number(element, "power_load"),
            charging_hours=number(element, "charging_time") if can_charge else None,
            is_fixed=boolean(element, "fix_issue_225"),
        )
        self._sign = -1.0 if boolean(element, "invert_current_sign") else 1.0
        self._starts = boolean(element, "start_draining")
        for tag in ("power_draining_topic", "stop_power_draining_topic"):
            if element.find(tag) is not None:
                host.warn(
                    f"`{robot.entity}`: wsgen does not take the <{tag}> of its battery; it drains "
                    "from when a joint is first driven, or from the start with <start_draining>."
                )
        topics = topics_of(host, robot, element)
        if element.find("recharge_by_topic") is not None and "start" in topics:
            host.subscription(robot, Bool, topics["start"], lambda _: self._charge(True))
            host.subscription(robot, Bool, topics["stop"], lambda _: self._charge(False))
        self._publisher = host.publisher(robot, BatteryState, topics["state"])
        self._message: Any = BatteryState(design_capacity=float("nan"), present=True)
        self._message.capacity = capacity
        self._last = host.now  # s, simulated, of the last update
        self.reset()

    def _charge(self, is_charging: bool) -> None:  # noqa: FBT001  as the message has it
        self._battery.is_charging = is_charging

    def update(self) -> None:
        """Let the time since the last update pass, and publish the state."""
        battery, step = self._battery, self._host.step_seconds
        battery.is_draining = battery.is_draining or self._robot.is_driven
        for _ in range(round((self._host.now - self._last) / step)):
            battery.step(step)
        self._last = self._host.now
        if not self._publisher.is_wanted:
            return
        message, kind = self._message, BatteryState
        message.header.stamp = self._host.stamp()
        message.voltage, message.charge = battery.voltage, battery.charge
        message.current = self._sign * battery.current
        message.percentage = battery.share * (100.0 if self._cell.is_fixed else 1.0)
        if battery.is_charging:
            message.power_supply_status = kind.POWER_SUPPLY_STATUS_CHARGING
        elif battery.is_draining:
            message.power_supply_status = kind.POWER_SUPPLY_STATUS_DISCHARGING
        elif battery.share > FULL:
            message.power_supply_status = kind.POWER_SUPPLY_STATUS_FULL
        else:
            message.power_supply_status = kind.POWER_SUPPLY_STATUS_NOT_CHARGING
        self._publisher.publish(message)

    def reset(self) -> None:
        """Begin again with the charge that it had."""
        self._battery = Battery(self._cell)
        self._battery.is_draining = self._starts
        self._last = self._host.now
