"""Robots as small as can be, and the two ways to put them into an engine."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from contextlib import closing, contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.model.inertia import of_solid
from wsgen.model.robot import (
    Box,
    Collision,
    Cylinder,
    Geometry,
    Inertial,
    Joint,
    JointLimit,
    JointType,
    Link,
    Mesh,
    Robot,
    Sphere,
    Surface,
)
from wsgen.model.transform import IDENTITY, Pose
from wsgen.model.world import World
from wsgen.simulation.engine import Engine, Loaded, Refused
from wsgen.simulation.scene import RobotRun, Scene, SpawnedRobot
from wsgen.simulation.simulate import run_scene

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


NewEngine = Callable[[World], Engine]

GROUND = World(name="ground", has_ground_plane=True)
VOID = World(name="void")
SPACE = World(name="space", gravity=(0.0, 0.0, 0.0))
CYLINDER = Cylinder(radius=0.4, length=0.5)
PLATE = Box(size=(0.4, 0.4, 0.1))
G = 9.8  # m/s², what these worlds have


def slope(degrees: float) -> World:
    """Even ground with gravity tilted, which is a slope down along x."""
    angle = math.radians(degrees)
    return replace(GROUND, gravity=(G * math.sin(angle), 0.0, -G * math.cos(angle)))


def body(
    geometry: Geometry | None,
    *,
    name: str = "base",
    mass: float = 1.0,
    moment: float | None = None,
    at: Pose = IDENTITY,
    mu: float = 1.0,
) -> Link:
    """A link of one shape, evenly filled unless a moment is given."""
    solid = None if geometry is None or moment is not None else of_solid(geometry, mass)
    x, y, z = solid or (moment or 0.06,) * 3
    shapes = () if geometry is None else (shape(geometry, mu=mu, at=at),)
    return Link(
        name=name,
        inertial=Inertial(mass=mass, pose_in_link=at, inertia=(x, 0.0, 0.0, y, 0.0, z)),
        collisions=shapes,
    )


def shape(geometry: Geometry, *, mu: float = 1.0, at: Pose = IDENTITY) -> Collision:
    return Collision(geometry=geometry, pose_in_link=at, surface=Surface(mu1=mu, mu2=mu))


def single(link: Link) -> Robot:
    return Robot(name="r", root=link.name, links=(link,))


def tree(root: Link, *children: tuple[Joint, Link], **more: object) -> Robot:
    """A robot of links with the joints that lead to them."""
    return replace(
        Robot(
            name="r",
            root=root.name,
            links=(root, *(link for _, link in children)),
            joints=tuple(joint for joint, _ in children),
        ),
        **more,  # type: ignore[arg-type]
    )


def joint(parent: str, child: str, kind: JointType, at: Pose = IDENTITY, **more: object) -> Joint:
    """A joint of the same name as its child."""
    made = Joint(name=child, type=kind, parent=parent, child=child, pose_in_parent=at)
    return replace(made, **more)  # type: ignore[arg-type]


def lattice(*cells: tuple[int, int, int], edge: float = 0.1, mu: float = 1.0) -> Robot:
    """One body of cubes in these cells, evenly filled as the box around all of them."""
    sides = [max(places) - min(places) + 1 for places in zip(*cells, strict=True)]
    low = [min(places) for places in zip(*cells, strict=True)]
    a, b, c = (edge * side for side in sides)
    cubes = []
    for cell in cells:
        x, y, z = (
            edge * (place - least - (side - 1) / 2)
            for place, least, side in zip(cell, low, sides, strict=True)
        )
        cubes.append(shape(Box(size=(edge, edge, edge)), mu=mu, at=Pose((x, y, z))))
    return single(replace(body(Box(size=(a, b, c)), mass=5.0), collisions=tuple(cubes)))


BAR = body(Box(size=(1.0, 0.1, 0.1)), name="bar", at=Pose((0.5, 0.0, 0.0)))
BAR_MOMENT = 1.01 / 12 + 0.25  # kg m², about the joint it hangs on


def pendulum(kind: JointType = JointType.CONTINUOUS, **more: object) -> Robot:
    """A bar of 1 kg and 1 m that hangs on the world, held out sideways along x."""
    limit = JointLimit(lower=-3.0, upper=3.0, effort=100.0, velocity=100.0)
    at = Pose((0.0, 0.0, 2.0))
    swing = joint("world", "bar", kind, at, axis_in_joint=(0.0, 1.0, 0.0), limit=limit)
    swing = replace(swing, **more)  # type: ignore[arg-type]
    return tree(Link(name="world"), (swing, BAR), fixed_to_world=True)


def lift(**more: object) -> Robot:
    """A body of 1 kg that slides down a vertical joint at the world."""
    limit = JointLimit(lower=-100.0, upper=100.0, effort=1.0, velocity=1.0)
    slide = joint("world", "cabin", JointType.PRISMATIC, axis_in_joint=(0.0, 0.0, 1.0), limit=limit)
    cabin = body(None, name="cabin")
    return tree(
        Link(name="world"),
        (replace(slide, **more), cabin),  # type: ignore[arg-type]
        fixed_to_world=True,
    )


def cube_mesh(folder: Path, name: str = "cube.obj") -> Mesh:
    """A mesh of edge 2 m, to be scaled, around its frame."""
    file = folder / name
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    faces = ("1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4")
    text = "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
    file.write_text(text + "".join(f"f {face}\n" for face in faces))
    return Mesh(uri=name, path=str(file))


def run_of(
    new_engine: NewEngine,
    robot: Robot,
    z: float = 0.0,
    *,
    world: World = GROUND,
    seconds: float = 3.0,
    on_the_ground: bool = False,
) -> RobotRun:
    """What a simulation measures of a robot that is spawned at that height."""
    spawned = SpawnedRobot(
        entity="e", robot=robot, pose_in_world=Pose((0.0, 0.0, z)), on_the_ground=on_the_ground
    )
    scene = Scene(world=world, robots=(spawned,), seconds=seconds)
    with closing(new_engine(world)) as engine:
        (robot_run,), refused = run_scene(engine, scene, lambda _: None)
    assert refused == {}
    return robot_run


@contextmanager
def spawned(
    new_engine: NewEngine,
    robot: Robot,
    pose: Pose = IDENTITY,
    *others: SpawnedRobot,
    world: World = VOID,
) -> Iterator[Engine]:
    """An engine that has the robot in it as `e`."""
    with closing(new_engine(world)) as engine:
        for one in (SpawnedRobot(entity="e", robot=robot, pose_in_world=pose), *others):
            answer = engine.spawn(one)
            assert isinstance(answer, Loaded), answer
        yield engine


def loaded(new_engine: NewEngine, robot: Robot) -> Loaded | Refused:
    """What an engine makes of a robot."""
    with closing(new_engine(GROUND)) as engine:
        return engine.spawn(SpawnedRobot(entity="e", robot=robot))


def ball_on_mesh(new_engine: NewEngine, file: str) -> tuple[float, float]:
    """Where a ball comes to rest on a static mesh, in m, and the CPU time that it took, in s."""
    started = time.process_time()
    static_models = Link(
        name="static_models", collisions=(Collision(geometry=Mesh(uri=file, path=file)),)
    )
    ball = single(body(Sphere(radius=0.1)))
    start = Pose((math.pi / 2, 0.1, 0.3))
    other = SpawnedRobot(entity="o", robot=ball, pose_in_world=start)
    with spawned(
        new_engine, replace(single(static_models), is_static=True), IDENTITY, other, world=VOID
    ) as engine:
        engine.advance(2000)
        return engine.state("o").xyz[2], time.process_time() - started
