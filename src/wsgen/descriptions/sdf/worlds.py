"""Gravity, physics step, lights and plugins of a `<world>`: everything but its models."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.descriptions.sdf.includes import GROUND_PLANE, GROUND_PLANE_FRICTION, is_sun
from wsgen.descriptions.sdf.source import line_of
from wsgen.descriptions.sdf.values import first, read_numbers, read_pose, triple, truth, word
from wsgen.diagnostics import Measured, Rule, Severity
from wsgen.gazebo.plugins import carries
from wsgen.gazebo.systems import is_of_gz
from wsgen.model.transform import rotate, rotation_of_rpy
from wsgen.model.world import SUN_COLOR, SUN_DIRECTION, PlacedModel, World
from wsgen.text import xmltree
from wsgen.text.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.descriptions.sdf.source import Source
    from wsgen.model.transform import Vector
    from wsgen.text.xmltree import Element


NO_GROUND = Rule(
    code="WLD006",
    name="no-ground",
    severity=Severity.WARNING,
    summary="The world does not have a ground plane.",
    what="Looks for a level plane at z = 0, or any other static model with a collision.",
    why="A robot that is spawned into such a world falls forever.",
    example='<world name="w">\n</world>',
    instead='<world name="w">\n'
    "  <include>\n"
    "    <uri>model://ground_plane</uri>\n"
    "  </include>\n"
    "</world>",
)

IMPOSSIBLE_STEP = Rule(
    code="WLD007",
    name="impossible-step",
    severity=Severity.ERROR,
    severity_varies="a warning for a long or short step, with which Gazebo still runs",
    measured=Measured(classic="simulates another model", sim="accepts it"),
    summary="The physics step is not positive, longer than 20 ms or shorter than 10 µs.",
    why="With long steps the engine misses contacts and becomes unstable; with short steps each "
    "second takes minutes. With a step of 0 or less, time does not pass; Gazebo Sim reads a step "
    "below one nanosecond as 0.",
    example="<physics>\n  <max_step_size>0.1</max_step_size>\n</physics>",
    instead="<physics>\n  <max_step_size>0.001</max_step_size>\n</physics>",
)

NO_DOWNWARD_GRAVITY = Rule(
    code="WLD045",
    name="no-downward-gravity",
    severity=Severity.WARNING,
    summary="The gravity of the world does not point down.",
    why="Robots float or fly away. This is right in space; otherwise the sign is usually wrong.",
    example="<gravity>0 0 9.8</gravity>",
    instead="<gravity>0 0 -9.8</gravity>",
)

DOWN = (0.0, 0.0, -1.0)
WHITE = (1.0, 1.0, 1.0)


def read_sun(source: Source, world: Element) -> tuple[Vector, Vector]:
    """The first light from above, which may be included: where it goes, and its color."""
    suns = []
    for element in children(world, "include", "light"):
        if element.tag == "light":
            sun = _sun(source, element)
            if sun is not None:
                suns.append(sun)
        elif is_sun(word(element, "uri")):
            suns.append((SUN_DIRECTION, SUN_COLOR))
    return suns[0] if suns else (SUN_DIRECTION, SUN_COLOR)


def _sun(source: Source, light: Element) -> tuple[Vector, Vector] | None:
    """Direction and color of a directional light that shines down; None for other lights."""
    is_on = truth(source, light, "light_on", default=True)
    if light.get("type") != "directional" or not is_on:
        return None
    pose, _ = read_pose(source, light)
    written = triple(source, light, "direction", default=DOWN)
    x, y, z = rotate(rotation_of_rpy(pose.rpy), written)
    length = math.hypot(x, y, z)
    if not 0 < length < math.inf or z >= 0:
        return None
    return (x / length, y / length, z / length), _color(source, light)


def _color(source: Source, light: Element) -> Vector:
    diffuse = first(light, "diffuse")
    if diffuse is None:
        return WHITE
    count = 3 if len((diffuse.text or "").split()) == 3 else 4  # noqa: PLR2004  rgb or rgba
    numbers = read_numbers(source, diffuse, count)
    if numbers is None:
        return WHITE
    red, green, blue = (min(1.0, max(0.0, part)) for part in numbers[:3])
    return (red, green, blue)


# What Gazebo Sim starts with if no world is named.
DEFAULT_WORLD = World(
    name="default",
    models=(PlacedModel(name=GROUND_PLANE, is_static=True),),
    has_ground_plane=True,
)


def default_world(simulator: str | None) -> World:
    """The world with sun and ground that a simulator brings along, of "classic" or "gz"."""
    if simulator != "classic":
        return DEFAULT_WORLD
    return replace(DEFAULT_WORLD, ground_friction=GROUND_PLANE_FRICTION)


STRONGEST_GRAVITY = 1000.0  # m/s²; at the surface of the Sun it is 274
SHORTEST_STEP = 1e-5  # s; with shorter ones, a second of a robot takes a minute or more
NANOSECOND = 1e-9  # s; Gazebo Sim counts time in whole ones
LONGEST_STEP = 0.02  # s; with longer ones contacts are missed, and no engine is stable


def describe_world(
    source: Source,
    element: Element,
    models: Sequence[PlacedModel],
    *,
    ground_friction: float | None,
) -> World:
    """The world of an element, with the models that were read from it."""
    sun_direction, sun_color = read_sun(source, element)
    return World(
        name=element.get("name") or "default",
        file=source.file,
        gravity=_gravity(source, element),
        step=_step(source, element),
        iterations=_of_ode(source, element, "solver", "iters"),
        correcting_speed=_of_ode(source, element, "constraints", "contact_max_correcting_vel"),
        models=tuple(models),
        has_ground_plane=ground_friction is not None,
        ground_friction=DEFAULT_WORLD.ground_friction
        if ground_friction is None
        else ground_friction,
        sun_direction=sun_direction,
        sun_color=sun_color,
        plugins=tuple(plugin.get("filename", "") for plugin in element.iter("plugin")),
    )


def check_ground(source: Source, element: Element, world: World) -> None:
    """Report a world without ground, unless it has water."""
    if not world.has_ground_plane and not any(map(carries, world.plugins)):
        source.report(
            NO_GROUND,
            "The world does not have a ground plane: robots that are spawned into it fall.",
            at=element,
            hint=GROUND_OF_GZ
            if any(map(is_of_gz, world.plugins))
            else "Add <include><uri>model://ground_plane</uri></include> to the world.",
        )


# Gazebo Sim brings no model of one along.
GROUND_OF_GZ = (
    'Add <model name="ground_plane"><static>true</static><link name="link">'
    '<collision name="collision"><geometry><plane><normal>0 0 1</normal><size>100 100</size>'
    "</plane></geometry></collision></link></model> to the world, with a similar <visual>."
)


def _gravity(source: Source, world: Element) -> tuple[float, float, float]:
    # Until SDF 1.5 it was part of <physics>.
    places = (world, *xmltree.children(world, "physics"))
    for element in (e for place in places for e in xmltree.children(place, "gravity")):
        numbers = read_numbers(source, element, 3, limit=STRONGEST_GRAVITY)
        if numbers:
            if numbers[2] >= 0:
                source.report(
                    NO_DOWNWARD_GRAVITY,
                    "The gravity of this world does not point down: it is "
                    f"{numbers[0]:g} {numbers[1]:g} {numbers[2]:g} m/s².",
                    at=element,
                    hint="Write <gravity>0 0 -9.8</gravity> for the gravity of Earth.",
                )
            return (numbers[0], numbers[1], numbers[2])
    return DEFAULT_WORLD.gravity


def _of_ode(source: Source, world: Element, *tags: str) -> tuple[float | None, int | None]:
    """A number of ODE's settings, if that is said, and the line."""
    for physics in children(world, "physics"):
        element = first(physics, "ode", *tags)
        numbers = None if element is None else read_numbers(source, element, 1)
        if element is not None and numbers:
            return numbers[0], line_of(element)
    return None, None


def _step(source: Source, world: Element) -> float:
    for physics in xmltree.children(world, "physics"):
        for element in xmltree.children(physics, "max_step_size"):
            numbers = read_numbers(source, element, 1)
            if numbers and SHORTEST_STEP <= numbers[0] <= LONGEST_STEP:
                return numbers[0]
            if numbers:
                runs = numbers[0] >= NANOSECOND
                source.report(
                    IMPOSSIBLE_STEP,
                    f"The physics step of {numbers[0]:g} s is not between {SHORTEST_STEP:g} and "
                    f"{LONGEST_STEP:g} s"
                    + (
                        f"; wsgen simulates with {DEFAULT_WORLD.step:g} s."
                        if runs
                        else ": time does not pass in Gazebo Sim."
                    ),
                    at=element,
                    hint="Write Gazebo's default, 0.001.",
                    severity=Severity.WARNING if runs else None,
                )
    return DEFAULT_WORLD.step
