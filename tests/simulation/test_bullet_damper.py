"""Which dampers are too stiff for PyBullet's own; what they do is in `test_engines_joints`."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from simulation.robots import BAR, BAR_MOMENT, body, joint, lift, pendulum, tree
from wsgen.model.robot import JointType
from wsgen.model.transform import Pose
from wsgen.simulation.bullet_body import undamped
from wsgen.simulation.engine import STIFF, is_stiff

if TYPE_CHECKING:
    from wsgen.model.robot import Robot


STEP = 0.001  # s
EDGE = STIFF / STEP  # of the damping, times what the joint moves


def stiff(robot: Robot, damping: float, step: float = STEP) -> bool:
    return is_stiff(replace(robot.joints[0], damping=damping), robot, step)


@pytest.mark.parametrize(("robot", "resistance"), [(lift(), 1.0), (pendulum(), BAR_MOMENT)])
def test_a_mass_on_a_slide_and_a_bar_about_its_end(robot: Robot, resistance: float) -> None:
    assert stiff(robot, 1.01 * EDGE * resistance)
    assert not stiff(robot, 0.99 * EDGE * resistance)
    assert stiff(robot, 0.51 * EDGE * resistance, step=2 * STEP)


def test_the_axis_decides() -> None:
    """About its own length the bar has next to no inertia."""
    about_itself = pendulum(axis_in_joint=(1.0, 0.0, 0.0))
    slim = 0.02 / 12
    assert stiff(about_itself, 1.01 * EDGE * slim)
    assert not stiff(about_itself, 0.99 * EDGE * slim)


def test_turned_principal_axes() -> None:
    arm = pendulum(axis_in_joint=(0.0, 0.6, 0.8))
    turned = replace(BAR, inertial=replace(BAR.inertial, pose_in_link=Pose((0.5, 0, 0), (1, 0, 0))))  # type: ignore[type-var]
    robot = replace(arm, links=(arm.links[0], turned))
    assert stiff(robot, 1.01 * EDGE * BAR_MOMENT)
    assert not stiff(robot, 0.99 * EDGE * BAR_MOMENT)


def test_the_lighter_side_decides() -> None:
    slide = joint("base", "cart", JointType.PRISMATIC)
    for masses in ((1.0, 100.0), (100.0, 1.0)):
        heavy, light = (
            body(None, name=n, mass=m) for n, m in zip(("base", "cart"), masses, strict=True)
        )
        robot = tree(heavy, (slide, light))
        assert stiff(robot, 1.01 * EDGE)
        assert not stiff(robot, 0.99 * EDGE)


def test_without_damping_or_motion_nothing_is_stiff() -> None:
    assert not stiff(pendulum(), 0.0)
    assert not stiff(pendulum(JointType.FIXED), 1e9)


def test_the_damping_is_taken_away_of_what_is_named() -> None:
    joints = tuple(
        joint("base", name, JointType.CONTINUOUS, damping=2.0, friction=1.0) for name in "ab"
    )
    kept, taken = undamped(joints, {"b"})
    assert kept == joints[0]
    assert taken == replace(joints[1], damping=0.0)
