"""An SDF world file -> World.

What a trial needs of it: gravity, the physics step, and whether something carries the robot. The
models of the world other than sun and ground plane are listed, and reported as left out;
`wsgen.world.models` reads them too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen import xmltree
from wsgen.model.pose import IDENTITY, Pose
from wsgen.model.world import PlacedModel, World
from wsgen.world.included import GROUND_PLANE, SUN, is_ground_plane, is_sun
from wsgen.world.source import load
from wsgen.world.values import read_numbers

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.world.source import Source
    from wsgen.xmltree import Element

# What Gazebo starts with when no world is named: both generations ship one with sun and ground.
DEFAULT_WORLD = World(
    name="default",
    models=(PlacedModel(name=GROUND_PLANE, is_static=True),),
    has_ground_plane=True,
    lights=(SUN,),
)

LONGEST_STEP = 0.02  # s; with longer ones contacts are missed, and no engine is stable


def read_world(file: Path) -> tuple[World | None, tuple[Diagnostic, ...]]:
    """Read a world file; None where it cannot be used, with the reason among the diagnostics."""
    diagnostics: list[Diagnostic] = []
    source = load(file, diagnostics)
    world = None if source is None else _read(source)
    return world, tuple(diagnostics)


def _read(source: Source) -> World | None:
    is_sdf = source.root.tag == "sdf"
    element = next(xmltree.children(source.root, "world"), None) if is_sdf else None
    if element is None:
        source.error(
            "WLD003",
            f"There is no <world> in an <sdf> here; the root element is <{source.root.tag}>.",
            at=source.root,
            hint='A world file is <sdf version="1.5"><world name="..."> ... </world></sdf>.',
        )
        return None
    models = [*_includes(source, element), *_models(source, element)]
    has_ground = any(model.name == GROUND_PLANE for model in models) or _has_plane(element)
    world = describe_world(source, element, models, has_ground=has_ground)
    check_is_carried(source, element, world)
    return world


def describe_world(
    source: Source, element: Element, models: Sequence[PlacedModel], *, has_ground: bool
) -> World:
    """The world of an element in which these models stand."""
    return World(
        name=element.get("name") or "default",
        file=source.file,
        gravity=_gravity(source, element),
        step=_step(source, element),
        models=tuple(models),
        has_ground_plane=has_ground,
        lights=_lights(element),
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


def check_ground(source: Source, element: Element, z: float, tilt: tuple[float, ...]) -> None:
    """Report a ground that is not level at z = 0; `tilt` is about x and y, rad."""
    if (z, *tilt) != (0.0, 0.0, 0.0):
        source.warning(
            "WLD009",
            f"The ground is at z = {z:g} m, turned by {tilt[0]:g} and "
            f"{tilt[1]:g} rad; in the trial it is level, at z = 0.",
            at=element,
            hint="Put the ground plane at the origin, and spawn the robot above it.",
        )


def _includes(source: Source, world: Element) -> list[PlacedModel]:
    models = []
    for include in xmltree.children(world, "include"):
        uri = xmltree.child_text(include, "uri") or ""
        if is_sun(uri):
            continue
        pose = _pose(source, include)
        if is_ground_plane(uri):
            name, is_static = GROUND_PLANE, True
            check_ground(source, include, pose.xyz[2], pose.rpy[:2])
        else:
            last = uri.rstrip("/").rpartition("/")[2]
            name, is_static = xmltree.child_text(include, "name") or last, False
            _report_left_out(source, include, uri or "(no uri)")
        models.append(PlacedModel(name=name, uri=uri, pose_in_world=pose, is_static=is_static))
    return models


def _models(source: Source, world: Element) -> list[PlacedModel]:
    models = []
    for element in xmltree.children(world, "model"):
        model = PlacedModel(
            name=element.get("name", ""),
            pose_in_world=_pose(source, element),
            is_static=(xmltree.child_text(element, "static") or "").lower() in ("1", "true"),
        )
        models.append(model)
        if any(True for _ in element.iter("plane")):
            check_ground(source, element, model.pose_in_world.xyz[2], model.pose_in_world.rpy[:2])
        else:
            _report_left_out(source, element, model.name)
    return models


def _report_left_out(source: Source, element: Element, name: str) -> None:
    source.warning(
        "WLD004",
        f"The model {name} is not part of the trial: only sun and ground plane are.",
        at=element,
        hint="The robot is tried without it.",
    )


def _has_plane(world: Element) -> bool:
    return any(
        True
        for model in xmltree.children(world, "model")
        for collision in model.iter("collision")
        for _ in collision.iter("plane")
    )


def _lights(world: Element) -> tuple[str, ...]:
    suns = (xmltree.child_text(include, "uri") for include in xmltree.children(world, "include"))
    inline = (light.get("name", "") for light in xmltree.children(world, "light"))
    return (*(SUN for uri in suns if is_sun(uri or "")), *inline)


def _gravity(source: Source, world: Element) -> tuple[float, float, float]:
    # Until SDF 1.5 it was part of <physics>.
    places = (world, *xmltree.children(world, "physics"))
    for element in (e for place in places for e in xmltree.children(place, "gravity")):
        numbers = read_numbers(source, element, 3)
        if numbers:
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


def _pose(source: Source, element: Element) -> Pose:
    for pose in xmltree.children(element, "pose"):
        numbers = read_numbers(source, pose, 6)
        if numbers:
            return Pose((numbers[0], numbers[1], numbers[2]), (numbers[3], numbers[4], numbers[5]))
    return IDENTITY
