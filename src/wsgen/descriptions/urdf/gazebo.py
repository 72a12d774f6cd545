"""`<gazebo>` elements: read and check them.

The keys are those that sdformat reads itself (`parser_urdf.cc`, ParseSDFExtension); everything
else is copied into the SDF as it is, of which wsgen takes the part that it simulates. What the
values do to links depends on what is lumped (`extensions`).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.descriptions.urdf.sensors import check_plugins, check_sensors
from wsgen.descriptions.urdf.unknown_elements import nearest_element
from wsgen.descriptions.urdf.values import (
    LEFT_OVER,
    NUMBER,
    leading_float,
    leading_integer,
    line_of,
    without_commas,
)
from wsgen.diagnostics import Measured, Rule, Severity
from wsgen.model.robot import GAZEBO_COLORS, GazeboTag, Plugin, SdfJoint, Sensor
from wsgen.text.suggestions import did_you_mean, nearest
from wsgen.text.xmltree import child_text, child_texts, children, gz_attribute

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.descriptions.urdf.values import Collector
    from wsgen.text.xmltree import Element


SURFACE_KEYS = ("mu1", "mu2", "kp", "kd", "minDepth", "maxContacts")
LUMPING_KEYS = ("preserveFixedJoint", "disableFixedJointLumping")
LINK_KEYS = frozenset(
    (
        *SURFACE_KEYS,
        *("maxVel", "fdir1", "laserRetro", "material"),
        *("dampingFactor", "selfCollide", "turnGravityOff"),
    )
)
JOINT_KEYS = frozenset(
    (
        *LUMPING_KEYS,
        *("springReference", "springStiffness", "stopCfm", "stopErp", "fudgeFactor"),
        *("provideFeedback", "implicitSpringDamper", "cfmDamping"),
    )
)
# Elements of SDF that belong into the <collision> of a link, and the keys that do the same.
OF_COLLISIONS = {
    "friction": "<mu1> and <mu2>",
    "surface": "<mu1>, <mu2>, <kp> and <kd>",
    "contact": "<kp>, <kd> and <minDepth>",
}
# Keys that std::stod reads, and numbers in copied SDF, which the SDF parser reads the same way.
NUMERIC = frozenset(
    (
        *("mu1", "mu2", "kp", "kd", "minDepth", "maxVel", "dampingFactor", "laserRetro"),
        *("springReference", "springStiffness", "stopCfm", "stopErp", "fudgeFactor"),
    )
)
SDF_NUMERIC = frozenset(
    (
        *("velocity_decay/linear", "velocity_decay/angular", "collision/max_contacts"),
        *("collision/laser_retro", "visual/laser_retro"),
        *(f"collision/surface/friction/ode/{key}" for key in ("mu", "mu2")),
        *(f"collision/surface/contact/ode/{key}" for key in ("kp", "kd", "min_depth")),
    )
)
NOT_NEGATIVE = frozenset(
    (
        *("mu1", "mu2"),
        *("collision/surface/friction/ode/mu", "collision/surface/friction/ode/mu2"),
    )
)
SDF_BOOLEAN = frozenset(("gravity", "self_collide"))
TRUTHS = frozenset(("true", "1"))
FALSEHOODS = frozenset(("false", "0"))
# Of these SDF elements also what is in them is taken, under `collision/surface/friction/ode/mu`.
COPIED = frozenset(("collision", "visual", "velocity_decay"))
# What Gazebo adds to the model for them is not part of the simulation.
NOT_SIMULATED = frozenset(("joint", "link", "model", "include"))
FRICTION = "collision/surface/friction/ode/"
# In copied SDF; of <fdir1> in the <gazebo> of a link, sdformat leaves the attribute out.
DIRECTION = FRICTION + "fdir1"
DIRECTION_IN = DIRECTION + "@gz:expressed_in"

UNKNOWN_REFERENCE = Rule(
    code="ROB030",
    name="unknown-reference",
    severity=Severity.WARNING,
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="A `<gazebo>` element refers to a link or joint that does not exist.",
    why="Gazebo silently ignores the element: the link keeps its default friction, color and "
    "sensors.",
    example='<link name="base_link"/>\n<gazebo reference="base">\n  <mu1>0.2</mu1>\n</gazebo>',
    instead='<link name="base_link"/>\n<gazebo reference="base_link">\n  <mu1>0.2</mu1>\n</gazebo>',
)

GAZEBO_NOT_A_NUMBER = Rule(
    code="ROB031",
    name="gazebo-not-a-number",
    severity=Severity.ERROR,
    severity_varies=(
        "a warning where Gazebo reads a number from the beginning of the text, or one that is "
        "not finite"
    ),
    measured=Measured(classic="crashes", sim="crashes"),
    summary="A number in a `<gazebo>` element is not a number or is out of range.",
    why="Gazebo converts these texts without a check: it terminates with an exception, refuses "
    "the robot, or reads only the beginning of the text.",
    example='<gazebo reference="wheel">\n  <mu1>low</mu1>\n</gazebo>',
    instead='<gazebo reference="wheel">\n  <mu1>0.1</mu1>\n</gazebo>',
)

UNKNOWN_GAZEBO_MATERIAL = Rule(
    code="ROB032",
    name="unknown-gazebo-material",
    severity=Severity.WARNING,
    summary="A `<gazebo>` element names a material that Gazebo does not have.",
    why="Gazebo draws the link in the default color.",
    example='<gazebo reference="base_link">\n  <material>Gazebo/Pink</material>\n</gazebo>',
    instead='<gazebo reference="base_link">\n  <material>Gazebo/Red</material>\n</gazebo>',
)

MISPLACED_GAZEBO_ELEMENT = Rule(
    code="ROB033",
    name="misplaced-gazebo-element",
    severity=Severity.WARNING,
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="A setting is in the wrong kind of `<gazebo>` element and has no effect.",
    why="Some settings apply to links, some to joints and some to the whole robot. Gazebo "
    "silently ignores the others.",
    example="<gazebo>\n  <mu1>0.2</mu1>\n</gazebo>",
    instead='<gazebo reference="base_link">\n  <mu1>0.2</mu1>\n</gazebo>',
)

GAZEBO_NOT_A_BOOLEAN = Rule(
    code="ROB045",
    name="gazebo-not-a-boolean",
    severity=Severity.ERROR,
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="A flag in a `<gazebo>` element is neither true nor false.",
    why="Gazebo copies the element into SDF, where the parser refuses the robot.",
    example='<gazebo reference="arm">\n  <gravity>off</gravity>\n</gazebo>',
    instead='<gazebo reference="arm">\n  <gravity>false</gravity>\n</gazebo>',
)

SDF_NOT_SIMULATED = Rule(
    code="ROB058",
    name="sdf-not-simulated",
    severity=Severity.WARNING,
    summary="`wsgen` does not simulate a model, link or joint in a `<gazebo>` element.",
    why="Gazebo adds these SDF elements to the robot, which then has parts that are missing in "
    "wsgen's simulation.",
    example="<gazebo>\n"
    '  <joint name="closing_joint" type="revolute">\n'
    "    <parent>arm</parent>\n"
    "    <child>hand</child>\n"
    "  </joint>\n"
    "</gazebo>",
    instead="# simulate this part of the robot in Gazebo",
)
NOT_SIMULATED_MESSAGE = (
    "Gazebo adds the SDF <{}> in a <gazebo> element to the robot; wsgen does not simulate it."
)
NOT_SIMULATED_HINT = "Simulate this part in Gazebo."


def read_tags(
    collector: Collector,
    root: Element,
    link_names: set[str],
    joint_names: set[str],
    *,
    is_complete: bool = True,
) -> tuple[GazeboTag, ...]:
    """Every `<gazebo>` element of the robot, checked.

    `is_complete` says that there are no other links and joints: none whose name is missing.
    """
    return tuple(
        _read_tag(collector, element, link_names, joint_names, is_complete=is_complete)
        for element in children(root, "gazebo")
    )


def _read_tag(
    collector: Collector,
    element: Element,
    link_names: set[str],
    joint_names: set[str],
    *,
    is_complete: bool,
) -> GazeboTag:
    reference = element.get("reference") or None  # an empty one means the whole robot
    path = "gazebo" if reference is None else f"gazebo[@reference='{reference}']"
    is_known = reference is None or reference in link_names or reference in joint_names
    if reference is not None and not is_known and is_complete:
        _report_unknown(collector, element, path, reference, link_names | joint_names)
    if reference in link_names:
        check_sensors(collector, element, path)
    elif reference is None:
        check_plugins(collector, element, path)
    values: dict[str, str] = {}
    for child in element:
        if not isinstance(child.tag, str):
            continue
        for key, leaf in _values_in(child, child.tag):
            values[key] = _value_of(leaf)
            if key == DIRECTION and (link := gz_attribute(leaf, "expressed_in")) is not None:
                values[DIRECTION_IN] = link
            _check_value(collector, leaf, f"{path}/{key}", key, values[key], is_known=is_known)
        inside = f"{path}/{child.tag}"
        if is_known:
            _check_placement(
                collector,
                child,
                inside,
                is_link=reference in link_names,
                is_joint=reference in joint_names,
            )
        if child.tag in NOT_SIMULATED and reference is None and not _is_ball(child):
            _report_not_simulated(collector, child, inside)
    return GazeboTag(
        reference=reference,
        values=values,
        plugins=_read_plugins(element),
        sensors=tuple(
            Sensor(
                name=sensor.get("name") or "",
                kind=sensor.get("type") or "",
                values=child_texts(sensor),
                plugins=_read_plugins(sensor),
                line=line_of(sensor),
            )
            for sensor in _descendants(element, "sensor")
        ),
        frames=tuple(
            part.get("name") or "" for tag in ("link", "frame") for part in children(element, tag)
        ),
        is_open=any(next(children(element, tag), None) is not None for tag in ("include", "model")),
        joints=tuple(_read_joint(joint) for joint in children(element, "joint"))
        if reference is None
        else (),
        line=line_of(element),
    )


def _read_plugins(element: Element) -> tuple[Plugin, ...]:
    """The plugins in the element and below it."""
    return tuple(
        Plugin(
            filename=plugin.get("filename") or "",
            values=child_texts(plugin),
            name=plugin.get("name") or "",
            line=line_of(plugin),
        )
        for plugin in _descendants(element, "plugin")
    )


def _read_joint(element: Element) -> SdfJoint:
    ends = {tag: child_text(element, tag) for tag in ("parent", "child")}
    return SdfJoint(
        name=element.get("name") or "",
        ends={tag: name for tag, name in ends.items() if name},
        line=line_of(element),
        is_ball=_is_ball(element),
    )


def _is_ball(element: Element) -> bool:
    """Whether it is a ball joint at the origin of its child, which may be simulated."""
    is_ball = element.tag == "joint" and element.get("type") == "ball"
    return is_ball and not child_text(element, "pose")


def _values_in(element: Element, key: str) -> Iterator[tuple[str, Element]]:
    """The element, if its text may mean something, and those in it where these are copied."""
    inside = [child for child in element if isinstance(child.tag, str)]
    is_copied = key.partition("/")[0] in COPIED
    if not inside or is_copied or _value_of(element):
        yield key, element
    if is_copied:
        for child in inside:
            yield from _values_in(child, f"{key}/{child.tag}")


def _value_of(element: Element) -> str:
    """The attribute `value`, which counts first, or the text."""
    value = element.get("value")
    return (element.text or "" if value is None else value).strip()


def _descendants(element: Element, tag: str) -> Iterator[Element]:
    for child in element:
        if child.tag == tag:
            yield child
        yield from _descendants(child, tag)


def _report_unknown(
    collector: Collector, element: Element, path: str, reference: str, known: set[str]
) -> None:
    near = nearest_element(collector, reference, known)
    collector.report(
        UNKNOWN_REFERENCE,
        f"The robot has no link or joint `{reference}`: Gazebo ignores this <gazebo> element.",
        hint=did_you_mean(near) if near else "Write the name of a link or joint of this robot.",
        at=element,
        path=path,
    )


def _report_not_simulated(collector: Collector, element: Element, path: str) -> None:
    collector.report(
        SDF_NOT_SIMULATED,
        NOT_SIMULATED_MESSAGE.format(element.tag),
        hint=NOT_SIMULATED_HINT,
        at=element,
        path=path,
    )


def _check_value(  # noqa: PLR0913  what, where, and whether it counts
    collector: Collector, element: Element, path: str, key: str, text: str, *, is_known: bool
) -> None:
    """Report a value that terminates Gazebo, that it refuses, or that is surely not what was meant.

    `is_known`: the reference is there; otherwise only the keys that sdformat reads at once matter.
    """
    if LEFT_OVER.search(text):  # reported once, for every element
        return
    is_copied_number = key in SDF_NUMERIC and is_known and bool(text)
    if key in NUMERIC or key == "maxContacts" or is_copied_number:
        _check_number(collector, element, path, key, text)
    elif key in SDF_BOOLEAN and is_known and text:
        if text.lower() not in TRUTHS | FALSEHOODS:
            collector.report(
                GAZEBO_NOT_A_BOOLEAN,
                f"<{key}>: `{text[:60]}` is neither true nor false: Gazebo refuses the robot.",
                hint="Write true or false.",
                at=element,
                path=path,
            )
    elif key == "material" and text.startswith("Gazebo/") and text not in GAZEBO_COLORS:
        message = f"Gazebo does not have the material `{text}`."
        if any(found.message == message for found in collector.diagnostics):
            return  # once for each name
        near = nearest(text, GAZEBO_COLORS)
        collector.report(
            UNKNOWN_GAZEBO_MATERIAL,
            message,
            hint=did_you_mean(near) if near else "Use Gazebo/Grey, Gazebo/Red, …",
            at=element,
            path=path,
        )


def _check_number(collector: Collector, element: Element, path: str, key: str, text: str) -> None:
    number = leading_integer(text) if key == "maxContacts" else leading_float(text)
    what = f"<{key.rpartition('/')[2]}>: `{text[:60]}`"
    if number is None:
        collector.report(
            GAZEBO_NOT_A_NUMBER,
            f"{what} is not a number, and Gazebo "
            + ("refuses the robot." if "/" in key else "terminates with an exception."),
            hint="Write one number with a decimal point.",
            at=element,
            path=path,
        )
    elif key in NOT_NEGATIVE and number < 0:
        collector.report(
            GAZEBO_NOT_A_NUMBER,
            f"{what} is less than 0, and Gazebo refuses the robot.",
            hint="Write 0 or a positive number.",
            at=element,
            path=path,
        )
    elif not math.isfinite(number):
        collector.report(
            GAZEBO_NOT_A_NUMBER,
            f"{what} is not finite: wsgen ignores it.",
            hint="Write a finite number.",
            at=element,
            path=path,
            severity=Severity.WARNING,
        )
    elif not NUMBER.fullmatch(text) or (key == "maxContacts" and float(text) != number):
        collector.report(
            GAZEBO_NOT_A_NUMBER,
            f"{what} is not one number: Gazebo reads the beginning, {number:g}.",
            hint=f"Write {without_commas(text, 1) or f'{number:g}, or the number that is meant'}.",
            at=element,
            path=path,
            severity=Severity.WARNING,
        )


def _check_placement(
    collector: Collector, element: Element, path: str, *, is_link: bool, is_joint: bool
) -> None:
    """Report a key that has no effect on what the `<gazebo>` element refers to."""
    key = str(element.tag)
    right_place = None
    if key in JOINT_KEYS and not is_joint:
        right_place = "a joint"
    elif key in LINK_KEYS and not is_link:
        right_place = "a link"
    elif key == "static" and (is_link or is_joint):
        right_place = "the whole robot"
    elif key in OF_COLLISIONS and is_link:
        right_place = "a <collision>"
    if right_place is None:
        return
    hint = 'Move it to <gazebo reference="NAME"> with the name of ' + right_place + "."
    if key in OF_COLLISIONS:
        hint = f"Write {OF_COLLISIONS[key]}, which Gazebo applies to the collisions of the link."
    elif key in LUMPING_KEYS:
        hint = 'Move it to <gazebo reference="JOINT"> with the name of the fixed joint.'
    elif key == "static":
        hint = "Move it to a <gazebo> without `reference`."
    elif key == "selfCollide" and not is_joint:
        hint = (
            "Write <self_collide>true</self_collide>, which Gazebo copies to the model, for all "
            "links."
        )
    collector.report(
        MISPLACED_GAZEBO_ELEMENT,
        f"<{key}> belongs to {right_place}: here it has no effect.",
        hint=hint,
        at=element,
        path=path,
    )
