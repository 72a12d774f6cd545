"""Worlds of one body each, for wsgen's engines and for the real Gazebo Classic."""

from __future__ import annotations

import importlib
import math
from contextlib import closing
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from simulation.conftest import CLASSES
from wsgen.checks.rules.settings import without
from wsgen.descriptions.sdf.models import read_sdf
from wsgen.model.engines import ENGINES as SPECS
from wsgen.simulation.run import missing_engines
from wsgen.simulation.scene import SpawnedRobot

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.checks.rules.settings import Setting
    from wsgen.model.transform import Vector

ENGINES = [name for name in SPECS if not missing_engines([name])]
BOX = "<box><size>0.4 0.4 0.1</size></box>"
SPHERE = "<sphere><radius>0.1</radius></sphere>"
GRAVITY = 9.8  # m/s²


def not_followed(setting: Setting) -> tuple[str, tuple[str, ...]]:
    """Why engines differ from Gazebo Classic where a setting is, and which."""
    elements = setting.elements.replace("`", "")
    return f"with {elements}, {setting.in_gazebo} there", without(setting, SPECS)


class Body(NamedTuple):
    """One that is let go."""

    shape: str = BOX
    surface: str = ""
    height: float = 0.05  # m, of its middle
    gravity: Vector = (0.0, 0.0, -GRAVITY)  # m/s²; tilted, level ground is a slope
    ground: float | None = 100.0  # its friction; None: Gazebo's default
    seconds: float = 1.0
    more: str = ""  # of the link
    constraints: str = ""  # of ODE, in the world


def friction(mu: float, mu2: float | None = None, more: str = "") -> str:
    second = mu if mu2 is None else mu2
    return f"<friction><ode><mu>{mu}</mu><mu2>{second}</mu2>{more}</ode></friction>"


def down(degrees: float, heading: float = 0.0) -> Vector:
    """Gravity on a slope down along this heading, degrees."""
    angle, way = math.radians(degrees), math.radians(heading)
    along = GRAVITY * math.sin(angle)
    return (along * math.cos(way), along * math.sin(way), -GRAVITY * math.cos(angle))


SURFACES = {
    **{
        f"mu {mu:g} on {ground:g}, {degrees} degrees": Body(
            surface=friction(mu), ground=ground, gravity=down(degrees)
        )
        for mu, ground, degrees in (
            (0.05, 100, 2),
            (0.05, 100, 10),
            (0.2, 100, 30),
            (0.5, 100, 45),
            (1, 100, 30),
            (1, 100, 60),
            (1.5, 100, 50),
            (1.5, 100, 65),
            (3, 100, 60),
            (50, 100, 60),
            (100, 100, 70),
            (1, 0.3, 30),
            (0.1, 0.3, 30),
            (100, 1.5, 60),
        )
    },
    "mu 3 on the default, 60 degrees": Body(surface=friction(3), ground=None, gravity=down(60)),
    **{
        f"mu 0.1 alone, down along {heading} degrees": Body(
            surface="<friction><ode><mu>0.1</mu></ode></friction>", gravity=down(40, heading)
        )
        for heading in (0, 90)
    },
    "mu 0.5 down along 45 degrees": Body(surface=friction(0.5), gravity=down(40, 45)),
    **{
        f"mu 0.5, mu2 0.1, down along {heading} degrees": Body(
            surface=friction(0.5, 0.1), gravity=down(40, heading)
        )
        for heading in (0, 45, 90)
    },
    **{
        f"fdir1, mu 0.5, mu2 0.1, down along {heading} degrees": Body(
            surface=friction(0.5, 0.1, "<fdir1>1 0 0</fdir1>"), gravity=down(40, heading)
        )
        for heading in (0, 90)
    },
    "falls 0.5 m": Body(SPHERE, height=0.6, seconds=0.5),
    "falls, with velocity decay": Body(
        SPHERE,
        height=0.6,
        seconds=0.4,
        more="<velocity_decay><linear>0.01</linear></velocity_decay>",
    ),
    "bounces, but not off the ground": Body(
        SPHERE,
        "<bounce><restitution_coefficient>0.5</restitution_coefficient>"
        "<threshold>0.01</threshold></bounce>",
        height=0.6,
        seconds=0.55,
    ),
    **{
        f"slip2 {slip:g}, 10 degrees": Body(
            surface=friction(1, 1, f"<slip2>{slip}</slip2>"), gravity=down(10), seconds=2.0
        )
        for slip in (0.001, 0.1)
    },
    "rests": Body(seconds=2.0),
    **{
        f"rests where {tag} is {value:g}": Body(seconds=2.0, constraints=f"<{tag}>{value}</{tag}>")
        for tag, value in (("cfm", 0.001), ("erp", 0.8), ("contact_surface_layer", 0.01))
    },
    "rests on a soft surface": Body(
        surface="<contact><ode><kp>1000</kp><kd>10</kd></ode></contact>", seconds=2.0
    ),
    "5 mm deep": Body(height=0.045, seconds=1.0),
    "5 mm deep, with min_depth": Body(
        surface="<contact><ode><min_depth>0.003</min_depth></ode></contact>", height=0.045
    ),
    "without gravity": Body(height=0.5, more="<gravity>0</gravity>"),
}


def world_of(one: Body) -> str:
    """The file of its world."""
    own = "" if one.ground is None else friction(one.ground)
    moment = 0.01 if one.shape == BOX else 0.004
    return f"""<?xml version="1.0"?>
<sdf version="1.6"><world name="w">
  <physics type="ode"><ode><constraints>{one.constraints}</constraints></ode></physics>
  <gravity>{" ".join(f"{part:.9g}" for part in one.gravity)}</gravity>
  <model name="floor"><static>true</static><link name="link"><collision name="c">
    <geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry>
    <surface>{own}</surface>
  </collision></link></model>
  <model name="body"><pose>0 0 {one.height} 0 0 0</pose><link name="link">
    <inertial><mass>1</mass><inertia><ixx>{moment}</ixx><iyy>{moment}</iyy><izz>{moment}</izz>
    </inertia></inertial>
    <collision name="c"><geometry>{one.shape}</geometry><surface>{one.surface}</surface></collision>
    {one.more}
  </link></model>
</world></sdf>
"""


def simulated(one: Body, engine: str, folder: Path) -> tuple[Vector, Vector]:
    """Where its body is after its time in an engine of wsgen, m, and how it moves, m/s."""
    file = folder / "w.world"
    file.write_text(world_of(one), encoding="utf-8")
    read = read_sdf(file, find_model=lambda _: None)
    assert read.world is not None
    classic = replace(read.world, simulator="classic")
    module = importlib.import_module(f"wsgen.simulation.{engine}")
    (model,) = read.models
    assert model.robot is not None
    with closing(getattr(module, CLASSES[engine])(classic)) as world:
        world.spawn(
            SpawnedRobot(entity="body", robot=model.robot, pose_in_world=model.pose_in_world)
        )
        world.advance(round(one.seconds / world.step_seconds))
        linear, _ = world.link_velocities("body")["link"]
        return world.link_poses("body")["link"].xyz, linear
