"""Blueprints of robots as small as can be."""

from __future__ import annotations

from typing import TYPE_CHECKING

from simulation.robots import GROUND, PLATE, body, single
from wsgen.model.sweep import Value, Variant
from wsgen.model.transform import Pose
from wsgen.pipeline.prepare import PreparedRobot
from wsgen.sweeping.run_variant import Blueprint

if TYPE_CHECKING:
    from wsgen.model.robot import Robot
    from wsgen.model.world import World

ON_THE_GROUND = Pose((0.0, 0.0, 0.0501))  # of the plate


def prepared(robot: Robot, entity: str = "plate", pose: Pose = ON_THE_GROUND) -> PreparedRobot:
    return PreparedRobot(
        entity=entity, written=robot, lumped=robot, readable=robot, spawn_pose=pose
    )


def blueprint(*robots: PreparedRobot, world: World | None = GROUND) -> Blueprint:
    """A plate on the ground, unless other robots are given."""
    plate = single(body(PLATE, mass=2.0))
    return Blueprint(name="plates", world=world, prepared=robots or (prepared(plate),))


def variant(number: int = 0, **values: Value) -> Variant:
    """A variant; two underscores stand for the dot in the name of a parameter."""
    return Variant(
        number=number, values={name.replace("__", "."): value for name, value in values.items()}
    )
