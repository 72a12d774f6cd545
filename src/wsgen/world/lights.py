"""Lights of a world, as far as a picture needs them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from wsgen.model.transform import rotate, rotation_of_rpy
from wsgen.model.world import SUN_COLOUR, SUN_DIRECTION
from wsgen.world.included import SUN, is_sun
from wsgen.world.values import first, read_numbers, read_pose, triple, truth, word
from wsgen.xmltree import children

if TYPE_CHECKING:
    from wsgen.model.transform import Vector
    from wsgen.world.source import Source
    from wsgen.xmltree import Element

DOWN = (0.0, 0.0, -1.0)
WHITE = (1.0, 1.0, 1.0)


class Lights(NamedTuple):
    """What shines in a world."""

    names: tuple[str, ...]
    sun_direction: Vector  # of the first one from above: where it goes, of length 1
    sun_colour: Vector  # of that one: red, green, blue, 0 to 1


def read_lights(source: Source, world: Element) -> Lights:
    """The lights of a world, an included sun among them."""
    names = []
    suns = []
    for element in children(world, "include", "light"):
        if element.tag == "light":
            names.append(element.get("name") or "")
            sun = _sun(source, element)
            if sun is not None:
                suns.append(sun)
        elif is_sun(word(element, "uri")):
            names.append(SUN)
            suns.append((SUN_DIRECTION, SUN_COLOUR))
    direction, colour = suns[0] if suns else (SUN_DIRECTION, SUN_COLOUR)
    return Lights(tuple(names), direction, colour)


def _sun(source: Source, light: Element) -> tuple[Vector, Vector] | None:
    """Direction and colour of a directional light that shines down; None for any other."""
    is_on = truth(source, light, "light_on", default=True)
    if light.get("type") != "directional" or not is_on:
        return None
    pose, _ = read_pose(source, light)
    written = triple(source, light, "direction", default=DOWN)
    x, y, z = rotate(rotation_of_rpy(pose.rpy), written)
    length = math.hypot(x, y, z)
    if not 0 < length < math.inf or z >= 0:
        return None
    return (x / length, y / length, z / length), _colour(source, light)


def _colour(source: Source, light: Element) -> Vector:
    diffuse = first(light, "diffuse")
    if diffuse is None:
        return WHITE
    count = 3 if len((diffuse.text or "").split()) == 3 else 4  # noqa: PLR2004  rgb or rgba
    numbers = read_numbers(source, diffuse, count)
    if numbers is None:
        return WHITE
    red, green, blue = (min(1.0, max(0.0, part)) for part in numbers[:3])
    return (red, green, blue)
