"""What the parent link of a joint exerts on its child, of every engine."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from simulation.robots import GROUND, VOID, G, body, joint, pendulum, spawned, tree
from wsgen.model.robot import Box, JointType, Link
from wsgen.model.transform import IDENTITY, Pose
from wsgen.simulation.engine import Motor

if TYPE_CHECKING:
    from simulation.robots import NewEngine
    from wsgen.model.robot import Robot

# 2 kg, whose center is 0.3 m along x of the frame.
LOAD = body(Box(size=(0.1, 0.1, 0.1)), name="load", mass=2.0, at=Pose((0.3, 0.0, 0.0)))
TURNED = Pose((0.1, 0.0, 2.0), (0.0, 0.0, math.pi / 2))
MOMENT = 2.0 * 0.01 / 6 + 2.0 * 0.09  # kg m², about the joint


def near(*numbers: float) -> object:
    return pytest.approx(numbers, abs=0.03)


def test_a_fixed_joint_carries_a_weight(new_engine: NewEngine) -> None:
    """Seen from the world, about the child's frame, which is turned by 90 degrees."""
    robot = tree(
        Link(name="world"),
        (joint("world", "load", JointType.FIXED, TURNED), LOAD),
        fixed_to_world=True,
    )
    with spawned(new_engine, robot, IDENTITY, world=VOID) as engine:
        engine.joint_wrench("e", "load")
        engine.advance(5)
        force, torque = engine.joint_wrench("e", "load")
        assert force == near(0.0, 0.0, 2 * G)
        assert torque == near(0.3 * 2 * G, 0.0, 0.0)  # the center of mass is along y of the world


def arm(axis: tuple[float, float, float]) -> Robot:
    turns = joint("world", "load", JointType.CONTINUOUS, Pose((0.1, 0.0, 2.0)), axis_in_joint=axis)
    return tree(Link(name="world"), (turns, LOAD), fixed_to_world=True)


def test_a_motor_is_part_of_it(new_engine: NewEngine) -> None:
    with spawned(new_engine, arm((0.0, 1.0, 0.0)), IDENTITY, world=VOID) as engine:
        engine.drive("e", {"load": Motor(0.0, 1e4)})
        engine.joint_wrench("e", "load")
        engine.advance(20)
        force, torque = engine.joint_wrench("e", "load")
        assert force == near(0.0, 0.0, 2 * G)
        assert torque == near(0.0, -0.3 * 2 * G, 0.0)


def test_an_effort_is_part_of_it(new_engine: NewEngine) -> None:
    with spawned(new_engine, arm((0.0, 1.0, 0.0)), IDENTITY, world=VOID) as engine:
        engine.set_efforts("e", {"load": -2.0})
        engine.joint_wrench("e", "load")
        engine.advance(2)
        force, torque = engine.joint_wrench("e", "load")
        falls = (2 * G * 0.3 - 2.0) / MOMENT  # rad/s²
        assert force == near(0.0, 0.0, 2 * G - 2 * 0.3 * falls)
        assert torque == near(0.0, -2.0, 0.0)


def test_what_turns_is_pulled_to_the_middle(new_engine: NewEngine) -> None:
    with spawned(new_engine, arm((0.0, 0.0, 1.0)), IDENTITY, world=VOID) as engine:
        engine.drive("e", {"load": Motor(4.0, 1e4)})
        engine.joint_wrench("e", "load")
        engine.advance(100)
        force, _ = engine.joint_wrench("e", "load")
        angle = engine.joint_positions("e")["load"]
        pull = 2.0 * 0.3 * 4.0**2
        assert force == pytest.approx(
            (-pull * math.cos(angle), -pull * math.sin(angle), 2 * G), abs=0.08
        )


def test_what_stands_on_the_ground_is_pressed_down(new_engine: NewEngine) -> None:
    """The ground's push is part of it: the child carries the robot."""
    foot = body(Box(size=(0.3, 0.3, 0.1)), name="foot", mass=1.0)
    robot = tree(
        body(Box(size=(0.1, 0.1, 0.1)), mass=5.0),
        (joint("base", "foot", JointType.FIXED, Pose((0.0, 0.0, -0.3))), foot),
    )
    with spawned(new_engine, robot, Pose((0.0, 0.0, 0.35)), world=GROUND) as engine:
        engine.joint_wrench("e", "foot")
        engine.advance(1000)
        force, torque = engine.joint_wrench("e", "foot")
        assert force == pytest.approx((0.0, 0.0, -5 * G), abs=0.5)
        assert torque == pytest.approx((0.0, 0.0, 0.0), abs=0.2)


def test_nothing_before_a_step_and_of_unknown_joints(new_engine: NewEngine) -> None:
    still = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    with spawned(new_engine, replace(pendulum()), IDENTITY, world=VOID) as engine:
        assert engine.joint_wrench("e", "bar") == still
        engine.advance(3)
        assert engine.joint_wrench("e", "bar") != still
        assert engine.joint_wrench("e", "leg") == still
        engine.place("e", IDENTITY)
        assert engine.joint_wrench("e", "bar") == still
