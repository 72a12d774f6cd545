"""The hardware that `<ros2_control>` of a URDF describes, as Gazebo's plugins understand it.

Source: ros-controls/ros2_control, hardware_interface/src/component_parser.cpp; what Gazebo makes of
it: gazebo_ros2_control/src/gazebo_system.cpp, gz_ros2_control/src/gz_system.cpp.
"""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

from wsgen.model.robot import Mimic
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from wsgen.model.devices import Element
    from wsgen.model.robot import Joint


POSITION, VELOCITY, EFFORT = "position", "velocity", "effort"
OF_JOINTS = (POSITION, VELOCITY, EFFORT)  # what the simulators know
IMU = (
    *("orientation.x", "orientation.y", "orientation.z", "orientation.w"),
    *("angular_velocity.x", "angular_velocity.y", "angular_velocity.z"),
    *("linear_acceleration.x", "linear_acceleration.y", "linear_acceleration.z"),
)
FORCE_TORQUE = (
    *("force.x", "force.y", "force.z"),
    *("torque.x", "torque.y", "torque.z"),
)
# What `<hardware><plugin>` names where the simulator is the hardware.
SIMULATED = frozenset(
    (
        "gazebo_ros2_control/GazeboSystem",
        "gz_ros2_control/GazeboSimSystem",
        "ign_ros2_control/IgnitionSystem",
        "ign_ros2_control/IgnitionSimSystem",
    )
)


@dataclass(frozen=True, kw_only=True)
class Gains:
    """Of a PID controller inside of Gazebo Classic's plugin."""

    p: float
    i: float = 0.0
    d: float = 0.0
    most: float = math.inf  # of the integral's part
    least: float = -math.inf


@dataclass(frozen=True, kw_only=True)
class ControlledJoint:
    """A `<joint>` of `<ros2_control>`."""

    name: str
    commands: tuple[str, ...] = ()  # those that a simulator knows
    states: tuple[str, ...] = ()
    initial: Mapping[str, float]  # by state: where it is at the beginning
    follows: Mimic | None = None
    position_gains: Gains | None = None
    velocity_gains: Gains | None = None


class SensorPart(NamedTuple):
    """A `<sensor>` of `<ros2_control>`."""

    name: str
    states: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Component:
    """A `<ros2_control>`."""

    name: str
    kind: str  # system, actuator, sensor
    plugin: str
    joints: tuple[ControlledJoint, ...] = ()
    sensors: tuple[SensorPart, ...] = ()
    others: tuple[str, ...] = ()  # states of <gpio>, which no simulator has

    @property
    def is_simulated(self) -> bool:
        """Whether a simulator is this hardware."""
        return self.plugin in SIMULATED

    @property
    def commands(self) -> tuple[str, ...]:
        """The full names of its command interfaces, `joint_1/position`."""
        return tuple(f"{one.name}/{kind}" for one in self.joints for kind in one.commands)

    @property
    def states(self) -> tuple[str, ...]:
        """Those of its state interfaces."""
        parts: tuple[ControlledJoint | SensorPart, ...] = (*self.joints, *self.sensors)
        return tuple(f"{one.name}/{kind}" for one in parts for kind in one.states)


class Hardware(NamedTuple):
    """All hardware of a robot, and what is wrong with it."""

    components: tuple[Component, ...]
    problems: tuple[str, ...]


def read_hardware(elements: Iterable[Element], joints: Iterable[Joint]) -> Hardware:
    """Read the `<ros2_control>` elements of a robot; `joints` are those that are simulated."""
    there = {joint.name: joint for joint in joints}
    problems: list[str] = []
    components = tuple(_component(element, there, problems) for element in elements)
    return Hardware(components, tuple(problems))


def _component(element: Element, there: Mapping[str, Joint], problems: list[str]) -> Component:
    joints, sensors, others = [], [], []
    for part in element.children:
        name = part.attributes.get("name", "")
        if part.tag == "joint":
            if name in there:
                joints.append(_joint(part, there[name], problems))
            else:
                problems.append(
                    f"Skipping joint in the URDF named '{name}' which is not in the gazebo model."
                )
        elif part.tag == "sensor":
            sensors.append(SensorPart(name, _names(part, "state_interface")))
        elif part.tag == "gpio":
            others.append(name)
    return Component(
        name=element.attributes.get("name", ""),
        kind=element.attributes.get("type", ""),
        plugin=element.get("hardware/plugin"),
        joints=tuple(joints),
        sensors=tuple(sensors),
        others=tuple(others),
    )


def _names(part: Element, tag: str) -> tuple[str, ...]:
    return tuple(one.attributes.get("name", "") for one in part.find_all(tag))


def _joint(part: Element, joint: Joint, problems: list[str]) -> ControlledJoint:
    parameters = {one.attributes.get("name", ""): one.text for one in part.find_all("param")}
    initial = {}
    for state in part.find_all("state_interface"):
        given = {one.attributes.get("name", ""): one.text for one in state.find_all("param")}
        name = state.attributes.get("name", "")
        if "initial_value" in given:
            value = _number(given["initial_value"])
            if value is None:
                problems.append(
                    f"Failed converting initial_value string to real number for the joint "
                    f"{joint.name} and state interface {name}. Actual value of parameter: "
                    f"{given['initial_value']}. Initial value will be set to 0.0"
                )
            initial[name] = value or 0.0
    return ControlledJoint(
        name=joint.name,
        commands=tuple(one for one in _names(part, "command_interface") if one in OF_JOINTS),
        states=tuple(one for one in _names(part, "state_interface") if one in OF_JOINTS),
        initial=initial,
        follows=_follows(part, parameters, joint),
        position_gains=_gains(parameters, "pos_"),
        velocity_gains=_gains(parameters, "vel_"),
    )


