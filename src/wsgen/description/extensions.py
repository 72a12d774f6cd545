"""What `<gazebo>` elements do to the links and joints that Gazebo builds.

sdformat finds the collision that a value is for by names: a collision that has a name of its own
which does not begin with that of its link gets nothing, nor does one of a lumped link, unless it
has no name or begins with the link's (`InsertSDFExtensionCollision` of parser_urdf.cc).
"""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.description.gazebo_values import FALSEHOODS, SURFACE_KEYS, TRUTHS
from wsgen.description.numbers import NUMBER, leading_float, leading_integer
from wsgen.model.colours import GAZEBO_COLOURS
from wsgen.model.robot import Surface

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from wsgen.model.robot import Collision, GazeboTag, Joint, Link, Visual

    TagsOfBody = dict[str, list[tuple[int, GazeboTag]]]  # by reference, with their places in order

TRUE = frozenset(("true", "yes", "1"))  # as sdformat reads its own keys, in lower case
FALSE = frozenset(("false", "no", "0"))
LUMPED = "_fixed_joint_lump__"  # what sdformat puts into the names of lumped shapes

FRICTION = "collision/surface/friction/ode/"
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


def is_true(text: str | None) -> bool:
    """Whether sdformat takes the text of one of its own keys for true."""
    return text is not None and text.lower() in TRUE


def is_static(tags: Iterable[GazeboTag]) -> bool:
    """Whether the robot as a whole cannot move; the last word counts."""
    said = [tag.values["static"] for tag in tags if not tag.reference and "static" in tag.values]
    return bool(said) and is_true(said[-1])


def collides_with_itself(tags: Iterable[GazeboTag]) -> bool:
    """What holds for links that say nothing of it; the first word counts."""
    return next(
        (
            tag.values["self_collide"].lower() in TRUTHS
            for tag in tags
            if not tag.reference and "self_collide" in tag.values
        ),
        False,
    )


def with_springs(joint: Joint, tags: Iterable[GazeboTag]) -> Joint:
    """The joint with the spring that the tags about it give it; the last word counts."""
    stiffness, reference = joint.spring_stiffness, joint.spring_reference
    for tag in tags:
        said = _finite(tag.values.get("springStiffness"))
        stiffness = stiffness if said is None else said
        said = _finite(tag.values.get("springReference"))
        reference = reference if said is None else said
    return replace(joint, spring_stiffness=stiffness, spring_reference=reference)


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
        collisions=tuple(
            _with_surface(collision, _meant(link, collision.name, "_collision", index, about))
            for index, collision in enumerate(link.collisions)
        ),
        visuals=tuple(
            _with_colour(visual, _meant(link, visual.name, "_visual", index, about))
            for index, visual in enumerate(link.visuals)
        ),
    )


def _flags(tags: Iterable[GazeboTag]) -> tuple[list[bool], list[bool], list[float]]:
    """The elements <gravity>, <self_collide> and <velocity_decay> that the link gets.

    A key takes the place of the first such element there is, and goes to the end; copied SDF comes
    behind the last.
    """
    gravity: list[bool] = []
    collide: list[bool] = []
    decay: list[float] = []
    for tag in tags:
        values = tag.values
        if "turnGravityOff" in values:
            gravity = [*gravity[1:], values["turnGravityOff"].lower() in FALSE]
        if "selfCollide" in values:
            collide = [*collide[1:], is_true(values["selfCollide"])]
        if "dampingFactor" in values:
            decay.append(_finite(values["dampingFactor"]) or 0.0)
        if "gravity" in values:
            gravity.append(values["gravity"].lower() not in FALSEHOODS)
        if "self_collide" in values:
            collide.append(values["self_collide"].lower() in TRUTHS)
        if "velocity_decay" in values:
            parts = (values.get(f"velocity_decay/{motion}") for motion in ("linear", "angular"))
            decay.append(max(_finite(part) or 0.0 for part in parts))
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
    for tag in tags:
        if "collision/surface" in tag.values:  # takes the place of the whole
            numbers.clear()
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
        surface=Surface(
            mu1=numbers.get("mu1", 1.0),
            mu2=numbers.get("mu2", 1.0),
            kp=numbers.get("kp"),
            kd=numbers.get("kd"),
            min_depth=numbers.get("min_depth"),
            max_contacts=contacts[0] if contacts else None,
        ),
    )


def _with_colour(visual: Visual, tags: Sequence[GazeboTag]) -> Visual:
    rgba = visual.rgba
    for tag in tags:
        rgba = GAZEBO_COLOURS.get(tag.values.get("material", ""), rgba)
        words = tag.values.get("visual/material/diffuse", "").split()
        if len(words) in {3, 4} and all(NUMBER.fullmatch(word) for word in words):
            red, green, blue, alpha = (
                min(1.0, max(0.0, float(word))) for word in (*words, "1")[:4]
            )
            rgba = (red, green, blue, alpha)
    return visual if rgba == visual.rgba else replace(visual, rgba=rgba)


def _finite(text: str | None) -> float | None:
    """The number that Gazebo reads; None where there is none, or no engine could use it."""
    number = None if text is None else leading_float(text)
    return number if number is not None and math.isfinite(number) else None
