"""Which joints gravity can move."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from wsgen.model.kinematics import unactuated_joints
from wsgen.model.robot import Inertial, Joint, JointLimit, JointType, Link, Robot
from wsgen.model.transform import Pose

MOMENTS = (0.1, 0.0, 0.0, 0.1, 0.0, 0.1)


def part(name: str, center: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Link:
    inertial = Inertial(mass=1.0, pose_in_link=Pose(center), inertia=MOMENTS)
    return Link(name=name, inertial=inertial)


def joint(parent: str, child: str, kind: JointType = JointType.CONTINUOUS) -> Joint:
    return Joint(name=child, type=kind, parent=parent, child=child, axis_in_joint=(0.0, 1.0, 0.0))


def robot(link: Link, one: Joint | None = None, *more: tuple[Link, Joint]) -> Robot:
    return Robot(
        name="r",
        root="base",
        links=(part("base"), link, *(further for further, _ in more)),
        joints=(one or joint("base", link.name), *(further for _, further in more)),
    )


@pytest.mark.parametrize("center", [(0.0, 0.0, 0.0), (0.0, 0.3, 0.0), (0.003, -0.3, 0.003)])
def test_a_wheel_is_no_unactuated_joint(center: tuple[float, float, float]) -> None:
    """Its center of mass may be anywhere along its axle, and a little beside it."""
    assert unactuated_joints(robot(part("wheel", center))) == set()


@pytest.mark.parametrize("center", [(0.006, 0.0, 0.0), (0.0, 0.3, 0.2), (0.004, 0.0, 0.004)])
def test_a_wheel_off_its_axle_is_an_unactuated_joint(center: tuple[float, float, float]) -> None:
    assert unactuated_joints(robot(part("arm", center))) == {"arm"}


def test_the_axis_is_that_of_the_joint() -> None:
    slanted = replace(joint("base", "wheel"), axis_in_joint=(0.6, 0.8, 0.0))
    assert unactuated_joints(robot(part("wheel", (0.3, 0.4, 0.0)), slanted)) == set()
    assert unactuated_joints(robot(part("wheel", (-0.3, 0.4, 0.0)), slanted)) == {"wheel"}


@pytest.mark.parametrize("kind", [JointType.REVOLUTE, JointType.PRISMATIC])
def test_what_does_not_turn_without_end_is_an_unactuated_joint(kind: JointType) -> None:
    assert unactuated_joints(robot(part("arm"), joint("base", "arm", kind))) == {"arm"}


def test_what_carries_something_is_an_unactuated_joint() -> None:
    """A turntable with a wheel on it; a caster's fork."""
    fork = robot(part("fork"), joint("base", "fork"), (part("wheel"), joint("fork", "wheel")))
    assert unactuated_joints(fork) == {"fork"}


def test_fixed_joints_and_links_without_mass() -> None:
    assert unactuated_joints(robot(part("bump"), joint("base", "bump", JointType.FIXED))) == set()
    assert unactuated_joints(robot(Link(name="frame"))) == {"frame"}


def test_the_swivel_of_a_caster_is_no_unactuated_joint() -> None:
    """Gravity cannot turn it, though it carries the wheel."""
    upright = replace(joint("base", "fork"), axis_in_joint=(0.0, 0.0, 1.0))
    wheel = part("wheel"), joint("fork", "wheel")
    assert unactuated_joints(robot(part("fork", (0.1, 0.0, 0.0)), upright, wheel)) == set()
    # Upright in the robot, not in its own frame.
    turned = replace(
        joint("base", "fork"),
        axis_in_joint=(0.0, 1.0, 0.0),
        pose_in_parent=Pose(rpy=(math.pi / 2, 0.0, 0.0)),
    )
    assert unactuated_joints(robot(part("fork", (0.1, 0.0, 0.0)), turned, wheel)) == set()
    slanted = replace(upright, axis_in_joint=(0.0, 0.5, 0.866))
    assert unactuated_joints(robot(part("fork", (0.1, 0.0, 0.0)), slanted, wheel)) == {"fork"}


def test_a_wheel_with_limits_that_it_never_reaches() -> None:
    limit = JointLimit(lower=-1e16, upper=1e16, effort=1.0, velocity=1.0)
    axle = replace(joint("base", "wheel", JointType.REVOLUTE), limit=limit)
    assert unactuated_joints(robot(part("wheel"), axle)) == set()


def test_a_ball_in_its_socket_is_no_unactuated_joint() -> None:
    ball = joint("base", "ball", JointType.BALL)
    assert unactuated_joints(robot(part("ball"), ball)) == set()
    assert unactuated_joints(robot(part("ball", (0.0, 0.3, 0.0)), ball)) == {"ball"}
