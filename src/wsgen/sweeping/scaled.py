"""The text of a robot, URDF or SDF, with other masses, inertias and frictions.

Only the numbers change: comments and layout stay. An engine makes of the new text what `apply`
makes of the robot of the old one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.checks.fixes.source import Edit, apply
from wsgen.checks.fixes.xml_source import children, read_tags

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from wsgen.checks.fixes.xml_source import Span, Tag


FRICTION = ("surface", "friction", "ode")  # of a <collision> in SDF, around <mu> and <mu2>
FRICTION_OF_GAZEBO = ("mu1", "mu2")  # in the <gazebo> of a link
MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
COEFFICIENTS = ("mu", "mu2")
DEFAULT_FRICTION = 1.0


def scale_text(
    text: str,
    *,
    mass: float = 1.0,
    inertia: float = 1.0,
    friction: float = 1.0,
    ground: float | None = None,
) -> str:
    """The text with these factors on all masses, moments of inertia and frictions.

    Args:
        text: A URDF, expanded, or an SDF model.
        mass: On the mass and the inertia of each link.
        inertia: On the inertia alone.
        friction: On the friction coefficients.
        ground: The friction coefficient of the ground; where it is the smaller one, it is that of
            the contact.
    """
    tags = read_tags(text)
    edits: list[Edit] = []
    if (mass, inertia) != (1.0, 1.0):
        edits += _of_inertials(text, tags, mass, mass * inertia)
    if friction != 1.0 or ground is not None:
        highest = float("inf") if ground is None else ground
        is_urdf = any(tag.name == "robot" and not tag.path for tag in tags)
        edit = _of_urdf if is_urdf else _of_sdf
        edits += edit(text, tags, friction, highest)
    return apply(text, edits)


def _of_inertials(text: str, tags: Sequence[Tag], mass: float, inertia: float) -> Iterator[Edit]:
    for tag in tags:
        if not tag.path or tag.path[-1].name not in {"inertial", "inertia"}:
            continue
        if tag.name == "mass":
            yield from _scaled(text, _number(tag), mass)
        elif tag.name == "inertia":
            for name in MOMENTS:
                if name in tag.attributes:
                    yield from _scaled(text, tag.attributes[name].value, inertia)
        elif tag.name in MOMENTS:
            yield from _scaled(text, tag.content(), inertia)


def _number(tag: Tag) -> Span:
    """Where the number of a `<mass>` is: URDF has it in an attribute, SDF as text."""
    value = tag.attributes.get("value")
    return tag.content() if value is None else value.value


def _scaled(text: str, place: Span, factor: float, highest: float = float("inf")) -> Iterator[Edit]:
    try:
        number = float(text[place.start : place.end])
    except ValueError:  # not a number, which is reported where the robot is read
        return
    yield _edit(place.start, place.end, _written(min(highest, factor * number)))


def _edit(start: int, end: int, text: str) -> Edit:
    return Edit(start=start, end=end, text=text)


def _written(number: float) -> str:
    return f"{number:.12g}"


def _of_urdf(text: str, tags: Sequence[Tag], friction: float, highest: float) -> Iterator[Edit]:
    """Frictions in `<gazebo>` elements; links without any get one."""
    given: dict[str, set[str]] = {}  # coefficients, by the link that they are for
    for tag in tags:
        around = [one for one in tag.path if one.name == "gazebo"]
        if not around:
            continue
        is_in_collision = tuple(one.name for one in tag.path[-len(FRICTION) :]) == FRICTION
        if tag.name in FRICTION_OF_GAZEBO or (is_in_collision and tag.name in COEFFICIENTS):
            reference = around[0].attributes.get("reference")
            coefficient = "mu1" if tag.name == "mu" else tag.name
            given.setdefault(reference.text if reference else "", set()).add(coefficient)
            yield from _scaled(text, tag.content(), friction, highest)
    default = _written(min(highest, friction * DEFAULT_FRICTION))
    if float(default) == DEFAULT_FRICTION:
        return
    (robot,) = (tag for tag in tags if tag.name == "robot" and not tag.path)
    end = robot.content().end
    solid = {tag.path[-1].start for tag in tags if tag.name == "collision" and tag.path}
    for link in children(tags, robot):
        name = link.attributes.get("name")
        if link.name != "link" or name is None or link.start not in solid:
            continue
        missing = [one for one in FRICTION_OF_GAZEBO if one not in given.get(name.text, ())]
        if missing:
            values = "".join(f"<{one}>{default}</{one}>" for one in missing)
            yield _edit(end, end, f'  <gazebo reference="{name.text}">{values}</gazebo>\n')


def _of_sdf(text: str, tags: Sequence[Tag], friction: float, highest: float) -> Iterator[Edit]:
    """Frictions in the `<surface>` of collisions; those without any get one."""
    default = _written(min(highest, friction * DEFAULT_FRICTION))
    inside: dict[Span, list[Tag]] = {}  # elements, by the start of the one around them
    for tag in tags:
        if tag.path:
            inside.setdefault(tag.path[-1].start, []).append(tag)
    for collision in tags:
        if collision.name != "collision" or collision.end is None:
            continue
        inner, around = collision, list[str](FRICTION)
        while around:
            found = [one for one in inside.get(inner.start, ()) if one.name == around[0]]
            if not found or found[0].end is None:
                break
            inner = found[0]
            del around[0]
        there = [one for one in inside.get(inner.start, ()) if one.name in COEFFICIENTS]
        for tag in there:
            yield from _scaled(text, tag.content(), friction, highest)
        missing = [one for one in COEFFICIENTS if one not in {tag.name for tag in there}]
        if missing and float(default) != DEFAULT_FRICTION:
            opened = "".join(f"<{one}>" for one in around)
            closed = "".join(f"</{one}>" for one in reversed(around))
            values = "".join(f"<{one}>{default}</{one}>" for one in missing)
            end = inner.content().end
            yield _edit(end, end, f"{opened}{values}{closed}")
