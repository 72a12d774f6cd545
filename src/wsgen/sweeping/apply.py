"""Vary a blueprint by parameters of wsgen's own; nothing is read or written.

Poses, and all that is measured, stay relative to the ground: on a slope gravity is tilted instead,
so that "up" is the ground's normal.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.model.transform import Pose
from wsgen.sweeping.parameters import (
    FRICTION,
    FRICTION_SCALE,
    GRAVITY,
    INERTIA_SCALE,
    MASS_SCALE,
    PUSH_DIRECTION,
    PUSH_FORCE,
    PUSH_SECONDS,
    SLOPE,
    SPAWN_PITCH,
    SPAWN_ROLL,
    SPAWN_X,
    SPAWN_Y,
    SPAWN_YAW,
    SPAWN_Z,
    own_values,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from wsgen.model.robot import Inertial, Link, Robot, Surface
    from wsgen.model.sweep import Value
    from wsgen.model.transform import Vector
    from wsgen.model.world import World
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.sweeping.blueprint import Blueprint


OF_THE_SPAWN_POSE = (SPAWN_X, SPAWN_Y, SPAWN_Z, SPAWN_ROLL, SPAWN_PITCH, SPAWN_YAW)
OF_THE_WORLD = (SLOPE, GRAVITY)
OF_THE_LINKS = (FRICTION, MASS_SCALE, INERTIA_SCALE, FRICTION_SCALE)


def apply(blueprint: Blueprint, values: Mapping[str, Value]) -> Blueprint:
    """The blueprint with the values of those parameters that are wsgen's own.

    Models of the world around the robots stay as they are. Parameters of other names, which have
    had their effect on the blueprint already, are left out.
    """
    own = own_values(values)
    if not own:
        return blueprint
    world = blueprint.world
    return replace(
        blueprint,
        world=None if world is None else _tilted(world, own),
        prepared=tuple(
            robot if robot.is_static_model else _varied(robot, own) for robot in blueprint.prepared
        ),
        push=_push(own) if PUSH_FORCE in own else blueprint.push,
        push_seconds=own.get(PUSH_SECONDS, blueprint.push_seconds),
    )


def _tilted(world: World, own: Mapping[str, float]) -> World:
    """The world with its gravity, seen from a ground that falls along +x."""
    if not any(name in own for name in OF_THE_WORLD):
        return world
    x, y, z = world.gravity
    strength = math.hypot(x, y, z)
    if GRAVITY in own:
        factor = own[GRAVITY] / strength if strength else 0.0
        x, y, z = (factor * x, factor * y, factor * z) if strength else (0.0, 0.0, -own[GRAVITY])
    slope = own.get(SLOPE, 0.0)
    sin, cos = math.sin(slope), math.cos(slope)
    return replace(world, gravity=(x * cos - z * sin, y, x * sin + z * cos))


def _push(own: Mapping[str, float]) -> Vector:
    """The force in the world; without a direction along +x."""
    direction = own.get(PUSH_DIRECTION, 0.0)
    return own[PUSH_FORCE] * math.cos(direction), own[PUSH_FORCE] * math.sin(direction), 0.0


def _varied(prepared: PreparedRobot, own: Mapping[str, float]) -> PreparedRobot:
    if any(name in own for name in OF_THE_SPAWN_POSE):
        prepared = _moved(prepared, own)
    if not any(name in own for name in OF_THE_LINKS):
        return prepared
    vary = _link_varier(own)
    return replace(
        prepared,
        written=_with_links(prepared.written, vary),
        lumped=_with_links(prepared.lumped, vary),
        readable=None if prepared.readable is None else _with_links(prepared.readable, vary),
    )


def _moved(prepared: PreparedRobot, own: Mapping[str, float]) -> PreparedRobot:
    (x, y, z), (roll, pitch, yaw) = prepared.spawn_pose.xyz, prepared.spawn_pose.rpy
    pose = Pose(
        xyz=(own.get(SPAWN_X, x), own.get(SPAWN_Y, y), own.get(SPAWN_Z, z)),
        rpy=(own.get(SPAWN_ROLL, roll), own.get(SPAWN_PITCH, pitch), own.get(SPAWN_YAW, yaw)),
    )
    if SPAWN_Z not in own:
        return replace(prepared, spawn_pose=pose)
    # No launch file gives this height: hints must not name one.
    return replace(prepared, spawn_pose=pose, on_the_ground=False, height=None)


def _with_links(robot: Robot, vary: Callable[[Link], Link]) -> Robot:
    return replace(robot, links=tuple(map(vary, robot.links)))


def _link_varier(own: Mapping[str, float]) -> Callable[[Link], Link]:
    """What makes of a link the one with other masses, inertias and frictions."""
    mass = own.get(MASS_SCALE, 1.0)
    inertia = mass * own.get(INERTIA_SCALE, 1.0)
    scale, ground = own.get(FRICTION_SCALE, 1.0), own.get(FRICTION, math.inf)
    has_friction = FRICTION_SCALE in own or FRICTION in own
    has_inertia = MASS_SCALE in own or INERTIA_SCALE in own

    def surface_of(surface: Surface) -> Surface:
        # Two that touch have the friction of the smaller coefficient.
        return replace(
            surface,
            mu1=min(ground, scale * surface.mu1),
            mu2=min(ground, scale * surface.mu2),
        )

    def inertial_of(inertial: Inertial) -> Inertial:
        xx, xy, xz, yy, yz, zz = (inertia * moment for moment in inertial.inertia)
        return replace(inertial, mass=mass * inertial.mass, inertia=(xx, xy, xz, yy, yz, zz))

    def vary(link: Link) -> Link:
        if has_inertia and link.inertial is not None:
            link = replace(link, inertial=inertial_of(link.inertial))
        if has_friction and link.collisions:
            link = replace(
                link,
                collisions=tuple(
                    replace(shape, surface=surface_of(shape.surface)) for shape in link.collisions
                ),
            )
        return link

    return vary
