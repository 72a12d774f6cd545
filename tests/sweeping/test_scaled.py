"""The text of a robot with other numbers is the robot with other numbers."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from wsgen.descriptions.sdf.models import read_sdf
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.sweeping.parameters import FRICTION, FRICTION_SCALE, INERTIA_SCALE, MASS_SCALE
from wsgen.sweeping.worst import scale_text

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.model.robot import Link, Robot

    Reader = Callable[[str], Robot]


URDF = """\
<?xml version="1.0"?>
<!-- <mass value="1"/> stays -->
<robot name="r">
  <link name="base">
    <inertial>
      <mass value="2.0"/>  <!-- kg -->
      <inertia ixx="0.1" ixy="0" ixz="-0.01" iyy="0.2" iyz="0" izz="0.3"/>
    </inertial>
    <collision><geometry><box size="1 1 1"/></geometry></collision>
  </link>
  <link name="arm">
    <inertial><mass value="1e-1"/>
      <inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial>
    <collision><geometry><sphere radius="0.1"/></geometry></collision>
  </link>
  <joint name="j" type="revolute">
    <parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
  <gazebo reference="arm"><mu1>0.4</mu1><mu2> 0.2 </mu2></gazebo>
</robot>
"""
SDF = """\
<sdf version="1.7"><model name="m">
  <link name="base">
    <inertial><mass>2.0</mass><inertia><ixx>0.1</ixx><iyy>0.2</iyy><izz>0.25</izz></inertia></inertial>
    <collision name="bare"><geometry><box><size>1 1 1</size></box></geometry></collision>
    <collision name="half"><geometry><sphere><radius>1</radius></sphere></geometry>
      <surface><contact/><friction><ode><mu>0.4</mu></ode></friction></surface></collision>
    <collision name="soft"><geometry><sphere><radius>1</radius></sphere></geometry>
      <surface><contact/></surface></collision>
  </link>
</model></sdf>
"""


def urdf(text: str) -> Robot:
    robot, found = read_urdf(text, file=None)
    assert robot is not None, found
    return lump(robot)[0]


def sdf(text: str) -> Robot:
    found = read_sdf(Path("m.sdf"), content=text, find_model=lambda _: None)
    robot = found.models[0].robot
    assert robot is not None
    return robot


def numbers(link: Link) -> tuple[float, ...]:
    assert link.inertial is not None
    return (link.inertial.mass, *link.inertial.inertia)


def frictions(link: Link) -> list[tuple[float, float]]:
    return [(shape.surface.mu1, shape.surface.mu2) for shape in link.collisions]


@pytest.mark.parametrize(("text", "read"), [(URDF, urdf), (SDF, sdf)])
def test_masses_and_inertias(text: str, read: Reader) -> None:
    before, after = read(text), read(scale_text(text, {MASS_SCALE: 3.0, INERTIA_SCALE: 0.5}))
    for one, other in zip(before.links, after.links, strict=True):
        mass, *moments = numbers(one)
        assert numbers(other) == pytest.approx((3 * mass, *(1.5 * moment for moment in moments)))
        assert frictions(one) == frictions(other)


@pytest.mark.parametrize(("text", "read"), [(URDF, urdf), (SDF, sdf)])
@pytest.mark.parametrize(("friction", "ground"), [(0.5, None), (2.0, None), (1.5, 0.3), (1.0, 0.3)])
def test_frictions_also_where_none_is_written(
    text: str, read: Reader, friction: float, ground: float | None
) -> None:
    own = {FRICTION_SCALE: friction, **({} if ground is None else {FRICTION: ground})}
    before, after = read(text), read(scale_text(text, own))
    highest = math.inf if ground is None else ground
    for one, other in zip(before.links, after.links, strict=True):
        expected = [
            (min(highest, friction * mu1), min(highest, friction * mu2))
            for mu1, mu2 in frictions(one)
        ]
        assert frictions(other) == [pytest.approx(pair) for pair in expected]
        assert numbers(one) == numbers(other)


def test_nothing_else_changes() -> None:
    assert scale_text(URDF, {}) == URDF
    changed = scale_text(URDF, {MASS_SCALE: 2.0})
    assert [
        line
        for line, other in zip(URDF.splitlines(), changed.splitlines(), strict=True)
        if line != other
    ] == [line for line in URDF.splitlines() if "mass value" in line or "inertia i" in line][1:]
    assert "<!-- kg -->" in changed
