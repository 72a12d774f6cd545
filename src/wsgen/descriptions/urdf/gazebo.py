"""`<gazebo>` elements: read and check them, and apply them to links and joints as Gazebo does.

The keys are those that sdformat reads itself (`parser_urdf.cc`, ParseSDFExtension); everything
else is copied into the SDF as it is, of which wsgen takes the part that it simulates. `read_tags`
reads and checks; what the values do depends on what is lumped, and is applied then.

sdformat finds the collision that a value is for by names: a collision that has a name of its own
which does not begin with that of its link gets nothing, nor does one of a lumped link, unless it
has no name or begins with the link's (`InsertSDFExtensionCollision` of parser_urdf.cc).
"""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import TYPE_CHECKING, Any

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
from wsgen.model.robot import (
    GAZEBO_COLORS,
    STOP,
    GazeboTag,
    Plugin,
    Rgba,
    SdfJoint,
    Sensor,
    Surface,
    painted,
)
from wsgen.text.suggestions import did_you_mean, nearest
from wsgen.text.xmltree import child_text, child_texts, children, gz_attribute

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from wsgen.descriptions.urdf.values import Collector
    from wsgen.model.robot import Collision, Joint, Link, Visual
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
OF_SPRINGS_AND_STOPS = ("springStiffness", "springReference", "stopErp", "stopCfm")
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
TRUE = frozenset(("true", "yes", "1"))  # as sdformat reads its own keys, in lower case
FALSE = frozenset(("false", "no", "0"))
LUMPED = "_fixed_joint_lump__"  # what sdformat puts into the names of lumped shapes
FRICTION = "collision/surface/friction/ode/"
# In copied SDF; of <fdir1> in the <gazebo> of a link, sdformat leaves the attribute out.
DIRECTION = FRICTION + "fdir1"
DIRECTION_IN = DIRECTION + "@gz:expressed_in"
CONTACT = "collision/surface/contact/ode/"
# The field of Surface that a key sets, and the one of the same thing in copied SDF.
FIELDS = {"mu1": "mu1", "mu2": "mu2", "kp": "kp", "kd": "kd", "minDepth": "min_depth"}
SDF_FIELDS = {
    FRICTION + "mu": "mu1",
    FRICTION + "mu2": "mu2",
    CONTACT + "kp": "kp",
    CONTACT + "kd": "kd",
    CONTACT + "min_depth": "min_depth",
}
Direction = dict[str, Any]  # fields of Surface
# <laserRetro> is for collisions alone (gazebosim/sdformat, src/parser_urdf.cc,
# `InsertSDFExtensionCollision`): lidars on a GPU, which see visuals, do not see it.
RETRO_OF_COLLISION = ("collision/laser_retro", "laserRetro")
RETRO_OF_VISUAL = ("visual/laser_retro",)
TagsOfBody = dict[str, list[tuple[int, GazeboTag]]]  # by reference, with their places in order

