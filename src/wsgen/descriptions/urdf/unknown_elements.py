"""Misspelled elements and attributes of a URDF, which programs silently ignore."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.descriptions.rules import MISSPELLED_ATTRIBUTE, MISSPELLED_ELEMENT
from wsgen.text import suggestions
from wsgen.text.tables import read_markup_names

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from wsgen.descriptions.urdf.values import Collector
    from wsgen.text.xmltree import Element


SHAPES = ("box", "cylinder", "sphere", "mesh")
# What urdfdom and sdformat look for in an element. Others are allowed, and many tools have some.
KNOWN, ATTRIBUTES = read_markup_names(__file__, "known-names.txt")
# Without which an element is refused.
REQUIRED = {
    "box": ("size",),
    "cylinder": ("radius", "length"),
    "sphere": ("radius",),
    "mesh": ("filename",),
    "mass": ("value",),
    "parent": ("link",),
    "child": ("link",),
}
OTHER_LENGTHS = frozenset(("diameter", "width"))  # twice a radius
# Attributes that some program or version of the format has.
OTHERS = frozenset(("type", "reference_position", "quat_xyzw", "convex", "id", "group"))
SHORT = 4  # letters; of words up to this length other orders and neighbors are compared
# So alike two words are, as difflib counts, that one is taken for the other: `parnt` and `parent`
# are at 0.91, `visuals` and `visual` at 0.92, `colour` and `color` at 0.91.
ALIKE = 0.8
# Attributes, among the few that one element has and lacks. Few people misspell the first letter,
# and those of other programs are as alike: `frame` is no `name` (0.67), `stiction` no `friction`
# (0.75), `power` no `lower` (0.8).
LIKE_ATTRIBUTE = 0.82
LIKE_INITIAL = 0.6  # with the same first letter

MOST_COMPARED = 500  # names; difflib takes its time
MOST_HINTS = 50  # diagnostics; with more of them, spelling is not the problem


def nearest_element(collector: Collector, name: str, known: Iterable[str]) -> str | None:
    """A known name that is nearly the same; None where there is none, or it would take too long."""
    if len(collector.diagnostics) > MOST_HINTS:
        return None
    alike = sorted(other for other in known if abs(len(other) - len(name)) <= len(name) // 3)
    return suggestions.nearest(name, alike[:MOST_COMPARED])


def check_spelling(collector: Collector, element: Element, path: str) -> None:
    """Report children, in the element and below it, whose names are nearly those of known ones."""
    _check_attributes(collector, element, path)
    known = KNOWN.get(str(element.tag), ())
    if element.tag == "gazebo":
        _check_reference(collector, element, path)
    for child in element:
        if not isinstance(child.tag, str):
            continue
        inside = f"{path}/{child.tag}"
        if element.tag == "robot":
            identifier = "reference" if child.tag == "gazebo" else "name"
            value = child.get(identifier)
            inside = child.tag if value is None else f"{child.tag}[@{identifier}='{value}']"
        if child.tag in known:
            if element.tag != "gazebo":  # what is in its elements is SDF
                check_spelling(collector, child, inside)
            continue
        near = meant_element(child.tag, known)
        if near is not None:
            collector.report_misspelled(
                MISSPELLED_ELEMENT,
                f"<{child.tag}> is not an element of <{element.tag}>: Gazebo silently ignores it.",
                hint=f"Did you mean <{near}>?",
                at=child,
                path=inside,
                owner=element,
                name=near,
            )


def meant_element(tag: str, known: Sequence[str]) -> str | None:
    """The element that a misspelled one must be; None where none is nearly the same."""
    near = [other for other in known if other.lower() == tag.lower()]
    near = near or [other for other in known if sorted(other) == sorted(tag)]
    near = near or [other for other in known if other == tag.replace("l", "1")]  # `mul`
    return near[0] if near else suggestions.nearest(tag, known, cutoff=ALIKE)


def _check_attributes(collector: Collector, element: Element, path: str) -> None:
    known = ATTRIBUTES.get(str(element.tag), ())
    lacking = [name for name in known if name not in element.attrib]
    others = [name for name in map(str, element.attrib) if name not in known]
    required = [name for name in REQUIRED.get(str(element.tag), ()) if name in lacking]
    is_only_one = len(required) == len(others) == 1 and others[0] not in OTHER_LENGTHS
    for name in others:
        meant = None if name in OTHERS else _meant(name, lacking)
        if meant is None and is_only_one and name not in OTHERS:
            meant = required[0]
        if meant is not None:
            collector.report_misspelled(
                MISSPELLED_ATTRIBUTE,
                f"`{name}` is not an attribute of <{element.tag}>: Gazebo silently ignores it.",
                hint=suggestions.did_you_mean(meant),
                at=element,
                path=f"{path}/@{name}",
                owner=element,
                name=meant,
            )


def _meant(name: str, lacking: Sequence[str]) -> str | None:
    """The attribute that a misspelled one must be, of those that the element lacks."""
    near = [other for other in lacking if other.lower() == name.lower()]
    if len(name) <= SHORT:  # too few letters for a likeness
        near = near or [other for other in lacking if sorted(other) == sorted(name.lower())]
    if near:
        return near[0]
    alike = [other for other in lacking if other[0] == name[:1].lower()]
    return suggestions.nearest(name, lacking, cutoff=LIKE_ATTRIBUTE) or suggestions.nearest(
        name, alike, cutoff=LIKE_INITIAL
    )


def _check_reference(collector: Collector, element: Element, path: str) -> None:
    """Report what should be called `reference`: without it the element is about the whole robot."""
    for attribute in map(str, element.attrib):
        if attribute != "reference" and "reference".startswith(attribute.lower()[:3]):
            collector.report(
                MISSPELLED_ELEMENT,
                f"`{attribute}` is not an attribute of <gazebo>: Gazebo silently ignores it and "
                "applies the element to the whole robot.",
                hint=suggestions.did_you_mean("reference"),
                at=element,
                path=path,
            )
