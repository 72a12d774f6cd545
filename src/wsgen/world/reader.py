"""What the element `<world>` says beside the models that stand in it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen import xmltree
from wsgen.model.world import PlacedModel, World
from wsgen.world.included import GROUND_PLANE, SUN
from wsgen.world.lights import read_lights
from wsgen.world.values import read_numbers

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.world.source import Source
    from wsgen.xmltree import Element

# What Gazebo starts with when no world is named: both generations ship one with sun and ground.
DEFAULT_WORLD = World(
    name="default",
    models=(PlacedModel(name=GROUND_PLANE, is_static=True),),
    has_ground_plane=True,
    lights=(SUN,),
)

STRONGEST_GRAVITY = 1000.0  # m/s²; at the surface of the Sun it is 274
LONGEST_STEP = 0.02  # s; with longer ones contacts are missed, and no engine is stable


def describe_world(
    source: Source, element: Element, models: Sequence[PlacedModel], *, has_ground: bool
) -> World:
    """The world of an element in which these models stand."""
    lights = read_lights(source, element)
    return World(
        name=element.get("name") or "default",
        file=source.file,
        gravity=_gravity(source, element),
        step=_step(source, element),
        models=tuple(models),
        has_ground_plane=has_ground,
        lights=lights.names,
        sun_direction=lights.sun_direction,
        sun_colour=lights.sun_colour,
        plugins=tuple(plugin.get("filename", "") for plugin in element.iter("plugin")),
    )


def check_is_carried(source: Source, element: Element, world: World) -> None:
    """Report a world without ground."""
    if not world.has_ground_plane:
        source.warning(
            "WLD006",
            "The world has no ground plane: whatever is spawned into it falls.",
            at=element,
            hint="Add <include><uri>model://ground_plane</uri></include> to the world.",
        )


def _gravity(source: Source, world: Element) -> tuple[float, float, float]:
    # Until SDF 1.5 it was part of <physics>.
    places = (world, *xmltree.children(world, "physics"))
    for element in (e for place in places for e in xmltree.children(place, "gravity")):
        numbers = read_numbers(source, element, 3, limit=STRONGEST_GRAVITY)
        if numbers:
            if numbers[2] >= 0:
                source.warning(
                    "WLD045",
                    "Nothing is pulled down in this world: gravity is "
                    f"{numbers[0]:g} {numbers[1]:g} {numbers[2]:g} m/s².",
                    at=element,
                    hint="On Earth it is <gravity>0 0 -9.8</gravity>.",
                )
            return (numbers[0], numbers[1], numbers[2])
    return DEFAULT_WORLD.gravity


def _step(source: Source, world: Element) -> float:
    for physics in xmltree.children(world, "physics"):
        for element in xmltree.children(physics, "max_step_size"):
            numbers = read_numbers(source, element, 1)
            if numbers and 0 < numbers[0] <= LONGEST_STEP:
                return numbers[0]
            if numbers:
                source.error(
                    "WLD007",
                    f"The physics step of {numbers[0]:g} s is not between 0 and "
                    f"{LONGEST_STEP:g} s.",
                    at=element,
                    hint="Gazebo's default is 0.001.",
                )
    return DEFAULT_WORLD.step