def _number(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _follows(part: Element, parameters: Mapping[str, str], joint: Joint) -> Mimic | None:
    """By its <mimic> in the URDF, or as Humble's releases have it, by parameters."""
    if part.attributes.get("mimic", "").lower() == "false":
        return None
    if "mimic" in parameters:
        multiplier = _number(parameters.get("multiplier", "1"))
        offset = _number(parameters.get("offset", "0"))
        return Mimic(
            joint=parameters["mimic"],
            multiplier=1.0 if multiplier is None else multiplier,
            offset=offset or 0.0,
        )
    return joint.mimic


def _gains(parameters: Mapping[str, str], prefix: str) -> Gains | None:
    given = {
        name: _number(parameters[prefix + name]) or 0.0
        for name in ("kp", "ki", "kd")
        if prefix + name in parameters
    }
    if not given:
        return None
    most = _number(parameters.get(f"{prefix}max_integral_error", ""))
    least = _number(parameters.get(f"{prefix}min_integral_error", ""))
    return Gains(
        p=given.get("kp", 0.0),
        i=given.get("ki", 0.0),
        d=given.get("kd", 0.0),
        most=math.inf if most is None else most,
        least=-math.inf if least is None else least,
    )


class Interfaces:
    """What controllers read and command: values by full name, and who has claimed what."""

    def __init__(self, components: Iterable[Component]) -> None:
        simulated = [one for one in components if one.is_simulated]
        self.states = dict.fromkeys(self._names(simulated, "states"), 0.0)
        self.commands = dict.fromkeys(self._names(simulated, "commands"), 0.0)
        self.claims: dict[str, str] = {}  # command interface -> controller
        for component in simulated:
            for joint in component.joints:
                for kind, value in joint.initial.items():
                    for values in (self.states, self.commands):
                        if f"{joint.name}/{kind}" in values:
                            values[f"{joint.name}/{kind}"] = value

    @staticmethod
    def _names(components: Iterable[Component], kind: str) -> Iterator[str]:
        for component in components:
            yield from getattr(component, kind)

    def claim(self, controller: str, names: Iterable[str]) -> None:
        """Let a controller have command interfaces."""
        self.claims.update(dict.fromkeys(names, controller))

    def release(self, controller: str) -> None:
        """Take from a controller all that it has claimed."""
        self.claims = {name: one for name, one in self.claims.items() if one != controller}


class Pid:
    """A PID controller, as control_toolbox's: the error is given, the integral's part is bound."""

    def __init__(self, gains: Gains) -> None:
        self._gains = gains
        self._last: float | None = None
        self._integral = 0.0

    def reset(self) -> None:
        """Forget the past."""
        self._last, self._integral = None, 0.0

    def command(self, error: float, seconds: float, rate: float | None = None) -> float:
        """What to do about an error; `rate` is how fast it changes, when that is known."""
        gains = self._gains
        if seconds <= 0.0 or not math.isfinite(error):
            return 0.0
        if rate is None:
            rate = 0.0 if self._last is None else (error - self._last) / seconds
        self._last = error
        self._integral += gains.i * seconds * error
        self._integral = min(gains.most, max(gains.least, self._integral))
        return gains.p * error + self._integral + gains.d * rate


# The order of the keys of a `std::unordered_map<std::string, ...>` of libstdc++ on 64 bits: it is
# the same on each machine, and controllers that go through one publish in it. Source:
# gcc-mirror/gcc, libstdc++-v3: libsupc++/hash_bytes.cc (`_Hash_bytes`), src/c++11/
# hashtable_c++0x.cc (`_M_need_rehash`), include/bits/hashtable.h.

SIZES = (13, 29, 59, 127, 257, 541, 1109, 2357, 5087)  # numbers of buckets, as the map grows
SEED, FACTOR = 0xC70F6907, 0xC6A4A7935BD1E995
BITS = (1 << 64) - 1
WORD = 8  # bytes


def unordered(names: Iterable[str]) -> list[str]:
    """The keys of a map that these, all different, were put into one after the other."""
    size = 1
    order: list[str] = []
    for name in names:
        if size < SIZES[-1] and len(order) >= (size if size > 1 else 0):
            size = next(one for one in SIZES if one > size)
            before, order = order, []
            for one in before:
                _put(order, one, size)
        _put(order, name, size)
    return order


def _put(order: list[str], name: str, size: int) -> None:
    """Put a key before the others of its bucket, or before all where it is the first of it."""
    bucket = _hash(name.encode()) % size
    same = (place for place, one in enumerate(order) if _hash(one.encode()) % size == bucket)
    order.insert(next(same, 0), name)


@cache
def _hash(text: bytes) -> int:
    whole = len(text) - len(text) % WORD
    found = SEED ^ (len(text) * FACTOR & BITS)
    for start in range(0, whole, WORD):
        word = int.from_bytes(text[start : start + WORD], "little") * FACTOR & BITS
        found = (found ^ (_mix(word) * FACTOR & BITS)) * FACTOR & BITS
    if whole < len(text):
        found = (found ^ int.from_bytes(text[whole:], "little")) * FACTOR & BITS
    return _mix(_mix(found) * FACTOR & BITS)


def _mix(value: int) -> int:
    return value ^ value >> 47
