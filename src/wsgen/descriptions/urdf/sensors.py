"""`<sensor>` and `<plugin>` in `<gazebo>` elements: what Gazebo's SDF parser refuses of them.

sdformat copies them from the URDF as they are, and then reads them as any SDF (`Sensor.cc`,
`Param.cc`): one mistake, and it refuses the whole robot.

`<ros2_control>` and `<transmission>` are kept as they are written.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.descriptions.urdf.values import LEFT_OVER, leading_float, line_of
from wsgen.diagnostics import Measured, Rule, Severity
from wsgen.gazebo.sensors import SYSTEM_OF_SENSOR
from wsgen.model.devices import NUMBERS_OF_POSE, NUMBERS_OF_QUATERNION_POSE
from wsgen.model.robot import ControlledPart, ControlSystem, Transmission
from wsgen.text.suggestions import did_you_mean, nearest
from wsgen.text.xmltree import child_text, children

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.descriptions.urdf.values import Collector
    from wsgen.text.xmltree import Element


TYPES = sorted(
    (
        *SYSTEM_OF_SENSOR,
        *("custom", "dvl", "rfid", "rfidtag", "sonar", "wireless_receiver", "wireless_transmitter"),
    )
)
# Elements with one number, with a truth, and with the pose, anywhere in a sensor.
NUMBERS = frozenset(
    (
        *("update_rate", "horizontal_fov", "width", "height", "near", "far", "samples"),
        *("resolution", "min_angle", "max_angle", "min", "max", "mean", "stddev", "bias_mean"),
        *("bias_stddev", "dynamic_bias_stddev", "dynamic_bias_correlation_time"),
    )
)
TRUTHS = frozenset(("always_on", "visualize", "enable_metrics"))
TRUE_OR_FALSE = frozenset(("true", "false", "1", "0"))
# How many, and what to write.
POSES = {
    NUMBERS_OF_POSE: ("six", "Write x y z roll pitch yaw, in m and rad."),
    NUMBERS_OF_QUATERNION_POSE: ("seven", "Write x y z, in m, and the quaternion x y z w."),
}
WIDEST_VIEW = 6.283186  # rad, and the narrowest
NARROWEST_VIEW = 0.1

INCOMPLETE_SENSOR = Rule(
    code="ROB097",
    name="incomplete-sensor",
    severity=Severity.ERROR,
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="A sensor has no name or no known type.",
    why="Gazebo refuses the whole robot.",
    example='<gazebo reference="camera_link">\n  <sensor name="eye" type="camra"/>\n</gazebo>',
    instead='<gazebo reference="camera_link">\n  <sensor name="eye" type="camera"/>\n</gazebo>',
)

INCOMPLETE_PLUGIN = Rule(
    code="ROB098",
    name="incomplete-plugin",
    severity=Severity.ERROR,
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="A plugin has no `name` or no `filename`.",
    why="Gazebo refuses the whole robot or, in some places, ignores the plugin.",
    example='<plugin filename="libgazebo_ros_diff_drive.so">',
    instead='<plugin name="diff_drive" filename="libgazebo_ros_diff_drive.so">',
)

INVALID_SENSOR_VALUE = Rule(
    code="ROB099",
    name="invalid-sensor-value",
    severity=Severity.ERROR,
    severity_varies="a warning for a text that begins with a number, and for a range that ends "
    "before it begins",
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="A value of a sensor is not a number or flag, or is out of range.",
    what="Checks rates, sizes, ranges, angles, noise, flags and poses in `<sensor>`. The field of "
    "view of a camera is an angle between 0.1 and 6.28 rad.",
    why="Gazebo refuses the whole robot.",
    example="<horizontal_fov>90</horizontal_fov>",
    instead="<horizontal_fov>1.5708</horizontal_fov>",
)


def check_plugins(collector: Collector, element: Element, path: str) -> None:
    """Report plugins of the robot as a whole, or of its sensors, that Gazebo refuses."""
    for plugin in children(element, "plugin"):
        lacking = [key for key in ("name", "filename") if not plugin.get(key)]
        if lacking:
            there = next((key for key in ("name", "filename") if plugin.get(key)), "")
            named = plugin.get(there) or ""
            collector.report(
                INCOMPLETE_PLUGIN,
                f"The plugin {f'`{named}` ' if named else ''}has no "
                f"{' and no '.join(lacking)}: Gazebo refuses the robot.",
                hint='Write <plugin name="NAME" filename="FILE">.',
                at=plugin,
                path=f"{path}/plugin" + (f"[@{there}='{named}']" if there else ""),
            )


def check_sensors(collector: Collector, element: Element, path: str) -> None:
    """Report what Gazebo refuses in the sensors of a link."""
    for sensor in children(element, "sensor"):
        name, kind = sensor.get("name") or "", sensor.get("type") or ""
        place = f"{path}/sensor[@name='{name}']" if name else f"{path}/sensor"
        if not name:
            collector.report(
                INCOMPLETE_SENSOR,
                "A sensor has no name: Gazebo refuses the robot.",
                hint=f'Write <sensor name="NAME" type="{kind or "camera"}">.',
                at=sensor,
                path=place,
            )
        if kind not in TYPES and not LEFT_OVER.search(kind):
            near = nearest(kind, TYPES) if kind else None
            collector.report(
                INCOMPLETE_SENSOR,
                f"The sensor `{name}` has "
                + (f"the unknown type `{kind}`" if kind else "no type")
                + ": Gazebo refuses the robot.",
                hint=did_you_mean(near) if near else 'Write its type, for example type="camera".',
                at=sensor,
                path=place,
            )
        check_plugins(collector, sensor, place)
        _check_range(collector, sensor, place)
        for inner, below in _leaves(sensor, place):
            problem = _problem(inner, str(inner.tag), (inner.text or "").strip())
            if problem is not None:
                message, hint, severity = problem
                collector.report(
                    INVALID_SENSOR_VALUE,
                    message,
                    hint=hint,
                    at=inner,
                    path=below,
                    severity=severity,
                )


def _check_range(collector: Collector, sensor: Element, path: str) -> None:
    """Report a range that ends before it begins."""
    for inner, below in _leaves(sensor, path):
        if inner.tag not in {"range", "clip"}:
            continue
        first, last = ("min", "max") if inner.tag == "range" else ("near", "far")
        begin, end = (leading_float((inner.findtext(tag) or "").strip()) for tag in (first, last))
        if begin is not None and end is not None and begin >= end:
            collector.report(
                INVALID_SENSOR_VALUE,
                f"<{inner.tag}> begins at {begin:g} m and ends at {end:g} m: the sensor measures "
                "nothing.",
                hint="Write the shorter distance first.",
                at=inner,
                path=below,
                severity=Severity.WARNING,
            )


def _leaves(element: Element, path: str) -> Iterator[tuple[Element, str]]:
    """What is in a sensor, with its path; not what its plugins read."""
    for child in element:
        if isinstance(child.tag, str) and child.tag != "plugin":
            below = f"{path}/{child.tag}"
            yield child, below
            yield from _leaves(child, below)


def _problem(element: Element, tag: str, text: str) -> tuple[str, str, Severity] | None:
    """What is wrong with a text, what to write, and how bad it is; None where nothing is."""
    if not text or LEFT_OVER.search(text):
        return None
    if tag in TRUTHS and text.lower() not in TRUE_OR_FALSE:
        problem = f"`{text[:60]}` is neither true nor false", "Write true or false."
    elif tag == "pose" and not _is_pose(text, count := _numbers_of_pose(element)):
        words, hint = POSES[count]
        problem = f"`{text[:60]}` is not {words} numbers", hint
    elif tag in NUMBERS:
        return _number_problem(tag, text)
    else:
        return None
    return f"<{tag}>: {problem[0]}: Gazebo refuses the robot.", problem[1], Severity.ERROR


def _number_problem(tag: str, text: str) -> tuple[str, str, Severity] | None:
    number = leading_float(text)
    if number is None:
        message = f"<{tag}>: `{text[:60]}` is not a number: Gazebo refuses the robot."
        return message, "Write one number with a decimal point.", Severity.ERROR
    if tag == "horizontal_fov" and not NARROWEST_VIEW <= number <= WIDEST_VIEW:
        message = (
            f"<horizontal_fov>: {number:g} is not between {NARROWEST_VIEW:g} and "
            f"{WIDEST_VIEW:.2f} rad: Gazebo refuses the robot."
        )
        hint = "Write the angle in radians, for example 1.5708 for 90 degrees."
        return message, hint, Severity.ERROR
    if len(text.split()) > 1:
        message = f"<{tag}>: `{text[:60]}` is not one number: Gazebo reads {number:g}."
        return message, f"Write {number:g}, or the number that is meant.", Severity.WARNING
    return None


def _numbers_of_pose(element: Element) -> int:
    if element.get("rotation_format") == "quat_xyzw":
        return NUMBERS_OF_QUATERNION_POSE
    return NUMBERS_OF_POSE


def _is_pose(text: str, count: int) -> bool:
    numbers = [leading_float(word) for word in text.split()]
    return len(numbers) == count and None not in numbers


PARTS = ("joint", "sensor", "gpio")
KNOWN = (*PARTS, "hardware", "transmission", "properties")


def read_controls(root: Element) -> tuple[ControlSystem, ...]:
    """The `<ros2_control>` elements of a robot."""
    return tuple(_read_system(element) for element in children(root, "ros2_control"))


def _read_system(element: Element) -> ControlSystem:
    hardware = next(children(element, "hardware"), None)
    plugin = None if hardware is None else next(children(hardware, "plugin"), None)
    return ControlSystem(
        name=element.get("name") or "",
        kind=element.get("type") or "",
        hardware=None if hardware is None else child_text(hardware, "plugin"),
        parts=tuple(_read_part(part) for part in children(element, *PARTS)),
        others=tuple(
            child.tag for child in element if isinstance(child.tag, str) and child.tag not in KNOWN
        ),
        line=line_of(element),
        hardware_line=None if plugin is None else line_of(plugin),
    )


def _read_part(element: Element) -> ControlledPart:
    commands, states = (
        tuple(interface.get("name") or "" for interface in children(element, tag))
        for tag in ("command_interface", "state_interface")
    )
    return ControlledPart(
        kind=str(element.tag),
        name=element.get("name") or "",
        commands=commands,
        states=states,
        mimic=element.get("mimic") or "",
        line=line_of(element),
    )


def read_transmissions(root: Element) -> tuple[Transmission, ...]:
    """The `<transmission>` elements of a robot."""
    return tuple(
        Transmission(
            name=element.get("name") or "",
            joints=tuple(
                joint.get("name") or (joint.text or "").strip()
                for joint in children(element, "joint")
            ),
            line=line_of(element),
        )
        for element in children(root, "transmission")
    )
