"""The rules over the limits of joints, each with its facts and no files."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.checks.rules.joint_limits import (
    limits_in_degrees,
    limits_in_millimeters,
    negative_limits,
    no_range,
    useless_mimics,
    zero_limits,
)
from wsgen.diagnostics import Severity
from wsgen.model.robot import Box, Collision, GazeboTag, Joint, JointLimit, JointType, Link, Mimic

FILE = Path("robot.urdf")
SLIDES, TURNS = JointType.PRISMATIC, JointType.REVOLUTE


def joint(
    lower: float = -1.0,
    upper: float = 1.0,
    *,
    kind: JointType = TURNS,
    effort: float = 5.0,
    velocity: float = 2.0,
    mimic: Mimic | None = None,
    name: str = "elbow",
) -> Joint:
    limit = JointLimit(lower=lower, upper=upper, effort=effort, velocity=velocity)
    return Joint(name=name, type=kind, parent="a", child="b", limit=limit, mimic=mimic, line=7)


@pytest.mark.parametrize(
    ("lower", "upper", "hint"),
    [
        (-90.0, 90.0, 'lower="-1.5708" upper="1.5708"'),
        (0.0, 180.0, 'lower="0" upper="3.1416"'),
        (-45.0, 30.0, 'lower="-0.7854" upper="0.5236"'),
        (-117.5, 0.0, 'lower="-2.0508" upper="0"'),
    ],
)
def test_limits_in_degrees(lower: float, upper: float, hint: str) -> None:
    (found,) = limits_in_degrees([joint(lower, upper)], FILE)
    assert (found.code, found.severity, found.line) == ("ROB081", Severity.WARNING, 7)
    assert found.element == "joint[@name='elbow']/limit"
    assert hint in (found.hint or "")


@pytest.mark.parametrize(
    "sound",
    [
        joint(-3.14, 3.14),
        joint(-6.283, 6.283),
        joint(-10.0, 10.0),
        joint(-12.566, 12.566),  # two turns, in radians
        joint(-1e16, 1e16),
        joint(-1000.0, 1000.0),
        joint(0.0, 45.0, kind=SLIDES),
        joint(-90.0, 90.0, kind=JointType.CONTINUOUS),
    ],
)
def test_limits_in_radians(sound: Joint) -> None:
    assert not list(limits_in_degrees([sound], FILE))


def test_no_effort_and_no_velocity() -> None:
    (effort,) = zero_limits([joint(effort=0.0)], FILE)
    (velocity,) = zero_limits([joint(velocity=0.0, kind=SLIDES)], FILE)
    assert (effort.code, velocity.code) == ("ROB082", "ROB083")
    assert effort.line == velocity.line == 7
    assert "N m" in (effort.hint or "")
    assert "m/s" in (velocity.hint or "")


def test_what_no_motor_moves_needs_no_effort() -> None:
    follower = joint(effort=0.0, velocity=0.0, mimic=Mimic(joint="other"))
    fixed = joint(effort=0.0, velocity=0.0, kind=JointType.FIXED)
    without_bound = joint(effort=-1.0, velocity=-1.0)  # of SDF
    assert not list(zero_limits([follower, fixed, without_bound, joint()], FILE))
    spring = GazeboTag(reference="elbow", values={"springStiffness": "100"})
    assert not list(zero_limits([joint(effort=0.0, velocity=0.0)], FILE, [spring]))


def test_a_joint_without_range() -> None:
    (found,) = no_range([joint(0.0, 0.0)], FILE)
    assert (found.code, found.line) == ("ROB084", 7)
    assert not list(no_range([joint(), joint(0.0, 0.0, kind=JointType.CONTINUOUS)], FILE))


def test_a_joint_that_mimics_a_fixed_one() -> None:
    leader = joint(name="left", kind=JointType.FIXED)
    follower = joint(name="right", mimic=Mimic(joint="left"))
    (found,) = useless_mimics([leader, follower], FILE)
    assert (found.code, found.element) == ("ROB085", "joint[@name='right']/mimic")
    fixed = joint(name="right", mimic=Mimic(joint="left"), kind=JointType.FIXED)
    (found,) = useless_mimics([joint(name="left"), fixed], FILE)
    assert "is itself fixed" in found.message
    assert found.severity is Severity.INFO


def test_a_joint_that_cannot_follow() -> None:
    leader = joint(0.0, 0.04, name="left", kind=SLIDES)
    mimic = Mimic(joint="left", multiplier=-1.0)
    follower = joint(0.0, 0.04, name="right", kind=SLIDES, mimic=mimic)
    (found,) = useless_mimics([leader, follower], FILE)
    assert (found.code, found.severity) == ("ROB086", Severity.INFO)
    assert 'lower="-0.04" upper="0"' in (found.hint or "")
    mirrored = joint(-0.04, 0.0, name="right", kind=SLIDES, mimic=mimic)
    unknown = joint(mimic=Mimic(joint="nobody"))
    assert not list(useless_mimics([leader, mirrored, unknown], FILE))


@pytest.mark.parametrize(
    ("lower", "upper", "extent", "hint"),
    [
        (0.0, 300.0, 1.0, 'lower="0" upper="0.3"'),
        (-150.0, 150.0, 0.8, 'lower="-0.15" upper="0.15"'),
        (0.0, 40.0, 0.1, 'lower="0" upper="0.04"'),
        (-12.5, 0.0, 0.2, 'lower="-0.0125" upper="0"'),
    ],
)
def test_limits_in_millimeters(lower: float, upper: float, extent: float, hint: str) -> None:
    links = [body("a"), body("b")]
    joints = [joint(lower, upper, kind=SLIDES)]
    (found,) = limits_in_millimeters(joints, links, extent, FILE)
    assert (found.code, found.severity, found.line) == ("ROB132", Severity.WARNING, 7)
    assert found.hint == f"Write {hint}."


def body(name: str) -> Link:
    return Link(name=name, collisions=(Collision(geometry=Box(size=(0.1, 0.1, 0.1))),))


@pytest.mark.parametrize(
    ("lower", "upper", "extent"),
    [
        (0.0, 0.3, 1.0),
        (0.0, 20.0, 15.0),  # a crane
        (0.0, 8.0, 0.1),  # nobody writes so short a slider in millimeters
        (-1e16, 1e16, 1.0),  # no limit
        (-10000.0, 10000.0, 1.0),  # the same
        (0.0, 299.997, 1.0),  # computed
        (0.0, 300.0, 0.0),  # nothing has a size
    ],
)
def test_limits_that_are_no_millimeters(lower: float, upper: float, extent: float) -> None:
    links = [body("a"), body("b")]
    joints = [joint(lower, upper, kind=SLIDES)]
    assert [*limits_in_millimeters(joints, links, extent, FILE)] == []


def test_the_way_of_a_robot_over_the_floor_is_no_slider() -> None:
    joints = [joint(-100.0, 100.0, kind=SLIDES)]
    assert [*limits_in_millimeters(joints, [Link(name="a"), body("b")], 1.0, FILE)] == []
    joints = [joint(-100.0, 100.0, kind=TURNS)]
    assert [*limits_in_millimeters(joints, [body("a"), body("b")], 1.0, FILE)] == []


@pytest.mark.parametrize(
    ("effort", "velocity", "hints"),
    [
        (-10.0, 1.0, ['Write effort="10".']),
        (1.0, -0.5, ['Write velocity="0.5".']),
        (-1.0, -1.0, ['Write effort="1".', 'Write velocity="1".']),
        (0.0, 0.0, []),
    ],
)
def test_negative_limits(effort: float, velocity: float, hints: list[str]) -> None:
    joints = [joint(effort=effort, velocity=velocity)]
    found = [*negative_limits(joints, FILE)]
    assert [one.hint for one in found] == hints
    assert {one.code for one in found} <= {"ROB131"}
    fixed = [joint(effort=effort, velocity=velocity, kind=JointType.FIXED)]
    assert [*negative_limits(fixed, FILE)] == []
