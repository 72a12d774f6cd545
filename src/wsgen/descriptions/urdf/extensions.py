"""What `<gazebo>` elements do to the links and joints of a robot, as Gazebo does it.

sdformat finds the collision that a value is for by names: a collision that has a name of its own
which does not begin with that of its link gets nothing, nor does one of a lumped link, unless it
has no name or begins with the link's (`InsertSDFExtensionCollision` of parser_urdf.cc).
"""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from wsgen.descriptions.urdf.gazebo import (
    DIRECTION,
    DIRECTION_IN,
    FALSEHOODS,
    FRICTION,
    LUMPING_KEYS,
    SURFACE_KEYS,
    TRUTHS,
)
from wsgen.descriptions.urdf.values import NUMBER, leading_float, leading_integer
from wsgen.model.robot import (
    GAZEBO_COLORS,
    STOP,
    GazeboTag,
    Joint,
    JointLimit,
    JointType,
    Rgba,
    Surface,
    painted,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from wsgen.model.robot import Collision, Link, Visual


PRESERVES, HOLDS = LUMPING_KEYS
OF_SPRINGS_AND_STOPS = ("springStiffness", "springReference", "stopErp", "stopCfm")
TRUE = frozenset(("true", "yes", "1"))  # as sdformat reads its own keys, in lower case
FALSE = frozenset(("false", "no", "0"))
LUMPED = "_fixed_joint_lump__"  # what sdformat puts into the names of lumped shapes
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

# Of a fixed joint whose lumping is disabled: no movement, by any force.
HELD = JointLimit(lower=0.0, upper=0.0, effort=-1.0, velocity=-1.0)
# Gazebo makes no joint of these: what hangs on them is loose.
LOOSE = frozenset((JointType.FLOATING, JointType.PLANAR))


def _is_true(text: str | None) -> bool:
    """Whether sdformat takes the text of one of its own keys for true."""
    return text is not None and text.lower() in TRUE


def kept_joints(tags: Sequence[GazeboTag]) -> dict[str, str]:
    """What keeps fixed joints from being lumped: the key that does, by the joint.

    With both, a joint is preserved.
    """
    kept: dict[str, str] = {}
    for key in (HOLDS, PRESERVES):
        kept |= {
            tag.reference: key for tag in tags if tag.reference and _is_true(tag.values.get(key))
        }
    return kept


def is_static(tags: Iterable[GazeboTag]) -> bool:
    """Whether the robot as a whole cannot move; the last setting counts."""
    said = [tag.values["static"] for tag in tags if not tag.reference and "static" in tag.values]
    return bool(said) and _is_true(said[-1])


def extend_joints(
    joints: Iterable[Joint], tags: Sequence[GazeboTag], body_of: Mapping[str, str]
) -> list[Joint]:
    """The joints with what `<gazebo>` elements give them, or make of them.

    Args:
        joints: Those that are left when all else is lumped.
        tags: All of the robot.
        body_of: By link, the one that it is lumped into, or itself.
    """
    about = _by_name(tags)
    left = (_sprung(_turning(joint), about.get(joint.name, ())) for joint in joints)
    return [_on_ball(joint, tags, body_of) for joint in left]


def _sprung(joint: Joint, tags: Iterable[GazeboTag]) -> Joint:
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


def _turning(joint: Joint) -> Joint:
    """A fixed joint whose lumping is disabled becomes a revolute one that cannot turn."""
    if joint.type is not JointType.FIXED or joint.kept_by != HOLDS:
        return joint
    return replace(joint, type=JointType.REVOLUTE, limit=HELD, axis_in_joint=(0.0, 0.0, 1.0))


def _on_ball(joint: Joint, tags: Sequence[GazeboTag], body_of: Mapping[str, str]) -> Joint:
    """What would be loose, on the ball joint of SDF that holds it where the URDF has it."""
    if joint.type not in LOOSE:
        return joint
    ball = next(
        (
            one
            for one in (one for tag in tags for one in tag.joints if one.is_ball)
            if one.ends.get("child") == joint.child
            and body_of.get(one.ends.get("parent", "")) == joint.parent
        ),
        None,
    )
    if ball is None:
        return joint
    return Joint(
        name=ball.name,
        type=JointType.BALL,
        parent=joint.parent,
        child=joint.child,
        pose_in_parent=joint.pose_in_parent,
        line=ball.line,
    )


def extend_links(
    links: Mapping[str, Link], parts: Mapping[str, Sequence[str]], tags: Sequence[GazeboTag]
) -> dict[str, tuple[Link, list[tuple[GazeboTag, str]]]]:
    """The links with what `<gazebo>` elements give them, and the elements that give them nothing.

    Args:
        links: What is left when all else is lumped, by name.
        parts: The names of what is in each, in sdformat's order: its own, then the lumped ones.
        tags: All of the robot.

    Returns:
        By link, itself and the tags with values for surfaces that none of its collisions gets,
        with the first such key.
    """
    # What holds for links without a setting of their own; the first one counts.
    self_collide = next(
        (
            tag.values["self_collide"].lower() in TRUTHS
            for tag in tags
            if not tag.reference and "self_collide" in tag.values
        ),
        False,
    )
    about = _by_name(tags)
    return {
        name: _extend(
            link,
            [tag for part in parts[name] for tag in about.get(part, ())],
            self_collide=self_collide,
        )
        for name, link in links.items()
    }


def _by_name(tags: Iterable[GazeboTag]) -> dict[str, list[GazeboTag]]:
    """The tags about links and joints, by their names."""
    about: dict[str, list[GazeboTag]] = {}
    for tag in tags:
        if tag.reference:
            about.setdefault(tag.reference, []).append(tag)
    return about


def _extend(
    link: Link, tags: Sequence[GazeboTag], *, self_collide: bool
) -> tuple[Link, list[tuple[GazeboTag, str]]]:
    if not tags and not self_collide:
        return link, []
    gravity, collide, decay = _flags(tags)
    about = _by_reference(tags)
    of_collisions = [
        _meant(link, collision.name, "_collision", index, about)
        for index, collision in enumerate(link.collisions)
    ]
    reached = {id(tag) for meant in of_collisions for tag in meant}
    extended = replace(
        link,
        # Of repeated elements the first one counts.
        gravity=gravity[0] if gravity else link.gravity,
        self_collide=collide[0] if collide else link.self_collide or self_collide,
        velocity_decay=decay[0] if decay else link.velocity_decay,
        is_kinematic=any(tag.values.get("kinematic", "").lower() in TRUTHS for tag in tags),
        collisions=tuple(map(_with_surface, link.collisions, of_collisions)),
        visuals=tuple(
            _with_look(visual, _meant(link, visual.name, "_visual", index, about))
            for index, visual in enumerate(link.visuals)
        ),
    )
    return extended, [
        (tag, keys[0])
        for tag in tags
        if id(tag) not in reached
        and (keys := [key for key in (*SURFACE_KEYS, "collision") if key in tag.values])
    ]


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
            collide = [*collide[1:], _is_true(values["selfCollide"])]
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