UNKNOWN_REFERENCE = Rule(
    code="ROB030",
    name="unknown-reference",
    severity=Severity.WARNING,
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="A `<gazebo>` element refers to a link or joint that does not exist.",
    why=(
        "Gazebo silently ignores the element: the link keeps its default friction, color and "
        "sensors."
    ),
    example='<link name="base_link"/>\n<gazebo reference="base">\n  <mu1>0.2</mu1>\n</gazebo>',
    instead=(
        '<link name="base_link"/>\n<gazebo reference="base_link">\n  <mu1>0.2</mu1>\n</gazebo>'
    ),
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
    why=(
        "Gazebo converts these texts without a check: it terminates with an exception, refuses "
        "the robot, or reads only the beginning of the text."
    ),
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
    why=(
        "Some settings apply to links, some to joints and some to the whole robot. Gazebo "
        "silently ignores the others."
    ),
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
    why=(
        "Gazebo adds these SDF elements to the robot, which then has parts that are missing in "
        "wsgen's simulation."
    ),
    example=(
        "<gazebo>\n"
        '  <joint name="closing_joint" type="revolute">\n'
        "    <parent>arm</parent>\n"
        "    <child>hand</child>\n"
        "  </joint>\n"
        "</gazebo>"
    ),
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


def is_true(text: str | None) -> bool:
    """Whether sdformat takes the text of one of its own keys for true."""
    return text is not None and text.lower() in TRUE


def is_static(tags: Iterable[GazeboTag]) -> bool:
    """Whether the robot as a whole cannot move; the last setting counts."""
    said = [tag.values["static"] for tag in tags if not tag.reference and "static" in tag.values]
    return bool(said) and is_true(said[-1])


def collides_with_itself(tags: Iterable[GazeboTag]) -> bool:
    """What holds for links without a setting of their own; the first one counts."""
    return next(
        (
            tag.values["self_collide"].lower() in TRUTHS
            for tag in tags
            if not tag.reference and "self_collide" in tag.values
        ),
        False,
    )


def with_springs_and_stops(joint: Joint, tags: Iterable[GazeboTag]) -> Joint:
    """The joint with the spring and stops that the tags about it give it; the last one counts."""
    said: dict[str, float] = {}
    for tag in tags:
        numbers = ((key, _finite(tag.values.get(key))) for key in OF_SPRINGS_AND_STOPS)
        said |= {key: number for key, number in numbers if number is not None}
    if not said:
        return joint
    stop = (said.get("stopErp", STOP[0]), said.get("stopCfm", STOP[1]))
    return replace(
        joint,
        spring_stiffness=said.get("springStiffness", joint.spring_stiffness),
        spring_reference=said.get("springReference", joint.spring_reference),
        stop=None if stop == STOP else stop,
    )


def with_extensions(link: Link, tags: Sequence[GazeboTag], *, self_collide: bool) -> Link:
    """The link with what the tags about it, and about those lumped into it, give it.

    `tags` are in sdformat's order: the link's own, then those of the lumped links as they came,
    each with its reference as written. `self_collide` is what holds where none says anything of it.
    """
    if not tags and not self_collide:
        return link
    gravity, collide, decay = _flags(tags)
    about = _by_reference(tags)
    return replace(
        link,
        # Of repeated elements the first one counts.
        gravity=gravity[0] if gravity else link.gravity,
        self_collide=collide[0] if collide else link.self_collide or self_collide,
        velocity_decay=decay[0] if decay else link.velocity_decay,
        is_kinematic=any(tag.values.get("kinematic", "").lower() in TRUTHS for tag in tags),
        collisions=tuple(
            _with_surface(collision, _meant(link, collision.name, "_collision", index, about))
            for index, collision in enumerate(link.collisions)
        ),
        visuals=tuple(
            _with_look(visual, _meant(link, visual.name, "_visual", index, about))
            for index, visual in enumerate(link.visuals)
        ),
    )


def _flags(
    tags: Iterable[GazeboTag],
) -> tuple[list[bool], list[bool], list[tuple[float, float]]]:
    """The elements <gravity>, <self_collide> and <velocity_decay> that the link gets.

    A key takes the place of the first such element there is, and goes to the end; copied SDF comes
    behind the last.
    """
    gravity: list[bool] = []
    collide: list[bool] = []
    decay: list[tuple[float, float]] = []
    for tag in tags:
        values = tag.values
        if "turnGravityOff" in values:
            gravity = [*gravity[1:], values["turnGravityOff"].lower() in FALSE]
        if "selfCollide" in values:
            collide = [*collide[1:], is_true(values["selfCollide"])]
        if "dampingFactor" in values:
            decay.append((_finite(values["dampingFactor"]) or 0.0,) * 2)
        if "gravity" in values:
            gravity.append(values["gravity"].lower() not in FALSEHOODS)
        if "self_collide" in values:
            collide.append(values["self_collide"].lower() in TRUTHS)
        if "velocity_decay" in values:
            linear, angular = (
                _finite(values.get(f"velocity_decay/{motion}")) or 0.0
                for motion in ("linear", "angular")
            )
            decay.append((linear, angular))
    return gravity, collide, decay


def without_effect(link: Link, tags: Sequence[GazeboTag]) -> list[tuple[GazeboTag, str]]:
    """Tags with values for surfaces that none of the collisions gets, with the first such key."""
    by_reference = _by_reference(tags)
    reached = {
        id(tag)
        for index, collision in enumerate(link.collisions)
        for tag in _meant(link, collision.name, "_collision", index, by_reference)
    }
    return [
        (tag, keys[0])
        for tag in tags
        if id(tag) not in reached
        and (keys := [key for key in (*SURFACE_KEYS, "collision") if key in tag.values])
    ]


def _by_reference(tags: Iterable[GazeboTag]) -> TagsOfBody:
    by_reference: TagsOfBody = {}
    for place, tag in enumerate(tags):
        by_reference.setdefault(tag.reference or "", []).append((place, tag))
    return by_reference


def _meant(
    link: Link, name: str | None, ending: str, index: int, tags: TagsOfBody
) -> list[GazeboTag]:
    """The tags that are for one shape of a link, by its name in the SDF."""
    full = (name or link.name) + ending + (f"_{index}" if index else "")
    if not full.startswith(link.name):
        full = link.name + LUMPED + full
    if LUMPED not in full:
        return [tag for _, tag in tags.get(link.name, ())]
    # Any link that is named behind the mark and before the ending may be meant.
    references = {
        piece[: found.start()]
        for piece in full.split(LUMPED)[1:]
        for found in re.finditer(ending, piece)
    } - {link.name}
    meant = sorted(
        (entry for reference in references for entry in tags.get(reference, ())),
        key=lambda entry: entry[0],
    )
    return [tag for _, tag in meant]


def _with_surface(collision: Collision, tags: Sequence[GazeboTag]) -> Collision:
    if not tags:
        return collision
    numbers: dict[str, float] = {}
    contacts: list[int] = []
    direction: Direction = {}
    for tag in tags:
        if "collision/surface" in tag.values:  # takes the place of the whole
            numbers.clear()
            direction = {}
        direction = _direction(tag) or direction
        for fields in (SDF_FIELDS, FIELDS):
            for key, field in fields.items():
                number = _finite(tag.values.get(key))
                if number is not None:
                    numbers[field] = number
        if "collision/max_contacts" in tag.values:
            contacts.append(leading_integer(tag.values["collision/max_contacts"]) or 0)
        if "maxContacts" in tag.values:
            contacts = [*contacts[1:], leading_integer(tag.values["maxContacts"]) or 0]
    return replace(
        collision,
        laser_retro=_last_number(tags, RETRO_OF_COLLISION, collision.laser_retro),
        surface=Surface(
            mu1=numbers.get("mu1", 1.0),
            mu2=numbers.get("mu2", 1.0),
            kp=numbers.get("kp"),
            kd=numbers.get("kd"),
            min_depth=numbers.get("min_depth"),
            max_contacts=contacts[0] if contacts else None,
            **direction,
        ),
    )


def _direction(tag: GazeboTag) -> Direction:
    """The first direction of friction that a tag gives, as fields of a surface."""
    for key, link in (("fdir1", None), (DIRECTION, tag.values.get(DIRECTION_IN))):
        words = tag.values.get(key, "").split()
        numbers = [number for number in map(_finite, words) if number is not None]
        if len(words) == len(numbers) == 3 and any(numbers):  # noqa: PLR2004  x, y, z
            return {"fdir1": (numbers[0], numbers[1], numbers[2]), "fdir1_in": link}
    return {}


def _with_look(visual: Visual, tags: Sequence[GazeboTag]) -> Visual:
    rgba, name, colors = visual.rgba, "", dict.fromkeys(("ambient", "diffuse", "emissive"))
    for tag in tags:
        name = tag.values.get("material", name)
        rgba = GAZEBO_COLORS.get(tag.values.get("material", ""), rgba)
        for key in colors:
            colors[key] = _color(tag.values.get(f"visual/material/{key}")) or colors[key]
        rgba = _color(tag.values.get("visual/material/diffuse")) or rgba
    is_painted = name in GAZEBO_COLORS or any(colors.values())
    paint = painted(name, *colors.values()) if is_painted else visual.paint
    retro = _last_number(tags, RETRO_OF_VISUAL, visual.laser_retro)
    if (rgba, paint, retro) == (visual.rgba, visual.paint, visual.laser_retro):
        return visual
    return replace(visual, rgba=rgba, paint=paint, laser_retro=retro)


def _color(text: str | None) -> Rgba | None:
    """Red, green, blue and alpha, from 0 to 1, of three or four numbers."""
    words = (text or "").split()
    if len(words) not in {3, 4} or not all(NUMBER.fullmatch(word) for word in words):
        return None
    red, green, blue, alpha = (min(1.0, max(0.0, float(word))) for word in (*words, "1")[:4])
    return (red, green, blue, alpha)


def _last_number(tags: Iterable[GazeboTag], keys: Sequence[str], default: float) -> float:
    """The last number that the tags give for one of the keys."""
    found = default
    for tag in tags:
        for key in keys:
            number = _finite(tag.values.get(key))
            found = found if number is None else number
    return found


def _finite(text: str | None) -> float | None:
    """The number that Gazebo reads; None where there is none, or no engine could use it."""
    number = None if text is None else leading_float(text)
    return number if number is not None and math.isfinite(number) else None
