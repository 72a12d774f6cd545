"""`<material>` and `<surface>` of SDF: how shapes look, and how they touch."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.model.colours import GAZEBO_COLOURS
from wsgen.model.robot import Surface
from wsgen.world.values import first, number, optional_number, read_numbers, word

if TYPE_CHECKING:
    from wsgen.world.source import Source
    from wsgen.xmltree import Element

Rgba = tuple[float, float, float, float]

MOST_CONTACTS = 10_000  # of two shapes; more is a slip


def read_colour(source: Source, visual: Element) -> Rgba | None:
    """Diffuse, else what the name of a script stands for, else ambient."""
    material = first(visual, "material")
    if material is None:
        return None
    script = GAZEBO_COLOURS.get(word(material, "script", "name"))
    colour = _rgba(source, material, "diffuse") or script or _rgba(source, material, "ambient")
    transparency = number(source, visual, "transparency", default=0.0)
    if colour is None or transparency == 0:
        return colour
    return (*colour[:3], min(1.0, max(0.0, colour[3] * (1 - transparency))))


def read_surface(source: Source, collision: Element) -> Surface:
    """How a collision touches others."""
    surface = first(collision, "surface")
    contacts = optional_number(source, collision, "max_contacts")
    if surface is None and contacts is None:
        return Surface()
    place = collision if surface is None else surface
    return Surface(
        mu1=max(0.0, number(source, place, "friction", "ode", "mu", default=1.0)),
        mu2=max(0.0, number(source, place, "friction", "ode", "mu2", default=1.0)),
        kp=optional_number(source, place, "contact", "ode", "kp"),
        kd=optional_number(source, place, "contact", "ode", "kd"),
        min_depth=optional_number(source, place, "contact", "ode", "min_depth"),
        max_contacts=None if contacts is None else int(min(max(contacts, 0), MOST_CONTACTS)),
    )


def _rgba(source: Source, material: Element, tag: str) -> Rgba | None:
    element = first(material, tag)
    words = [] if element is None else (element.text or "").split()
    if element is None or not words:
        return None
    numbers = read_numbers(source, element, 3 if len(words) == 3 else 4)  # noqa: PLR2004  rgb or rgba
    if numbers is None:
        return None
    red, green, blue, alpha = (min(1.0, max(0.0, part)) for part in (*numbers, 1.0)[:4])
    return (red, green, blue, alpha)
