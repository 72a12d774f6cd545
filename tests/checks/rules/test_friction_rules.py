"""Rules about friction that has a direction: robots in a text, as Gazebo has them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from urdf_texts import MASS, joint, link, robot, shape
from wsgen.checks.rules.bodies import slippery_wheels
from wsgen.checks.rules.drives import friction_without_direction, turning_friction
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Robot

FILE = Path("robot.urdf")
BESIDE = "<mu1>1</mu1><mu2>{mu2}</mu2><fdir1 gz:expressed_in='base_footprint'>1 -1 0</fdir1>"
COPIED = (
    "<collision><surface><friction><ode><mu>1</mu><mu2>0</mu2>"
    "<fdir1 {where}>1 -1 0</fdir1></ode></friction></surface></collision>"
)
IN_FOOTPRINT = 'gz:expressed_in="base_footprint"'


AXIS = '<axis xyz="0 1 0"/>'
TURNED = '<origin rpy="-1.5707963 0 0"/><axis xyz="0 0 1"/>'  # the same axis, in another frame


def robots(about_the_wheel: str, axis: str = AXIS) -> tuple[Robot, Robot]:
    """As it is written, and as Gazebo has it."""
    touches = MASS + shape("collision", "<sphere radius='0.1'/>")
    body = link("base_footprint", "") + link("base_link") + link("wheel", touches)
    body += joint("f", "base_footprint", "base_link")
    body += joint("w", "base_link", "wheel", axis, kind="continuous")
    text = robot(f'{body}<gazebo reference="wheel">{about_the_wheel}</gazebo>')
    written, _ = read_urdf(text, file=FILE)
    assert written is not None
    return written, lump(written)[0]


def turning(about_the_wheel: str) -> list[Diagnostic]:
    return list(turning_friction(*robots(about_the_wheel), FILE))


def test_a_direction_that_stays_with_the_robot() -> None:
    assert turning(COPIED.format(where=IN_FOOTPRINT)) == []


@pytest.mark.parametrize(
    ("about_the_wheel", "why"),
    [
        (BESIDE.format(mu2=0), "it lacks a gz:expressed_in that Gazebo reads"),
        (COPIED.format(where=""), "it lacks a gz:expressed_in that Gazebo reads"),
        (
            COPIED.format(where='ignition:expressed_in="base_link"'),
            "gz:expressed_in names `base_link`, which is lumped into another link",
        ),
        (
            COPIED.format(where='gz:expressed_in="chassis"'),
            "gz:expressed_in names `chassis`, which is not a link of the robot",
        ),
    ],
)
def test_a_direction_that_turns_with_the_wheel(about_the_wheel: str, why: str) -> None:
    (found,) = turning(about_the_wheel)
    assert found.code == "ROB141"
    said = "The friction direction of `wheel` turns with the wheel: "
    assert found.message.startswith(said + why)
    assert found.hint is not None
    assert '<fdir1 gz:expressed_in="base_footprint">' in found.hint


def test_a_direction_that_changes_nothing() -> None:
    """Also that of tires, which slide to the side as they do ahead, and that of the axle."""
    assert turning(BESIDE.format(mu2=0.6)) == []
    assert turning("<mu1>0</mu1><mu2>1</mu2><fdir1>0 1 0</fdir1>") == []
    _, lumped = robots(BESIDE.format(mu2=1))
    assert list(friction_without_direction(lumped, ["bullet"])) == []


def test_engines_without_directions_are_named() -> None:
    _, lumped = robots(COPIED.format(where=IN_FOOTPRINT))
    assert list(friction_without_direction(lumped, ["mujoco"])) == []
    (found,) = friction_without_direction(lumped, ["bullet", "mujoco", "dart"])
    assert found.message == (
        "PyBullet and DART have no friction directions (<fdir1>), which `wheel` of `r` has: "
        "the robot does not drive sideways."
    )


def slippery(about_the_wheel: str, axis: str) -> list[str]:
    written, _ = robots(about_the_wheel, axis)
    found = slippery_wheels({"w"}, written.joints, written.gazebo, FILE)
    return [one.message for one in found]


@pytest.mark.parametrize("axis", [AXIS, TURNED])
def test_a_wheel_of_rollers_is_not_slippery(axis: str) -> None:
    assert slippery(BESIDE.format(mu2=0), axis) == []
    assert slippery("<mu1>0</mu1><mu2>1</mu2><fdir1>1 1 0</fdir1>", axis) == []


@pytest.mark.parametrize("axis", [AXIS, TURNED])
@pytest.mark.parametrize(
    ("about_the_wheel", "why"),
    [
        ("<mu1>1</mu1><mu2>0</mu2>", "(<mu2> is 0): it spins."),
        ("<mu1>1</mu1><mu2>0</mu2><fdir1>1 0 0</fdir1>", "(<mu2> is 0): it spins, or slides to"),
        ("<mu1>0</mu1><mu2>1</mu2><fdir1>0 1 0</fdir1>", "(<mu1> is 0): it spins, or slides to"),
        ("<mu1>0</mu1><mu2>0</mu2><fdir1>1 1 0</fdir1>", "(<mu1> is 0): it spins, or slides to"),
        ("<mu1>1</mu1><mu2>0</mu2><fdir1>1 1</fdir1>", "(<mu2> is 0): it spins, or slides to"),
        ("<mu1>1</mu1><mu2>0</mu2><fdir1>0 0 0</fdir1>", "(<mu2> is 0): it spins, or slides to"),
    ],
)
def test_a_direction_ahead_makes_no_rollers(about_the_wheel: str, why: str, axis: str) -> None:
    (message,) = slippery(about_the_wheel, axis)
    assert why in message
