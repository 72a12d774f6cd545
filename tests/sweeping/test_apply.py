"""Parameters of wsgen's own change what they say, and nothing else."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from simulation.robots import GROUND, PLATE, SPACE, body, shape, single
from sweeping.blueprints import blueprint, prepared
from wsgen.model.robot import Sphere
from wsgen.model.transform import Pose
from wsgen.model.world import SpawnHeight
from wsgen.sweeping import parameters
from wsgen.sweeping.run_variant import apply

if TYPE_CHECKING:
    from wsgen.sweeping.run_variant import Blueprint


def plate_of(made: Blueprint) -> tuple[float, tuple[float, ...], float, float]:
    """Mass, inertia and frictions of the robot that is simulated."""
    (link,) = made.prepared[0].lumped.links
    assert link.inertial is not None
    surface = link.collisions[0].surface
    return link.inertial.mass, link.inertial.inertia, surface.mu1, surface.mu2


@pytest.mark.parametrize("name", sorted(parameters.OWN_NAMES))
def test_each_name_that_can_be_given_has_an_effect(name: str) -> None:
    made = blueprint()
    pushed = {"push.force": 2.0} if name in parameters.NEED_A_FORCE else {}
    assert apply(made, {**pushed, name: 0.3}) != apply(made, pushed)


def test_other_parameters_change_nothing() -> None:
    made = blueprint()
    assert apply(made, {}) is made
    assert apply(made, {"wheel_radius": 0.1, "world": "office"}) is made


def test_the_ground_falls_along_x() -> None:
    x, y, z = apply(blueprint(), {"world.slope": 0.3}).world.gravity  # type: ignore[union-attr]
    assert (x, y, z) == pytest.approx((9.8 * math.sin(0.3), 0.0, -9.8 * math.cos(0.3)))


def test_gravity_has_the_strength_that_is_given_and_keeps_its_direction() -> None:
    world = replace(GROUND, gravity=(0.0, 3.0, -4.0))
    made = apply(blueprint(world=world), {"world.gravity": 10})
    assert made.world is not None
    assert made.world.gravity == pytest.approx((0.0, 6.0, -8.0))
    fallen = apply(blueprint(world=SPACE), {"world.gravity": 1.6, "world.slope": 0.1})
    assert fallen.world is not None
    assert fallen.world.gravity == pytest.approx((1.6 * math.sin(0.1), 0.0, -1.6 * math.cos(0.1)))


def test_a_contact_has_the_smaller_friction() -> None:
    robot = single(replace(body(PLATE), collisions=(shape(PLATE, mu=0.4), shape(Sphere(radius=1)))))
    made = apply(blueprint(prepared(robot)), {"world.friction": 0.6})
    (link,) = made.prepared[0].lumped.links
    assert [one.surface.mu1 for one in link.collisions] == [0.4, 0.6]
    assert [one.surface.mu2 for one in link.collisions] == [0.4, 0.6]
    both = apply(blueprint(), {"world.friction": 0.6, "robot.friction_scale": 0.5})
    assert plate_of(both)[2:] == (0.5, 0.5)


def test_masses_scale_with_inertias_and_inertias_alone() -> None:
    mass, inertia, *_ = plate_of(blueprint())
    heavier = plate_of(apply(blueprint(), {"robot.mass_scale": 3}))
    assert heavier[0] == 3 * mass
    assert heavier[1] == pytest.approx([3 * one for one in inertia])
    rounder = plate_of(apply(blueprint(), {"robot.mass_scale": 3, "robot.inertia_scale": 0.5}))
    assert rounder[0] == 3 * mass
    assert rounder[1] == pytest.approx([1.5 * one for one in inertia])


def test_the_robot_is_spawned_elsewhere() -> None:
    height = SpawnHeight(file=None, line=None, option="-z", holder="it")
    on_ground = replace(blueprint().prepared[0], on_the_ground=True, height=height)
    turned = apply(blueprint(on_ground), {"spawn.x": 2, "spawn.yaw": 0.5}).prepared[0]
    assert turned.spawn_pose == Pose((2.0, 0.0, 0.0501), (0.0, 0.0, 0.5))
    assert (turned.on_the_ground, turned.height) == (True, height)
    lifted = apply(blueprint(on_ground), {"spawn.z": 1.5, "spawn.roll": 0.1}).prepared[0]
    assert lifted.spawn_pose == Pose((0.0, 0.0, 1.5), (0.1, 0.0, 0.0))
    assert (lifted.on_the_ground, lifted.height) == (False, None)


def test_a_push_is_horizontal() -> None:
    assert apply(blueprint(), {"push.force": 8}).push == (8.0, 0.0, 0.0)
    made = apply(blueprint(), {"push.force": 8, "push.direction": math.pi / 2, "push.seconds": 1})
    assert made.push == pytest.approx((0.0, 8.0, 0.0))
    assert made.push_seconds == 1.0


def test_models_of_the_world_stay_as_they_are() -> None:
    model = replace(blueprint().prepared[0], is_static_model=True)
    everything = dict.fromkeys(parameters.OWN_NAMES, 0.5)
    assert apply(blueprint(model), everything).prepared == (model,)
